"""`linecad export`: a scene file to CAD files."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from linecad.cli.arguments import (
    add_confidence,
    add_detail,
    add_groups,
    add_loudness,
    add_main,
    add_option,
    add_outputs,
    add_scale,
    wanted_of,
)
from linecad.cli.checks import check_kept, check_outputs, check_some
from linecad.cli.progress import ProgressDisplay
from linecad.errors import OutputError

if TYPE_CHECKING:
    from linecad.cli.arguments import Commands


def add_to(commands: "Commands") -> None:
    """Add the command."""
    command = commands.add_parser(
        "export",
        help="a scene file to CAD files",
        description="Write a scene, as `linecad convert` saved it, in other formats.",
        epilog="example: linecad export facade.json -o facade.dxf -o facade.usdz",
    )
    command.set_defaults(run=run)
    command.add_argument("scene", type=Path, metavar="SCENE.json", nargs="?")
    add_outputs(command)
    command.add_argument(
        "--photo", type=Path, metavar="PHOTO", help="the scene's photo, for formats that show it (else looked for)"
    )
    command.add_argument(
        "--camera", type=Path, metavar="FILE", help="the photo's calibration, for scene files of earlier versions"
    )
    add_scale(command)
    add_confidence(command)
    add_detail(command)
    add_groups(command)
    add_main(command)
    add_option(command, "an option of a format")
    command.add_argument("--formats", action="store_true", help="list the formats and end")
    add_loudness(command)


def run(parsed: argparse.Namespace) -> int:
    """Write a scene in other formats, or list them."""
    if parsed.formats:
        return _print_formats()
    if parsed.scene is None:
        raise OutputError("no scene file was given; name the .json that `linecad convert` wrote")
    check_some(parsed.output)
    from linecad.camera.reread import find_beside
    from linecad.io.scene_file import read_scene
    from linecad.outputs import PhotoOfScene, format_values, pixels_for, write_outputs

    values = format_values(parsed.output, parsed.option)
    wanted = wanted_of(parsed)
    # The scene file itself may come back, with a scale, where nothing of it would be lost.
    kept = [parsed.photo, parsed.camera, None if wanted.is_whole else parsed.scene]
    check_outputs(parsed.output, kept)
    with ProgressDisplay(parsed.quiet, parsed.verbose) as show:
        show.stage("reading the scene")
        scene = read_scene(parsed.scene)
        check_kept(parsed.output, [find_beside(scene.photo, parsed.scene)])
        scene = wanted.of(scene)
        photo = PhotoOfScene(parsed.photo, parsed.camera, parsed.scene)
        pixels = pixels_for(scene, parsed.output, values, photo, show.note)
        write_outputs(scene, pixels, parsed.output, values, show.stage)
    return 0


def _print_formats() -> int:
    from exporters.formats import FORMATS, SCENE_FILE

    print(f"{SCENE_FILE:6} the scene file, which `linecad export` reads (docs/reference/scene-file.md)")
    for suffix, row in FORMATS.items():
        print(f"{suffix:6} {row.phrase} (in {row.unit})")
        for option in row.options:
            print(f"         --option {option.key}={option.usual}: {option.phrase}; {option.accepted}")
    return 0
