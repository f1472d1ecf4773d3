"""Building every object again and again keeps memory flat, and is quick next to an episode."""

import gc
from pathlib import Path

import pytest

from diagrams.station import MakePushStation
from keypush.objects.catalogue import catalogue_names
from keypush.objects.library import make_object
from keypush.scenario import ObjectConfig, Scenario


def resident_megabytes() -> float:
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * 4096 / 1e6


def build_all() -> None:
    for name in catalogue_names():
        MakePushStation(Scenario(object=ObjectConfig(name=name)), make_object(name))
        gc.collect()


@pytest.mark.slow
@pytest.mark.timeout(600)
def test_memory_is_flat_over_building_all_objects_five_times() -> None:
    build_all()
    before = resident_megabytes()
    for _ in range(4):
        build_all()
    assert resident_megabytes() - before < 20
