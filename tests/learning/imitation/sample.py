"""The committed data set, small encoders and short trainings on them."""

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import torch

from keypush.learning.checkpoint import save_network
from keypush.learning.clips import Clips
from keypush.learning.imitation.config import ImitationConfig
from keypush.learning.imitation.examples import Examples, make_examples
from keypush.learning.imitation.selection import Selection, select_rows
from keypush.learning.imitation.targets import make_targets
from keypush.learning.imitation.train import train_imitation
from keypush.learning.rows import Rows, read_rows
from keypush.networks.config import EncoderConfig
from keypush.networks.contact_network import ContactNetwork
from keypush.scenario import ControlConfig

SAMPLE = Path(__file__).parents[3] / "docs" / "sample"
CLIPS = Clips.of(ControlConfig())
QUICK = ImitationConfig(
    rows_per_object=60, epochs=3, batch=128, clouds_per_object=2, held_out_objects=["mug"]
)


def write_encoder(path: Path) -> Path:
    """Writes untrained weights of the kind contact."""
    with torch.random.fork_rng():
        torch.manual_seed(0)
        network = ContactNetwork(EncoderConfig())
    save_network(network, path, {})
    return path


def train(
    kind: str, out: Path, encoder: Path, data: Path = SAMPLE, **change: Any
) -> dict[str, Any]:
    """A short training."""
    config = dataclasses.replace(QUICK, **change)
    return train_imitation(kind, data, out, encoder, config, lambda _: None)


def sample_rows() -> Rows:
    """All rows of successful episodes."""
    return read_rows(SAMPLE)


def sample_examples(kind: str, config: ImitationConfig) -> tuple[Selection, Examples]:
    """Examples of the committed data set."""
    rows = sample_rows()
    targets = make_targets(kind, rows, CLIPS, config)
    selection = select_rows(rows, np.isfinite(targets).all(axis=1), config)
    return selection, make_examples(rows, targets, selection.rows, use_com=config.use_com)
