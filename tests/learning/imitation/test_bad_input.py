"""What cannot be trained on is named at once, on one line."""

import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from keypush.dataset.arrays import to_array, to_column
from keypush.errors import UserError
from keypush.learning.checkpoint import save_network
from keypush.learning.config import TrainingConfig
from keypush.learning.imitation.token_cache import FOLDER
from keypush.learning.lightning_run import CHECKPOINTS, LAST
from keypush.learning.train import train as train_surface
from keypush.objects import library
from keypush.resources import models_dir
from tests.learning.imitation.sample import SAMPLE, train, write_encoder
from tests.learning.scenes import make_network
from tests.learning.synthetic import write_data

Change = Callable[[pa.Table], pa.Table]


@pytest.fixture(scope="module")
def encoder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_encoder(tmp_path_factory.mktemp("encoder") / "contact.safetensors")


def _without(name: str) -> Change:
    return lambda table: table.drop_columns([name])


def _as_double(name: str) -> Change:
    def change(table: pa.Table) -> pa.Table:
        place = table.column_names.index(name)
        return table.set_column(place, name, table[name].cast(pa.list_(pa.float64(), 3)))

    return change


def _with(name: str, value: float) -> Change:
    def change(table: pa.Table) -> pa.Table:
        place, field = table.column_names.index(name), table.schema.field(name)
        values = np.array(to_array(table[name]))
        values[40, 1] = value
        return table.set_column(place, field, to_column(values, field.type))

    return change


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (_without("action"), r"file-000\.parquet: column action is missing; allowed: fixed_size"),
        (_as_double("keypoint"), r"column keypoint is .*double.*; allowed"),
        (_with("keypoint", np.inf), r"keypoint is \[.*inf.*\] in episode 0; allowed: finite"),
        (_with("keypoint", np.nan), r"keypoint is \[.*nan.*\] in episode 0; .* NaN in all of them"),
        (_with("observation.goal", np.nan), r"observation\.goal is \[.*nan\] in episode 0"),
        (_with("observation.tool_pose", 7.0), r"tool_pose is \[.*7.0.*\] in .*; .* of norm 1$"),
        (_with("action", -np.inf), r"action is \[.*-inf.*\] in episode 0; .* numbers$"),
    ],
)  # fmt: skip
def test_bad_columns_are_named(change: Change, message: str, encoder: Path, tmp_path: Path) -> None:
    data = shutil.copytree(SAMPLE, tmp_path / "data")
    (file,) = data.glob("data/*/*.parquet")
    pq.write_table(change(pq.read_table(file)), file)
    with pytest.raises(UserError, match=message) as caught:
        train("keypoint", tmp_path / "out", encoder, data)
    assert "\n" not in str(caught.value)
    with pytest.raises(UserError, match=message):
        train_surface(data, tmp_path / "out", TrainingConfig())
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("gone", ["visual.ply", "object.json", "collision.obj"])
def test_an_object_whose_files_are_gone_is_named(
    gone: str, encoder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    data = write_data(tmp_path / "data", [("can", 1.0)], episodes=4)
    shutil.copytree(models_dir() / "objects" / "can", tmp_path / "models" / "objects" / "can")
    (tmp_path / "models" / "objects" / "can" / gone).unlink()
    monkeypatch.setattr(library, "models_dir", lambda: tmp_path / "models")
    with pytest.raises(UserError, match=r"object folder .*can: cannot be read"):
        train("keypoint", tmp_path / "out", encoder, data, held_out_objects=[])
    assert not (tmp_path / "out").exists()


def test_bad_encoders_are_named(encoder: Path, tmp_path: Path) -> None:
    save_network(make_network(), tmp_path / "other.safetensors", {})
    with pytest.raises(UserError, match=r"kind is 'surface_keypoint'; allowed here: contact"):
        train("keypoint", tmp_path / "out", tmp_path / "other.safetensors")
    damaged = tmp_path / "damaged.safetensors"
    damaged.write_bytes(encoder.read_bytes()[:5000])
    damaged.with_suffix(".json").write_bytes(encoder.with_suffix(".json").read_bytes())
    with pytest.raises(UserError, match=r"damaged\.safetensors: cannot be"):
        train("keypoint", tmp_path / "out", damaged)
    with pytest.raises(UserError, match=r"weights 'nothing': no file .*\(contact\)"):
        train("keypoint", tmp_path / "out", Path("nothing"))


def test_an_encoder_with_the_name_of_the_head_is_refused(encoder: Path, tmp_path: Path) -> None:
    mine = Path(shutil.copy(encoder, tmp_path / "keypoint.safetensors"))
    shutil.copy(encoder.with_suffix(".json"), tmp_path / "keypoint.json")
    with pytest.raises(UserError, match=r"has the name of the file .* any but keypoint\.safe"):
        train("keypoint", tmp_path, mine)
    assert mine.read_bytes() == encoder.read_bytes()


def test_a_folder_with_another_run_is_refused(encoder: Path, tmp_path: Path) -> None:
    train("keypoint", tmp_path / "out", encoder, epochs=1)
    last = r"last\.ckpt: is from a run with other values of"
    with pytest.raises(UserError, match=rf"{last} epochs;"):
        train("keypoint", tmp_path / "out", encoder, epochs=2)
    state = tmp_path / "out" / FOLDER / "tokens.json"
    cached = state.read_bytes()
    with pytest.raises(UserError, match=rf"{last} data, seed;"):
        train("keypoint", tmp_path / "out", encoder, epochs=1, seed=5)
    assert state.read_bytes() == cached
    with pytest.raises(UserError, match=rf"{last} data, kind;"):
        train("behavior_cloning", tmp_path / "out", encoder, epochs=1)
    (tmp_path / "out" / CHECKPOINTS / LAST).write_bytes(b"damaged")
    with pytest.raises(UserError, match=r"last\.ckpt: is no checkpoint of `keypush`; delete it"):
        train("keypoint", tmp_path / "out", encoder, epochs=1)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"heads": 3}, "heads is 3; allowed: divisors of 128"),
        ({"batch": 0}, "batch is 0; allowed: 1 to 65536"),
        ({"learning_rate": float("nan")}, "learning_rate is nan; allowed"),
        ({"precision": "16"}, "precision is '16'; allowed: 32, bf16"),
        ({"accelerator": "abacus"}, "accelerator is 'abacus'; allowed: cpu, gpu, auto"),
        ({"label": "guessed"}, "label is 'guessed'; allowed: measured, analytic"),
        ({"held_out_objects": ["kettle"]}, "held_out_objects has kettle; allowed: block, book"),
    ],
)
def test_bad_settings_are_named(
    change: dict[str, Any], message: str, encoder: Path, tmp_path: Path
) -> None:
    with pytest.raises(UserError, match=message):
        train("keypoint", tmp_path / "out", encoder, **change)
