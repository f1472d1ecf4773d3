"""Tokens of all examples, encoded once and kept on disk: 256 bytes a token, in bfloat16.

A row has a token of the hand and one of each patch: 4352 bytes with 16 patches, 8448 with 32.
The cloud noise is that of one draw. A build that was stopped goes on with the object it was at.
"""

import json
import os
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, override

import numpy as np
import torch
from tqdm import tqdm

from keypush.atomic_file import write_whole
from keypush.errors import UserError, one_line
from keypush.learning.clouds import surface_samplers
from keypush.learning.imitation.config import ImitationConfig
from keypush.learning.imitation.encoding import EncoderInput, clouds_of, encode, posed
from keypush.learning.imitation.examples import Examples
from keypush.learning.imitation.token_source import MOST_CLOUDS, Fetch, TokenSource
from keypush.learning.record import digest_of
from keypush.networks.config import WIDTH, EncoderConfig
from keypush.networks.patch_encoder import PatchTransformerEncoder

FOLDER = "cache"
_TOKENS, _STATE = "tokens.bfloat16", "tokens.json"
_BATCH = 256
_SPARE = 2**28
"""Bytes that are left free for weights and logs."""


class CachedTokens(TokenSource):
    """A memory map of tokens."""

    def __init__(self, path: Path, examples: int, tokens: int) -> None:
        # NumPy knows no bfloat16.
        shape = (examples, tokens, WIDTH)
        self._tokens = np.memmap(path, dtype=np.int16, mode="r", shape=shape)

    def take(self, index: torch.Tensor) -> torch.Tensor:
        """Reads the tokens of some examples (B,), (B, T, WIDTH) in bfloat16."""
        return torch.from_numpy(self._tokens[index.numpy()]).view(torch.bfloat16)

    @override
    def epoch(self, number: int) -> Fetch:
        return self.take

    @override
    def validation(self) -> Fetch:
        return self.take


def cache_tokens(
    folder: Path,
    examples: Examples,
    encoder: PatchTransformerEncoder,
    config: ImitationConfig,
    tell: Callable[[str], None],
) -> CachedTokens:
    """Encodes examples into a file, or finds them there.

    Args:
        folder: of the cache; what another build left there is overwritten.
        examples: to be encoded.
        encoder: in evaluation mode.
        config: seed, noise and precision.
        tell: is told the size before it starts.

    Raises:
        UserError: there is no room on the disk, or the folder cannot be written.
    """
    tokens = encoder.config.patches + 1
    size = cache_bytes(len(examples), encoder.config)
    key = _key(examples, encoder, config)
    done = _objects_done(folder, key, size)
    path = folder / _TOKENS
    if done < len(examples.objects):
        tell(f"token cache {path}: {len(examples)} rows, {size / 1e9:.2f} GB on disk")
        if not done:
            # What it tells is no longer so, once the first row is written.
            (folder / _STATE).unlink(missing_ok=True)
        _reserve(path, size)
        stored = np.memmap(path, dtype=np.int16, mode="r+", shape=(len(examples), tokens, WIDTH))
        _encode_all(stored, examples, encoder, config, done, folder / _STATE, key)
    return open_cache(folder, len(examples), encoder.config)


def open_cache(folder: Path, examples: int, encoder: EncoderConfig) -> CachedTokens:
    """Opens a cache that `cache_tokens` has finished, of so many examples."""
    return CachedTokens(folder / _TOKENS, examples, encoder.patches + 1)


def cache_bytes(examples: int, encoder: EncoderConfig) -> int:
    """Returns the size of a cache on disk."""
    return examples * (encoder.patches + 1) * WIDTH * 2


def check_room(folder: Path, size: int) -> None:
    """Checks that a folder that is there has room for a cache, in place of one that is there.

    Raises:
        UserError: it has not.
    """
    path = folder / _TOKENS
    there = path.stat().st_size if path.exists() else 0
    free = shutil.disk_usage(folder).free + there
    if free < size + _SPARE:
        raise UserError(
            f"{path}: needs {size / 1e9:.2f} GB and {free / 1e9:.2f} GB are free; allowed: a "
            "smaller rows_per_object, cache false, or an output folder with more room"
        )


def scenes_of_object(
    examples: Examples, number: int, encoder: PatchTransformerEncoder, config: ImitationConfig
) -> Iterator[tuple[torch.Tensor, EncoderInput]]:
    """Yields the examples of one object, a batch at a time, with the scenes that are encoded."""
    index = torch.nonzero(examples.object_index == number)[:, 0]
    if not len(index):
        return
    samplers = surface_samplers([examples.objects[number]])
    count = min(config.clouds_per_object, len(index), MOST_CLOUDS)
    bank = clouds_of(samplers, count, encoder, config, (number, "cached_clouds"))
    generator = torch.Generator().manual_seed(config.seed)
    entries = bank.choose(torch.zeros_like(index), generator)
    for part, entry in zip(torch.split(index, _BATCH), torch.split(entries, _BATCH), strict=True):
        yield part, posed(examples, part, bank, entry)


def _encode_all(
    stored: np.memmap[Any, np.dtype[np.int16]],
    examples: Examples,
    encoder: PatchTransformerEncoder,
    config: ImitationConfig,
    done: int,
    state: Path,
    key: str,
) -> None:
    first = int(torch.searchsorted(examples.object_index, done))
    progress = tqdm(total=len(examples), initial=first, desc="encode", unit="row", disable=None)
    with progress:
        for number in range(done, len(examples.objects)):
            for index, scenes in scenes_of_object(examples, number, encoder, config):
                tokens = encode(encoder, scenes, config.encoder_precision).to(torch.bfloat16)
                stored[index.numpy()] = tokens.cpu().view(torch.int16).numpy()
                progress.update(len(index))
            stored.flush()  # After a loss of power nothing counts as done that is not on the disk.
            content = {"key": key, "objects_done": number + 1}
            write_whole(state, json.dumps(content).encode())


def _key(examples: Examples, encoder: PatchTransformerEncoder, config: ImitationConfig) -> str:
    """A hash of everything that decides the tokens."""
    settings = (config.seed, config.cloud_deviation, config.clouds_per_object)
    told = repr((list(examples.objects), encoder.config, settings, config.encoder_precision))
    columns = (examples.object_index, examples.R_WO, examples.p_WO, examples.hand)
    return digest_of([
        np.frombuffer(told.encode(), dtype=np.uint8),
        *(column.numpy() for column in columns),
        *(weight.cpu().numpy() for weight in encoder.state_dict().values()),
    ])  # fmt: skip


def _objects_done(folder: Path, key: str, size: int) -> int:
    """How many objects an earlier build of the same tokens has encoded."""
    try:
        state = json.loads((folder / _STATE).read_text(encoding="utf-8"))
        whole = (folder / _TOKENS).stat().st_size == size
        return int(state["objects_done"]) if whole and state["key"] == key else 0
    except (OSError, ValueError, KeyError, TypeError):
        return 0  # none, or not one of ours: it is made anew


def _reserve(path: Path, size: int) -> None:
    """Makes the file at its full size, so that no write into the map can fail."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        check_room(path.parent, size)
        with path.open("ab") as file:
            file.truncate(size)
            os.posix_fallocate(file.fileno(), 0, size)
    except OSError as error:
        raise UserError(f"{path}: cannot be written: {one_line(error)}") from error
