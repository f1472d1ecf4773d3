"""Files of an ablation: read as they were written, or refused by name."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from keypush.errors import UserError
from keypush.learning.ablation.results import (
    FILE,
    read_ablation,
    read_training,
    write_ablation,
    write_training,
)
from tests.learning.ablation.sample import made_up


def test_what_is_written_is_read(tmp_path: Path) -> None:
    ablation = made_up(lambda s, seed: s.thesis_error / 3 + 1e-3 * seed)
    write_ablation(ablation, tmp_path)
    assert read_ablation(tmp_path) == ablation
    write_training(ablation.trainings[3], tmp_path / "new" / "one.json")
    assert read_training(tmp_path / "new" / "one.json") == ablation.trainings[3]
    assert read_training(tmp_path / "none.json") is None


def _drop(key: str) -> Callable[[dict[str, Any]], object]:
    return lambda content: content.pop(key)


@pytest.mark.parametrize(
    "damage",
    [
        _drop("seeds"),
        _drop("encoders"),
        lambda content: content["trainings"].pop(),
        lambda content: content["trainings"].reverse(),
        lambda content: content["encoders"].pop(),
        lambda content: content["trainings"][0]["epochs"].clear(),
        lambda content: content["trainings"][0]["epochs"][0].update(held_out_error=float("nan")),
        lambda content: content["trainings"][0]["epochs"][0].update(held_out_error="0.1"),
        lambda content: content["trainings"][0]["epochs"][0].update(more=1.0),
        lambda content: content["trainings"][0]["setting"].update(heads=4),
        lambda content: content.update(trainings=None),
        lambda content: content.update(seeds=[]),
    ],
)
def test_a_damaged_file_is_named(damage: Callable[[Any], object], tmp_path: Path) -> None:
    write_ablation(made_up(lambda s, _: s.thesis_error), tmp_path)
    content = json.loads((tmp_path / FILE).read_text())
    damage(content)
    (tmp_path / FILE).write_text(json.dumps(content))
    with pytest.raises(UserError, match=r"ablation\.json: is damaged: .*; allowed: what") as caught:
        read_ablation(tmp_path)
    assert "\n" not in str(caught.value)


def test_no_file_and_no_json_are_named(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"ablation\.json: cannot be read: No such file"):
        read_ablation(tmp_path)
    (tmp_path / FILE).write_text("{")
    with pytest.raises(UserError, match=r"ablation\.json: is damaged"):
        read_ablation(tmp_path)
    (tmp_path / FILE).write_text("[1]")
    with pytest.raises(UserError, match=r"ablation\.json: is damaged"):
        read_ablation(tmp_path)
    with pytest.raises(UserError, match=r"ablation\.json: is damaged"):
        read_training(tmp_path / FILE)
