"""Typed evaluation of input ports: pydrake types `InputPort.Eval` as `object`."""

from typing import Any, cast

import numpy as np
from numpy.typing import NDArray
from pydrake.systems.framework import Context, InputPort


def eval_vector(port: InputPort, context: Context) -> NDArray[np.float64]:
    """Evaluates a vector-valued input port.

    Raises:
        RuntimeError: the port is not connected.
    """
    if not port.HasValue(context):
        raise RuntimeError(f"input port '{port.get_name()}' is not connected")
    return cast(NDArray[np.float64], port.Eval(context))


def eval_abstract(port: InputPort, context: Context) -> Any:
    """Evaluates an abstract-valued input port.

    Raises:
        RuntimeError: the port is not connected.
    """
    if not port.HasValue(context):
        raise RuntimeError(f"input port '{port.get_name()}' is not connected")
    return port.Eval(context)
