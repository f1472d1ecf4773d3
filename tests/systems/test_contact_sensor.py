"""ContactSensor against statics: a plate that rests on three balls, whose loads are known."""

from dataclasses import dataclass

import numpy as np
import pytest
from numpy.typing import NDArray
from pydrake.geometry import (
    AddCompliantHydroelasticProperties,
    AddContactMaterial,
    AddRigidHydroelasticProperties,
    Box,
    ProximityProperties,
    Shape,
    Sphere,
)
from pydrake.math import RigidTransform
from pydrake.multibody.plant import (
    AddMultibodyPlant,
    CoulombFriction,
    MultibodyPlant,
    MultibodyPlantConfig,
)
from pydrake.multibody.tree import RigidBody, SpatialInertia
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import Context, DiagramBuilder

from keypush.systems.contact_sensor import ContactSensor
from tests.systems.contract import evaluate, everything, outputs, ports

MASS, GRAVITY, RADIUS, THICKNESS = 0.5, 9.81, 0.01, 0.02
COM = np.array([0.006, -0.004])
ANGLES = np.deg2rad([90.0, 210.0, 330.0])
PADS = 0.04 * np.column_stack([np.cos(ANGLES), np.sin(ANGLES)])
LOADS = np.linalg.solve(np.vstack([np.ones(3), PADS.T]), MASS * GRAVITY * np.array([1.0, *COM]))
"""Balance of forces and of moments: the load on each ball."""


@dataclass(frozen=True)
class Scene:
    """A plate on balls, some of which belong to the robot and the others to the table."""

    sensor: ContactSensor
    plant: MultibodyPlant
    simulator: Simulator
    context: Context
    """The sensor's own."""

    def contact(self) -> NDArray[np.float64]:
        return np.array(evaluate(self.sensor, "contact", self.context))


def _properties(rigid: bool) -> ProximityProperties:
    properties = ProximityProperties()
    AddContactMaterial(
        properties=properties,
        dissipation=50.0,
        point_stiffness=1e5,
        friction=CoulombFriction(static_friction=0.5, dynamic_friction=0.5),
    )
    if rigid:
        AddRigidHydroelasticProperties(resolution_hint=0.005, properties=properties)
    else:
        AddCompliantHydroelasticProperties(
            resolution_hint=0.004, hydroelastic_modulus=1e7, properties=properties
        )
    return properties


def _add(plant: MultibodyPlant, body: RigidBody, p_BG: NDArray[np.float64], shape: Shape) -> None:
    """A compliant ball or the rigid plate."""
    name = f"{body.name()}_{len(plant.GetCollisionGeometriesForBody(body))}"
    plant.RegisterCollisionGeometry(
        body, RigidTransform(p_BG), shape, name, _properties(isinstance(shape, Box))
    )


def _scene(model: str, robots_balls: int, object_first: bool, lift: float = 0.0) -> Scene:
    builder = DiagramBuilder()
    config = MultibodyPlantConfig(time_step=1e-3, contact_model=model)
    plant, _ = AddMultibodyPlant(config, builder)
    names = ["plate", "robot", "table"] if object_first else ["robot", "table", "plate"]
    p_PCm = np.array([*COM, 0.0])
    inertia = SpatialInertia.SolidBoxWithMass(MASS, 0.12, 0.12, THICKNESS)
    moved = SpatialInertia(MASS, p_PCm, inertia.Shift(-p_PCm).get_unit_inertia())
    bodies = {n: plant.AddRigidBody(n, moved if n == "plate" else inertia) for n in names}
    for name in ("robot", "table"):
        plant.WeldFrames(plant.world_frame(), bodies[name].body_frame())
    for name in names:
        if name == "plate":
            _add(plant, bodies[name], np.zeros(3), Box(0.12, 0.12, THICKNESS))
        for i, xy in enumerate(PADS):
            if (name == "robot" and i < robots_balls) or (name == "table" and i >= robots_balls):
                _add(plant, bodies[name], np.array([*xy, 0.0]), Sphere(RADIUS))
    plant.Finalize()
    sensor = ContactSensor(
        frozenset(plant.GetCollisionGeometriesForBody(bodies["robot"])),
        frozenset(plant.GetCollisionGeometriesForBody(bodies["plate"])),
        frozenset({bodies["robot"].index()}),
        bodies["plate"].index(),
    )
    builder.AddSystem(sensor)
    results = plant.get_contact_results_output_port()
    builder.Connect(results, sensor.GetInputPort("contact_results"))
    simulator = Simulator(builder.Build())
    root = simulator.get_mutable_context()
    start = RigidTransform(np.array([0.0, 0.0, RADIUS + THICKNESS / 2 + lift]))
    plant.SetFreeBodyPose(plant.GetMyMutableContextFromRoot(root), bodies["plate"], start)
    return Scene(sensor, plant, simulator, sensor.GetMyMutableContextFromRoot(root))


@pytest.mark.parametrize("model", ["hydroelastic_with_fallback", "point"])
@pytest.mark.parametrize("robots_balls", [3, 2, 1])
@pytest.mark.parametrize("object_first", [True, False])
def test_force_and_centroid_are_those_of_statics(
    model: str, robots_balls: int, object_first: bool
) -> None:
    scene = _scene(model, robots_balls, object_first)
    scene.simulator.AdvanceTo(0.5)
    contact = scene.contact()
    loads, pads = LOADS[:robots_balls], PADS[:robots_balls]
    weight = loads.sum()
    # On the object, so upwards; with all three balls it is the object's whole weight.
    np.testing.assert_allclose(contact[3:], [0.0, 0.0, weight], atol=0.01 * weight)
    centroid = [*(loads @ pads / weight), RADIUS]
    np.testing.assert_allclose(contact[:3], centroid, atol=5e-4)


def test_with_every_ball_the_centroid_lies_under_the_com() -> None:
    scene = _scene("hydroelastic_with_fallback", 3, True)
    scene.simulator.AdvanceTo(0.5)
    np.testing.assert_allclose(scene.contact()[:2], COM, atol=5e-4)
    np.testing.assert_allclose(scene.contact()[5], MASS * GRAVITY, rtol=0.01)


@pytest.mark.parametrize("model", ["hydroelastic_with_fallback", "point"])
@pytest.mark.parametrize(("robots_balls", "lift"), [(0, 0.0), (3, 0.5)])
def test_without_contact_there_is_no_place_and_no_force(
    model: str, robots_balls: int, lift: float
) -> None:
    """Also while the object rests on the table alone."""
    scene = _scene(model, robots_balls, True, lift)
    scene.simulator.AdvanceTo(0.1)
    contact = scene.contact()
    assert np.all(np.isnan(contact[:3]))
    np.testing.assert_array_equal(contact[3:], np.zeros(3))


def test_ports() -> None:
    scene = _scene("point", 3, True)
    assert ports(scene.sensor) == {"in": {"contact_results": None}, "out": {"contact": 6}}


def test_outputs_are_pure() -> None:
    scene = _scene("hydroelastic_with_fallback", 3, True)
    scene.simulator.AdvanceTo(0.05)
    plant_context = scene.plant.GetMyContextFromRoot(scene.simulator.get_context())
    before = scene.plant.GetPositionsAndVelocities(plant_context).tobytes()
    sensors = everything(scene.context)
    first = outputs(scene.sensor, scene.context)
    scene.simulator.get_mutable_context().DisableCaching()
    assert outputs(scene.sensor, scene.context) == first
    assert scene.plant.GetPositionsAndVelocities(plant_context).tobytes() == before
    assert everything(scene.context) == sensors
