"""Every field of a frame: its name, type, shape, frame of reference, unit and meaning.

A frame is what stands in one policy step: what was seen then and what was done about it.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
import pyarrow as pa

CLOUD = "observation.point_cloud"
_ARROW = {
    "float32": pa.float32(),
    "float64": pa.float64(),
    "int64": pa.int64(),
    "bool": pa.bool_(),
}
_POSE = ("qw", "qx", "qy", "qz", "x", "y", "z")
_XYZ = ("x", "y", "z")


@dataclass(frozen=True)
class Feature:
    """One field of a frame."""

    name: str
    dtype: str
    shape: tuple[int, ...]
    frame: str
    """Frame of reference, or "-"."""
    unit: str
    """SI, or "-"."""
    meaning: str
    names: tuple[str, ...] | None = None
    """Of the entries along the first axis."""
    may_be_nan: bool = False
    """Whether NaN stands for "there is none"; everything else is finite."""

    @property
    def size(self) -> int:
        """How many numbers one frame has."""
        return int(np.prod(self.shape))

    @property
    def arrow_type(self) -> pa.DataType:
        """A plain column where the shape is (1,), lists of fixed length otherwise."""
        kind = _ARROW[self.dtype]
        if self.shape == (1,):
            return kind
        for length in reversed(self.shape):
            kind = pa.list_(kind, length)
        return kind

    def describe(self) -> dict[str, Any]:
        """Returns the entry of `meta/info.json`."""
        return {
            "dtype": self.dtype,
            "shape": list(self.shape),
            "names": None if self.names is None else list(self.names),
            "frame": self.frame,
            "unit": self.unit,
            "meaning": self.meaning,
        }


FEATURES = (
    Feature(
        "observation.state", "float32", (14,), "-", "rad, rad/s",
        "positions of the seven joints, then their velocities",
        tuple(f"{kind}{i}" for kind in ("q", "v") for i in range(1, 8)),
    ),
    Feature(
        "observation.hand_state", "float32", (9,), "W", "m, -",
        "the network's hand state: position of the tool tip, then the first two columns of its "
        "rotation matrix",
        ("x", "y", "z", "xx", "xy", "xz", "yx", "yy", "yz"),
    ),
    Feature(
        "observation.tool_pose", "float32", (7,), "W", "-, m",
        "pose X_WE of the tool tip: unit quaternion with qw >= 0, then position", _POSE,
    ),
    Feature(
        "observation.object_pose", "float64", (7,), "W", "-, m",
        "true pose X_WO of the object: unit quaternion with qw >= 0, then position; in full "
        "precision, because the clouds are rebuilt from it", _POSE,
    ),
    Feature("observation.com", "float32", (3,), "W", "m", "true centre of mass", _XYZ),
    Feature("observation.goal", "float32", (2,), "W", "m", "goal of the object's origin", _XYZ[:2]),
    Feature(
        "action", "float32", (6,), "W", "m, rad",
        "the expert's answer to this frame: residual of the tool pose, translation and "
        "axis-angle; zero in an episode's last frame, which has no answer",
        ("x", "y", "z", "rx", "ry", "rz"),
    ),
    Feature(
        "stage", "int64", (1,), "-", "-",
        "the expert's stage when the frame was seen: 0 rise, 1 approach, 2 descend, 3 settle, "
        "4 push, 5 retreat, 6 halted",
    ),
    Feature(
        "contact.measured", "float32", (3,), "W", "m",
        "force-weighted centroid of all contacts of robot and object; NaN where they do not touch",
        _XYZ, may_be_nan=True,
    ),
    Feature(
        "contact.force", "float32", (3,), "W", "N",
        "sum of the robot's contact forces on the object; zero where they do not touch", _XYZ,
    ),
    Feature(
        "contact.analytic", "float32", (3,), "W", "m",
        "the contact that the expert aims at, its answer to this frame; NaN in an episode's last "
        "frame, which has no answer", _XYZ, may_be_nan=True,
    ),
    Feature(
        "keypoint", "float32", (3,), "W", "m",
        "the label: the measured contact of the push that the frame belongs to, carried with the "
        "object to this frame; NaN where no such contact follows and where the tool has halted",
        _XYZ, may_be_nan=True,
    ),
    Feature("next.done", "bool", (1,), "-", "-", "whether the frame is its episode's last"),
    Feature(
        "next.success", "bool", (1,), "-", "-",
        "whether the frame is the last one of an episode that succeeded",
    ),
    Feature("timestamp", "float32", (1,), "-", "s", "simulated time since the episode's start"),
    Feature("frame_index", "int64", (1,), "-", "-", "policy step, counted from 0 in each episode"),
    Feature("episode_index", "int64", (1,), "-", "-", "number of the episode in the data set"),
    Feature("index", "int64", (1,), "-", "-", "number of the frame in the data set"),
    Feature("task_index", "int64", (1,), "-", "-", "number of the task in meta/tasks.parquet"),
)  # fmt: skip


def cloud_feature(points: int) -> Feature:
    """Returns the field that `keypush dataset export --clouds` adds."""
    return Feature(
        CLOUD, "float32", (points, 3), "W", "m",
        "the noisy cloud of the object's surface, as the sensor gave it",
    )  # fmt: skip


def arrow_schema(features: tuple[Feature, ...]) -> pa.Schema:
    """Returns the columns of the files in `data/`."""
    return pa.schema([pa.field(feature.name, feature.arrow_type) for feature in features])
