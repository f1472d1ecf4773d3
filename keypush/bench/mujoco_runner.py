"""MujocoEpisodeRunner: the episodes of `EpisodeRunner` with MuJoCo as the engine."""

from typing import Any

import numpy as np
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import Diagram, DiagramBuilder

from diagrams.push_diagram import add_policy
from keypush.bench.mujoco_plant import MujocoPlant
from keypush.bench.mujoco_scene import make_mujoco_model
from keypush.control.arm_kinematics import ArmKinematics
from keypush.errors import UserError
from keypush.objects.library import make_object
from keypush.robot.panda import NUM_JOINTS
from keypush.rollout.episode import EpisodeResult, split_rows
from keypush.rollout.start import StartSampler
from keypush.scenario import Scenario, VariationConfig
from keypush.systems.differential_ik_controller import DifferentialIkController
from keypush.systems.episode_monitor import Outcome, longest_episode
from keypush.systems.episode_seed import set_episode_seed
from keypush.systems.torque_noise import TorqueNoise


class MujocoEpisodeRunner:
    """Same starts, expert, controller, noise, monitor and log; MuJoCo instead of Drake's plant."""

    def __init__(self, scenario: Scenario) -> None:
        """Builds scene and diagram; the scenario's policy must be the expert.

        Raises:
            UserError: MuJoCo or CoACD is not installed, or the scenario varies the object.
        """
        assert scenario.policy == "expert"
        if scenario.variation != VariationConfig():
            raise UserError(
                "variation is set; allowed where engines are compared: none, since MuJoCo's scene "
                "has the object as the catalogue has it"
            )
        self._scenario = scenario
        model = make_object(scenario.object.name, scenario.object.size_ratio, scenario.object.mass)
        builder = DiagramBuilder()
        self._plant = MujocoPlant(
            make_mujoco_model(scenario, model),
            model.p_OoOcm_O,
            scenario.robot.stiffness,
            scenario.episode.policy_period,
        )
        station, self._noise = _make_station(scenario, self._plant)
        builder.AddSystem(station)
        self._policy = add_policy(builder, station, model, scenario)
        self._diagram = builder.Build()
        self._sampler = StartSampler(scenario, model)
        self._simulator = Simulator(self._diagram)

    def run(self, episode: int) -> EpisodeResult:
        """Runs one episode; see `EpisodeRunner.run`. It does not judge `settled_success`."""
        start = self._sampler.sample(episode)
        context, policy = self._simulator.get_mutable_context(), self._policy
        self._diagram.SetDefaultContext(context)
        context.SetTime(0.0)
        self._plant.set_start(self._plant.GetMyMutableContextFromRoot(context), start)
        goal = policy.goal.get_mutable_source_value(
            policy.goal.GetMyMutableContextFromRoot(context)
        )
        goal.set_value(start.goal)
        for system in (self._noise, policy.planner):
            mine = system.GetMyMutableContextFromRoot(context)
            set_episode_seed(mine, self._scenario.seed, episode)
        policy.log.FindMutableLog(context).Clear()
        self._simulator.Initialize()
        config = self._scenario.episode
        self._simulator.AdvanceTo(longest_episode(config))
        return self._result(episode)

    def _result(self, episode: int) -> EpisodeResult:
        context, monitor = self._simulator.get_context(), self._policy.monitor
        verdict: Any = monitor.GetOutputPort("verdict").Eval(monitor.GetMyContextFromRoot(context))
        plant_context = self._plant.GetMyContextFromRoot(context)
        X_WO: Any = self._plant.GetOutputPort("object_pose").Eval(plant_context)
        keys = {
            "object": self._scenario.object.name,
            "size_ratio": self._scenario.object.size_ratio,
            "seed": self._scenario.seed,
            "episode": episode,
        }
        summary: dict[str, object] = {
            **keys,
            "outcome": Outcome(int(verdict[0])).name.lower(),
            "steps": int(verdict[1]),
            "final_position": np.array(X_WO.translation()),
        }
        rows = split_rows(self._policy.log.FindLog(context), keys)
        return EpisodeResult(summary, rows, context.get_time())


def _make_station(scenario: Scenario, plant: MujocoPlant) -> tuple[Diagram, TorqueNoise]:
    """Returns a station with the ports of `MakePushStation`'s that the expert needs."""
    period = scenario.episode.policy_period
    builder = DiagramBuilder()
    builder.AddSystem(plant)
    controller = builder.AddSystem(
        DifferentialIkController(ArmKinematics(scenario.robot), scenario.control, period)
    )
    noise = TorqueNoise(NUM_JOINTS, scenario.noise.torque_deviation, period)
    builder.AddSystem(noise)
    builder.Connect(plant.GetOutputPort("arm_state"), controller.GetInputPort("arm_state"))
    builder.Connect(
        controller.GetOutputPort("arm_desired_state"), plant.GetInputPort("arm_desired_state")
    )
    builder.Connect(noise.GetOutputPort("torque"), plant.GetInputPort("torque"))
    builder.ExportInput(controller.GetInputPort("tool_action"), "tool_action")
    for name in ("arm_state", "tool_pose", "object_pose", "object_com", "contact"):
        builder.ExportOutput(plant.GetOutputPort(name), name)
    station = builder.Build()
    station.set_name("station")
    return station, noise
