"""Upright walls just above the base of an object.

The table foresees contact within its margin, which long steps need. A face that leans outwards
just above the base is foreseen to run into the table when the object slides towards it: the object
is braked, lifted and trips over nothing. Walls that stand upright over the base's outline as far
as the margin reaches leave nothing to run into.
"""

import trimesh
from manifold3d import CrossSection, Manifold

from keypush.objects.manifolds import to_manifold, to_mesh

HEIGHT = 1.3e-3
"""How high the walls are, m: the table's margin, and a quarter more for smaller objects."""
_BASE = 1e-6
"""Height above the base, m, at which its outline is taken."""


def with_skirt(mesh: trimesh.Trimesh) -> trimesh.Trimesh:
    """Cuts away what leans out over the base's outline within `HEIGHT` above the base.

    Args:
        mesh: closed, upright, its base flat.
    """
    solid = to_manifold(mesh)
    low, high = mesh.bounds
    outline = solid.slice(low[2] + _BASE)
    around = CrossSection.square(tuple(2 * (high - low)[:2]), center=True).translate(
        tuple((low + high)[:2] / 2)
    )
    leaning = Manifold.extrude(around - outline, HEIGHT).translate((0.0, 0.0, float(low[2])))
    return to_mesh(solid - leaning)
