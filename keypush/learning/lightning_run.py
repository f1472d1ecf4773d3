"""One way to train: epochs under Lightning that may be stopped at any moment.

Everything that an epoch draws follows from seed and epoch, the state is written whole after every
epoch, and the learning rate follows from how far the run is. So a run that was killed and goes on
ends with the weights of one that was not.
"""

import logging
import math
import signal
import sys
import warnings
from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Mapping, Sized
from contextlib import contextmanager
from pathlib import Path
from typing import Any, ClassVar, Protocol, override

import torch
from lightning.fabric.utilities.exceptions import MisconfigurationException
from lightning.pytorch import LightningModule, Trainer
from lightning.pytorch.callbacks import Checkpoint
from lightning.pytorch.loggers import CSVLogger, TensorBoardLogger
from torch import nn

from keypush.errors import UserError, one_line
from keypush.learning.run_config import RunConfig
from keypush.seeding import make_generator

CHECKPOINTS = "checkpoints"
LAST, BEST = "last.ckpt", "best.ckpt"
_IDENTITY, _HISTORY = "keypush_run", "keypush_history"
_PRECISIONS = {"32": "32-true", "bf16": "bf16-mixed"}

History = list[dict[str, Any]]


class Batches(Iterable[Any], Sized, Protocol):
    """Batches of one epoch."""


