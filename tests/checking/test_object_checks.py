"""Checks pass for good objects and name what is wrong with bad ones."""

import dataclasses

import numpy as np
import pytest
import trimesh

from keypush.checking.object_checks import check_object
from keypush.checking.report import describe_checks
from keypush.objects.asset import ObjectAsset
from keypush.objects.catalogue import catalogue_names
from keypush.objects.library import load_object

FEW = ["block", "mug", "tripod", "candle", "plate"]


def failing(asset: ObjectAsset) -> set[str]:
    return {name for name, check in check_object(asset).items() if not check.ok}


@pytest.mark.parametrize("name", FEW)
def test_good_objects_pass(name: str) -> None:
    assert failing(load_object(name)) == set()


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in catalogue_names() if name not in FEW])
def test_all_other_built_in_objects_pass(name: str) -> None:
    assert failing(load_object(name)) == set()


def test_a_mesh_of_few_faces_is_not_felt_and_tips_too_early() -> None:
    block = load_object("block")
    box = trimesh.creation.box(block.collision.extents)
    coarse = dataclasses.replace(block, collision=box, visual=box)
    assert failing(coarse) >= {"support", "tips"}


def test_a_hole_is_found() -> None:
    mug = load_object("mug")
    holed = mug.collision.copy()
    holed.update_faces(np.arange(len(holed.faces)) != 100)
    assert "closed" in failing(dataclasses.replace(mug, collision=holed))


def test_another_shape_than_the_one_that_is_seen_is_found() -> None:
    mug = load_object("mug")
    assert "surface" in failing(dataclasses.replace(mug, collision=load_object("can").collision))


def test_a_centre_of_mass_beyond_the_base_does_not_stand() -> None:
    can = load_object("can")
    top_heavy = dataclasses.replace(can, p_OoOcm_O=np.array([0.04, 0.0, 0.0]))
    assert "stands" in failing(top_heavy)


def test_an_inertia_that_no_body_has_is_found() -> None:
    can = load_object("can")
    broken = dataclasses.replace(can, inertia_per_mass=1e-3 * np.diag([1.0, 1.0, 3.0]))
    assert failing(broken) == {"inertia", "stands", "tips"}  # Drake would not simulate it


def test_the_report_is_ok_only_if_all_is() -> None:
    checks = check_object(load_object("block"))
    assert describe_checks({"block": checks})["block"]["ok"] is True
    first = next(iter(checks))
    checks[first] = dataclasses.replace(checks[first], ok=False)
    report = describe_checks({"block": checks})["block"]
    assert report["ok"] is False
    assert set(report[first]) == {"ok", "value", "limit", "text"}
