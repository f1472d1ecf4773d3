"""How far inside its support polygon an object tips on a soft table."""

import numpy as np
from numpy.typing import NDArray

from keypush.objects.model import ObjectModel
from keypush.objects.table import THICKNESS
from tests.physics.thrown import GRAVITY

Array = NDArray[np.float64]


def tipping_inset(model: ObjectModel, direction: Array, modulus: float) -> float:
    """Distance inside the polygon at which the object tips in `direction`, m.

    The table is a foundation of stiffness k = modulus / (THICKNESS / 2) that only presses.
    Tilted by phi, the object stands on the part of its base beyond s0: k phi times the first
    moment of that part is the weight, which gives phi, and the pressure's centre is s_p. The
    COM at height h moves out by h phi, so it may start at most at max over s0 of s_p - h phi.
    For a straight edge that is `keypush.objects.table`'s formula.
    """
    s, area = _strips(model.support_polygon, direction)
    best = -np.inf
    for s0 in s[:-20:10]:
        moment = np.clip(s - s0, 0.0, None) * area
        phi = model.mass * GRAVITY / (modulus / (THICKNESS / 2) * moment.sum())
        best = max(best, s @ moment / moment.sum() - com_height(model) * phi)
    return float(np.max(model.support_polygon @ direction) - best)


def com_height(model: ObjectModel) -> float:
    """Height of the COM above the table, m."""
    return float(model.p_OoOcm_O[2] + model.rest_height)


def _strips(polygon: Array, direction: Array, count: int = 2000) -> tuple[Array, Array]:
    """Cuts the outer 20 mm of a convex polygon into strips across `direction`; place, area."""
    along = polygon @ direction
    across = polygon @ np.array([-direction[1], direction[0]])
    step = 0.02 / count
    s = along.max() - step * (np.arange(count)[::-1] + 0.5)
    low, high = np.full(count, np.inf), np.full(count, -np.inf)
    for i in range(len(polygon)):
        if abs(along[i] - along[i - 1]) < 1e-12:
            continue
        share = (s - along[i - 1]) / (along[i] - along[i - 1])
        crossing = across[i - 1] + share * (across[i] - across[i - 1])
        met = (share >= 0.0) & (share <= 1.0)
        low = np.where(met, np.minimum(low, crossing), low)
        high = np.where(met, np.maximum(high, crossing), high)
    return s, np.where(high > low, high - low, 0.0) * step
