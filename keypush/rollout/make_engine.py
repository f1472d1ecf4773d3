"""Makes the engine that a name stands for."""

from collections.abc import Sequence
from typing import Literal

from keypush.errors import UserError
from keypush.rollout.engine import Engine
from keypush.rollout.job import Job
from keypush.rollout.pool import LocalEngine
from keypush.rollout.worker import MakeRunner

EngineName = Literal["local", "ray"]


def make_engine(
    name: EngineName, workers: int | None, jobs: Sequence[Job], make_runner: MakeRunner
) -> Engine:
    """Makes an engine.

    Args:
        name: which one.
        workers: at most this many blocks run at once; None: as many as there are cores.
        jobs: whose blocks are going to run.
        make_runner: importable by name, since workers are new processes.

    Raises:
        UserError: Ray is asked for and not installed.
    """
    if name == "local":
        return LocalEngine(workers, [job.scenario for job in jobs], make_runner)
    try:
        from keypush.rollout.ray_engine import RayEngine  # noqa: PLC0415  # Ray is optional.
    except ModuleNotFoundError as error:
        if error.name is None or error.name.split(".")[0] != "ray":
            raise
        raise UserError(
            "--engine ray: the package ray is not installed; allowed: --engine local, or "
            "`pip install keypush[ray]` first"
        ) from error
    return RayEngine(workers, jobs, make_runner)
