"""Runs the study of the expert that `docs/expert.md` reports, or goes on with it.

    scripts/uv.sh run scripts/study_expert.py OUT [CONDITION...]

Every condition leaves a folder in OUT; finished blocks stay, so it can be stopped at any time.
"""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import tyro
from as_command import as_command, check_names

from keypush.objects.library import parse_object_list
from keypush.planning.presets import EXPERTS, expert_scenario
from keypush.rollout.job import Job
from keypush.rollout.parallel import run_job
from keypush.scenario import PlannerConfig, Scenario

SEED = 4
"""Not that of the data set, nor of evaluations."""
FEW = "block,mug,bowl,duck,candle,t_block,star_prism,tripod"
"""Objects of every kind, on which one field at a time is changed."""
_FEW_EPISODES, _ALL_EPISODES, _TRAIN_EPISODES, _NOMINAL_EPISODES = 6, 10, 10, 20


@dataclass(frozen=True)
class Condition:
    """Settings under which the expert runs."""

    expert: str = "tuned"
    planner: tuple[tuple[str, Any], ...] = ()
    size_ratio: float = 1.0
    com_shift: float = 0.0
    integrator: str = "cenic"
    objects: str = FEW
    episodes: int = _FEW_EPISODES

    def scenario(self) -> Scenario:
        """Returns what is run; the object's name is replaced by each of `objects`."""
        plain = Scenario(seed=SEED)
        plain = replace(
            plain,
            object=replace(plain.object, size_ratio=self.size_ratio),
            variation=replace(plain.variation, com_shift=self.com_shift),
            simulation=replace(plain.simulation, integrator=self.integrator),
        )
        scenario = expert_scenario(plain, self.expert)
        return replace(scenario, planner=replace(scenario.planner, **dict(self.planner)))


_EVERYWHERE = Condition(objects="all", episodes=_ALL_EPISODES)


def conditions() -> dict[str, Condition]:
    """Returns all conditions by the name of their folder: first on all objects, then on few."""
    fields: dict[str, list[Any]] = {
        "pitch_deg": [45.0, 75.0],
        "tool_height": [0.01, 0.02, 0.03],
        "push_speed": [0.03, 0.1, 0.2],
        "touch_speed": [0.01, 0.04, 0.065],
        "reaim": [False],
        "lateral_gain": [0.0, 2.0],
        "reapproach_error": [0.008, 0.2],
        "approach_margin": [0.02, 0.06],
        "wait_tilt_deg": [90.0],
        "reset_period": [20],
    }
    found = {
        "tuned": replace(_EVERYWHERE, episodes=_NOMINAL_EPISODES),
        "size_0.75": replace(_EVERYWHERE, size_ratio=0.75),
        "size_1.25": replace(_EVERYWHERE, size_ratio=1.25),
        "com_shift": replace(_EVERYWHERE, com_shift=0.015),
        # Touches at the speed of the push.
        "com_shift_struck": replace(
            _EVERYWHERE, com_shift=0.015, planner=(("touch_speed", PlannerConfig().push_speed),)
        ),
        "reset": replace(_EVERYWHERE, planner=(("reset_period", 20),)),
        "thesis": replace(_EVERYWHERE, expert="thesis"),
        # Against the first episodes of "tuned": the reference with small fixed steps.
        "discrete": Condition(objects="train", integrator="discrete", episodes=_TRAIN_EPISODES),
        "few": Condition(),
    }
    for name, values in fields.items():
        for value in values:
            found[f"few_{name}_{value}"] = Condition(planner=((name, value),))
    yaw = ("wrist_yaw_deg", EXPERTS["thesis"]["wrist_yaw_deg"])
    height = ("tool_height", EXPERTS["thesis"]["tool_height"])
    return found | {
        "few_wrist_yaw_deg_0": Condition(planner=(yaw, height)),
        "few_tool_height_0.025": Condition(planner=(height,)),
    }


def run(name: str, condition: Condition, folder: Path) -> None:
    """Runs what is missing of a condition."""
    folder.mkdir(parents=True, exist_ok=True)
    print(name, flush=True)
    job = Job(
        scenario=condition.scenario(),
        objects=tuple(parse_object_list(condition.objects)),
        episodes=condition.episodes,
    )
    run_job(job, folder, workers=2)


def main(out: Path, names: tyro.conf.Positional[tuple[str, ...]] = ()) -> None:
    """Runs conditions.

    Args:
        out: the folder.
        names: of the conditions; all by default.
    """
    known = conditions()
    check_names("condition", names, list(known))
    for name in names or known:
        run(name, known[name], out / name)


if __name__ == "__main__":
    as_command(main)
