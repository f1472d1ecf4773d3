"""Training of the thesis' networks on an expert's episodes."""

import dataclasses
import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import torch

from keypush.dataset.read import open_dataset
from keypush.learning.card import weights_path
from keypush.learning.checkpoint import load_network, parameter_count, save_network
from keypush.learning.clouds import surface_samplers
from keypush.learning.imitation.config import ImitationConfig
from keypush.learning.imitation.examples import Examples, make_examples
from keypush.learning.imitation.module import ImitationModule
from keypush.learning.imitation.selection import select_rows
from keypush.learning.imitation.targets import Clips, make_targets
from keypush.learning.imitation.token_cache import FOLDER, cache_tokens
from keypush.learning.imitation.token_source import FreshTokens
from keypush.learning.lightning_run import check_accelerator, fit, one_thread
from keypush.learning.record import command_line, data_record, digest_of, git_revision
from keypush.learning.rows import read_rows
from keypush.networks.config import KeypointConfig
from keypush.networks.contact_network import ContactNetwork
from keypush.networks.keypoint_network import BehaviorCloningNetwork, KeypointNetwork
from keypush.scenario import load_scenario

Network = KeypointNetwork | BehaviorCloningNetwork
NETWORKS: dict[str, type[KeypointNetwork] | type[BehaviorCloningNetwork]] = {
    "keypoint": KeypointNetwork,
    "behavior_cloning": BehaviorCloningNetwork,
}


def train_imitation(
    kind: str,
    data_dir: Path,
    out_dir: Path,
    encoder: str | Path,
    config: ImitationConfig,
    tell: Callable[[str], None],
) -> dict[str, Any]:
    """Trains a head, or goes on where an interrupted run in `out_dir` stopped.

    The finished network is written to `out_dir/KIND.safetensors`.

    Args:
        kind: one of `NETWORKS`.
        data_dir: folder of a data set.
        out_dir: folder for weights, checkpoints, logs and the token cache; made if missing.
        encoder: name or path of weights of the kind "contact"; their encoder is taken as it is.
        config: settings.
        tell: is told what takes room on the disk before it does.

    Returns:
        The errors after every epoch, and at the end on validation episodes and on each held-out
        object; see `errors.summarise`.

    Raises:
        UserError: the configuration is out of range, encoder or data cannot be read, an object
            is not there, or `out_dir` holds a run with another configuration or other data.
    """
    config.validate()
    check_accelerator(config)
    network = make_network(kind, encoder, config)
    rows = read_rows(data_dir, keep_failures=config.keep_failures)
    surface_samplers([(name, 1.0) for name in sorted({name for name, _ in rows.objects})])
    clips = Clips.of(load_scenario(open_dataset(data_dir).scenario).control)
    targets = make_targets(kind, rows, clips, config)
    selection = select_rows(rows, np.isfinite(targets).all(axis=1), config)
    examples = make_examples(rows, targets, selection.rows, use_com=config.use_com)
    digest = _digest(examples)
    encoder_file = weights_path(encoder)
    encoder_record = {
        "file": encoder_file.name,
        "sha256": hashlib.sha256(encoder_file.read_bytes()).hexdigest(),
    }
    identity = {
        **dataclasses.asdict(config),
        "kind": kind,
        "data": digest,
        "encoder": encoder_record["sha256"],
    }
    with one_thread():
        tokens = (
            cache_tokens(out_dir / FOLDER, examples, network.encoder, config, tell)
            if config.cache
            else FreshTokens(examples, network.encoder, config)
        )
    module = ImitationModule(network, examples, selection, tokens, clips, config)
    fit(module, out_dir, identity)
    with one_thread():
        metrics: dict[str, Any] = {
            "history": module.history,
            "validation": module.measure(torch.from_numpy(selection.validation)),
            "held_out_objects": {
                name: module.measure(torch.from_numpy(index))
                for name, index in selection.held_out.items()
            },
        }
    record = {
        "parameters": parameter_count(network.head),
        "git_revision": git_revision(),
        "command": command_line(),
        "encoder": encoder_record,
        "action_clips": dataclasses.asdict(clips),
        "data": {**data_record(rows, digest), "trained_rows": len(selection.train)},
        "training": dataclasses.asdict(config),
        "metrics": metrics,
    }
    save_network(network, out_dir / f"{kind}.safetensors", record)
    return metrics


def make_network(kind: str, encoder: str | Path, config: ImitationConfig) -> Network:
    """Makes a network with a trained encoder and a new head, whose weights follow from the seed.

    Raises:
        UserError: the encoder's weights cannot be read or are of another kind.
    """
    contact = load_network(encoder, ContactNetwork)
    sizes = KeypointConfig(
        encoder=contact.config, use_com=config.use_com, heads=config.heads, dropout=config.dropout
    )
    with torch.random.fork_rng(devices=[]):
        torch.manual_seed(config.seed)
        network = NETWORKS[kind](sizes)
    network.encoder.load_state_dict(contact.encoder.state_dict())
    network.eval()
    return network


def _digest(examples: Examples) -> str:
    """A hash of what is trained on."""
    columns = (examples.object_index, examples.R_WO, examples.p_WO, examples.hand,
               examples.query, examples.target)  # fmt: skip
    return digest_of(column.numpy() for column in columns)
