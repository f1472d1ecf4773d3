"""Puts an episode's mass properties and friction into the Context of a station.

Drake keeps both as parameters of a context, so the diagram stays and `SetDefaultContext` takes
them back. Shapes are part of the model: another size needs another diagram.
"""

from pydrake.geometry import ProximityProperties, RoleAssign
from pydrake.multibody.plant import CoulombFriction
from pydrake.multibody.tree import RigidBody
from pydrake.systems.framework import Context

from diagrams.station import PushStation
from keypush.objects.model import ObjectModel
from keypush.objects.plant import spatial_inertia
from keypush.objects.table import TABLE_BODY
from keypush.objects.variation import ObjectVariation
from keypush.scenario import Scenario


def set_mass_properties(station: PushStation, root: Context, model: ObjectModel) -> None:
    """Gives the station's object the mass, centre of mass and inertia of a model.

    Args:
        station: whose object has the model's shape.
        root: context of a diagram that holds the station.
        model: what the plant and the port `object_com` follow from now on.
    """
    if model is station.model:
        return
    plant_context = station.plant.GetMyMutableContextFromRoot(root)
    station.object_body.SetSpatialInertiaInBodyFrame(plant_context, spatial_inertia(model))
    station.poses.set_com(station.poses.GetMyMutableContextFromRoot(root), model.p_OoOcm_O)


def set_frictions(
    station: PushStation, root: Context, variation: ObjectVariation, scenario: Scenario
) -> None:
    """Gives object, table (with the floor) and arm the coefficients of an episode.

    A context that has the scenario's already is left alone: each geometry costs up to some
    milliseconds, since Drake makes its hydroelastic representation anew.

    Args:
        station: built with the scenario.
        root: context of a diagram that holds the station, with the model's own coefficients.
        variation: what the coefficients become.
        scenario: what they are.
    """
    plant = station.plant
    arm = [plant.get_body(index) for index in plant.GetBodyIndices(station.panda.instance)]
    table = plant.GetBodyByName(TABLE_BODY)
    for bodies, before, now in (
        ([station.object_body], scenario.object.friction, variation.object_friction),
        ([table], scenario.table.friction, variation.table_friction),
        (arm, scenario.robot.gripper_friction, variation.gripper_friction),
    ):
        if now != before:
            for body in bodies:
                _set_friction(station, root, body, now)


def _set_friction(station: PushStation, root: Context, body: RigidBody, coefficient: float) -> None:
    scene_graph, source = station.scene_graph, station.plant.get_source_id()
    assert source is not None
    context = scene_graph.GetMyMutableContextFromRoot(root)
    friction = CoulombFriction(static_friction=coefficient, dynamic_friction=coefficient)
    for geometry in station.plant.GetCollisionGeometriesForBody(body):
        own = scene_graph.model_inspector().GetProximityProperties(geometry)
        properties = ProximityProperties(own)
        properties.UpdateProperty("material", "coulomb_friction", friction)
        scene_graph.AssignRole(context, source, geometry, properties, RoleAssign.kReplace)
