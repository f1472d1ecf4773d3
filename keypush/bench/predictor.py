"""How long a network's answer takes and how true it is, beside the same network in PyTorch."""

import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from rich.table import Table

from keypush.errors import UserError
from keypush.learning.card import weights_path
from keypush.learning.clips import Clips
from keypush.learning.eager import both_models, random_network, read_network
from keypush.learning.kinds import KINDS
from keypush.learning.model import PolicyModel, Vector
from keypush.networks.config import EncoderConfig, KeypointConfig, SurfaceConfig
from keypush.objects.library import make_object
from keypush.objects.point_cloud import sensed_points
from keypush.policies import POLICIES
from keypush.scenario import Scenario
from keypush.seeding import make_generator

_TURN = 20
"""So many scenes one network answers before the other has its turn."""
_OTHER_SIZES = [(16, 2), (32, 3), (16, 3)]
"""Patch size and layers of the thesis' other networks."""

_TIMES = ("latency_ms", "latency_cpu_ms", "torch_latency_ms", "torch_latency_cpu_ms")
"""Of a call: wall time, and that of its thread alone, which others on the core do not lengthen."""
_RATIOS = {
    "speedup_vs_torch": ("latency_ms_p50", "torch_latency_ms_p50"),
    "speedup_vs_torch_cpu": ("latency_cpu_ms_p50", "torch_latency_cpu_ms_p50"),
}

Scene = tuple[Vector, Vector, Vector, Vector]
"""Cloud, goal, centre of mass and hand, as `KeypointModel.predict` has them."""


@dataclass(frozen=True)
class Case:
    """One network."""

    told: dict[str, Any]
    """What it is, for the report."""
    kind: str
    fast: PolicyModel
    eager: PolicyModel


def measure_predictors(
    scenario: Scenario, objects: Sequence[str], scenes: int
) -> list[dict[str, Any]]:
    """Asks every network about the same random scenes, in this process, at batch size one.

    A call goes from the raw cloud in W to the answer in W. The networks in NumPy and in PyTorch
    take turns, so that whatever else the machine does slows both alike; turns are long enough for
    each to find its own weights in the processor's cache.

    Args:
        scenario: noise, clips of the action, reachable part of the table, seed.
        objects: catalogue names.
        scenes: number per object.

    Raises:
        UserError: shipped weights cannot be read, or the cloud is too small for a network.
    """
    shown = list(_scenes(scenario, objects, scenes))
    return [_measure(case, shown) for case in _cases(Clips.of(scenario.control))]


def _cases(clips: Clips) -> Iterator[Case]:
    for policy, needs in POLICIES.items():
        if needs.weights_kind is not None:
            yield _policy_case(policy, needs.weights_kind, clips, uses_com=needs.uses_com)
    for patch_size, layers in _OTHER_SIZES:
        encoder = EncoderConfig(patch_size=patch_size, layers=layers)
        sizes = KeypointConfig(encoder=encoder, heads=16)
        yield _case(None, "keypoint", random_network("keypoint", sizes), "random", clips)


def _policy_case(policy: str, kind: str, clips: Clips, *, uses_com: bool) -> Case:
    try:
        path = weights_path(policy)
    except UserError:  # not trained yet
        config = KINDS[kind]
        assert config is KeypointConfig or config is SurfaceConfig
        return _case(policy, kind, random_network(kind, config(use_com=uses_com)), "random", clips)
    return _case(policy, kind, read_network(kind, path), "shipped", clips)


def _case(policy: str | None, kind: str, network: Any, weights: str, clips: Clips) -> Case:
    config = network.config
    encoder = config if isinstance(config, SurfaceConfig) else config.encoder
    told = {
        "policy": policy,
        "kind": kind,
        "weights": weights,
        "patch_size": encoder.patch_size,
        "layers": encoder.layers,
        "use_com": config.use_com,
    }
    return Case(told, kind, *both_models(kind, network, clips))


