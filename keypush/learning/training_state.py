"""What a training run needs to go on after an interruption."""

import dataclasses
import io
import pickle
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import torch

from keypush.errors import UserError
from keypush.learning.checkpoint import write_atomically
from keypush.learning.config import TrainingConfig
from keypush.networks.surface_keypoint_network import SurfaceKeypointNetwork


@dataclass
class TrainingState:
    """A run between two epochs."""

    network: SurfaceKeypointNetwork
    optimizer: torch.optim.AdamW
    epoch: int = 0
    """Epochs done."""
    history: list[dict[str, Any]] = field(default_factory=list)
    """Loss and validation errors after every epoch."""

    @staticmethod
    def new(config: TrainingConfig) -> "TrainingState":
        """Starts a run; the weights follow from `config.seed`."""
        with torch.random.fork_rng(devices=[]):
            torch.manual_seed(config.seed)
            network = SurfaceKeypointNetwork(config.network)
        optimizer = torch.optim.AdamW(
            network.parameters(),
            lr=config.learning_rate,
            weight_decay=config.weight_decay,
            foreach=True,
        )
        return TrainingState(network.eval(), optimizer)


def save_state(state: TrainingState, path: Path, config: TrainingConfig) -> None:
    """Writes the state; the file appears whole or not at all."""
    buffer = io.BytesIO()
    content = {
        "config": dataclasses.asdict(config),
        "network": state.network.state_dict(),
        "optimizer": state.optimizer.state_dict(),
        "epoch": state.epoch,
        "history": state.history,
    }
    torch.save(content, buffer)
    write_atomically(path, buffer.getvalue())


def load_state(path: Path, config: TrainingConfig) -> TrainingState | None:
    """Reads the state of an earlier run; None when there is none.

    Raises:
        UserError: the file is damaged or comes from a run with another configuration.
    """
    if not path.exists():
        return None
    try:
        content = torch.load(path, weights_only=True)
        found = content["config"]
    except (OSError, RuntimeError, EOFError, pickle.UnpicklingError, KeyError, TypeError) as error:
        raise UserError(f"{path}: is no training state; delete it to start again") from error
    wanted = dataclasses.asdict(config)
    changed = [name for name in wanted if found.get(name) != wanted[name]]
    if changed:
        raise UserError(
            f"{path}: is from a run with other values of {', '.join(changed)}; allowed: the "
            "same values, or another output folder"
        )
    state = TrainingState.new(config)
    state.network.load_state_dict(content["network"])
    state.optimizer.load_state_dict(content["optimizer"])
    state.epoch, state.history = content["epoch"], content["history"]
    return state
