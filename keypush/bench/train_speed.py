"""How fast the thesis' head trains on cached tokens, beside the way one would write it down.

Pretended data of the right shapes: what is measured does not depend on the numbers.
"""

import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
from rich.table import Table
from torch import nn
from torch.nn import functional

from keypush.bench.literal_network import LiteralHead
from keypush.learning.clouds import CloudBank
from keypush.learning.imitation.config import ImitationConfig
from keypush.learning.imitation.encoding import encode, posed
from keypush.learning.imitation.examples import Examples
from keypush.learning.imitation.presets import preset_config
from keypush.learning.imitation.token_cache import CachedTokens
from keypush.learning.lightning_run import one_thread
from keypush.learning.patches import group_patches_batch
from keypush.networks.config import CLOUD_POINTS, WIDTH, KeypointConfig
from keypush.networks.keypoint_network import KeypointNetwork
from keypush.networks.normalisation import LENGTH

AIM = 8.0
"""Times as fast as the literal way."""
_ROWS = 8192
_CLOUDS = 64
_ROUNDS = 4
_ENCODED_AT_ONCE = 256


@dataclass(frozen=True)
class _Pretended:
    """A network and data for it."""

    network: KeypointNetwork
    examples: Examples
    bank: CloudBank


def measure_training(seconds: float) -> dict[str, Any]:
    """Measures both ways in turns, on one thread, in samples per second of CPU time.

    Args:
        seconds: for each of: literal steps, cached steps, encoding.

    Returns:
        `literal`: batches of 64, `nn.MultiheadAttention`, the encoder run on every batch in single
        precision, patches known beforehand. `cached`: batches of the preset "affordable" from
        a token file; `encoding`: into that file. `ratio`: of the two ways where every row is
        encoded once and used in every epoch; `ratio_of_steps` without that share of encoding.
    """
    affordable, thesis = (
        preset_config(ImitationConfig(), name) for name in ("affordable", "thesis")
    )
    with one_thread(), torch.random.fork_rng(devices=[]), tempfile.TemporaryDirectory() as folder:
        torch.manual_seed(0)
        pretended = _pretend()
        tokens = _write_tokens(pretended, Path(folder))
        steps = {
            "literal": (thesis.batch, _literal_step(pretended, thesis)),
            "cached": (affordable.batch, _cached_step(pretended, tokens, affordable)),
            "encoding": (_ENCODED_AT_ONCE, _encoding_step(pretended)),
        }
        rates: dict[str, list[float]] = {name: [] for name in steps}
        for _ in range(_ROUNDS):
            for name, (batch, step) in steps.items():
                rates[name].append(_rate(step, batch, seconds / _ROUNDS))
        difference = _difference(pretended, tokens)
    speed = {name: float(np.median(values)) for name, values in rates.items()}
    with_encoding = 1 / (1 / speed["cached"] + 1 / (affordable.epochs * speed["encoding"]))
    return {
        "literal": {"batch": thesis.batch, "samples_per_s": speed["literal"]},
        "cached": {
            "batch": affordable.batch,
            "samples_per_s": speed["cached"],
            "epochs": affordable.epochs,
            "samples_per_s_with_encoding": with_encoding,
        },
        "encoding": {"batch": _ENCODED_AT_ONCE, "samples_per_s": speed["encoding"]},
        "ratio": with_encoding / speed["literal"],
        "ratio_of_steps": speed["cached"] / speed["literal"],
        "aim": AIM,
        "largest_difference_of_outputs": difference,
        "rounds": _ROUNDS,
        "threads": 1,
        "torch": torch.__version__,
    }


def training_table(report: dict[str, Any]) -> Table:
    """Shows what `measure_training` found."""
    table = Table(title="Training of the thesis' head, samples per second of one core")
    for column in ("way", "batch", "samples/s"):
        table.add_column(column, justify="left" if column == "way" else "right")
    cached = report["cached"]
    for way, batch, rate in (
        ("as written down, encoder in every step", report["literal"]["batch"],
         report["literal"]["samples_per_s"]),
        ("on cached tokens", cached["batch"], cached["samples_per_s"]),
        ("encoding into the cache", report["encoding"]["batch"],
         report["encoding"]["samples_per_s"]),
        (f"cached, encoding shared by {cached['epochs']} epochs", cached["batch"],
         cached["samples_per_s_with_encoding"]),
    ):  # fmt: skip
        table.add_row(way, str(batch), f"{rate:,.0f}")
    table.caption = f"{report['ratio']:.1f} times as fast; the aim is {report['aim']:g}"
    return table


