"""Assets on disk: whole or not at all, and the same when they are read again."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from keypush.errors import UserError
from keypush.objects.asset import ObjectAsset, read_asset, write_asset
from keypush.objects.build import BuildOptions, build_asset
from keypush.objects.generators.solids import box
from keypush.objects.library import load_object, object_folder
from keypush.objects.manifolds import to_mesh


def brick(name: str = "brick") -> ObjectAsset:
    mesh = to_mesh(box((0.2, 0.1, 0.06)))
    return build_asset(name, mesh, BuildOptions(up="z", mass=0.25), {"file": "a.stl"})


def test_what_is_written_is_read(tmp_path: Path) -> None:
    asset = brick()
    write_asset(asset, tmp_path / "brick")
    found = read_asset(tmp_path / "brick")
    assert (found.name, found.mass, found.colour) == ("brick", 0.25, asset.colour)
    assert found.provenance == asset.provenance
    np.testing.assert_array_equal(found.collision.faces, asset.collision.faces)
    np.testing.assert_allclose(found.collision.vertices, asset.collision.vertices, atol=1e-10)
    np.testing.assert_allclose(found.visual.vertices, asset.visual.vertices, atol=1e-8)
    np.testing.assert_array_equal(found.p_OoOcm_O, asset.p_OoOcm_O)
    np.testing.assert_array_equal(found.inertia_per_mass, asset.inertia_per_mass)
    for pose, expected in zip(found.poses, asset.poses, strict=True):
        assert pose.R_WO.IsNearlyEqualTo(expected.R_WO, 1e-12)
        assert (pose.height, pose.share) == (expected.height, expected.share)
    assert list(tmp_path.iterdir()) == [tmp_path / "brick"]  # nothing half-written beside it


def test_an_existing_folder_is_kept(tmp_path: Path) -> None:
    (tmp_path / "brick").mkdir()
    with pytest.raises(UserError, match=r"'brick'.*exists; allowed: another name"):
        write_asset(brick(), tmp_path / "brick")
    assert list((tmp_path / "brick").iterdir()) == []


def test_a_folder_that_cannot_be_written_is_one_line(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(UserError, match="cannot be written") as caught:
        write_asset(brick(), tmp_path / "file" / "brick")
    assert "\n" not in str(caught.value)


def damage_text(folder: Path) -> None:
    (folder / "object.json").write_text("{")


def damage_format(folder: Path) -> None:
    found = json.loads((folder / "object.json").read_text())
    (folder / "object.json").write_text(json.dumps({**found, "format": 99}))


def damage_inertia(folder: Path) -> None:
    found = json.loads((folder / "object.json").read_text())
    (folder / "object.json").write_text(json.dumps({**found, "inertia_per_mass": [1, 2]}))


def damage_mesh(folder: Path) -> None:
    (folder / "visual.ply").write_bytes(b"ply\nnonsense")


def lose_mesh(folder: Path) -> None:
    (folder / "collision.obj").unlink()


@pytest.mark.parametrize(
    "damage", [damage_text, damage_format, damage_inertia, damage_mesh, lose_mesh]
)
def test_a_damaged_asset_is_refused_by_its_folder(
    tmp_path: Path, damage: Callable[[Path], None]
) -> None:
    folder = tmp_path / "brick"
    write_asset(brick(), folder)
    damage(folder)
    with pytest.raises(UserError, match="cannot be read") as caught:
        read_asset(folder)
    assert str(folder) in str(caught.value)
    assert "\n" not in str(caught.value)


UNIT = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
POSE = {"quaternion_wxyz": [1, 0, 0, 0], "height": 0.03, "tipping_angle": 0.5, "share": 0.4}


@pytest.mark.parametrize(
    ("field", "value", "words"),
    [
        ("mass", -1, "mass is -1 and not a number above 0"),
        ("mass", float("inf"), "mass is inf and not a number"),
        ("mass", "0.1", "mass is '0.1' and not a number"),
        ("mass", True, "mass is True and not a number"),
        ("mass", 10**400, "mass is 1000"),
        ("colour", [0.1, 0.2], "colour is [0.1, 0.2] and not 3 numbers"),
        ("colour", [0.1, 0.2, 1.5], "colour is [0.1, 0.2, 1.5] and not three numbers from 0 to 1"),
        ("centre_of_mass", [0, None, 0], "centre_of_mass is [0, None, 0] and not 3 numbers"),
        ("inertia_per_mass", [1, 2], "inertia_per_mass is [1, 2] and not 3 x 3 numbers"),
        ("inertia_per_mass", [UNIT[0], UNIT[1], [0, 0, 3]], "and not the inertia of a body"),
        ("inertia_per_mass", [UNIT[0], UNIT[1], [0, 0, -1]], "and not the inertia of a body"),
        ("inertia_per_mass", [[1, 0.5, 0], *UNIT[1:]], "and not the inertia of a body"),
        ("resting_poses", [], "resting_poses is [] and not a list of one or more"),
        ("resting_poses", {}, "resting_poses is {} and not a list of one or more"),
        ("resting_poses", [POSE, 3], "resting_poses[1] is 3 and not a mapping"),
        ("resting_poses", [{}], "resting_poses[0].quaternion_wxyz is missing"),
        ("resting_poses", [POSE | {"height": None}], "resting_poses[0].height is None and not a"),
        (
            "resting_poses",
            [POSE | {"quaternion_wxyz": [0, 0, 0, 0]}],
            "[0].quaternion_wxyz is [0.0, 0.0, 0.0, 0.0] and not a quaternion",
        ),
        ("provenance", {}, "provenance.volume is missing"),
        ("provenance", None, "provenance is None and not a mapping"),
    ],
)
def test_a_field_that_no_object_can_have_is_named(
    tmp_path: Path, field: str, value: object, words: str
) -> None:
    folder = tmp_path / "brick"
    write_asset(brick(), folder)
    found = json.loads((folder / "object.json").read_text())
    (folder / "object.json").write_text(json.dumps({**found, field: value}))
    with pytest.raises(UserError) as caught:
        read_asset(folder)
    assert f"{folder}: cannot be read: object.json: " in str(caught.value)
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)
    (folder / "object.json").write_text(json.dumps({k: found[k] for k in found if k != field}))
    with pytest.raises(UserError, match=rf"object\.json: {field} is missing"):
        read_asset(folder)


@pytest.mark.parametrize("text", ["[]", "null", 100_000 * "[", "{"])
def test_what_is_no_mapping_is_named(tmp_path: Path, text: str) -> None:
    folder = tmp_path / "brick"
    write_asset(brick(), folder)
    (folder / "object.json").write_text(text)
    with pytest.raises(UserError, match=r"cannot be read: object\.json: "):
        read_asset(folder)


def test_surface_samples_are_the_same_whenever_it_is_read() -> None:
    again = read_asset(object_folder("mug")).surface_samples
    np.testing.assert_array_equal(load_object("mug").surface_samples, again)
