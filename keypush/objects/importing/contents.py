"""The bytes of a mesh file, made fit for a reader that knows UTF-8 alone."""

import json
from pathlib import Path

from keypush.errors import UserError, one_line

_STL_HEADER = 84
_STL_FACE = 50
_STL_BEGINNING = 2000
"""Bytes in which the first face of one that is text begins."""
_NOT_ASCII = bytes(range(128)) + b"?" * 128


def read_contents(path: Path) -> bytes:
    """Returns a file's bytes.

    Raises:
        UserError: it cannot be read, is a glTF file that is not JSON, or a binary STL file
            that ends too early.
    """
    try:
        data = path.read_bytes()
    except OSError as error:
        raise UserError(f"{path}: cannot be read: {error.strerror}") from error
    if path.suffix.lower() == ".gltf":
        # In place of one that it cannot read, trimesh would take a file `model.gltf` beside it.
        try:
            json.loads(data)
        except (ValueError, RecursionError) as error:
            raise UserError(f"{path}: cannot be read as glTF: {one_line(error)}") from error
    if path.suffix.lower() == ".stl" and b"facet" not in data[:_STL_BEGINNING].lower():
        return _whole_stl(path, data)
    return data


def _whole_stl(path: Path, data: bytes) -> bytes:
    """Returns a binary STL file without what some programs append."""
    faces = int.from_bytes(data[_STL_HEADER - 4 : _STL_HEADER], "little")
    expected = _STL_HEADER + _STL_FACE * faces
    if len(data) < expected:
        raise UserError(
            f"{path}: not an STL file, or cut off: {len(data)} bytes; "
            f"its header says {faces} faces, which take {expected}"
        )
    return data[:expected]


def as_utf8(data: bytes, suffix: str) -> bytes:
    """Replaces by question marks what is not ASCII in text that is not UTF-8.

    Names and comments may be in any encoding, also in the headers of binary files.

    Args:
        data: contents of the file.
        suffix: its extension in lower case, such as ".stl".
    """
    end = _text_length(data, suffix)
    try:
        data[:end].decode()
    except UnicodeDecodeError:
        return data[:end].translate(_NOT_ASCII) + data[end:]
    return data


def _text_length(data: bytes, suffix: str) -> int:
    if suffix == ".glb":
        return 0
    if suffix == ".ply":
        return data.find(b"end_header") + 1
    faces = int.from_bytes(data[_STL_HEADER - 4 : _STL_HEADER], "little")
    if suffix == ".stl" and len(data) == _STL_HEADER + _STL_FACE * faces:
        return _STL_HEADER - 4
    return len(data)
