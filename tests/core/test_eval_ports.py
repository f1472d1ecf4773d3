"""Input ports are read with their types, and one without a wire is named."""

import numpy as np
import pytest
from pydrake.common.value import Value
from pydrake.math import RigidTransform
from pydrake.systems.framework import LeafSystem

from keypush.eval_ports import eval_abstract, eval_vector


class TwoInputs(LeafSystem):
    def __init__(self) -> None:
        super().__init__()
        self.vector = self.DeclareVectorInputPort("force", 2)
        self.pose = self.DeclareAbstractInputPort("pose", Value(RigidTransform()))


def test_values_arrive() -> None:
    system = TwoInputs()
    context = system.CreateDefaultContext()
    system.vector.FixValue(context, [1.0, 2.0])
    system.pose.FixValue(context, RigidTransform(np.array([1.0, 2.0, 3.0])))
    np.testing.assert_array_equal(eval_vector(system.vector, context), [1.0, 2.0])
    X = eval_abstract(system.pose, context)
    np.testing.assert_array_equal(X.translation(), [1.0, 2.0, 3.0])


def test_a_port_without_a_wire_is_named() -> None:
    system = TwoInputs()
    context = system.CreateDefaultContext()
    with pytest.raises(RuntimeError, match="'force' is not connected"):
        eval_vector(system.vector, context)
    with pytest.raises(RuntimeError, match="'pose' is not connected"):
        eval_abstract(system.pose, context)
