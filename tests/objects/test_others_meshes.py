"""Meshes that others made become objects, as they are, and are pushed.

They are Meta-World's (MIT licence), read from its wheel; nothing of its code runs.
"""

from importlib.metadata import distribution
from pathlib import Path

import pytest

from keypush.checking.adding import add_object_file
from keypush.checking.object_checks import check_object
from keypush.objects.library import load_object
from keypush.rollout.episode import EpisodeRunner
from keypush.scenario import ObjectConfig, Scenario

MESHES = [
    "assembly_peg/assembly_peg_ring", "bin/bin", "box/boxhandle", "buttonbox/stopbot",
    "coffeemachine/cup", "coffeemachine/mug", "drawer/drawer", "faucet/faucetbase",
    "hammer/hammerhead", "plug/plug", "puck/puck", "thermos/therm_cap",
]  # fmt: skip


@pytest.fixture(autouse=True)
def data_home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))


@pytest.mark.slow
@pytest.mark.timeout(120)
@pytest.mark.parametrize("mesh", MESHES)
def test_it_is_added_passes_its_checks_and_is_pushed(mesh: str) -> None:
    folder = Path(str(distribution("metaworld").locate_file("metaworld/assets/objects/meshes")))
    add_object_file(folder / f"{mesh}.stl", "theirs")
    asset = load_object("theirs")
    checks = check_object(asset)
    assert [name for name, check in checks.items() if not check.ok] == []
    scenario = Scenario(policy="expert", object=ObjectConfig(name="theirs"))
    summary = EpisodeRunner(scenario).run(0).summary
    print(mesh, len(asset.collision.faces), summary["outcome"], summary["steps"])  # noqa: T201  # the table
    assert summary["outcome"] in {"success", "toppled", "fell", "timed_out"}
