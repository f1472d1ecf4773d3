"""What an episode costs, and where its time goes."""

import json
import time

import pytest

from keypush.bench.policy_time import PARTS, measure_policies
from keypush.bench.stack_samples import sampled
from keypush.cli.main import main
from keypush.policies import POLICIES
from keypush.scenario import EpisodeConfig, Scenario


def _wait() -> None:
    time.sleep(0.1)


def _work() -> None:
    end = time.perf_counter() + 1.0
    while time.perf_counter() < end:
        pass


def test_more_samples_tell_of_more_time() -> None:
    with sampled(lambda frame: frame.f_code.co_name) as found:
        _wait()
        _work()
    assert found["_work"] > found["_wait"] > 0
    assert found["_work"] + found["_wait"] > 0.8 * found.total()


def test_every_policy_is_measured_and_its_shares_make_one() -> None:
    scenario = Scenario(episode=EpisodeConfig(max_steps=40))
    found = {line.pop("policy"): line for line in measure_policies(scenario, ["can"], 1)}
    assert list(found) == list(POLICIES)
    for line in found.values():
        assert line["cpu_seconds_per_episode"] > 0
        assert line["steps_per_episode"] == 41
        assert sum(line["shares"].values()) == pytest.approx(1)
        assert line["shares"]["physics"] > 0
    assert found["geometric"]["shares"]["network"] == found["expert"]["shares"]["network"] == 0
    assert found["keypoint"]["shares"]["network"] > 0


@pytest.mark.parametrize("as_json", [True, False])
def test_the_verb_tells_every_share(as_json: bool, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["bench", "policies", "--objects", "can", "--episodes", "1",
                 "--set", "episode.max_steps=5"]  # fmt: skip
    assert main([*arguments, "--json"] if as_json else arguments) == 0
    out = capsys.readouterr().out
    if as_json:
        assert {line["policy"] for line in json.loads(out)["policies"]} == set(POLICIES)
    else:
        assert all(part in out for part in PARTS)
