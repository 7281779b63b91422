"""`linecad convert`: a photo to a scene and CAD files."""

import argparse
import math
from pathlib import Path
from typing import TYPE_CHECKING

from linecad.cli.arguments import (
    add_camera,
    add_confidence,
    add_depth,
    add_detail,
    add_groups,
    add_loudness,
    add_main,
    add_outputs,
    add_reconstruction,
    add_scale,
    options_of,
    wanted_of,
)
from linecad.cli.checks import check_outputs, check_some
from linecad.cli.former import add_former
from linecad.cli.progress import ProgressDisplay

if TYPE_CHECKING:
    from linecad.cli.arguments import Commands
    from linecad.scene import Scene


def add_to(commands: "Commands") -> None:
    """Add the command."""
    command = commands.add_parser(
        "convert",
        help="a photo to a scene and CAD files",
        description="Reconstruct the lines and planes of a photo and write them.",
        epilog="example: linecad convert facade.jpg --camera facade.json -o facade.step -o facade.png",
    )
    command.set_defaults(run=run)
    command.add_argument("photo", type=Path, metavar="PHOTO")
    add_outputs(command)
    add_camera(command)
    command.add_argument(
        "--corrections", type=Path, metavar="FILE", help="annotations of lines and crossings, made with linecad edit"
    )
    add_depth(command)
    add_scale(command)
    add_confidence(command)
    add_detail(command)
    add_groups(command)
    add_main(command)
    add_reconstruction(command, "any other option, of the reconstruction or a format")
    add_loudness(command)
    add_former(command)


def run(parsed: argparse.Namespace) -> int:
    """Convert one photo."""
    check_some(parsed.output)
    options, values = options_of(parsed, parsed.output)
    check_outputs(parsed.output, [parsed.photo, parsed.camera, parsed.corrections, parsed.depth])
    from linecad.convert import Conversion

    conversion = Conversion(
        parsed.camera, parsed.focal, options, values, parsed.corrections, parsed.depth, wanted_of(parsed)
    ).checked()
    with ProgressDisplay(parsed.quiet, parsed.verbose) as show:
        show.stage("reading the photo")
        photo = conversion.read(parsed.photo)
        scene = conversion.reconstruct(photo, show.progress, show.stage)
        scene = conversion.write(scene, photo, parsed.photo, parsed.output, show.stage)
    print("\n".join(_summary(scene)))
    return 0


def _summary(scene: "Scene") -> list[str]:
    """What came out. The status is the program's; which crossings are real was decided after it."""
    from linecad.camera.text import summary

    crossings, solve = scene.intersections, scene.solve
    gap = f"{solve.gap:.2%}" if math.isfinite(solve.gap) else "unknown"
    lines = [
        f"{len(scene.lines)} lines, {int(crossings.real.sum())} of {len(crossings)} crossings real, "
        f"{len(scene.planes)} planes; program: {solve.status}, gap {gap}"
    ]
    if scene.certainty is not None:
        lines.append(summary(scene.camera, scene.certainty))
    return lines + [f"note: {note}" for note in scene.remarks]
