"""Makes the built-in objects of the catalogue anew, or those that are named."""

import shutil

import tyro
from as_command import as_command, check_names
from tqdm import tqdm

from keypush.objects.asset import write_asset
from keypush.objects.build import BuildOptions, build_asset
from keypush.objects.catalogue import catalogue
from keypush.resources import models_dir


def main(names: tyro.conf.Positional[tuple[str, ...]] = ()) -> None:
    """Writes `models/objects/NAME` for every name.

    Args:
        names: of the objects; all by default.
    """
    check_names("object", names, list(catalogue()))
    folder = models_dir() / "objects"
    for name in tqdm(names or list(catalogue()), unit="object", disable=None):
        entry = catalogue()[name]
        mesh = entry.generate()
        made = {"generator": entry.generator, "parameters": dict(entry.parameters)}
        asset = build_asset(name, mesh, BuildOptions(up="z", colour=entry.colour), made)
        shutil.rmtree(folder / name, ignore_errors=True)
        write_asset(asset, folder / name)


if __name__ == "__main__":
    as_command(main)
