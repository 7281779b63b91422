"""`linecad camera`: the camera of a photo alone, and how sure it is."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from linecad.cli.arguments import add_camera, add_loudness
from linecad.cli.checks import check_outputs
from linecad.cli.progress import ProgressDisplay

if TYPE_CHECKING:
    from linecad.cli.arguments import Commands


def add_to(commands: "Commands") -> None:
    """Add the command."""
    command = commands.add_parser(
        "camera",
        help="the camera of a photo alone, and how sure it is",
        description="Find the camera and the Manhattan frame of a photo, print or write them (docs/guide/camera.md).",
        epilog="example: linecad camera facade.jpg -o facade.camera.json -o facade.camera.png",
    )
    command.set_defaults(run=run)
    command.add_argument("photo", type=Path, metavar="PHOTO")
    command.add_argument(
        "-o", "--output", type=Path, action="append", default=[], metavar="OUT",
        help="file to write: .json, which --camera reads, .fspy or .png, a picture; repeat for more",
    )  # fmt: skip
    add_camera(command)
    add_loudness(command)


def run(parsed: argparse.Namespace) -> int:
    """Find one camera."""
    from linecad.camera.camera_file import check_suffix, write_camera
    from linecad.camera.report import find_camera
    from linecad.camera.text import summary, table

    for path in parsed.output:
        check_suffix(path)
    check_outputs(parsed.output, [parsed.photo, parsed.camera])
    with ProgressDisplay(parsed.quiet, parsed.verbose) as show:
        report = find_camera(parsed.photo, parsed.camera, parsed.focal, show.stage)
        for path in parsed.output:
            show.stage(f"writing {path}")
            write_camera(report, path)
    if parsed.output:
        print("\n".join([summary(report.camera, report.certainty), *(f"note: {note}" for note in report.notes)]))
    else:
        print("\n".join(table(report)))
    return 0