class EpochModule(LightningModule, ABC):
    """A network, and how an epoch trains it.

    Attributes:
        network: what is trained; parameters that need no gradient stay as they are.
        config: settings of the run.
        history: loss and errors after every epoch.
    """

    MONITOR: ClassVar[str]
    """The entry of `errors` that tells progress: less is better."""

    def __init__(self, network: nn.Module, config: RunConfig) -> None:
        super().__init__()
        self.network = network
        self.config = config
        self.history: History = []
        self._loss_sum = torch.zeros(())
        self._rows = 0

    @abstractmethod
    def batches(self, epoch: int) -> Batches:
        """Returns the batches of an epoch, the same ones whenever it is asked for them."""

    @abstractmethod
    def loss(self, batch: Any) -> tuple[torch.Tensor, int]:
        """Returns the mean loss over a batch, and its number of rows."""

    @abstractmethod
    def errors(self) -> dict[str, Any]:
        """Measures the network on rows that are not trained on."""

    @abstractmethod
    def learning_rate(self, epochs: float) -> float:
        """Returns the learning rate after this many epochs, with fractions."""

    @abstractmethod
    @override
    def configure_optimizers(self) -> torch.optim.Optimizer:
        """Makes the optimiser."""

    def share(self, rows: torch.Tensor) -> torch.Tensor:
        """Returns this process's share of an epoch's rows, as many as every other's."""
        world = self.trainer.world_size
        return rows[: len(rows) // world * world][self.trainer.global_rank :: world]

    @override
    def train_dataloader(self) -> Batches:
        """Asked for anew in every epoch."""
        return self.batches(self.current_epoch)

    @override
    def on_train_epoch_start(self) -> None:
        """Draws of dropout depend on seed and epoch alone."""
        rng = make_generator(self.config.seed, self.current_epoch, "dropout")
        torch.manual_seed(int(rng.integers(2**62)))
        self.network.train()
        self._loss_sum, self._rows = torch.zeros((), device=self.device), 0

    @override
    def on_train_batch_start(self, batch: Any, batch_idx: int) -> None:
        """Sets the learning rate."""
        epochs = self.current_epoch + batch_idx / float(self.trainer.num_training_batches)
        for group in self.trainer.optimizers[0].param_groups:
            group["lr"] = self.learning_rate(epochs)

    @override
    def training_step(self, batch: Any) -> torch.Tensor:
        """Returns the loss."""
        loss, rows = self.loss(batch)
        self._loss_sum += loss.detach() * rows
        self._rows += rows
        self.log("step_loss", loss.detach(), prog_bar=True)
        return loss

    @override
    def on_train_epoch_end(self) -> None:
        """Measures, tells and decides whether to stop."""
        self.network.eval()
        with torch.inference_mode():
            errors = self.errors()
        entry = {"loss": float(self._loss_sum) / self._rows, **errors}
        if not math.isfinite(entry["loss"] + float(entry[self.MONITOR])):
            raise UserError(
                f"loss is {entry['loss']:g} and {self.MONITOR} is {entry[self.MONITOR]:g} after "
                f"epoch {self.current_epoch + 1}; allowed: finite; a smaller learning_rate may help"
            )
        self.history.append(entry)
        self.log_dict({name: float(value) for name, value in entry.items()}, rank_zero_only=True)
        self.trainer.should_stop = is_over(self.history, self.config, self.MONITOR)

    @override
    def on_save_checkpoint(self, checkpoint: dict[str, Any]) -> None:
        """Puts the history beside the weights."""
        checkpoint[_HISTORY] = self.history

    @override
    def on_load_checkpoint(self, checkpoint: dict[str, Any]) -> None:
        """Takes the history back."""
        self.history = checkpoint[_HISTORY]


def best_epoch(history: History, monitor: str) -> int:
    """Returns the first epoch with the least error."""
    return min(range(len(history)), key=lambda epoch: float(history[epoch][monitor]))


def is_over(history: History, config: RunConfig, monitor: str) -> bool:
    """Whether no epoch is to follow."""
    if len(history) >= config.epochs:
        return True
    waited = len(history) - 1 - best_epoch(history, monitor) if history else 0
    return 0 < config.patience <= waited


def fit(module: EpochModule, out_dir: Path, identity: Mapping[str, Any], **options: Any) -> None:
    """Trains to the end, from where an earlier run in `out_dir` was stopped.

    Writes `checkpoints/` and `logs/`: a folder with a CSV file and TensorBoard's for every start.

    Args:
        module: leaves with the weights of the last epoch, or with `patience` of the best one.
        out_dir: folder of the run.
        identity: what decides the weights, in numbers, texts, lists and dictionaries.
        options: more arguments of Lightning's `Trainer`.

    Raises:
        UserError: `out_dir` holds a run with another identity or a damaged checkpoint, there is
            no such accelerator, or the folder cannot be written.
    """
    folder = out_dir / CHECKPOINTS
    earlier = read_checkpoint(folder / LAST, identity)
    config = module.config
    if earlier is None or not is_over(earlier[_HISTORY], config, module.MONITOR):
        with one_thread(), torch.random.fork_rng(devices=[]), _quiet():
            csv = CSVLogger(out_dir, name="logs")
            board = TensorBoardLogger(out_dir, name="logs", version=csv.version)
            checkpoint = _EpochCheckpoint(folder, identity)
            trainer = _trainer(config, logger=[csv, board], callbacks=[checkpoint], **options)
            _run(trainer, module, folder / LAST if earlier else None)
    kept = read_checkpoint(folder / (BEST if config.patience else LAST), identity)
    last = read_checkpoint(folder / LAST, identity)
    assert kept is not None and last is not None  # noqa: PT018  # written after every epoch
    module.load_state_dict(kept["state_dict"])
    module.history = last[_HISTORY]
    module.cpu().eval()


def refuse_other_run(out_dir: Path, identity: Mapping[str, Any]) -> None:
    """Checks that a folder holds no run with another identity.

    Raises:
        UserError: it does, or a damaged checkpoint.
    """
    read_checkpoint(out_dir / CHECKPOINTS / LAST, identity)


def read_checkpoint(path: Path, identity: Mapping[str, Any]) -> dict[str, Any] | None:
    """Reads the checkpoint of an earlier run; None when there is none.

    Raises:
        UserError: it is damaged or comes from a run with another identity.
    """
    if not path.exists():
        return None
    try:
        content: dict[str, Any] = torch.load(path, weights_only=True, map_location="cpu")
        _check_types(content)
    except Exception as error:  # any: what damaged bytes do to unpickling has no end
        raise UserError(
            f"{path}: is no checkpoint of `keypush`; delete it to start again"
        ) from error
    found = content[_IDENTITY]
    changed = sorted(name for name in {*found, *identity} if found.get(name) != identity.get(name))
    if changed:
        raise UserError(
            f"{path}: is from a run with other values of {', '.join(changed)}; allowed: the "
            "same values, or another output folder"
        )
    return content


def _check_types(content: dict[str, Any]) -> None:
    """Raises KeyError or TypeError where a checkpoint holds something else than it should."""
    for name in (_IDENTITY, "state_dict"):
        if not all(isinstance(key, str) for key in dict(content[name])):
            raise TypeError(name)
    if not all(isinstance(entry, dict) for entry in content[_HISTORY]):
        raise TypeError(_HISTORY)


class _EpochCheckpoint(Checkpoint):
    """Writes the state after every epoch; a file appears whole or not at all."""

    def __init__(self, folder: Path, identity: Mapping[str, Any]) -> None:
        self._folder = folder
        self._identity = dict(identity)

    @override
    def on_save_checkpoint(
        self, trainer: Trainer, pl_module: LightningModule, checkpoint: dict[str, Any]
    ) -> None:
        checkpoint[_IDENTITY] = self._identity

    @override
    def on_train_epoch_end(self, trainer: Trainer, pl_module: LightningModule) -> None:
        assert isinstance(pl_module, EpochModule)
        history = pl_module.history
        # The best first: a run that is killed in between does this epoch, and this, once more.
        if best_epoch(history, pl_module.MONITOR) == len(history) - 1:
            self._save(trainer, self._folder / BEST)
        self._save(trainer, self._folder / LAST)

    def _save(self, trainer: Trainer, path: Path) -> None:
        temporary = path.with_suffix(".tmp")
        try:
            trainer.save_checkpoint(temporary)
            if trainer.is_global_zero:
                temporary.replace(path)
            trainer.strategy.barrier()  # others read it when training is over
        except (OSError, RuntimeError) as error:
            raise UserError(f"{path}: cannot be written: {one_line(error)}") from error


def check_accelerator(config: RunConfig) -> None:
    """Checks that what is to compute is there.

    Raises:
        UserError: it is not.
    """
    with _quiet():
        _trainer(config, logger=False)


def _trainer(config: RunConfig, **options: Any) -> Trainer:
    try:
        return Trainer(
            accelerator=config.accelerator,
            devices=config.devices,
            precision=_PRECISIONS[config.precision],  # type: ignore[arg-type]  # one of its names
            max_epochs=config.epochs,
            reload_dataloaders_every_n_epochs=1,
            enable_progress_bar=sys.stdout.isatty(),
            enable_model_summary=False,
            **options,
        )
    except (MisconfigurationException, RuntimeError, ValueError) as error:
        raise UserError(
            f"accelerator is {config.accelerator!r} and devices is {config.devices}: "
            f"{one_line(error)}; allowed: cpu, 1"
        ) from error


def _run(trainer: Trainer, module: EpochModule, earlier: Path | None) -> None:
    answer_to_interrupt = signal.getsignal(signal.SIGINT)
    try:
        trainer.fit(module, ckpt_path=earlier, weights_only=True)
    except SystemExit:
        # Lightning ends the process after Ctrl-C and is deaf to another one; the command line has
        # its own answer.
        signal.signal(signal.SIGINT, answer_to_interrupt)
        if trainer.interrupted:
            raise KeyboardInterrupt from None
        raise


@contextmanager
def one_thread() -> Iterator[None]:
    """Runs torch on one thread, so that sums are added in the same order on every machine."""
    threads = torch.get_num_threads()
    torch.set_num_threads(1)
    try:
        yield
    finally:
        torch.set_num_threads(threads)


@contextmanager
def _quiet() -> Iterator[None]:
    """Keeps Lightning's remarks back: it advertises, and warns of loaders that are not its own."""
    loggers = [logging.getLogger(name) for name in ("lightning.pytorch", "lightning.fabric")]
    levels = [logger.level for logger in loggers]
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", module="lightning")
        for logger in loggers:
            logger.setLevel(logging.ERROR)
        try:
            yield
        finally:
            for logger, level in zip(loggers, levels, strict=True):
                logger.setLevel(level)
