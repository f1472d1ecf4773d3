"""What is refused before hours are spent."""

import json
from pathlib import Path
from typing import Any

from keypush.atomic_file import write_whole
from keypush.errors import UserError
from keypush.learning.ablation.config import AblationConfig
from keypush.learning.clouds import surface_samplers
from keypush.learning.rows import Rows
from keypush.objects.catalogue import catalogue_names

_SETTINGS_FILE = "settings.json"


def check_objects(data_dir: Path, rows: Rows, config: AblationConfig) -> tuple[str, ...]:
    """Returns the objects of the data, sorted.

    Raises:
        UserError: they are not those that are wanted, an object is held out twice, or their files
            are damaged.
    """
    held_out = config.held_out_objects
    twice = sorted(name for name in set(held_out) if held_out.count(name) > 1)
    if twice:
        raise UserError(f"held_out_objects has {', '.join(twice)} twice; allowed: each once")
    names = {name for name, _ in rows.objects}
    wanted = set(catalogue_names("train"))
    if not config.held_out_objects and names != wanted:
        missing, others = (", ".join(sorted(some)) for some in (wanted - names, names - wanted))
        found = f"no successful episode of {missing}" if missing else f"also {others}"
        raise UserError(
            f"data {data_dir}: has {found}; allowed: the {len(wanted)} objects of train, or any "
            "with held_out_objects of your own"
        )
    surface_samplers([(name, 1.0) for name in sorted(names)])
    return tuple(sorted(names))


def claim_folder(out_dir: Path, identity: dict[str, Any]) -> None:
    """Makes the folder this ablation's own.

    Raises:
        UserError: it is another one's.
    """
    path = out_dir / _SETTINGS_FILE
    text = json.dumps(identity, indent=1) + "\n"
    if not path.exists():
        write_whole(path, text.encode())
        return
    try:
        found, wanted = json.loads(path.read_text(encoding="utf-8")), json.loads(text)
        changed = sorted(n for n in {*found, *wanted} if found.get(n) != wanted.get(n))
    except (OSError, ValueError, TypeError, AttributeError) as error:
        raise UserError(f"{path}: is damaged; allowed: another output folder") from error
    if changed:
        raise UserError(
            f"{path}: is from an ablation with other values of {', '.join(changed)}; allowed: the "
            "same values, or another output folder"
        )
