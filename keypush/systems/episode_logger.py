"""EpisodeLogger: one row per policy step, in the order of the data set's columns."""

import numpy as np
from pydrake.common.value import Value
from pydrake.math import RigidTransform
from pydrake.systems.framework import BasicVector, Context, LeafSystem

from keypush.eval_ports import eval_abstract, eval_vector
from keypush.objects.point_cloud import pose_to_vector

ROW_COLUMNS: dict[str, int] = {
    "stage": 1,
    "object_pose": 7,
    "com": 3,
    "goal": 2,
    "tool_pose": 7,
    "action": 6,
    "q": 7,
    "v": 7,
    "contact_point": 3,
    "contact_force": 3,
    "target": 3,
}
"""Columns of a row and how many numbers each has."""
ROW_SIZE = sum(ROW_COLUMNS.values())


class EpisodeLogger(LeafSystem):
    """Packs what happens in a policy step into one row; a `VectorLogSink` keeps the rows.

    @system
    name: EpisodeLogger
    input_ports:
    - stage
    - object_pose
    - object_com
    - goal
    - tool_pose
    - tool_action
    - arm_state
    - contact
    - contact_target
    output_ports:
    - row
    @endsystem

    ``stage``: vector of 1, the planner's stage.

    ``object_pose``: abstract `RigidTransform`, X_WO in m.

    ``object_com``: vector of 3, p_WOcm in m.

    ``goal``: vector of 2, goal xy in W in m.

    ``tool_pose``: abstract `RigidTransform`, X_WE in m.

    ``tool_action``: vector of 6, residual of the tool pose in W, m and rad.

    ``arm_state``: vector of 14, joint positions (rad) and velocities (rad/s).

    ``contact``: vector of 6, measured contact point in W (m) and force on the object (N).

    ``contact_target``: vector of 3, the contact in W in m that the planner aims at.

    ``row``: vector of `ROW_SIZE`, all of that in the order of `ROW_COLUMNS`; poses as
    quaternion w, x, y, z (w >= 0) and position.
    """

    def __init__(self) -> None:
        """Needs nothing: the row's layout is fixed."""
        super().__init__()
        self.set_name("episode_logger")
        self._stage = self.DeclareVectorInputPort("stage", 1)
        self._object_pose = self.DeclareAbstractInputPort("object_pose", Value(RigidTransform()))
        self._com = self.DeclareVectorInputPort("object_com", 3)
        self._goal = self.DeclareVectorInputPort("goal", 2)
        self._tool_pose = self.DeclareAbstractInputPort("tool_pose", Value(RigidTransform()))
        self._action = self.DeclareVectorInputPort("tool_action", 6)
        self._arm_state = self.DeclareVectorInputPort("arm_state", 14)
        self._contact = self.DeclareVectorInputPort("contact", 6)
        self._target = self.DeclareVectorInputPort("contact_target", 3)
        self.DeclareVectorOutputPort("row", ROW_SIZE, self._calc_row)

    def _calc_row(self, context: Context, output: BasicVector) -> None:
        output.SetFromVector(
            np.concatenate(
                [
                    eval_vector(self._stage, context),
                    pose_to_vector(eval_abstract(self._object_pose, context)),
                    eval_vector(self._com, context),
                    eval_vector(self._goal, context),
                    pose_to_vector(eval_abstract(self._tool_pose, context)),
                    eval_vector(self._action, context),
                    eval_vector(self._arm_state, context),
                    eval_vector(self._contact, context),
                    eval_vector(self._target, context),
                ]
            )
        )
