"""`keypush dataset`: what a data set holds, whether it is whole, and what can be made of it."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, ClassVar

import tyro
from tyro.conf import subcommand

from keypush.cli.output import check_output_file, prepare_output_dir, write_output
from keypush.errors import UserError


@dataclass(kw_only=True)
class Info:
    """Tell what a data set holds: episodes, frames, success, objects, histograms."""

    data: tyro.conf.Positional[Path]
    """Folder of the data set."""
    json: bool = False
    """Print one JSON object instead of text."""

    def run(self) -> None:
        """Runs the verb."""
        from keypush.dataset.read import open_dataset
        from keypush.dataset.statistics import dataset_statistics, tell_statistics

        found = dataset_statistics(open_dataset(self.data))
        print(json.dumps(found) if self.json else "\n".join(tell_statistics(found)))


@dataclass(kw_only=True)
class Check:
    """Check that a data set is whole and true to itself; exits with status 1 if it is not.

    Checked are: every episode there once, numbering, times, finite numbers, unit quaternions,
    labels that follow from the contacts and lie on the object.
    """

    data: tyro.conf.Positional[Path]
    """Folder of the data set."""
    json: bool = False
    """Print one JSON object, {"ok": true, CHECK: {"ok": true, ...}}, instead of text."""

    def run(self) -> int:
        """Runs the verb; returns the exit status."""
        from keypush.dataset.check import check_dataset
        from keypush.dataset.read import open_dataset

        checks = check_dataset(open_dataset(self.data))
        ok = all(check.ok for check in checks.values())
        if self.json:
            print(json.dumps({"ok": ok, **{name: vars(c) for name, c in checks.items()}}))
        else:
            for name, check in checks.items():
                told = f"found {check.found}; allowed: {check.allowed}"
                print(f"{'ok' if check.ok else 'WRONG':<6}{name}: {told}")
        return 0 if ok else 1


@dataclass(kw_only=True)
class View:
    """Write an episode as a self-contained page, replayed from its frames alone."""

    data: tyro.conf.Positional[Path]
    """Folder of the data set."""
    episode: tyro.conf.Positional[int]
    """Number of the episode in the data set."""
    out: Path = Path("episode.html")
    """File to write."""

    def run(self) -> None:
        """Runs the verb."""
        from keypush.dataset.read import open_dataset
        from keypush.recording.replay import replay_episode

        dataset = open_dataset(self.data)
        check_output_file(self.out)
        write_output(self.out, replay_episode(dataset, self.episode))
        print(f"written: {self.out}")


@dataclass(kw_only=True)
class Export:
    """Copy a data set, in the same format, with the point clouds added to every frame."""

    data: tyro.conf.Positional[Path]
    """Folder of the data set."""
    out: Path
    """Folder for the copy."""
    clouds: bool = False
    """Add the clouds that the sensor measured, 6 kB for each frame."""

    def run(self) -> None:
        """Runs the verb."""
        if not self.clouds:
            raise UserError("--clouds is not given; allowed: --clouds, there is no other export")
        from keypush.dataset.export import check_export, export_clouds
        from keypush.dataset.read import open_dataset

        dataset = open_dataset(self.data)
        check_export(dataset, self.out)
        from keypush.rollout.folder_lock import hold_folder

        out = prepare_output_dir(self.out)
        with hold_folder(out):
            export_clouds(dataset, out)
        print(f"{len(dataset.episodes)} episodes, {dataset.frames} frames in {self.out}")


Action = (
    Annotated[Info, subcommand("info")]
    | Annotated[Check, subcommand("check")]
    | Annotated[View, subcommand("view")]
    | Annotated[Export, subcommand("export")]
)


@dataclass(kw_only=True)
class Dataset:
    """Tell, check, view and export data sets of `keypush collect`."""

    action: tyro.conf.OmitSubcommandPrefixes[Action]

    after_interrupt: ClassVar[str] = "nothing was written"

    def run(self) -> int | None:
        """Runs the verb; returns its exit status, if not 0."""
        return self.action.run()
