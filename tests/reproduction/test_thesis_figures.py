"""The thesis' figures, spot-checked against its tables."""

import pytest

from keypush.objects.catalogue import catalogue_names
from keypush.reproduction.thesis_figures import (
    SHIFTED,
    SIZE_TABLES,
    SIZES,
    shifted_rate,
    size_rate,
)


@pytest.mark.parametrize(
    ("group", "size", "policy", "rate"),
    [
        ("train", 1.0, "keypoint", 87.1),
        ("train", 0.75, "keypoint_no_com", 42.7),
        ("id", 1.25, "keypoint", 90.3),
        ("id", 1.125, "behavior_cloning", 38.8),
        ("ood", 0.875, "keypoint", 62.0),
        ("ood", 1.25, "keypoint_no_com", 41.9),
        ("ood", 1.0, "surface", None),
    ],
)
def test_sizes(group: str, size: float, policy: str, rate: float | None) -> None:
    assert size_rate(group, size, policy) == rate


def test_shifts() -> None:
    assert shifted_rate("bottle", "behavior_cloning", shifted=True) == 19.4
    assert shifted_rate("mug", "keypoint", shifted=False) == 92.6
    assert shifted_rate("telephone", "keypoint", shifted=True) == 42.4
    assert shifted_rate("block", "expert", shifted=True) is None


def test_every_table_is_whole() -> None:
    assert [number for number, _ in SIZE_TABLES.values()] == ["5.5", "5.6", "5.7"]
    for _, rates in SIZE_TABLES.values():
        assert set(rates) == set(SIZES) == {0.75, 0.875, 1.0, 1.125, 1.25}
    assert set(SHIFTED) <= set(catalogue_names("train"))
