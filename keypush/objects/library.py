"""All objects there are: the built-in ones and those that a user has added."""

import hashlib
import re
import shutil
from collections.abc import Iterable
from functools import lru_cache
from pathlib import Path

from platformdirs import user_data_path

from keypush.errors import UserError
from keypush.objects.asset import ASSET_FILES, ObjectAsset, read_asset
from keypush.objects.catalogue import GROUPS, catalogue, catalogue_names
from keypush.objects.model import ObjectModel, scaled_model
from keypush.resources import models_dir

USER_GROUP = "user"
"""Name for all objects that the user has added."""
_NAME = re.compile(r"[a-z][a-z0-9_]{0,39}")


def object_names() -> list[str]:
    """Returns the names of all objects, the built-in ones first."""
    return [*catalogue_names(), *user_object_names()]


def user_object_names() -> list[str]:
    """Returns the names of the objects that the user has added."""
    folder = user_objects_dir()
    if not folder.is_dir():
        return []
    return sorted(p.name for p in folder.iterdir() if p.is_dir() and _NAME.fullmatch(p.name))


def user_objects_dir() -> Path:
    """Returns the folder of the user's objects, below the platform's folder for user data."""
    return Path(user_data_path("keypush")) / "objects"


def check_new_name(name: str) -> None:
    """Checks that an object may be added under a name.

    Raises:
        UserError: the name is taken, stands for several objects, or is spelled otherwise.
    """
    if not _NAME.fullmatch(name):
        raise UserError(
            f"name is {name!r}; allowed: up to 40 small letters, digits and _, a letter first"
        )
    if name in (*GROUPS, USER_GROUP):
        raise UserError(f"name is {name!r}, which stands for several objects; allowed: another")
    if name in catalogue() or (user_objects_dir() / name).exists():
        raise UserError(f"name is {name!r}, which is taken; allowed: another name")


def remove_user_object(name: str) -> Path:
    """Removes an object that the user has added; returns where it was.

    Raises:
        UserError: there is none of that name.
    """
    if name not in user_object_names():
        known = ", ".join(user_object_names()) or "none was added"
        raise UserError(f"object {name!r} is not one that was added; allowed: {known}")
    folder = user_objects_dir() / name
    if folder.is_symlink():
        folder.unlink()
    else:
        shutil.rmtree(folder)
    return folder


def user_objects_digest(names: Iterable[str]) -> str | None:
    """Returns a digest of the files of the user's objects among some; None where none is.

    It tells objects apart that were removed and added again under the same name.
    """
    mine = sorted(set(user_object_names()).intersection(names))
    if not mine:
        return None
    digest = hashlib.sha256()
    for name in mine:
        for file in ASSET_FILES:
            digest.update((object_folder(name) / file).read_bytes())
    return digest.hexdigest()


def parse_object_list(text: str) -> list[str]:
    """Reads names of objects and groups, separated by commas.

    Raises:
        UserError: there is no such object or group, or none is given.
    """
    names: list[str] = []
    words = [word.strip() for word in text.split(",")]
    for word in words:
        if word in GROUPS:
            names += catalogue_names(word)
        elif word == USER_GROUP:
            names += user_object_names()
        elif word:
            names.append(word)
            if _find(word) is None:
                raise UserError(f"object {word!r} is not there; allowed: {_allowed()}")
    if not names:
        why = ", since none was added" if USER_GROUP in words else ""
        raise UserError(f"objects is {text!r}, which names none{why}; allowed: {_allowed()}")
    return list(dict.fromkeys(names))


def object_folder(name: str) -> Path:
    """Returns where an object is stored.

    Raises:
        UserError: there is no such object.
    """
    folder = _find(name)
    if folder is None:
        raise UserError(f"object {name!r} is not there; allowed: {', '.join(object_names())}")
    return folder


def load_object(name: str) -> ObjectAsset:
    """Reads an object, or returns it if it has been read.

    Raises:
        UserError: there is no such object, or its files are damaged.
    """
    folder = object_folder(name)
    description = folder / "object.json"
    # Where it is gone, reading it says so.
    return _load(folder, description.stat().st_mtime_ns if description.exists() else 0)


def make_object(name: str, size_ratio: float = 1.0, mass: float | None = None) -> ObjectModel:
    """Makes an object at a size and mass.

    Args:
        name: of a built-in object or of one that the user has added.
        size_ratio: size relative to the object's own.
        mass: kg; None: the object's own.

    Raises:
        UserError: there is no such object, or its files are damaged.
    """
    return scaled_model(load_object(name), size_ratio, mass)


@lru_cache(maxsize=64)
def _load(folder: Path, _changed: int) -> ObjectAsset:
    return read_asset(folder)


def _find(name: str) -> Path | None:
    if name in catalogue():
        return models_dir() / "objects" / name
    folder = user_objects_dir() / name
    return folder if _NAME.fullmatch(name) and folder.is_dir() else None


def _allowed() -> str:
    """What a list of objects may hold."""
    groups = [*GROUPS, USER_GROUP] if user_object_names() else [*GROUPS]
    return ", ".join([*groups, *object_names()])
