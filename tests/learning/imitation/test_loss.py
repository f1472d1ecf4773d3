"""Losses, their gradients, and whether a head can learn at all."""

from pathlib import Path

import numpy as np
import pytest
import torch

from keypush.learning.config import TrainingConfig
from keypush.learning.imitation.config import ImitationConfig
from keypush.learning.imitation.errors import summarise
from keypush.learning.imitation.module import ImitationModule
from keypush.learning.imitation.token_cache import cache_tokens
from keypush.learning.imitation.train import NETWORKS
from keypush.learning.lightning_run import EpochModule
from keypush.learning.surface_module import SurfaceModule
from keypush.networks.config import KeypointConfig
from tests.learning.imitation.sample import CLIPS, sample_examples
from tests.learning.scenes import SMALL

CONFIG = ImitationConfig(rows_per_object=8, clouds_per_object=2, dropout=0.0, batch=64)


def _module(kind: str, folder: Path) -> ImitationModule:
    selection, examples = sample_examples(kind, CONFIG)
    with torch.random.fork_rng():
        torch.manual_seed(0)
        network = NETWORKS[kind](KeypointConfig(dropout=CONFIG.dropout)).eval()
    tokens = cache_tokens(folder, examples, network.encoder, CONFIG, lambda _: None)
    return ImitationModule(network, examples, selection, tokens, CLIPS, CONFIG)


def _check_gradient(module: EpochModule, batch: object) -> None:
    """Compares the derivative along a random direction with finite differences."""
    trained: list[torch.Tensor] = [
        weight for weight in module.network.parameters() if weight.requires_grad
    ]
    rng = torch.Generator().manual_seed(1)
    direction = [torch.randn(weight.shape, generator=rng, dtype=weight.dtype) for weight in trained]
    loss, _ = module.loss(batch)
    gradient = torch.autograd.grad(loss, trained)
    derivative = float(sum((g * d).sum() for g, d in zip(gradient, direction, strict=True)))

    def at(step: float) -> float:
        with torch.no_grad():
            torch._foreach_add_(trained, direction, alpha=step)
            value = float(module.loss(batch)[0])
            torch._foreach_add_(trained, direction, alpha=-step)
        return value

    step = 1e-7
    assert derivative == pytest.approx((at(step) - at(-step)) / (2 * step), rel=1e-4)


@pytest.mark.parametrize("kind", list(NETWORKS))
def test_gradients_of_the_heads(kind: str, tmp_path: Path) -> None:
    module = _module(kind, tmp_path)
    module.double()
    rng = torch.Generator().manual_seed(0)
    tokens = torch.randn(16, 17, 128, generator=rng, dtype=torch.float64)
    query = torch.rand(16, 5, generator=rng, dtype=torch.float64)
    width = module.examples.target.shape[1]
    target = torch.rand(16, width, generator=rng, dtype=torch.float64)
    _check_gradient(module, (tokens, query, target))
    output = module.head(tokens, query)
    assert float(module.loss((tokens, query, target))[0].detach()) == pytest.approx(
        float((output - target).square().mean().detach())
    )


def test_gradients_of_the_surface_network() -> None:
    class WithoutData(SurfaceModule):
        """Only its loss is asked for."""

    config = TrainingConfig(network=SMALL, cloud_points=64)
    module = WithoutData(config, None, None, []).double()  # type: ignore[arg-type]  # no data
    rng = torch.Generator().manual_seed(0)

    def draw(*shape: int) -> torch.Tensor:
        return torch.randn(*shape, generator=rng, dtype=torch.float64)

    centres = torch.randint(64, (4, SMALL.patches), generator=rng)
    members = torch.randint(64, (4, SMALL.patches, SMALL.patch_size), generator=rng)
    fields = (draw(4, 64, 3), centres, members, draw(4, 2), draw(4, 3), draw(4, 9))
    _check_gradient(module, (fields, draw(4, 3)))


def test_a_head_learns_64_samples_by_heart(tmp_path: Path) -> None:
    module = _module("keypoint", tmp_path)
    order = np.random.default_rng(0).permutation(module.train_rows.numpy())[:64]
    index = torch.from_numpy(order)
    batch = (module.tokens.validation()(index), module.examples.query[index],
             module.examples.target[index])  # fmt: skip
    module.network.train()
    steps = 3000
    optimizer = torch.optim.AdamW(module.head.parameters(), lr=1e-3)
    schedule = torch.optim.lr_scheduler.CosineAnnealingLR(optimizer, steps)
    for _ in range(steps):
        loss, rows = module.loss(batch)
        optimizer.zero_grad()
        torch.autograd.backward(loss)
        optimizer.step()
        schedule.step()
    assert rows == 64
    module.network.eval()
    assert module.measure(index)["error_mean"] < 0.001


def test_errors_are_told_in_metres_along_and_across_the_push() -> None:
    # 0.4 m are 1: 4 cm along a push in y, 8 cm across it, 0 up.
    error, direction = torch.tensor([[0.2, 0.1, 0.0]]), torch.tensor([[0.0, 1.0]])
    told = summarise(error, direction, CLIPS)
    assert told["error_lateral_mean"] == pytest.approx(0.08)
    assert told["error_mean"] == told["error_xy_mean"] == pytest.approx(np.hypot(0.04, 0.08))
    assert told["mse"] == pytest.approx((0.04 + 0.01) / 3)


def test_errors_of_actions_are_told_in_mm_and_mrad() -> None:
    error = torch.tensor([[0.1, 0.0, 0.0, 0.0, 0.3, 0.4]])
    told = summarise(error, torch.tensor([[1.0, 0.0]]), CLIPS)
    assert told["translation_mm_mean"] == pytest.approx(6.0)
    assert told["rotation_mrad_p90"] == pytest.approx(50.0)
