"""Whether an object can be pushed: mesh, mass, how it stands and tips, whether it is reached.

Every check measures a number and holds it against a limit. Lengths are in m.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from keypush.checking.object_scene import ObjectScene
from keypush.checking.tipping import com_beyond_edge, directions
from keypush.objects.asset import BOUNDING_RADIUS, ObjectAsset
from keypush.objects.meshing.distance import hausdorff
from keypush.objects.meshing.felt import MOST_SUPPORT_GAP, pose_support_gap
from keypush.objects.model import ObjectModel, scaled_model
from keypush.objects.plant import spatial_inertia
from keypush.objects.resting import RestingPose
from keypush.rollout.start import StartSampler
from keypush.scenario import ObjectConfig, Scenario, SimulationConfig

Array = NDArray[np.float64]

DROP_HEIGHT = 0.005
DROP_TIME = 5.0
"""s."""
MOST_DRIFT = 0.002
MOST_TILT = np.deg2rad(1.0)
MOST_SURFACE_DISTANCE = 1.5e-3
"""Of what touches from what is seen, for an object of 0.1 m; in proportion for others."""
LEAST_SURFACE_LIMIT = 0.6e-3
"""What stays allowed for objects below 0.04 m: a skirt has the same height at any size."""
HARD_TABLE = 5e9
"""Modulus in Pa of the table on which objects are tipped, so hard that the mesh alone decides: on
the shipped one they tip up to 2 mm inside (see `keypush.objects.table`)."""
_TIP_TIME, _TIPPED = 3.0, 0.1
REACH_SAMPLES = 20
LEAST_REACHED = 0.7
"""Share of starts; the far edge of the table is not reached with any object."""


@dataclass(frozen=True)
class Check:
    """One measured property of an object."""

    ok: bool
    value: float | None
    """None: it was not measured."""
    limit: float
    text: str
    """What was measured, in words."""


_NOT_SIMULATED = Check(False, None, 0.0, "not simulated: mesh or inertia is wrong")


def check_object(asset: ObjectAsset) -> dict[str, Check]:
    """Runs all checks of an object at its nominal size, by name."""
    model = scaled_model(asset, 1.0)
    checks = {"closed": _closed(model), "volume": _volume(model), "inertia": _inertia(model)}
    sound = all(check.ok for check in checks.values())
    checks |= {"surface": _surface(model), "support": _support(model, asset.poses)}
    for name, simulate in (("stands", _stands), ("tips", _tips)):
        checks[name] = simulate(model) if sound else _NOT_SIMULATED
    return {**checks, "reachable": _reachable(model)}


def _closed(model: ObjectModel) -> Check:
    mesh = model.mesh
    ok = bool(mesh.is_watertight and mesh.is_winding_consistent)
    open_edges = len(mesh.edges_unique) * 2 - len(mesh.edges)
    return Check(ok, float(open_edges), 0.0, f"open edges of {len(mesh.faces)} faces")


def _volume(model: ObjectModel) -> Check:
    volume = float(model.mesh.volume)
    return Check(volume > 0, volume, 0.0, f"{1e6 * volume:.1f} cm^3")


def _inertia(model: ObjectModel) -> Check:
    """Triangle inequality of the principal moments: how much the largest is below the sum."""
    moments = np.linalg.eigvalsh(model.I_OOcm_O)
    slack = float((moments[0] + moments[1] - moments[2]) / moments[2])
    ok = bool(moments[0] > 0 and slack > 0 and spatial_inertia(model).IsPhysicallyValid())
    return Check(ok, slack, 0.0, "triangle inequality of the moments of inertia")


def _surface(model: ObjectModel) -> Check:
    proportional = MOST_SURFACE_DISTANCE * model.bounding_radius / BOUNDING_RADIUS
    limit = max(proportional, LEAST_SURFACE_LIMIT)
    distance = hausdorff(model.mesh, model.visual)
    return Check(distance < limit, distance, limit, "what touches from what is seen, m")


def _support(model: ObjectModel, poses: Sequence[RestingPose]) -> Check:
    """The worst over all stable poses."""
    seen = model.visual if model.visual.is_watertight else model.mesh
    gap = max(pose_support_gap(model.mesh, seen, pose) for pose in poses)
    text = f"support polygon short of the true one, the worst of stable poses ({len(poses)}), m"
    return Check(gap < MOST_SUPPORT_GAP, gap, MOST_SUPPORT_GAP, text)


def _stands(model: ObjectModel) -> Check:
    """Dropped upright, it stays upright and where it is."""
    scene = ObjectScene(model, SimulationConfig(), height=DROP_HEIGHT)
    start = scene.pose().translation()
    drift = tilt = 0.0
    for _ in range(round(DROP_TIME / 0.1)):
        tilt = scene.advance(0.1)
        drift = max(drift, float(np.hypot(*(scene.pose().translation() - start)[:2])))
    ok = bool(drift < MOST_DRIFT and tilt < MOST_TILT)
    text = f"drift in {DROP_TIME:g} s after a drop, m (tilt {np.rad2deg(tilt):.2f} deg)"
    return Check(ok, drift, MOST_DRIFT, text)


def _tips(model: ObjectModel) -> Check:
    """Stands with its COM 1 mm inside the support polygon, falls with it 1 mm outside."""
    setting = SimulationConfig(table_modulus=HARD_TABLE)
    wrong = 0
    for direction in directions(model):
        for outside in (-MOST_SUPPORT_GAP, MOST_SUPPORT_GAP):
            moved = com_beyond_edge(model, direction, outside)
            fell = ObjectScene(moved, setting).advance(_TIP_TIME, _TIPPED) >= _TIPPED
            wrong += fell != (outside > 0)
    text = "COM 1 mm inside or outside the support polygon: wrong outcomes of 8"
    return Check(wrong == 0, float(wrong), 0.0, text)


def _reachable(model: ObjectModel) -> Check:
    """Share of the drawn starts that the sampler need not drop."""
    sampler = StartSampler(Scenario(object=ObjectConfig(name=model.name)), model)
    dropped = 0
    for episode in range(REACH_SAMPLES):
        dropped += sampler.sample(episode).redrawn
    share = REACH_SAMPLES / (REACH_SAMPLES + dropped)
    text = f"share of {REACH_SAMPLES + dropped} starts that the arm reaches"
    return Check(share >= LEAST_REACHED, share, LEAST_REACHED, text)
