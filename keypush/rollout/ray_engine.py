"""Blocks on a Ray cluster: each machine runs episodes, the driver alone writes files."""

import logging
import os
import platform
import socket
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

import ray
from ray.exceptions import RayError

from keypush import __version__
from keypush.errors import UserError, one_line
from keypush.rollout.engine import Event, Lost, raise_failure
from keypush.rollout.job import Block, Job, take_block
from keypush.rollout.provenance import check_provenance
from keypush.rollout.worker import BlockWorker, Failed, MakeRunner, Message
from keypush.worker_environment import ONE_THREAD

_CONNECT_SECONDS = 10.0
_TOKEN = "~/.ray/auth_token"


class _RemoteWorker:
    """Lives in a process of the cluster and keeps its diagram between blocks."""

    def __init__(
        self, version: str, folder: str, jobs: Sequence[Job], make_runner: MakeRunner
    ) -> None:
        self._version = version
        self._folder = folder
        self._jobs = jobs
        self._checked: set[int] = set()
        self._worker = BlockWorker([job.scenario for job in jobs], make_runner)

    def run(self, block: Block) -> list[Message]:
        """Runs a block, unless this machine has other files or another keypush than the driver."""
        try:
            self._check_machine(block.job)
        except UserError as error:
            return [Failed(f"machine {platform.node()}: {error}", by_user=True)]
        messages: list[Message] = []
        self._worker.run(block, messages.append)
        return messages

    def _check_machine(self, job: int) -> None:
        """Raises a UserError that says what is not as where the command was given."""
        if self._version != __version__:
            raise UserError(f"keypush is {__version__} there; allowed: {self._version}, as here")
        if job in self._checked:
            return
        # Paths of weights and of policies may be relative to where the command was given.
        if Path(self._folder).is_dir():
            os.chdir(self._folder)
        check_provenance(self._jobs[job])
        self._checked.add(job)


def _check_address(address: str) -> None:
    """Asks whether anybody listens; Ray itself would try for minutes.

    Raises:
        UserError: nobody does.
    """
    host, _, port = address.removeprefix("ray://").rpartition(":")
    if not (host and port.isdigit()):
        return  # None, or a word such as "auto", which Ray answers at once.
    try:
        socket.create_connection((host, int(port)), _CONNECT_SECONDS).close()
    except (OSError, OverflowError) as error:
        raise UserError(
            f"--engine ray: no cluster answers at RAY_ADDRESS={address}: {one_line(error)}"
        ) from error


@dataclass
class _Running:
    """An actor and the block that it runs."""

    actor: Any
    block: Block


class RayEngine:
    """Connects to the cluster on entry; on exit its actors end.

    The cluster is that of RAY_ADDRESS or of `ray start` on this machine; where there is
    none, Ray starts one of this machine's cores.
    """

    def __init__(self, workers: int | None, jobs: Sequence[Job], make_runner: MakeRunner) -> None:
        """Args: see `make_engine`."""
        self.workers = 0
        self._most = workers
        self._arguments = (__version__, str(Path.cwd()), tuple(jobs), make_runner)
        self._running: dict[Any, _Running] = {}
        self._connected_here = False

    def __enter__(self) -> Self:
        """Connects.

        Raises:
            UserError: there is no cluster at the address.
        """
        if not ray.is_initialized():
            _check_address(os.environ.get("RAY_ADDRESS", ""))
            try:
                ray.init(logging_level=logging.ERROR, log_to_driver=False)
            # Ray raises a bare Exception where its own node is too slow to start.
            except Exception as error:
                raise UserError(
                    f"--engine ray: no cluster answers: {one_line(error)} (where there is one, "
                    f"RAY_AUTH_MODE and {_TOKEN} must be the same here as there)"
                ) from error
            self._connected_here = True
        # An actor that found no free core would hold its block for ever.
        resources = ray.cluster_resources()  # type: ignore[no-untyped-call]  # Ray has types in part
        cores = max(1, int(resources.get("CPU", 1)))
        self.workers = cores if self._most is None else min(self._most, cores)
        return self

    def __exit__(self, *error: object) -> None:
        """Ends the actors, and the connection if it was made here."""
        for running in self._running.values():
            ray.kill(running.actor)
        self._running.clear()
        if self._connected_here:
            ray.shutdown()

    def run(self, pending: list[Block]) -> Iterator[tuple[Block, Event]]:
        """Runs blocks, see `Engine`; the events of a block come together, at its end."""
        for _ in range(min(self.workers, len(pending))):
            self._hand_over(self._make_actor(), take_block(pending, None))
        while self._running:
            (ready,), _ = ray.wait(list(self._running), num_returns=1)
            done = self._running.pop(ready)
            try:
                messages: list[Message] = ray.get(ready)
            except RayError as error:
                pending.append(done.block)
                yield done.block, Lost(f"is lost: {one_line(error)}")
                self._hand_over(self._make_actor(), take_block(pending, None))
                continue
            whole = not isinstance(messages[-1], Failed)
            if whole and pending:
                self._hand_over(done.actor, take_block(pending, done.block))
            for message in messages:
                if isinstance(message, Failed):
                    raise_failure(message, done.block)
                yield done.block.one(message.episode), message

    def _make_actor(self) -> Any:
        remote = ray.remote(num_cpus=1, runtime_env={"env_vars": ONE_THREAD})(_RemoteWorker)
        return remote.remote(*self._arguments)

    def _hand_over(self, actor: Any, block: Block) -> None:
        self._running[actor.run.remote(block)] = _Running(actor, block)
