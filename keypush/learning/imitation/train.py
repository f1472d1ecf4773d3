"""Training of the thesis' networks on an expert's episodes."""

import dataclasses
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch

from keypush.atomic_file import write_whole
from keypush.dataset.read import open_dataset
from keypush.errors import UserError
from keypush.learning.card import weights_path
from keypush.learning.checkpoint import load_network, parameter_count, save_network
from keypush.learning.clips import Clips
from keypush.learning.clouds import surface_samplers
from keypush.learning.imitation.config import ImitationConfig
from keypush.learning.imitation.examples import Examples, make_examples
from keypush.learning.imitation.module import ImitationModule
from keypush.learning.imitation.selection import Selection, select_rows
from keypush.learning.imitation.targets import make_targets
from keypush.learning.imitation.token_cache import FOLDER, cache_tokens
from keypush.learning.imitation.token_source import FreshTokens, TokenSource
from keypush.learning.lightning_run import check_accelerator, fit, one_thread, refuse_other_run
from keypush.learning.record import data_record, digest_of, training_record
from keypush.learning.rows import Rows, read_rows
from keypush.learning.tensors import encoder_record
from keypush.networks.config import KeypointConfig
from keypush.networks.contact_network import ContactNetwork
from keypush.networks.keypoint_network import BehaviorCloningNetwork, KeypointNetwork
from keypush.scenario import load_scenario

Network = KeypointNetwork | BehaviorCloningNetwork
NETWORKS: dict[str, type[KeypointNetwork] | type[BehaviorCloningNetwork]] = {
    "keypoint": KeypointNetwork,
    "behavior_cloning": BehaviorCloningNetwork,
}


@dataclass(frozen=True)
class HeadData:
    """What heads are trained on, but for the tokens.

    Attributes:
        examples: all that were selected.
        selection: what each of them is for.
        clips: of the action.
        digest: a hash of what is trained on.
    """

    examples: Examples
    selection: Selection
    clips: Clips
    digest: str


def train_imitation(
    kind: str,
    data_dir: Path,
    out_dir: Path,
    encoder: str | Path,
    config: ImitationConfig,
    tell: Callable[[str], None],
) -> dict[str, Any]:
    """Trains a head, or goes on where an interrupted run in `out_dir` stopped.

    The finished head is written to `out_dir/KIND.safetensors`, and a copy of its encoder beside it.

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
    encoder_path = weights_path(encoder, ["contact"])
    _check_encoder_name(kind, encoder_path)
    network = make_network(kind, encoder_path, config)
    rows = read_rows(data_dir, keep_failures=config.keep_failures)
    surface_samplers([(name, 1.0) for name in sorted({name for name, _ in rows.objects})])
    data = head_data(kind, rows, data_dir, config)
    standing_on = encoder_record(encoder_path)
    identity = {"kind": kind, "encoder": standing_on["sha256"]}
    # Before the cache is made anew, which takes long and is of no use to the run that is there.
    refuse_other_run(out_dir, _identity(data, config, identity))
    with one_thread():
        tokens = (
            cache_tokens(out_dir / FOLDER, data.examples, network.encoder, config, tell)
            if config.cache
            else FreshTokens(data.examples, network.encoder, config)
        )
    metrics = train_head(network, data, tokens, out_dir, config, identity)
    taught = {
        **data_record(rows, data.digest, config.held_out_objects),
        "trained_rows": len(data.selection.train),
    }
    record = {
        **training_record(parameter_count(network.head), taught, config, metrics),
        "encoder": standing_on,
        "action_clips": dataclasses.asdict(data.clips),
    }
    _put_beside(encoder_path, out_dir)
    save_network(network, out_dir / f"{kind}.safetensors", record)
    return metrics


def head_data(kind: str, rows: Rows, data_dir: Path, config: ImitationConfig) -> HeadData:
    """Selects rows of a data set and makes examples of them.

    Args:
        kind: one of `NETWORKS`.
        rows: all rows of the data set.
        data_dir: its folder.
        config: settings.

    Raises:
        UserError: see `split_rows`.
    """
    clips = Clips.of(load_scenario(open_dataset(data_dir).scenario).control)
    targets = make_targets(kind, rows, clips, config)
    selection = select_rows(rows, np.isfinite(targets).all(axis=1), config)
    examples = make_examples(rows, targets, selection.rows, use_com=config.use_com)
    return HeadData(examples, selection, clips, _digest(examples))


def train_head(
    network: Network,
    data: HeadData,
    tokens: TokenSource,
    out_dir: Path,
    config: ImitationConfig,
    identity: Mapping[str, str],
) -> dict[str, Any]:
    """Trains the head of a network to its end, from where an earlier run in `out_dir` stopped.

    Args:
        network: its encoder made the tokens.
        data: what to train and measure on.
        tokens: of its examples.
        out_dir: folder for checkpoints and logs.
        config: settings.
        identity: what decides the weights beside settings and data.

    Returns:
        See `train_imitation`.

    Raises:
        UserError: see `fit`.
    """
    module = ImitationModule(network, data.examples, data.selection, tokens, data.clips, config)
    fit(module, out_dir, _identity(data, config, identity))
    with one_thread():
        return {
            "history": module.history,
            "validation": module.measure(torch.from_numpy(data.selection.validation)),
            "held_out_objects": {
                name: module.measure(torch.from_numpy(index))
                for name, index in data.selection.held_out.items()
            },
        }


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


def _identity(data: HeadData, config: ImitationConfig, more: Mapping[str, str]) -> dict[str, Any]:
    """Returns what decides the weights."""
    return {**dataclasses.asdict(config), "data": data.digest, **more}


def _check_encoder_name(kind: str, encoder: Path) -> None:
    """Checks that head and copied encoder do not take each other's place."""
    if encoder.stem == kind:
        raise UserError(
            f"encoder {encoder}: has the name of the file that is going to be written beside it; "
            f"allowed: any but {kind}.safetensors"
        )


def _put_beside(encoder: Path, out_dir: Path) -> None:
    """Copies an encoder and its card to where a head on it is written."""
    for path in (encoder.with_suffix(".json"), encoder):
        if path.parent.resolve() != out_dir.resolve():
            write_whole(out_dir / path.name, path.read_bytes())


def _digest(examples: Examples) -> str:
    """A hash of what is trained on."""
    columns = (examples.object_index, examples.R_WO, examples.p_WO, examples.hand,
               examples.query, examples.target)  # fmt: skip
    return digest_of(column.numpy() for column in columns)
