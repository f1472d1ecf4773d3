"""A user's own model: found or refused on one line; whatever it does wrong becomes a reason."""

import signal
import threading
import time
from collections.abc import Callable
from pathlib import Path
from types import FrameType
from typing import Any

import numpy as np
import pytest

from keypush.errors import UserError
from keypush.learning.model import PolicyError
from keypush.learning.own_policy import OwnModel, own_model, source_file
from keypush.learning.time_limit import NoAnswer, time_limit

CLOUD, GOAL, HAND = np.ones((16, 3)), np.zeros(2), np.zeros(9)

GOOD = """
from dataclasses import dataclass
from beside import HEIGHT

@dataclass
class Good:
    uses_com: bool = False

    def predict(self, cloud, goal, com, hand):
        cloud[:] = 0.0
        return [0.1, 0.2, HEIGHT]

def make():
    return Good(uses_com=True)
"""


class Answering:
    """Does what it is told when it is asked."""

    uses_com = False

    def __init__(self, answer: Callable[[], Any]) -> None:
        self._answer = answer

    def predict(self, _cloud: Any, _goal: Any, _com: Any, _hand: Any) -> Any:
        return self._answer()


def _reason(answer: Callable[[], Any], seconds: float = 60.0) -> str:
    model = OwnModel(Answering(answer), False, Path(__file__), seconds)
    with pytest.raises(PolicyError) as caught:
        model.predict(CLOUD, GOAL, None, HAND)
    return str(caught.value)


@pytest.mark.parametrize(("name", "uses_com"), [("Good", False), ("make", True)])
def test_a_class_or_a_function_of_a_file_makes_a_model(
    name: str, uses_com: bool, tmp_path: Path
) -> None:
    (tmp_path / "beside.py").write_text("HEIGHT = 0.3\n")
    (tmp_path / "mine.py").write_text(GOOD)
    model = own_model(f"{tmp_path}/mine.py:{name}")
    assert model.uses_com == uses_com
    keypoint = model.predict(CLOUD, GOAL, None, HAND)
    np.testing.assert_array_equal(keypoint, [0.1, 0.2, 0.3])
    np.testing.assert_array_equal(CLOUD, np.ones((16, 3)))


