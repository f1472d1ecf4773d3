"""Makes the built-in objects of the catalogue anew, or those that are named."""

import shutil
import sys

from tqdm import tqdm

from keypush.objects.asset import write_asset
from keypush.objects.build import BuildOptions, build_asset
from keypush.objects.catalogue import catalogue
from keypush.resources import models_dir


def main() -> None:
    """Writes `models/objects/NAME` for every name."""
    folder = models_dir() / "objects"
    for name in tqdm(sys.argv[1:] or list(catalogue()), unit="object", disable=None):
        entry = catalogue()[name]
        mesh = entry.generate()
        made = {"generator": entry.generator, "parameters": dict(entry.parameters)}
        asset = build_asset(name, mesh, BuildOptions(up="z", colour=entry.colour), made)
        shutil.rmtree(folder / name, ignore_errors=True)
        write_asset(asset, folder / name)


if __name__ == "__main__":
    main()
