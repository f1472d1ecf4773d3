"""How an episode went, on one line: where it was touched, how it was pushed, how it tipped."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydrake.math import RotationMatrix

from keypush.evaluation.measures import measure_rows
from keypush.objects.point_cloud import pose_from_vector
from keypush.planning.plan_state import Stage
from keypush.planning.push_frame import left_of, push_direction

_APART = 3
"""Contacts with fewer policy steps between them count as one."""
_IN_LINE = 0.005
"""So near to the line from the centre of mass to the goal a contact is in line with it, m."""
_NEARER = 0.005
"""How much nearer to the goal than at the end is worth a word, m."""
_TURNED_DEG = 5.0
"""Smaller turns are not worth a word."""
_TIMES = ("never", "once", "twice")

Array = NDArray[np.float64]
Rows = Mapping[str, NDArray[Any]]


def tell_course(summary: Mapping[str, Any], rows: Rows) -> str:
    """Tells how an episode went; how it ended is in its summary.

    Left and right are those of who looks from the centre of mass to the goal, at that moment.

    Args:
        summary: of the episode: success, outcome and steps.
        rows: columns of `rows/`: those of `measure_rows`, and com (n, 3).
    """
    until = int(summary["steps"]) + 1  # later rows belong to the settled test
    poses = rows["object_pose"][:until]
    touches = np.flatnonzero(np.isfinite(rows["contact_point"][:until]).all(axis=1))
    missed = [] if summary["success"] else _nearest(poses[:, 4:6] - rows["goal"][:until])
    if not len(touches):
        return _joined(["never touched", *_again(rows["stage"]), *missed])
    contacts = 1 + int(np.count_nonzero(np.diff(touches) > _APART))
    told = [
        f"first touched {_where(rows, touches[0])}",
        f"pushed {100 * measure_rows(rows)['object_path']:.0f} cm",
        f"{contacts} {'contact' if contacts == 1 else 'contacts'}",
        *_again(rows["stage"]),
        *_turned(poses),
        *missed,
    ]
    if summary["outcome"] == "toppled":
        told.append(f"last touched {_where(rows, touches[-1])}")
        told.append(f"tilted by {tilt_deg(poses)[-1]:.0f}° at the end")
    return _joined(told)


def tilt_deg(poses: Array) -> Array:
    """Returns by how much an object is tilted, against its first pose.

    Args:
        poses: (n, 7) quaternion w, x, y, z and position in W.

    Returns:
        (n,) angles between what points up at first and Wz, degrees.
    """
    up_O = _rotation(poses[0]).matrix()[2]
    ups = np.array([_rotation(pose).matrix()[2] for pose in poses])
    return np.asarray(np.rad2deg(np.arccos(np.clip(ups @ up_O, -1.0, 1.0))))


def _where(rows: Rows, step: int) -> str:
    """Where it is touched in a step: beside the line of the push, and how high."""
    p_WC, p_WOcm = rows["contact_point"][step], rows["com"][step]
    beside = float((p_WC - p_WOcm) @ left_of(push_direction(p_WOcm, rows["goal"][step])))
    height = f"{100 * p_WC[2]:.1f} cm high"
    if abs(beside) < _IN_LINE:
        return f"in line with the centre of mass, {height}"
    side = "left" if beside > 0 else "right"
    return f"{100 * abs(beside):.1f} cm {side} of the centre of mass, {height}"


def _again(stage: NDArray[np.integer]) -> list[str]:
    """How often the planner went back to an earlier stage; behaviour cloning has no stages."""
    times = int(np.count_nonzero(np.diff(stage[stage != Stage.HALTED].astype(int)) < 0))
    if times == 0:
        return []
    return [f"re-approached {_TIMES[times] if times < len(_TIMES) else f'{times} times'}"]


def _nearest(off: Array) -> list[str]:
    """How near it came to the goal, where it did not end there; `off` is its way to it, (n, 2)."""
    distances = np.linalg.norm(off, axis=1)
    if distances.min() > distances[-1] - _NEARER:
        return []
    return [f"came within {100 * distances.min():.1f} cm of the goal"]


def _turned(poses: Array) -> list[str]:
    """How far it turned about Wz, from the first pose to the last."""
    R = (_rotation(poses[-1]) @ _rotation(poses[0]).inverse()).matrix()
    turned = float(np.rad2deg(np.arctan2(R[1, 0] - R[0, 1], R[0, 0] + R[1, 1])))
    if abs(turned) < _TURNED_DEG:
        return []
    return [f"turned {abs(turned):.0f}° to the {'left' if turned > 0 else 'right'}"]


def _rotation(pose: Array) -> RotationMatrix:
    R_WO: RotationMatrix = pose_from_vector(pose).rotation()
    return R_WO


def _joined(parts: list[str]) -> str:
    text = "; ".join(parts)
    return text[0].upper() + text[1:]
