"""What the two scales run."""

import pytest

from keypush.errors import UserError
from keypush.objects.catalogue import catalogue_names
from keypush.reproduction.plan import PLANS, REPRODUCED, check_policies
from keypush.reproduction.thesis_figures import SHIFTED
from keypush.rollout.progress import SECONDS_PER_EPISODE
from keypush.seeding import EVALUATION_SEEDS


def test_full_is_the_thesis_own_amount_and_more() -> None:
    plan = PLANS["full"]
    assert set(plan.objects) == set(plan.shifted) == set(catalogue_names())
    assert (len(plan.sizes), plan.episodes) == (5, 50)
    assert plan.total == 32 * 5 * 50 + 32 * 50


def test_quick_has_objects_of_every_set_and_takes_minutes() -> None:
    plan = PLANS["quick"]
    assert {"train", "id", "ood"} == {
        group for group in ("train", "id", "ood") if set(catalogue_names(group)) & set(plan.objects)
    }
    assert set(SHIFTED) == set(plan.shifted) <= set(plan.objects)
    assert set(plan.sizes) == {0.75, 1.0, 1.25}
    assert len(REPRODUCED) * plan.total == 1640
    minutes = len(REPRODUCED) * plan.total * SECONDS_PER_EPISODE / 2 / 60
    assert 7 <= minutes <= 9


def test_conditions_are_those_of_the_tables() -> None:
    jobs = PLANS["quick"].jobs("geometric")
    found = [(j.scenario.object.size_ratio, j.scenario.variation.com_shift) for j in jobs]
    assert found == [(1.0, 0.0), (1.0, 0.015), (0.75, 0.0), (1.25, 0.0)]
    assert sum(job.total for job in jobs) == PLANS["quick"].total
    assert {job.scenario.seed for job in jobs} == {EVALUATION_SEEDS}
    assert {job.scenario.policy for job in jobs} == {"geometric"}


@pytest.mark.parametrize(
    ("policies", "words"),
    [
        (["geometric", "centroid"], "--policies has 'centroid'; allowed: keypoint, keypoint_no"),
        (["expert", "expert"], "--policies has expert twice"),
    ],
)
def test_wrong_policies_are_named(policies: list[str], words: str) -> None:
    with pytest.raises(UserError, match=words):
        check_policies(policies)
