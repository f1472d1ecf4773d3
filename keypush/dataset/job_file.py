"""What a job's files say: scenario.yaml and job.yaml, in its folder and in a data set's meta/."""

from pathlib import Path
from typing import Any

from keypush.errors import UserError, one_line
from keypush.yaml_text import parse_yaml

USER_OBJECTS = "user_objects_sha256"
"""Field of job.yaml: one digest of all of the user's own objects, where there are some."""


def read_yaml(path: Path) -> dict[str, Any]:
    """Reads a mapping.

    Raises:
        UserError: the file is missing or holds no mapping.
    """
    try:
        content = parse_yaml(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, UserError) as error:
        raise UserError(
            f"{path}: cannot be read: {one_line(error)}; allowed: the file of a job"
        ) from error
    if not isinstance(content, dict):
        raise UserError(f"{path}: holds no mapping; allowed: the file of a job")
    return content


def read_job(path: Path) -> tuple[list[str], int]:
    """Reads the objects of a job, and how many episodes each has.

    Raises:
        UserError: the file is missing, or does not say.
    """
    job = read_yaml(path)
    objects, episodes = job.get("objects"), job.get("episodes")
    if not (isinstance(objects, list) and objects and isinstance(episodes, int) and episodes > 0):
        raise UserError(
            f"{path}: objects is {objects!r} and episodes {episodes!r}; allowed: names of objects, "
            "and a whole number above 0"
        )
    return [str(name) for name in objects], episodes


def read_own_objects_digest(path: Path) -> str | None:
    """Reads the digest of the user's own objects; None where the job had none.

    Raises:
        UserError: the file is missing.
    """
    digest = read_yaml(path).get(USER_OBJECTS)
    return None if digest is None else str(digest)
