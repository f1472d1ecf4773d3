"""A keypoint model from outside the package: what a user's file or module makes.

Such a model may be wrong in ways that ours are not: it may raise, take for ever or answer with
something else than a keypoint. All of that becomes `PolicyError`, which ends an episode.
"""

import importlib
import inspect
import re
import reprlib
import sys
import traceback
from collections.abc import Iterator
from contextlib import chdir, contextmanager
from pathlib import Path
from types import ModuleType, NoneType
from typing import Any, override

import numpy as np
from numpy.typing import NDArray

from keypush.errors import UserError, one_line
from keypush.learning.model import KeypointModel, PolicyError, Seen, Vector
from keypush.learning.time_limit import NoAnswer, time_limit

Array = NDArray[Any]

ANSWER_SECONDS = 10.0
"""Wall time after which an answer does not count; far longer than any sensible one takes."""
_PLAIN = (bool, float, complex, bytes, NoneType, np.generic, np.ndarray)
_ADDRESS = re.compile(r" at 0x[0-9a-f]+")
_ALLOWED = (
    "allowed: a class or function that, called without arguments, gives an object with uses_com "
    "(true or false) and predict(cloud_W, goal_W, com_W, hand)"
)


class OwnModel(KeypointModel):
    """A user's model, whose mistakes are told as `PolicyError`."""

    def __init__(self, model: Any, uses_com: bool, source: Path, seconds: float) -> None:
        """Wraps a model.

        Args:
            model: the user's.
            uses_com: what it says of itself.
            source: the file that it comes from.
            seconds: the most wall time of an answer.
        """
        self._model = model
        self._uses_com = uses_com
        self._source = source
        self._seconds = seconds

    @property
    @override
    def uses_com(self) -> bool:
        """Whether `predict` needs `com_W`."""
        return self._uses_com

    @override
    def predict(self, cloud_W: Seen, goal_W: Seen, com_W: Seen | None, hand: Seen) -> Vector:
        """Returns the keypoint; see `KeypointModel.predict`.

        Raises:
            PolicyError: it raised, took too long, or answered with no three numbers.
        """
        seen = (cloud_W, goal_W, com_W, hand)
        try:
            with chdir("."), time_limit(self._seconds):  # back to here, wherever it goes
                # Copies: what it does to them must not reach the simulation.
                answer = self._model.predict(*(None if s is None else s.copy() for s in seen))
                keypoint = np.asarray(answer)
                shown = "" if _is_point(keypoint) else _shown(answer)
        except NoAnswer as error:
            raise PolicyError(f"no answer within {self._seconds:g} s") from error
        except KeyboardInterrupt:  # the user's Ctrl-C
            raise
        except BaseException as error:
            raise PolicyError(_told(error, self._source)) from error
        if shown:
            raise PolicyError(f"keypoint is {shown}; allowed: three numbers")
        return np.array(keypoint, dtype=float)


def own_model(policy: str) -> KeypointModel:
    """Makes the model that the name of a user's own policy stands for.

    A file is read anew each time; what it imports may lie beside it.

    Args:
        policy: "FILE.py:NAME" or "MODULE:NAME", see `keypush.policies.is_own_policy`.

    Raises:
        UserError: there is no such file, module or name, importing or calling it raised, or what
            it gives is no model.
    """
    source, _, name = policy.rpartition(":")
    try:
        module, path = _load(source)
        model = _make(module, name, path)
        uses_com = _says_uses_com(model, path)
        _check_predict(model, path)
        return OwnModel(model, uses_com, path, ANSWER_SECONDS)
    except UserError as error:
        raise UserError(f"policy {policy}: {error}") from error


def source_file(policy: str) -> Path:
    """Returns the file in which a user's own policy stands, after `own_model` has found it."""
    source = policy.rpartition(":")[0]
    return Path(source if source.endswith(".py") else str(sys.modules[source].__file__))


def _is_point(found: Array) -> bool:
    """Whether these are three real numbers: no text that looks like some, nothing true or false."""
    return found.shape == (3,) and found.dtype.kind in "iuf"


def _load(source: str) -> tuple[ModuleType, Path]:
    """Imports a file or module; returns it and its file."""
    path = Path(source)
    is_file = source.endswith(".py")
    if is_file and not path.is_file():
        raise UserError(f"no file {source} in {Path.cwd()}; allowed: the path of a Python file")
    folder = str(path.resolve().parent if is_file else Path.cwd())
    if folder not in sys.path:
        sys.path.append(folder)  # last, so that nothing there hides a package
    with _told_as_mistake("importing it", path):
        if is_file:
            return _run_file(path), path
        module = importlib.import_module(source)
        file = getattr(module, "__file__", None)
    if not isinstance(file, str):  # part of Python itself, or a folder
        raise UserError(f"module {source} has no file; allowed: a module that is a Python file")
    return module, Path(file)