def _scenes(scenario: Scenario, objects: Sequence[str], count: int) -> Iterator[Scene]:
    """Noisy clouds of objects that lie somewhere on the table, and the hand somewhere above it."""
    half = scenario.table.reachable / 2 * np.array([scenario.table.length, scenario.table.width])
    for name in objects:
        model = make_object(name)
        p_OP = sensed_points(model, scenario.noise.cloud_points, scenario.seed)
        for number in range(count):
            rng = make_generator(scenario.seed, number, f"bench_predictor:{name}")
            yaw = rng.uniform(-np.pi, np.pi)
            c, s = np.cos(yaw), np.sin(yaw)
            R_WO = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
            p_WO = np.append(rng.uniform(-half, half), model.rest_height)
            noise = rng.normal(scale=scenario.noise.cloud_deviation, size=p_OP.shape)
            q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
            p_WE = np.append(rng.uniform(-half, half), rng.uniform(0.01, 0.3))
            yield (
                p_OP @ R_WO.T + p_WO + noise,
                rng.uniform(-half, half),
                R_WO @ model.p_OoOcm_O + p_WO,
                np.concatenate([p_WE, q[:, 0], q[:, 1]]),
            )


def _measure(case: Case, scenes: Sequence[Scene]) -> dict[str, Any]:
    for scene in scenes[:_TURN]:
        case.fast.predict(*scene)
        case.eager.predict(*scene)
    times, errors = [], []
    for start in range(0, len(scenes), _TURN):
        turn = scenes[start : start + _TURN]
        (fast_times, fast), (eager_times, eager) = (
            _answers(model, turn) for model in (case.fast, case.eager)
        )
        times.append(np.hstack([fast_times, eager_times]))
        errors.append(np.abs(fast - eager))
    worst = np.max(np.concatenate(errors), axis=0)
    p50, p90 = np.percentile(1e3 * np.concatenate(times), [50, 90], axis=0)
    figures: dict[str, Any] = dict(case.told)
    for column, name in enumerate(_TIMES):
        figures[f"{name}_p50"], figures[f"{name}_p90"] = float(p50[column]), float(p90[column])
    for name, (mine, torchs) in _RATIOS.items():
        figures[name] = figures[torchs] / figures[mine]
    if case.kind == "behavior_cloning":
        figures["max_abs_error_rad"] = float(worst[3:].max())
    figures["max_abs_error_m"] = float(worst[:3].max())
    return figures


def _answers(model: PolicyModel, scenes: Sequence[Scene]) -> tuple[Vector, Vector]:
    """Returns wall and CPU time of every call, (n, 2) in s, and the answers, (n, size)."""
    times, answers = [], []
    for scene in scenes:
        start = time.perf_counter(), time.thread_time()
        answers.append(model.predict(*scene))
        times.append((time.perf_counter() - start[0], time.thread_time() - start[1]))
    return np.array(times), np.array(answers)


def summarise_predictors(
    scenario: Scenario, networks: Sequence[Mapping[str, Any]], scenes: int
) -> dict[str, Any]:
    """Returns the report: the figures of the policy "keypoint", and of every network.

    Args:
        scenario: of the measurement.
        networks: what `measure_predictors` returned.
        scenes: how many every network was asked about.
    """
    first = next(network for network in networks if network["policy"] == "keypoint")
    return {
        **first,
        "scenes": scenes,
        "cloud_points": scenario.noise.cloud_points,
        "seed": scenario.seed,
        "networks": list(networks),
    }


def predictors_table(report: Mapping[str, Any]) -> Table:
    """Lays out one line per network."""
    table = Table(
        title="Milliseconds from the raw cloud to the answer, on one core", title_justify="left"
    )
    table.add_column("policy")
    table.add_column("size")
    table.add_column("weights")
    for name in ("p50", "CPU", "torch", "ratio", "apart"):
        table.add_column(name, justify="right")
    for line in report["networks"]:
        table.add_row(
            line["policy"] or f"({line['kind']})",
            f"{line['patch_size']}, {line['layers']}",
            line["weights"],
            f"{line['latency_ms_p50']:.2f}",
            f"{line['latency_cpu_ms_p50']:.2f}",
            f"{line['torch_latency_cpu_ms_p50']:.2f}",
            f"{line['speedup_vs_torch_cpu']:.1f}",
            f"{1e6 * line['max_abs_error_m']:.1f} um",
        )
    table.caption = (
        f"{report['scenes']} scenes of {report['cloud_points']} points; size: points of a patch, "
        "layers; p50: wall time; CPU, torch, ratio: median CPU times; apart: largest difference of "
        "answers"
    )
    return table
