"""Pretraining of the contact network."""

import dataclasses
from collections.abc import Mapping, Sequence
from pathlib import Path
from statistics import median
from typing import Any

from keypush.errors import UserError
from keypush.learning.checkpoint import parameter_count, save_network
from keypush.learning.lightning_run import fit, one_thread
from keypush.learning.pretraining.config import PretrainConfig
from keypush.learning.pretraining.contact_objects import contact_objects
from keypush.learning.pretraining.contact_scenes import ContactBatches
from keypush.learning.pretraining.module import ContactModule
from keypush.learning.pretraining.scores import score_network
from keypush.learning.record import training_record
from keypush.networks.contact_network import ContactNetwork
from keypush.objects.library import load_object, parse_object_list

WEIGHTS = "contact.safetensors"


def pretrain(
    objects: str, measured_on: Sequence[str], out_dir: Path, config: PretrainConfig
) -> dict[str, Any]:
    """Pretrains a contact network, or goes on where an interrupted run in `out_dir` stopped.

    The finished network is written to `out_dir/contact.safetensors`.

    Args:
        objects: to train on; see `parse_object_list`.
        measured_on: more lists of objects, which are only measured on.
        out_dir: folder for weights, checkpoints and logs; made if missing.
        config: settings.

    Returns:
        Scores by set of objects and kind of scene; see `scores.score`.

    Raises:
        UserError: the configuration is out of range, an object is not there, none is left to train
            on, a list to measure on has the name of another set of objects, or `out_dir` holds a
            run with another configuration.
    """
    config.validate()
    names = _without_held_out(parse_object_list(objects), config.held_out_objects)
    sets = {"train": names, **{name: [name] for name in config.held_out_objects}}
    if len(config.held_out_objects) > 1:
        sets["held_out_objects"] = config.held_out_objects
    for text in measured_on:
        _add_set(sets, text)
    for name in {name for members in sets.values() for name in members}:
        load_object(name)  # a damaged one is told before hours of training
    module = ContactModule(contact_objects(names), config)
    identity = {**dataclasses.asdict(config), "kind": "contact", "objects": names}
    fit(module, out_dir, identity, gradient_clip_val=config.max_gradient)
    with one_thread():
        scores = _final_scores(module.contact, sets, config)
    taught = {
        "objects": sorted(names),
        "seeds": [config.seed],
        "samples": len(module.history) * config.samples_per_epoch,
    }
    metrics = {"history": module.history, **scores}
    record = {
        **training_record(parameter_count(module.contact), taught, config, metrics),
        "samples_per_second": round(median(e["samples_per_second"] for e in module.history)),
    }
    save_network(module.contact, out_dir / WEIGHTS, record)
    return scores


def _add_set(sets: dict[str, list[str]], text: str) -> None:
    """Adds a list of objects under its own name."""
    names = parse_object_list(text)
    before = sets.setdefault(text, names)
    if before != names:
        raise UserError(
            f"measure_on has {text}, but the scores of that name are those of "
            f"{', '.join(before)}; allowed: other lists, or names of objects"
        )


def _without_held_out(names: list[str], held_out: Sequence[str]) -> list[str]:
    unknown = sorted(set(held_out) - set(names))
    if unknown:
        raise UserError(
            f"held_out_objects has {', '.join(unknown)}; allowed: {', '.join(sorted(names))}"
        )
    left = [name for name in names if name not in held_out]
    if not left:
        raise UserError(
            f"held_out_objects has all of {', '.join(names)}; allowed: all but one of them"
        )
    return left


def _final_scores(
    network: ContactNetwork, sets: Mapping[str, Sequence[str]], config: PretrainConfig
) -> dict[str, Any]:
    """Scores on random scenes and on those that look like the task, for every set of objects."""
    scores: dict[str, Any] = {}
    for label, names in sets.items():
        objects = contact_objects(names)
        scores[label] = {}
        for kind, task_share in (("random_scenes", 0.0), ("task_scenes", 1.0)):
            mixed = dataclasses.replace(config, task_share=task_share)
            draw = (0, f"contact_test:{kind}")
            batches = ContactBatches(objects, mixed, draw, config.validation_samples)
            scores[label][kind] = score_network(network, batches)
    return scores