def _run_file(path: Path) -> ModuleType:
    """Imports a file without the bytecode that Python keeps: an edit in the same second counts."""
    module = ModuleType(f"keypush_own_policy_{path.stem}")
    module.__file__ = str(path.resolve())
    sys.modules[module.__name__] = module  # dataclasses and others look there for their module
    exec(compile(path.read_bytes(), str(path), "exec"), module.__dict__)
    return module


def _make(module: ModuleType, name: str, path: Path) -> Any:
    with _told_as_mistake(f"looking for {name}", path):
        made = getattr(module, name, None)
        others = "" if callable(made) else _others(module)
    if not callable(made):
        raise UserError(f"{path} has no class or function {name}{others}")
    with _told_as_mistake("calling it", path, f"; {_ALLOWED}"):
        return made()


def _says_uses_com(model: Any, path: Path) -> bool:
    """What a model says of itself, asked once: it must not change in the midst of a run."""
    with _told_as_mistake("asking what it gives for uses_com", path, f"; {_ALLOWED}"):
        uses_com = getattr(model, "uses_com", None)
    if not isinstance(uses_com, bool | np.bool_):
        raise UserError(f"what it gives has no uses_com; {_ALLOWED}")
    return bool(uses_com)


def _check_predict(model: Any, path: Path) -> None:
    with _told_as_mistake("asking what it gives for predict", path, f"; {_ALLOWED}"):
        predicts = _predicts(model)
    if not predicts:
        raise UserError(f"what it gives has no such predict; {_ALLOWED}")


def _others(module: ModuleType) -> str:
    """Names that may have been meant."""
    found = [
        name
        for name, value in vars(module).items()
        if callable(value) and getattr(value, "__module__", None) == module.__name__
    ]
    return f"; allowed: {', '.join(found)}" if found else ""


def _predicts(model: Any) -> bool:
    predict = getattr(model, "predict", None)
    if not callable(predict):
        return False
    try:
        inspect.signature(predict).bind(*[None] * 4)
    except TypeError:
        return False
    except ValueError:  # compiled functions may not tell what they take
        return True
    return True


@contextmanager
def _told_as_mistake(what: str, path: Path, allowed: str = "") -> Iterator[None]:
    """Turns whatever the user's code inside raises into a `UserError`, but for Ctrl-C.

    It may change the folder it works in, as to load its weights; afterwards that is what it was.
    """
    try:
        with chdir("."):
            yield
    except KeyboardInterrupt:
        raise
    except BaseException as error:
        raise UserError(f"{what} raised {_told(error, path)}{allowed}") from error


def _told(error: BaseException, path: Path) -> str:
    """What was raised, and in which line of the user's file."""
    frames = traceback.extract_tb(error.__traceback__)
    lines = [frame.lineno for frame in frames if Path(frame.filename) == path]
    if isinstance(error, SyntaxError):
        lines = [error.lineno]
    place = f" ({path.name}:{lines[-1]})" if lines and lines[-1] else ""
    text = _text(error if not isinstance(error, SyntaxError) else SyntaxError(error.msg))
    return f"{type(error).__name__}{': ' if text else ''}{text}{place}"


def _text(error: BaseException) -> str:
    try:
        text = one_line(error)
    except Exception:  # it is the user's class, whose __str__ may raise too
        return "(without a text)"
    # What is no Unicode, as of a file's odd name, no Parquet file can hold; and the same mistake
    # is to read the same in every process.
    return _ADDRESS.sub("", text).encode(errors="backslashreplace").decode()


class _Answers(reprlib.Repr):
    """Shows answers the same in every process: of objects the type, as texts have addresses."""

    @override
    def repr_instance(self, x: Any, level: int) -> str:
        if isinstance(x, _PLAIN) and getattr(x, "dtype", None) != np.dtype(object):
            return super().repr_instance(x, level)
        return f"<{type(x).__name__}>"


def _shown(answer: Any) -> str:
    """An answer on one line of bounded length."""
    text = " ".join(_Answers().repr(answer).split())
    return text.encode(errors="backslashreplace").decode()
