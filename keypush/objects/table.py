"""Adds the table and the floor to a plant."""

import numpy as np
from pydrake.geometry import (
    AddCompliantHydroelasticProperties,
    AddContactMaterial,
    Box,
    Cylinder,
    ProximityProperties,
)
from pydrake.math import RigidTransform
from pydrake.multibody.plant import CoulombFriction, MultibodyPlant
from pydrake.multibody.tree import RigidBody, SpatialInertia

from keypush.scenario import SimulationConfig, TableConfig

TABLE_BODY = "table"
"""Name of the body and of its model instance."""
THICKNESS = 0.02
"""Of the table top in m. Pressure at depth e is modulus * e / (THICKNESS / 2).

That ratio, by default 5e9 Pa/m, decides how near to its edge an object tips: on a foundation of
stiffness k one of weight F, COM height h and straight edge L tips 1.5 (4 F h / (9 k L))^(1/3)
inside it. Simulated, the catalogue's tip 0.6 to 0.8 mm inside such edges, 0.8 to 1.5 mm inside
round rims and up to 2 mm inside corners. A table ten times as stiff halves that, but CENIC's
long steps then kick pushed objects over.
"""
FLOOR = (3.0, 3.0, 0.1)
"""Extents of the floor in m."""
COLOUR = np.array([0.82, 0.74, 0.62, 1.0])


def add_table(plant: MultibodyPlant, table: TableConfig, simulation: SimulationConfig) -> RigidBody:
    """Adds the compliant table top, its legs (to be seen only) and the floor, before Finalize.

    The body "table", in a model instance of the same name, is welded to the world; its frame
    is W: the top face is centred on Wo. The floor is the plane z = -table.height.
    """
    instance = plant.AddModelInstance(TABLE_BODY)
    body = plant.AddRigidBody(TABLE_BODY, instance, SpatialInertia.Zero())
    plant.WeldFrames(plant.world_frame(), body.body_frame())
    top = Box(table.length, table.width, THICKNESS)
    X_WT = _shifted(0.0, 0.0, -THICKNESS / 2)
    properties = _material(table, simulation)
    plant.RegisterCollisionGeometry(body, X_WT, top, "table_top", properties)
    plant.RegisterVisualGeometry(body, X_WT, top, "table_top_visual", COLOUR)
    _add_legs(plant, body, table)
    _add_floor(plant, body, table, simulation)
    return body


def _material(table: TableConfig, simulation: SimulationConfig) -> ProximityProperties:
    properties = ProximityProperties()
    AddContactMaterial(
        properties=properties,
        dissipation=simulation.dissipation,
        friction=CoulombFriction(static_friction=table.friction, dynamic_friction=table.friction),
    )
    AddCompliantHydroelasticProperties(
        resolution_hint=THICKNESS,  # required, but of no effect on a box
        hydroelastic_modulus=simulation.table_modulus,
        properties=properties,
    )
    # The discrete model's short steps need no foresight, and chatter when given it.
    margin = simulation.table_margin if simulation.integrator == "cenic" else 0.0
    properties.AddProperty("hydroelastic", "margin", margin)
    return properties


def _add_legs(plant: MultibodyPlant, body: RigidBody, table: TableConfig) -> None:
    radius, height = 0.015, table.height - THICKNESS
    for index, (sx, sy) in enumerate([(-1, -1), (-1, 1), (1, -1), (1, 1)]):
        x, y = table.length / 2 - radius, table.width / 2 - radius
        X_WL = _shifted(sx * x, sy * y, -THICKNESS - height / 2)
        plant.RegisterVisualGeometry(body, X_WL, Cylinder(radius, height), f"leg_{index}", COLOUR)


def _add_floor(
    plant: MultibodyPlant, body: RigidBody, table: TableConfig, simulation: SimulationConfig
) -> None:
    properties = _material(table, simulation)
    X_WF = _shifted(0.0, 0.0, -table.height - FLOOR[2] / 2)
    plant.RegisterCollisionGeometry(body, X_WF, Box(*FLOOR), "floor", properties)


def _shifted(x: float, y: float, z: float) -> RigidTransform:
    return RigidTransform(np.array([x, y, z]))
