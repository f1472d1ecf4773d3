"""The cost of variation: what is compared, and the figures."""

import json

import pytest

from keypush.bench.variation_cost import VARIATIONS, measure_resets, summarise_resets
from keypush.cli.main import main
from keypush.errors import UserError
from keypush.scenario import EpisodeConfig, ObjectConfig, Scenario


def _scenario() -> Scenario:
    return Scenario(policy="expert", episode=EpisodeConfig(max_steps=3))


def test_figures_against_figures_by_hand() -> None:
    times = {
        "bottle": {kind: [0.002 * i, 0.5, 0.002 * i] for i, kind in enumerate(VARIATIONS, 1)},
        "mug": {kind: [0.004 * i] * 3 for i, kind in enumerate(VARIATIONS, 1)},
    }
    report = summarise_resets(_scenario(), times)
    kinds = ["nothing", "mass_com_inertia", "frictions", "size"]
    assert list(report["reset_ms"]) == kinds
    assert list(report["objects"]["bottle"]["reset_ms"].values()) == pytest.approx([2, 4, 6, 8])
    assert report["reset_ms"] == pytest.approx(dict(zip(kinds, [3, 6, 9, 12], strict=True)))
    assert report["ratio_to_plain"] == pytest.approx(dict(zip(kinds, [1, 2, 3, 4], strict=True)))
    assert report["episodes"] == 6


def test_every_variation_is_timed_in_every_episode() -> None:
    times = measure_resets(_scenario(), ["can"], 2)["can"]
    assert list(times) == list(VARIATIONS)
    for mine in times.values():
        assert len(mine) == 2
        assert min(mine) > 0


def test_a_field_without_room_for_a_variation_is_named() -> None:
    scenario = _scenario()
    scenario.object = ObjectConfig(name="can", size_ratio=0.25)
    with pytest.raises(UserError, match=r"variation\.size is .* and object\.size_ratio is 0\.25"):
        measure_resets(scenario, ["can"], 1)


@pytest.mark.parametrize("as_json", [True, False])
def test_the_verb_reports_every_object(as_json: bool, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["bench", "variation", "--objects", "can,mug", "--episodes", "1"]
    assert main([*arguments, "--json"] if as_json else arguments) == 0
    out = capsys.readouterr().out
    if as_json:
        report = json.loads(out)
        assert set(report["objects"]) == {"can", "mug"}
        assert report["ratio_to_plain"]["nothing"] == 1.0
    else:
        assert "can" in out
        assert "mass com inertia" in out
