"""`linecad addon`: linecad inside Blender and FreeCAD."""

import argparse
import sys
import sysconfig
from pathlib import Path
from typing import TYPE_CHECKING

from linecad import __version__
from linecad.cli.checks import check_outputs

if TYPE_CHECKING:
    from linecad.cli.arguments import Commands

PROGRAMS = ("blender", "freecad")  # as exporters.addons.write has them


def add_to(commands: "Commands") -> None:
    """Add the command."""
    command = commands.add_parser(
        "addon",
        help="linecad inside Blender or FreeCAD",
        description="Write the add-on for Blender or the macro for FreeCAD, which run this command on a photo, show "
        "its progress and import the model (docs/guide/blender.md, docs/guide/freecad.md).",
        epilog="example: linecad addon blender",
    )
    command.set_defaults(run=run)
    command.add_argument("program", choices=PROGRAMS, help="the program to write it for")
    command.add_argument(
        "-o", "--output", type=Path, default=Path(), metavar="OUT",
        help="file to write, or the folder for it (this one; linecad-blender.zip, linecad.FCMacro)",
    )  # fmt: skip


def run(parsed: argparse.Namespace) -> int:
    """Write one add-on."""
    from exporters.addons.write import ADDONS, write_addon

    addon = ADDONS[parsed.program]
    path = parsed.output / addon.file if parsed.output.is_dir() else parsed.output
    check_outputs([path], [])
    write_addon(parsed.program, path, __version__, _own_command())
    print(f"{path} is written; {addon.how}")
    return 0


def _own_command() -> str:
    """The path of this command, for programs that do not see it on PATH; empty where it is not installed."""
    name = "linecad.exe" if sys.platform == "win32" else "linecad"
    path = Path(sysconfig.get_path("scripts")) / name
    return str(path) if path.is_file() else ""
