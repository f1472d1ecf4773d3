"""Small data, short settings, and ablations whose errors are given by a formula."""

from collections.abc import Callable
from pathlib import Path

from keypush.learning.ablation.config import AblationConfig, AblationHead
from keypush.learning.ablation.results import Ablation, Encoder, Epoch, Training
from keypush.learning.ablation.settings import SETTINGS, SHAPES, Setting
from keypush.learning.pretraining.config import PretrainConfig
from keypush.objects.catalogue import catalogue_names
from tests.learning.synthetic import write_data

EPOCHS = 3
HELD_OUT = ("telephone", "bowl", "toy_car", "lamp_base")


def write_small_data(folder: Path, *, without: str = "", episodes: int = 3) -> Path:
    """Writes a few episodes of the 16 objects, or of all but one."""
    names = [name for name in catalogue_names("train") if name != without]
    return write_data(folder, [(name, 1.0) for name in names], episodes)


def short_config(**head: int) -> AblationConfig:
    """Settings of trainings that take moments."""
    small = {"rows_per_object": 8, "epochs": 2, "batch": 32, "clouds_per_object": 2, **head}
    return AblationConfig(
        seeds=(0,),
        head=AblationHead(**small),  # type: ignore[arg-type]  # all of them are whole numbers
        pretraining=PretrainConfig(
            epochs=2, samples_per_epoch=64, batch=32, clouds_per_object=2, validation_samples=16
        ),
    )


def made_up(error: Callable[[Setting, int], float], seeds: tuple[int, ...] = (0, 1, 2)) -> Ablation:
    """Returns an ablation with given errors, m, on held-out objects after the last epoch."""
    return Ablation(
        seeds=seeds,
        encoders=tuple(
            Encoder(shape=shape, trained_objects={"random_scenes": 0.9},
                    held_out_objects={"random_scenes": 0.8})
            for shape in SHAPES
        ),
        trainings=tuple(
            Training(
                setting=setting,
                seed=seed,
                epochs=tuple(
                    _epoch(error(setting, seed) * (1 + (EPOCHS - k) / EPOCHS), k)
                    for k in range(1, EPOCHS + 1)
                ),
                objects={name: error(setting, seed) + 1e-3 * i for i, name in enumerate(HELD_OUT)},
            )
            for setting in SETTINGS
            for seed in seeds
        ),
        provenance={
            "data": {
                "objects": catalogue_names("train"), "held_out_objects": list(HELD_OUT),
                "trained_rows": 1200, "rows": 5000,
            },
            "settings": {"pretraining.epochs": 2, "pretraining.samples_per_epoch": 64},
            "git_revision": "unknown",
            "command": ["keypush", "ablate"],
        },
    )  # fmt: skip


def _epoch(error: float, number: int) -> Epoch:
    return Epoch(
        learning_rate=4e-3 / number,
        train_mse=1e-4 / number,
        validation_error=0.8 * error,
        held_out_error=error,
        held_out_mse=error**2,
    )
