"""Adds an object to a plant."""

import numpy as np
import trimesh
from pydrake.common import MemoryFile
from pydrake.geometry import (
    AddContactMaterial,
    AddRigidHydroelasticProperties,
    InMemoryMesh,
    Mesh,
    ProximityProperties,
)
from pydrake.math import RigidTransform
from pydrake.multibody.plant import CoulombFriction, MultibodyPlant
from pydrake.multibody.tree import RigidBody, RotationalInertia, SpatialInertia

from keypush.objects.asset import obj_text
from keypush.objects.model import ObjectModel

OBJECT_BODY = "object"
"""Name of the body and of its model instance."""


def add_object(plant: MultibodyPlant, model: ObjectModel, friction: float) -> RigidBody:
    """Adds the free body "object" in a model instance of the same name, before Finalize.

    Its contact geometry is the rigid, possibly non-convex mesh; what it touches has to be
    compliant. Works for continuous and discrete plants.

    Args:
        plant: registered with a SceneGraph.
        model: what to add; its centre of mass and inertia are taken as they stand.
        friction: Coulomb coefficient; Drake combines a pair as 2ab/(a+b).
    """
    instance = plant.AddModelInstance(OBJECT_BODY)
    body = plant.AddRigidBody(OBJECT_BODY, instance, spatial_inertia(model))
    touches = drake_mesh(model.mesh)
    properties = ProximityProperties()
    AddRigidHydroelasticProperties(properties=properties)
    AddContactMaterial(
        properties=properties, friction=CoulombFriction(static_friction=friction,
                                                        dynamic_friction=friction)
    )  # fmt: skip
    plant.RegisterCollisionGeometry(body, RigidTransform(), touches, "object_collision", properties)
    plant.RegisterVisualGeometry(
        body, RigidTransform(), drake_mesh(model.visual), "object_visual", np.array(model.colour)
    )
    return body


def spatial_inertia(model: ObjectModel) -> SpatialInertia:
    """Returns M_OOo_O, the spatial inertia about Oo."""
    inertia = model.I_OOcm_O
    return SpatialInertia.MakeFromCentralInertia(
        mass=model.mass,
        p_PScm_E=model.p_OoOcm_O,
        I_SScm_E=RotationalInertia(
            Ixx=inertia[0, 0], Iyy=inertia[1, 1], Izz=inertia[2, 2],
            Ixy=inertia[0, 1], Ixz=inertia[0, 2], Iyz=inertia[1, 2],
        ),
    )  # fmt: skip


def drake_mesh(mesh: trimesh.Trimesh) -> Mesh:
    """Returns a mesh as OBJ text in memory, so that no file is involved."""
    file = MemoryFile(obj_text(mesh), ".obj", "object.obj")
    return Mesh(mesh_data=InMemoryMesh(mesh_file=file), scale=1.0)
