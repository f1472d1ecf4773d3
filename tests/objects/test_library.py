"""Built-in objects and those that a user adds."""

from pathlib import Path

import numpy as np
import pytest
import trimesh

from keypush.checking.adding import add_object_file
from keypush.errors import UserError
from keypush.objects.build import BuildOptions
from keypush.objects.catalogue import GROUPS, catalogue_names
from keypush.objects.generators.solids import box
from keypush.objects.library import (
    check_new_name,
    load_object,
    make_object,
    object_folder,
    object_names,
    parse_object_list,
    remove_user_object,
    user_object_names,
    user_objects_dir,
)
from keypush.objects.manifolds import to_mesh


@pytest.fixture
def data_home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    return tmp_path / "data"


@pytest.fixture
def crate(tmp_path: Path, data_home: Path) -> Path:  # noqa: ARG001  # sets where it is stored
    path = tmp_path / "Crate.stl"
    mesh = to_mesh(box((8.0, 5.0, 4.0)))
    mesh.export(path)
    return path


def test_without_additions_there_are_the_built_in_objects(data_home: Path) -> None:
    assert object_names() == catalogue_names()
    assert user_object_names() == []
    assert not data_home.exists()  # looking creates nothing


def test_an_added_object_is_like_a_built_in_one(crate: Path, data_home: Path) -> None:
    asset, folder = add_object_file(crate, "crate", BuildOptions(mass=0.2, up="z"))
    assert folder == user_objects_dir() / "crate"
    assert folder.is_relative_to(data_home)
    assert object_names() == [*catalogue_names(), "crate"]
    assert parse_object_list("user,mug,crate") == ["crate", "mug"]
    with pytest.raises(UserError, match=r"; allowed: .*, user, .*, crate$"):
        parse_object_list("teapot")
    model = make_object("crate", 1.25)
    assert model.mass == 0.2
    assert model.bounding_radius == pytest.approx(0.0625)
    assert make_object("crate", mass=0.3).mass == 0.3
    assert asset.provenance["file"] == "Crate.stl"
    assert len(asset.provenance["sha256"]) == 64
    assert [p.name for p in folder.parent.iterdir()] == ["crate"]


def test_a_taken_name_is_refused_and_the_object_kept(crate: Path) -> None:
    add_object_file(crate, "crate")
    before = load_object("crate")
    with pytest.raises(UserError, match="'crate', which is taken"):
        add_object_file(crate, "crate", BuildOptions(mass=0.5))
    assert load_object("crate") is before


def test_one_object_is_a_name_and_a_list_may_hold_groups(data_home: Path) -> None:
    names = ", ".join(catalogue_names())
    assert data_home
    for name in ("train", "user", "teapot"):
        with pytest.raises(UserError, match=f"^object '{name}' is not there; allowed: {names}$"):
            object_folder(name)
    groups = ", ".join(GROUPS)
    with pytest.raises(UserError, match=f"^object 'teapot' is not there; allowed: {groups}, "):
        parse_object_list("mug,teapot")
    with pytest.raises(UserError) as caught:
        parse_object_list("user")
    expected = "objects is 'user', which names none, since none was added; allowed: "
    assert str(caught.value) == f"{expected}{groups}, {names}"
    with pytest.raises(UserError, match=r"^objects is ',', which names none; allowed: "):
        parse_object_list(",")


@pytest.mark.parametrize("name", ["", "Crate", "1crate", "a b", "../up", ".hidden", "a" * 41])
def test_a_misspelled_name_is_refused(name: str, crate: Path) -> None:
    with pytest.raises(UserError, match=r"name is .*allowed"):
        add_object_file(crate, name)


@pytest.mark.parametrize("name", ["mug", *GROUPS, "user"])
def test_reserved_names_are_refused(name: str, data_home: Path) -> None:
    assert data_home
    with pytest.raises(UserError, match=f"name is '{name}'"):
        check_new_name(name)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (BuildOptions(diameter=0.0), r"--scale is 0\.0; allowed: 0\.02 to 0\.5"),
        (BuildOptions(diameter=float("nan")), "--scale is nan"),
        (BuildOptions(mass=-1.0), r"--mass is -1\.0"),
        (BuildOptions(density=float("inf")), "--density is inf"),
        (BuildOptions(mass=0.1, density=1000.0), "both given"),
    ],
)
def test_options_out_of_range_are_refused(options: BuildOptions, message: str, crate: Path) -> None:
    with pytest.raises(UserError, match=message):
        add_object_file(crate, "crate", options)
    assert user_object_names() == []


def test_what_cannot_be_pushed_leaves_nothing(tmp_path: Path, data_home: Path) -> None:
    ball = tmp_path / "ball.ply"
    trimesh.creation.icosphere(subdivisions=3).export(ball)
    with pytest.raises(UserError, match="no stable pose"):
        add_object_file(ball, "ball")
    assert not list(data_home.rglob("*ball*"))


def test_removing(crate: Path) -> None:
    add_object_file(crate, "crate")
    remove_user_object("crate")
    assert user_object_names() == []
    with pytest.raises(UserError, match=r"'crate' is not one that was added"):
        remove_user_object("crate")
    with pytest.raises(UserError, match="'mug' is not one that was added"):
        remove_user_object("mug")


def test_an_object_that_was_replaced_is_read_anew(crate: Path) -> None:
    add_object_file(crate, "crate", BuildOptions(mass=0.2))
    assert make_object("crate").mass == 0.2
    remove_user_object("crate")
    add_object_file(crate, "crate", BuildOptions(mass=0.4))
    assert make_object("crate").mass == 0.4


def test_sizes_scale_from_the_objects_own(crate: Path) -> None:
    add_object_file(crate, "crate", BuildOptions(diameter=0.2))
    model = make_object("crate", 0.5)
    assert model.bounding_radius == pytest.approx(0.05)
    expected = 0.05 * np.array([8.0, 5.0, 4.0]) / np.linalg.norm([4.0, 2.5, 2.0])
    np.testing.assert_allclose(np.sort(model.visual.extents), np.sort(expected), rtol=1e-5)