def _pretend() -> _Pretended:
    network = KeypointNetwork(KeypointConfig())
    cloud = 0.05 * torch.randn(_CLOUDS, CLOUD_POINTS, 3) / LENGTH
    sizes = network.config.encoder
    bank = CloudBank(cloud, *group_patches_batch(cloud, sizes.patches, sizes.patch_size), _CLOUDS)
    examples = Examples(
        objects=[("none", 1.0)],
        object_index=torch.zeros(_ROWS, dtype=torch.int64),
        R_WO=torch.linalg.qr(torch.randn(_ROWS, 3, 3))[0],
        p_WO=torch.rand(_ROWS, 3),
        hand=torch.rand(_ROWS, 9),
        query=torch.rand(_ROWS, network.config.query_size),
        target=torch.rand(_ROWS, network.OUTPUTS),
        direction=torch.zeros(_ROWS, 2),
    )
    return _Pretended(network, examples, bank)


def _write_tokens(pretended: _Pretended, folder: Path) -> CachedTokens:
    count = pretended.network.config.encoder.patches + 1
    path = folder / "tokens"
    tokens = torch.randn(_ROWS, count, WIDTH).to(torch.bfloat16)
    path.write_bytes(tokens.view(torch.int16).numpy().tobytes())
    return CachedTokens(path, _ROWS, count)


def _training_step(
    head: nn.Module, examples: Examples, config: ImitationConfig
) -> Callable[[torch.Tensor, torch.Tensor], None]:
    optimizer = torch.optim.AdamW(head.parameters(), lr=config.learning_rate, fused=True)
    head.train()

    def step(index: torch.Tensor, tokens: torch.Tensor) -> None:
        loss = functional.mse_loss(head(tokens, examples.query[index]), examples.target[index])
        optimizer.zero_grad()
        torch.autograd.backward(loss)
        optimizer.step()

    return step


def _cached_step(
    pretended: _Pretended, tokens: CachedTokens, config: ImitationConfig
) -> Callable[[], None]:
    step = _training_step(pretended.network.head, pretended.examples, config)

    def cached() -> None:
        index = torch.randint(_ROWS, (config.batch,))
        step(index, tokens.take(index).float())

    return cached


def _literal_step(pretended: _Pretended, config: ImitationConfig) -> Callable[[], None]:
    network, examples, bank = pretended.network, pretended.examples, pretended.bank
    step = _training_step(LiteralHead(network.head), examples, config)

    def literal() -> None:
        index = torch.randint(_ROWS, (config.batch,))
        cloud, *others = posed(examples, index, bank, torch.randint(_CLOUDS, (config.batch,)))
        cloud += config.cloud_deviation / LENGTH * torch.randn_like(cloud)
        step(index, encode(network.encoder.eval(), (cloud, *others), "32"))  # type: ignore[arg-type]  # three others

    return literal


def _encoding_step(pretended: _Pretended) -> Callable[[], None]:
    network, examples, bank = pretended.network, pretended.examples, pretended.bank

    def encoding() -> None:
        index = torch.randint(_ROWS, (_ENCODED_AT_ONCE,))
        scenes = posed(examples, index, bank, torch.randint(_CLOUDS, (_ENCODED_AT_ONCE,)))
        encode(network.encoder.eval(), scenes, "bf16").to(torch.bfloat16)

    return encoding


def _rate(step: Callable[[], None], batch: int, seconds: float) -> float:
    """Samples per second of CPU time."""
    step()  # the first one allocates
    began, steps = time.process_time(), 0
    while time.process_time() - began < seconds:
        step()
        steps += 1
    return steps * batch / (time.process_time() - began)


def _difference(pretended: _Pretended, tokens: CachedTokens) -> float:
    """The largest difference between the outputs of both heads with the same weights."""
    head = pretended.network.head.eval()
    index = torch.arange(256)
    inputs = (tokens.take(index).float(), pretended.examples.query[index])
    with torch.inference_mode():
        return float((head(*inputs) - LiteralHead(head).eval()(*inputs)).abs().max())
