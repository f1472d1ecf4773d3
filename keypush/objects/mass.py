"""Mass properties of a closed mesh of uniform density."""

import numpy as np
import trimesh
from numpy.typing import NDArray


def uniform_density(
    mesh: trimesh.Trimesh, mass: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Computes centre of mass and inertia from volume integrals over the mesh.

    Source: Eberly, "Polyhedral Mass Properties (Revisited)", as trimesh implements it.

    Args:
        mesh: closed mesh, faces outwards, in the frame of interest O.
        mass: kg.

    Returns:
        p_OoOcm_O (3,) in m and I_OOcm_O (3, 3) in kg m^2, about the centre of mass.

    Raises:
        ValueError: the mesh is not closed or encloses no volume.
    """
    if not mesh.is_watertight or mesh.volume <= 0:
        raise ValueError("mass properties need a closed mesh whose faces point outwards")
    scale = mass / float(mesh.volume)
    return np.array(mesh.center_mass), scale * np.array(mesh.moment_inertia)
