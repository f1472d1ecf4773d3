"""Where the files that ship with keypush lie, in a checkout and in an installed wheel."""

from pathlib import Path

_PACKAGE = Path(__file__).resolve().parent


def models_dir() -> Path:
    """Returns the folder with robot and table models and trained weights.

    A wheel carries it inside the package; a checkout has it beside the package.
    """
    inside = _PACKAGE / "models"
    return inside if inside.is_dir() else _PACKAGE.parent / "models"


def weights_dir() -> Path:
    """Returns the folder of the trained weights that ship with keypush."""
    return models_dir() / "weights"
