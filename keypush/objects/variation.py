"""What differs from one episode to the next: an object's size, mass properties and friction."""

import dataclasses
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from keypush.objects.model import ObjectModel
from keypush.objects.resting import edge_gaps, room
from keypush.scenario import VARIED_FIELDS, Scenario
from keypush.seeding import make_generator

Array = NDArray[np.float64]
MOST_OF_REACH = 0.9
"""Share of the way to the convex hull's surface beyond which no centre of mass moves."""


@dataclass(frozen=True, eq=False)
class ObjectVariation:
    """What one episode draws."""

    size_ratio: float
    mass_factor: float
    """On the object's mass."""
    object_friction: float
    table_friction: float
    gripper_friction: float
    com_shift: Array
    """Wanted offset (2,) of the centre of mass in O, horizontal, m."""


@dataclass(frozen=True, eq=False)
class VariedObject:
    """An object as one episode has it."""

    model: ObjectModel
    com_offset: Array
    """How far (2,) the centre of mass was moved in O, horizontally, m."""
    com_capped: bool
    """Whether that is less than was wanted."""


def draw_variation(scenario: Scenario, episode: int) -> ObjectVariation:
    """Draws what varies in an episode, from the scenario's seed and the episode alone.

    Whatever the scenario varies, the same numbers are drawn in the same order: an episode
    keeps its direction of shift, say, when friction begins to vary too.
    """
    rng = make_generator(scenario.seed, episode, "variation")
    drawn: dict[str, float] = {}
    for name, (section, field) in VARIED_FIELDS.items():
        drawn[name] = float(rng.uniform(*getattr(scenario.variation, name)))
        if name != "mass":
            drawn[name] *= getattr(getattr(scenario, section), field)
    angle = rng.uniform(-np.pi, np.pi)
    return ObjectVariation(
        size_ratio=drawn["size"],
        mass_factor=drawn["mass"],
        object_friction=drawn["object_friction"],
        table_friction=drawn["table_friction"],
        gripper_friction=drawn["gripper_friction"],
        com_shift=scenario.variation.com_shift * np.array([np.cos(angle), np.sin(angle)]),
    )


def vary_object(model: ObjectModel, variation: ObjectVariation, com_margin: float) -> VariedObject:
    """Gives a model that has the episode's size its mass and its centre of mass."""
    return shift_com(
        with_mass(model, model.mass * variation.mass_factor), variation.com_shift, com_margin
    )


def with_mass(model: ObjectModel, mass: float) -> ObjectModel:
    """Returns the same object in a material of another density."""
    if mass == model.mass:
        return model
    return dataclasses.replace(model, mass=mass, I_OOcm_O=model.I_OOcm_O * (mass / model.mass))


def shift_com(model: ObjectModel, offset: Array, margin: float) -> VariedObject:
    """Moves the centre of mass horizontally, as if part of the mass were gathered in a lump.

    Of the mass m a share mu lies in a point Q inside the convex hull, halfway between the new
    centre of mass and the hull's surface in the direction u of the shift; the rest is
    distributed as before. With s the shift, r the distance from the old centre of mass to the
    surface and d = (s + r) / 2 that to Q,

        mu = s / d,    I' = (1 - mu) I + mu (1 - mu) m d^2 (1 - u u^T)

    (parallel-axis theorem). A sum of mass distributions that exist exists too: for every s < r
    the pseudo-inertia stays positive definite, which is what makes inertia physically
    consistent. Unlike density that varies linearly, which turns negative from s = r / 3 on in
    a box, this reaches every shift that the object can stand with, and needs of the old
    distribution no more than its inertia.

    Source: Wensing, Kim, Slotine, "Linear Matrix Inequalities for Physically Consistent
    Inertial Parameter Identification", IEEE RA-L 3 (2018), for the pseudo-inertia.

    Args:
        model: of any distribution of mass.
        offset: (2,) wanted shift in O, m.
        margin: how far inside the support polygon the centre of mass stays, m; one that is
            nearer to the edge from the start does not move.
    """
    wanted = float(np.hypot(*offset))
    if wanted == 0.0:
        return VariedObject(model, np.zeros(2), com_capped=False)
    u = np.asarray(offset) / wanted
    reach = room(*_hull_gaps(model), u)
    allowed = min(_standing_room(model, u, margin), MOST_OF_REACH * reach)
    if allowed == 0.0:
        return VariedObject(model, np.zeros(2), com_capped=True)
    s = min(wanted, allowed)
    d = (s + reach) / 2
    share = s / d
    u_O = np.array([*u, 0.0])
    lump = share * (1 - share) * model.mass * d**2 * (np.eye(3) - np.outer(u_O, u_O))
    shifted = dataclasses.replace(
        model, p_OoOcm_O=model.p_OoOcm_O + s * u_O, I_OOcm_O=(1 - share) * model.I_OOcm_O + lump
    )
    return VariedObject(shifted, s * u, com_capped=wanted > allowed)


def _standing_room(model: ObjectModel, u: Array, margin: float) -> float:
    """How far the centre of mass may move along u (2,) inside the support polygon, m."""
    normals, gaps = edge_gaps(model.support_polygon, model.p_OoOcm_O[:2])
    if gaps.min() < margin:
        return 0.0
    return room(normals, gaps - margin, u)


def _hull_gaps(model: ObjectModel) -> tuple[Array, Array]:
    """Horizontal parts (f, 2) of the convex hull's outward normals, and the COM's depths (f,)."""
    equations = ConvexHull(model.vertices).equations
    return equations[:, :2], -(equations[:, :3] @ model.p_OoOcm_O + equations[:, 3])
