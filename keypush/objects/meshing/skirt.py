"""The base of an object: flat, with upright walls just above it.

The table foresees contact within its margin, which long steps need. A face that leans outwards
just above the base is foreseen to run into the table when the object slides towards it: the object
is braked, lifted and trips over nothing. Walls that stand upright over the base's outline as far
as the margin reaches leave nothing to run into. A round thing that touches in a line or in points
gets a flat base first.
"""

import numpy as np
import trimesh
from manifold3d import CrossSection, Manifold

from keypush.objects.manifolds import to_manifold, to_mesh
from keypush.objects.meshing.felt import support_gap
from keypush.objects.resting import TOUCH_TOLERANCE

HEIGHT = 1.3e-3
"""How high the walls are, m: the table's margin, and a quarter more for smaller objects."""
_BASE = 1e-6
"""Height above the base, m, at which its outline is taken."""
_NARROW, _SHORT = 2e-4, 8e-4
"""A base needs no other one if it reaches to within `_SHORT` of what touches, m, even with a rim
of `_NARROW` taken off."""


def with_skirt(mesh: trimesh.Trimesh) -> trimesh.Trimesh:
    """Cuts away what leans out over the base's outline within `HEIGHT` above the base.

    Args:
        mesh: closed, upright.
    """
    solid = to_manifold(mesh)
    low, high = mesh.bounds
    outline, touching = (solid.slice(low[2] + h) for h in (_BASE, TOUCH_TOLERANCE))
    if _falls_short(outline, touching):
        outline = touching
        solid += Manifold.extrude(outline, TOUCH_TOLERANCE + _BASE).translate((0, 0, low[2]))
    around = CrossSection.square(tuple(2 * (high - low)[:2]), center=True).translate(
        tuple((low + high)[:2] / 2)
    )
    leaning = Manifold.extrude(around - outline, HEIGHT).translate((0.0, 0.0, float(low[2])))
    return to_mesh(solid - leaning)


def _falls_short(outline: CrossSection, touching: CrossSection) -> bool:
    """Whether the base's outline supports much less than all that nearly touches."""
    inner = outline.offset(-_NARROW)
    if inner.is_empty():
        return True
    felt, polygon = (np.vstack(section.to_polygons()) for section in (inner, touching))
    return support_gap(felt, polygon) > _SHORT
