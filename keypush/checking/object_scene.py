"""One object alone on the table: what physics oracles and checks of objects look at."""

import dataclasses

import numpy as np
from numpy.typing import NDArray
from pydrake.math import RigidTransform
from pydrake.multibody.math import SpatialForce
from pydrake.multibody.plant import (
    AddMultibodyPlant,
    ExternallyAppliedSpatialForce,
    MultibodyPlantConfig,
)
from pydrake.systems.analysis import ApplySimulatorConfig, Simulator
from pydrake.systems.framework import DiagramBuilder

from keypush.objects.model import ObjectModel
from keypush.objects.plant import add_object
from keypush.objects.table import add_table
from keypush.rollout.simulation import simulator_config
from keypush.scenario import ObjectConfig, SimulationConfig, TableConfig


class ObjectScene:
    """An object that stands at Wo, and the simulator that moves it."""

    def __init__(
        self, model: ObjectModel, simulation: SimulationConfig, height: float = 0.0
    ) -> None:
        """Args: the object, how to simulate, and how high above the table it starts, m."""
        cenic = simulation.integrator == "cenic"
        builder = DiagramBuilder()
        config = MultibodyPlantConfig(
            time_step=0.0 if cenic else simulation.discrete_period,
            contact_model="hydroelastic_with_fallback",
        )
        self.plant, _ = AddMultibodyPlant(config, builder)
        add_table(self.plant, TableConfig(), simulation)
        self.body = add_object(self.plant, model, ObjectConfig().friction)
        self.plant.Finalize()
        builder.ExportInput(self.plant.get_applied_spatial_force_input_port(), "force")
        self.simulator = Simulator(builder.Build())
        ApplySimulatorConfig(simulator_config(simulation), self.simulator)
        self._root = self.simulator.get_mutable_context()
        self.context = self.plant.GetMyMutableContextFromRoot(self._root)
        self.push(np.zeros(3), np.zeros(3))
        start = RigidTransform(np.array([0.0, 0.0, model.rest_height + height]))
        self.plant.SetFreeBodyPose(self.context, self.body, start)
        self.simulator.Initialize()

    def push(self, p_OoQ_O: NDArray[np.float64], f_W: NDArray[np.float64]) -> None:
        """Applies a constant force at Q, fixed in the object, from now on."""
        force = ExternallyAppliedSpatialForce()
        force.body_index = self.body.index()
        force.p_BoBq_B = p_OoQ_O
        force.F_Bq_W = SpatialForce(np.zeros(3), f_W)
        self.simulator.get_system().get_input_port(0).FixValue(self._root, [force])

    def advance(self, duration: float, stop_at_tilt: float = np.inf) -> float:
        """Simulates in policy steps; returns the largest tilt seen between them, rad."""
        end, largest = self._root.get_time() + duration, 0.0
        while self._root.get_time() < end - 1e-9 and largest < stop_at_tilt:
            self.simulator.AdvanceTo(min(end, self._root.get_time() + 0.1))
            largest = max(largest, self.tilt())
        return largest

    def tilt(self) -> float:
        """Angle between Oz and Wz, rad."""
        z = self.pose().rotation().matrix()[2, 2]
        return float(np.arccos(np.clip(z, -1.0, 1.0)))

    def pose(self) -> RigidTransform:
        """X_WO."""
        pose: RigidTransform = self.plant.EvalBodyPoseInWorld(self.context, self.body)
        return pose


def with_com(model: ObjectModel, xy: NDArray[np.float64]) -> ObjectModel:
    """Moves the centre of mass to xy, at its own height, and keeps the inertia about it."""
    return dataclasses.replace(model, p_OoOcm_O=np.array([*xy, model.p_OoOcm_O[2]]))