def test_a_module_is_imported_from_the_folder_or_the_packages(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert not own_model("keypush.learning.baselines:CentroidKeypoint").uses_com
    (tmp_path / "module_of_mine.py").write_text(GOOD.replace("from beside import HEIGHT", ""))
    monkeypatch.chdir(tmp_path)
    assert not own_model("module_of_mine:Good").uses_com
    assert source_file("module_of_mine:Good").samefile(tmp_path / "module_of_mine.py")


def test_an_edited_file_is_read_anew(tmp_path: Path) -> None:
    path = tmp_path / "mine.py"
    for height in (0.25, 0.75):  # the same size and, to Python, the same time
        path.write_text(GOOD.replace("from beside import HEIGHT", f"HEIGHT = {height}"))
        keypoint = own_model(f"{path}:Good").predict(CLOUD, GOAL, None, HAND)
        assert keypoint[2] == height


@pytest.mark.parametrize(
    ("text", "name", "words"),
    [
        (GOOD, "Better", ["mine.py has no class or function Better", "allowed: Good, make"]),
        ("x = 3", "x", ["has no class or function x"]),
        ("import no_such_package", "X", ["ModuleNotFoundError", "no_such_package", "(mine.py:1)"]),
        ("\nclass X", "X", ["SyntaxError: expected ':' (mine.py:2)"]),
        ("raise SystemExit(3)", "X", ["SystemExit: 3 (mine.py:1)"]),
        ("def X():\n    return 1 / 0", "X", ["calling it raised ZeroDivisionError", "mine.py:2"]),
        ("def X(size): pass", "X", ["calling it raised TypeError", "without arguments"]),
        ("def X(): pass", "X", ["has no uses_com", "predict(cloud_W, goal_W, com_W, hand)"]),
        ("class X:\n    uses_com = True", "X", ["has no such predict"]),
        (
            "class X:\n    uses_com = True\n    def predict(self, cloud): pass",
            "X",
            ["has no such predict"],
        ),
        (
            "class Stop(BaseException): pass\nraise Stop('now')",
            "X",
            ["raised Stop: now (mine.py:2"],
        ),
        (
            "class Stop(BaseException): pass\ndef X(): raise Stop('now')",
            "X",
            ["calling it raised Stop: now (mine.py:2); allowed: a class or function"],
        ),
        (
            "class Mute(Exception):\n    def __str__(self): raise RuntimeError\nraise Mute",
            "X",
            ["importing it raised Mute: (without a text) (mine.py:3)"],
        ),
        (
            "class X:\n    @property\n    def uses_com(self): raise RuntimeError('no')",
            "X",
            ["for uses_com raised RuntimeError: no (mine.py:3)", "without arguments"],
        ),
        (
            "class X:\n    uses_com = True\n    def __getattr__(self, name): raise KeyError(name)",
            "X",
            ["for predict raised KeyError: 'predict' (mine.py:3)", "without arguments"],
        ),
        (
            "def __getattr__(name): raise KeyError(name)",
            "X",
            ["looking for X raised KeyError: 'X'"],
        ),
    ],
)
def test_what_is_no_model_is_refused_on_one_line(
    text: str, name: str, words: list[str], tmp_path: Path
) -> None:
    (tmp_path / "mine.py").write_text(text.replace("from beside import HEIGHT", ""))
    policy = f"{tmp_path / 'mine.py'}:{name}"
    with pytest.raises(UserError) as caught:
        own_model(policy)
    message = str(caught.value)
    assert message.startswith(f"policy {policy}: ")
    assert "\n" not in message
    for word in words:
        assert word in message


def test_missing_files_and_modules_are_named() -> None:
    with pytest.raises(UserError, match=r"policy none\.py:X: no file none\.py in "):
        own_model("none.py:X")
    with pytest.raises(UserError, match=r"policy no_such\.module:X: importing it raised ModuleNot"):
        own_model("no_such.module:X")


@pytest.mark.parametrize("policy", ["sys:exit", "builtins:int", "folder_of_mine:Base"])
def test_a_module_without_a_file_is_refused(
    policy: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "folder_of_mine").mkdir()
    monkeypatch.chdir(tmp_path)
    expected = f"policy {policy}: module {policy.partition(':')[0]} has no file; allowed"
    with pytest.raises(UserError, match=expected):
        own_model(policy)


def test_what_it_says_of_itself_is_asked_once(tmp_path: Path) -> None:
    (tmp_path / "mine.py").write_text("""
class X:
    asked = 0
    def predict(self, cloud, goal, com, hand): return [0, 0, 0]
    @property
    def uses_com(self):
        self.asked += 1
        return self.asked == 1 or 1 / 0
""")
    model = own_model(f"{tmp_path / 'mine.py'}:X")
    assert model.uses_com
    assert model.uses_com


def test_what_it_raises_is_told_with_its_place() -> None:
    def fail() -> None:
        raise ValueError("bad\n cloud")

    line = fail.__code__.co_firstlineno + 1
    assert _reason(fail) == f"ValueError: bad cloud (test_own_policy.py:{line})"
    assert _reason(lambda: int("a")).startswith("ValueError: invalid literal")
    assert _reason(lambda: exec("raise SystemExit")).startswith("SystemExit (test_own_policy.py")


def test_an_exception_that_is_no_exception_or_cannot_be_told_ends_the_answer() -> None:
    class Stop(BaseException):
        pass

    class MuteError(Exception):
        def __str__(self) -> str:
            raise RuntimeError

    def fail(error: BaseException) -> None:
        raise error

    assert _reason(lambda: fail(Stop("now"))).startswith("Stop: now (test_own_policy.py:")
    assert _reason(lambda: fail(MuteError())).startswith("MuteError: (without a text) (test_own")
    assert _reason(lambda: fail(ValueError("\udcff"))).startswith("ValueError: \\udcff (")


def test_ctrl_c_is_the_users_and_not_the_models() -> None:
    def interrupt() -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        OwnModel(Answering(interrupt), False, Path(__file__), 60.0).predict(CLOUD, GOAL, None, HAND)


class Unprintable:
    def __repr__(self) -> str:
        raise SystemExit


@pytest.mark.parametrize(
    "answer",
    [
        None,
        [1.0, 2.0],
        np.zeros((3, 3)),
        3.0,
        ["0.1", "0.2", "0.3"],
        [True, False, True],
        np.zeros(3, dtype=complex),
        np.array([0.1, 0.2, 0.3], dtype=object),
        "here",
        "\udcff",
    ],
)
def test_what_is_not_three_numbers_is_refused(answer: Any) -> None:
    reason = _reason(lambda: answer)
    assert reason.endswith("; allowed: three numbers")
    assert "\n" not in reason


@pytest.mark.parametrize(
    ("answer", "shown"),
    [
        (Unprintable(), "<Unprintable>"),
        ((0.1 for _ in range(3)), "<generator>"),
        ([0.1, 0.2, Unprintable()], "[0.1, 0.2, <Unprintable>]"),
        (np.array([0.1, None, 0.3], dtype=object), "<ndarray>"),
    ],
)
def test_an_object_is_told_by_its_type_as_its_text_may_change(answer: Any, shown: str) -> None:
    assert _reason(lambda: answer) == f"keypoint is {shown}; allowed: three numbers"


def test_addresses_in_what_it_raises_are_left_out() -> None:
    def fail() -> None:
        raise TypeError(f"no number: {object()}")

    assert _reason(fail).startswith("TypeError: no number: <object object> (test_own_policy.py:")


@pytest.mark.parametrize(
    "answer", [(0, 1, 2), [0.0, 1, np.float32(2)], np.arange(3, dtype=np.uint8), np.arange(3.0)]
)
def test_three_real_numbers_of_any_type_are_a_keypoint(answer: Any) -> None:
    model = OwnModel(Answering(lambda: answer), False, Path(__file__), 60.0)
    keypoint = model.predict(CLOUD, GOAL, None, HAND)
    assert keypoint.dtype == np.float64
    assert keypoint is not answer
    np.testing.assert_array_equal(keypoint, [0.0, 1.0, 2.0])


def test_a_number_that_is_not_finite_is_for_who_asks() -> None:
    model = OwnModel(Answering(lambda: [0.0, np.nan, 0.0]), False, Path(__file__), 60.0)
    assert np.isnan(model.predict(CLOUD, GOAL, None, HAND)[1])


def _wait_for_ever() -> None:
    while True:
        try:
            time.sleep(3600)
        except Exception:
            continue


def test_who_never_answers_is_interrupted() -> None:
    assert _reason(_wait_for_ever, seconds=0.2) == "no answer within 0.2 s"


def test_who_catches_the_limit_is_told_again_and_does_not_count_when_late() -> None:
    interrupted: list[type[BaseException]] = []

    def stubborn() -> list[float]:
        while len(interrupted) < 2:
            try:
                time.sleep(3600)
            except BaseException as error:
                interrupted.append(type(error))
        return [0.1, 0.2, 0.3]

    assert _reason(stubborn, seconds=0.2) == "no answer within 0.2 s"
    assert interrupted == [NoAnswer, NoAnswer]


def test_it_may_work_in_another_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "weights").mkdir()
    (tmp_path / "mine.py").write_text("""
import os
from pathlib import Path
os.chdir("weights")
class X:
    uses_com = False
    def __init__(self):
        self.made_in = os.getcwd()
        os.chdir("weights")
    def predict(self, cloud, goal, com, hand):
        os.chdir(Path(__file__).parent / "weights")
        return [0.1, 0.2, 0.3]
""")
    monkeypatch.chdir(tmp_path)
    model = own_model("mine.py:X")
    assert Path.cwd() == tmp_path
    model.predict(CLOUD, GOAL, None, HAND)
    assert Path.cwd() == tmp_path
    own_model("mine.py:X")  # still found


def test_handler_and_timer_are_what_they_were() -> None:
    rung = []

    def handler(number: int, _frame: FrameType | None) -> None:
        rung.append(number)

    before = signal.signal(signal.SIGALRM, handler)
    left, interval = signal.setitimer(signal.ITIMER_REAL, 50.0)
    try:
        with pytest.raises(NoAnswer), time_limit(0.1):
            time.sleep(3600)
        assert signal.getsignal(signal.SIGALRM) is handler
        assert 1.0 < signal.getitimer(signal.ITIMER_REAL)[0] < 50.0
        signal.raise_signal(signal.SIGALRM)
        assert rung == [signal.SIGALRM]
    finally:
        signal.signal(signal.SIGALRM, before)
        signal.setitimer(signal.ITIMER_REAL, left, interval)


def test_other_threads_have_no_limit() -> None:
    reached = threading.Event()

    def run() -> None:
        with time_limit(1e-3):
            time.sleep(0.05)
        reached.set()

    thread = threading.Thread(target=run)
    thread.start()
    thread.join()
    assert reached.is_set()
