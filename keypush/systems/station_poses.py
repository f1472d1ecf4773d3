"""StationPoses: picks tool pose, object pose and COM out of the plant's body poses."""

import weakref
from collections.abc import Callable
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray
from pydrake.common.value import Value
from pydrake.math import RigidTransform
from pydrake.multibody.tree import BodyIndex
from pydrake.systems.framework import BasicVector, Context, LeafSystem

from keypush.eval_ports import eval_abstract

COM_PARAMETER = 0


class StationPoses(LeafSystem):
    """Picks tool pose, object pose and centre of mass out of the plant's body poses.

    @system
    name: StationPoses
    input_ports:
    - body_poses
    output_ports:
    - object_pose
    - object_com
    - tool_pose
    @endsystem

    ``body_poses``: abstract `list[RigidTransform]`, X_WB of every body in m, the plant's
    port of that name.

    ``object_pose``: abstract `RigidTransform`, X_WO in m; ground truth ("cheat").

    ``object_com``: vector of 3, p_WoOcm_W in m; ground truth ("cheat").

    ``tool_pose``: abstract `RigidTransform`, X_WE in m.

    All outputs follow the input at once. The centre of mass in O is a numeric parameter, so
    that an episode can shift it together with the plant's inertia.
    """

    def __init__(
        self,
        object_body: BodyIndex,
        hand_body: BodyIndex,
        X_HE: RigidTransform,
        p_OoOcm_O: NDArray[np.float64],
    ) -> None:
        """Args: body indices of object and hand, the tool tip in the hand, the COM in O (3,)."""
        super().__init__()
        self.set_name("station_poses")
        self._object = int(object_body)
        self._hand = int(hand_body)
        self._X_HE = X_HE
        self.DeclareNumericParameter(BasicVector(p_OoOcm_O))
        self._poses = self.DeclareAbstractInputPort("body_poses", Value[list[RigidTransform]]())
        self._declare_pose("object_pose", self._calc_object_pose)
        self.DeclareVectorOutputPort("object_com", 3, self._calc_object_com)
        self._declare_pose("tool_pose", self._calc_tool_pose)

    def _declare_pose(self, name: str, calc: Callable[[Any, Any], None]) -> None:
        # Weak, because pydrake holds an abstract port's function where the garbage collector
        # does not see it: a bound method would keep system and diagram alive for ever.
        method = weakref.WeakMethod(calc)

        def calc_while_alive(context: Any, output: Any) -> None:
            bound = method()
            assert bound is not None
            bound(context, output)

        self.DeclareAbstractOutputPort(
            name,
            lambda: Value(RigidTransform()),
            calc_while_alive,
            prerequisites_of_calc={self._poses.ticket()},
        )

    def set_com(self, context: Context, p_OoOcm_O: NDArray[np.float64]) -> None:
        """Sets the centre of mass (3,) in O of this system's context."""
        context.get_mutable_numeric_parameter(COM_PARAMETER).SetFromVector(p_OoOcm_O)

    def _object_pose(self, context: Context) -> RigidTransform:
        return cast(RigidTransform, eval_abstract(self._poses, context)[self._object])

    def _calc_object_pose(self, context: Context, output: Any) -> None:
        output.set_value(self._object_pose(context))

    def _calc_object_com(self, context: Context, output: BasicVector) -> None:
        p_OoOcm_O = context.get_numeric_parameter(COM_PARAMETER).value()
        X_WO = self._object_pose(context)
        output.SetFromVector(X_WO.rotation().matrix() @ p_OoOcm_O + X_WO.translation())

    def _calc_tool_pose(self, context: Context, output: Any) -> None:
        output.set_value(eval_abstract(self._poses, context)[self._hand] @ self._X_HE)
