"""What every system promises: evaluating its outputs changes nothing and repeats itself."""

from typing import Any

import numpy as np
from pydrake.math import RigidTransform
from pydrake.systems.framework import Context, PortDataType, System


def ports(system: System) -> dict[str, dict[str, int | None]]:
    """Input and output ports by name, with their sizes; None if abstract."""
    inputs = [system.get_input_port(i) for i in range(system.num_input_ports())]
    outputs = [system.get_output_port(i) for i in range(system.num_output_ports())]
    return {
        kind: {
            port.get_name(): port.size() if port.get_data_type() == PortDataType.kVectorValued
            else None
            for port in found
        }
        for kind, found in (("in", inputs), ("out", outputs))
    }  # fmt: skip


def everything(context: Context) -> list[bytes]:
    """Time, state and parameters of a leaf's context, bit for bit."""
    assert context.num_abstract_states() == 0
    assert context.num_abstract_parameters() == 0
    return [
        np.float64(context.get_time()).tobytes(),
        context.get_continuous_state_vector().CopyToVector().tobytes(),
        *(context.get_discrete_state(i).CopyToVector().tobytes()
          for i in range(context.num_discrete_state_groups())),
        *(context.get_numeric_parameter(i).CopyToVector().tobytes()
          for i in range(context.num_numeric_parameter_groups())),
    ]  # fmt: skip


def outputs(system: System, context: Context, order: int = 1) -> dict[str, bytes]:
    """All outputs, bit for bit, evaluated from first to last or from last to first."""
    indices = list(range(system.num_output_ports()))[::order]
    found = [system.get_output_port(i) for i in indices]
    return {port.get_name(): _bytes(port.Eval(context)) for port in found}


def _bytes(value: Any) -> bytes:
    numbers = value.GetAsMatrix34() if isinstance(value, RigidTransform) else np.asarray(value)
    data: bytes = numbers.tobytes()
    return data


def evaluate(system: System, port: str, context: Context) -> Any:
    """The value of one output port; a copy, as Drake may hand out its own cache."""
    value = system.GetOutputPort(port).Eval(context)
    return RigidTransform(value) if isinstance(value, RigidTransform) else value


def assert_pure(system: System, context: Context) -> None:
    """Outputs leave the context as it is and depend on it alone."""
    before = everything(context)
    first = outputs(system, context)
    assert everything(context) == before
    again = context.Clone()
    again.DisableCaching()
    for order in (-1, 1):
        assert outputs(system, again, order) == first
    assert everything(again) == before


def assert_resets(system: System, context: Context) -> None:
    """SetDefaultContext brings back the state and the parameters of a new context."""
    fresh = system.CreateDefaultContext()
    assert everything(context) != everything(fresh), "nothing has happened yet"
    system.SetDefaultContext(context)
    context.SetTime(0.0)
    assert everything(context) == everything(fresh)
