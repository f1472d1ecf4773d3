"""The whole diagram: who is wired to whom, for every policy."""

import numpy as np
import pytest
from pydrake.systems.framework import System

from diagrams.push_diagram import MakePushDiagram, PushDiagram
from keypush.learning.baselines import GeometricKeypoint
from keypush.policies import POLICIES
from keypush.scenario import parse_scenario
from keypush.systems.episode_logger import ROW_SIZE
from tests.systems.contract import ports


def _push(policy: str) -> PushDiagram:
    scenario = parse_scenario(f"{{policy: {policy}, object: {{name: block}}}}")
    # Wires depend on nothing else in a model than whether it uses the centre of mass.
    model = GeometricKeypoint(uses_com=POLICIES[policy].uses_com)
    return MakePushDiagram(scenario, None if policy == "expert" else model)


def _wires(push: PushDiagram) -> dict[str, str]:
    """What feeds each input, as "system.port"."""

    def name(system: System, port: str) -> str:
        return f"{system.get_name()}.{port}"

    return {
        name(sink, sink.get_input_port(int(i)).get_name()): name(
            source, source.get_output_port(int(o)).get_name()
        )
        for (sink, i), (source, o) in push.diagram.connection_map().items()
    }


@pytest.mark.parametrize("policy", POLICIES)
def test_every_input_has_its_wire(policy: str) -> None:
    push = _push(policy)
    assert ports(push.diagram) == {"in": {}, "out": {}}
    wires = _wires(push)
    unused = set() if POLICIES[policy].uses_com else {"keypoint_predictor.object_com"}
    for system in push.diagram.GetSystems():
        for port in ports(system)["in"]:
            name = f"{system.get_name()}.{port}"
            assert (name in wires) != (name in unused)
    planner = push.planner.get_name()
    assert wires["station.tool_action"] == f"{planner}.tool_action"
    assert wires[f"{planner}.halted"] == "episode_monitor.halted"
    assert wires["episode_logger.contact"] == "station.contact"


SEEN = {"station.point_cloud", "station.tool_pose", "goal.y0", "episode_monitor.halted"}


@pytest.mark.parametrize("policy", [name for name in POLICIES if name != "expert"])
def test_a_policy_sees_the_cloud_and_of_the_truth_at_most_the_centre_of_mass(policy: str) -> None:
    wires = _wires(_push(policy))
    estimator = "upright_estimator"
    systems = ("keypoint_predictor", estimator, "push_planner", "behavior_cloning_policy")
    seen = {source for sink, source in wires.items() if sink.split(".")[0] in systems}
    acts, uses_com = POLICIES[policy].acts, POLICIES[policy].uses_com
    own = {"keypoint_predictor.keypoint", f"{estimator}.object_up"}
    planned = set() if acts else {"station.arm_state", *own}
    assert seen == SEEN | planned | ({"station.object_com"} if uses_com else set())


def test_expert_and_learned_policy_share_everything_else() -> None:
    systems = [
        {s.get_name() for s in _push(p).diagram.GetSystems()}
        for p in ("expert", "centroid", "behavior_cloning")
    ]
    assert systems[0] - systems[1] == {"expert_planner"}
    assert systems[1] - systems[0] == {"push_planner", "keypoint_predictor", "upright_estimator"}
    assert systems[2] - systems[0] == {"behavior_cloning_policy"}


def test_the_log_holds_whole_rows() -> None:
    push = _push("expert")
    assert push.log.get_input_port().size() == ROW_SIZE


def test_the_cloud_is_drawn_anew_for_another_seed() -> None:
    clouds = []
    for seed in (0, 0, 1):
        scenario = parse_scenario(
            f"{{policy: expert, seed: {seed}, noise: {{cloud_deviation: 0}}}}"
        )
        push = MakePushDiagram(scenario)
        station = push.station.diagram
        context = station.GetMyContextFromRoot(push.diagram.CreateDefaultContext())
        clouds.append(np.array(station.GetOutputPort("point_cloud").Eval(context)))
    np.testing.assert_array_equal(clouds[0], clouds[1])
    assert np.any(clouds[0] != clouds[2])
