"""`keypush objects`: what can be pushed, and how to add to it."""

import json
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import tyro
from tyro.conf import subcommand

from keypush.cli.options import OBJECTS
from keypush.cli.output import check_output_file, prepare_output_dir, write_output

if TYPE_CHECKING:
    from keypush.checking.object_checks import Check
    from keypush.objects.asset import ObjectAsset


@dataclass(kw_only=True)
class List:
    """List the objects there are."""

    json: bool = False
    """Print one JSON object instead of a table."""

    def run(self) -> int:
        """Runs the verb; returns the exit status."""
        from rich.console import Console

        from keypush.objects.listing import describe_objects, objects_table

        described, unreadable = describe_objects()
        if self.json:
            print(json.dumps(described))
        else:
            Console().print(objects_table(described))
        for mistake in unreadable:
            print(f"keypush: {mistake}", file=sys.stderr)
        return 2 if unreadable else 0


@dataclass(kw_only=True)
class Show:
    """Show one object: writes OUT/NAME.html, to turn around in a browser, and OUT/NAME.png."""

    name: tyro.conf.Positional[str]
    """Object to show."""
    out: Path = Path("out/objects")
    """Folder for page and picture."""
    open: bool = False
    """Open the page in a browser."""

    def run(self) -> None:
        """Runs the verb."""
        from keypush.objects.library import load_object, make_object
        from keypush.objects.listing import tell_object
        from keypush.recording.object_page import object_page
        from keypush.recording.object_sheet import render_picture

        story = tell_object(load_object(self.name))
        model = make_object(self.name)
        out = prepare_output_dir(self.out)
        page = out / f"{self.name}.html"
        write_output(page, object_page(model, story))
        write_output(out / f"{self.name}.png", render_picture(model))
        for line in story:
            print(line)
        print(f"written: {page} and {out / self.name}.png")
        if self.open:
            import webbrowser

            webbrowser.open(page.resolve().as_uri())


@dataclass(kw_only=True)
class Sheet:
    """Write pictures of many objects on one sheet (PNG), each with its centre of mass."""

    objects: Annotated[str, tyro.conf.arg(metavar=OBJECTS)] = "all"
    """Objects to show."""
    out: Path = Path("objects.png")
    """File to write."""

    def run(self) -> None:
        """Runs the verb."""
        from keypush.objects.library import make_object, parse_object_list
        from keypush.objects.listing import split_of
        from keypush.recording.object_sheet import render_sheet

        names = parse_object_list(self.objects)
        check_output_file(self.out)
        labelled = [
            (make_object(name), f"{name.replace('_', ' ')} ({split_of(name)})") for name in names
        ]
        write_output(self.out, render_sheet(labelled))
        print(f"written: {self.out}")


@dataclass(kw_only=True)
class CheckObjects:
    """Check that objects can be pushed; exits with status 1 if one fails.

    Measured are: closed mesh, volume, inertia, how far what touches is from what is seen, the
    support polygon in every stable pose, a drop from 5 mm, where it tips, and what the arm reaches.
    """

    names: tyro.conf.Positional[tuple[str, ...]] = ()
    """Objects or groups of them; by default all built-in ones."""
    json: bool = False
    """Print one JSON object, {NAME: {"ok": true, ...}}, instead of a table."""

    def run(self) -> int:
        """Runs the verb; returns the exit status."""
        from rich.console import Console
        from tqdm import tqdm

        from keypush.checking.object_checks import check_object
        from keypush.checking.report import checks_table, describe_checks
        from keypush.objects.library import load_object, parse_object_list

        names = parse_object_list(",".join(self.names) or "all")
        checked: dict[str, dict[str, Check]] = {}
        for name in tqdm(names, unit="object", disable=None):
            checked[name] = check_object(load_object(name))
        report = describe_checks(checked)
        if self.json:
            print(json.dumps(report))
        else:
            Console().print(checks_table(checked))
        return 0 if all(line["ok"] for line in report.values()) else 1


@dataclass(kw_only=True)
class Add:
    """Make a pushable object of a mesh file: OBJ, STL, PLY, GLB, glTF or OFF.

    The mesh may be of any size, have holes and several parts; what was done to it is told. The
    object is stored in your data folder and can be used like a built-in one.
    """

    file: tyro.conf.Positional[Path]
    """Mesh file."""
    name: str
    """Name of the object: small letters, digits and _."""
    scale: float = 0.1
    """Diameter of the object's bounding sphere, m."""
    up: Literal["x", "y", "z"] | None = None
    """Axis of the file that points up; by default the object rests as it does likeliest."""
    density: float | None = None
    """Density in kg/m^3."""
    mass: float | None = None
    """Mass in kg; 0.1 where neither it nor the density is given."""

    def run(self) -> None:
        """Runs the verb."""
        from keypush.checking.adding import add_object_file
        from keypush.objects.build import BuildOptions
        from keypush.objects.listing import tell_object

        options = BuildOptions(
            diameter=self.scale, up=self.up, density=self.density, mass=self.mass
        )
        asset, folder = add_object_file(self.file, self.name, options)
        _tell(asset)
        for line in tell_object(asset):
            print(line)
        print(f"written: {folder}")


@dataclass(kw_only=True)
class Remove:
    """Remove an object that was added."""

    name: tyro.conf.Positional[str]
    """Object to remove."""

    def run(self) -> None:
        """Runs the verb."""
        from keypush.objects.library import remove_user_object

        print(f"removed: {remove_user_object(self.name)}")


def _tell(asset: "ObjectAsset") -> None:
    for note in asset.provenance["notes"]:
        print(f"- {note}")
    if left_out := asset.provenance["poses_left_out"]:
        print(f"- resting poses on edges that are hardly felt, left out: {left_out}")


Action = (
    Annotated[List, subcommand("list")]
    | Annotated[Show, subcommand("show")]
    | Annotated[Sheet, subcommand("sheet")]
    | Annotated[CheckObjects, subcommand("check")]
    | Annotated[Add, subcommand("add")]
    | Annotated[Remove, subcommand("remove")]
)


@dataclass(kw_only=True)
class Objects:
    """List, show, check and add the objects that are pushed."""

    action: tyro.conf.OmitSubcommandPrefixes[Action]

    after_interrupt = "nothing was written"

    def run(self) -> int | None:
        """Runs the verb; returns its exit status, if not 0."""
        return self.action.run()
