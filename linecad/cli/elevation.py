"""`linecad elevation`: a facade of a scene, or its plan, drawn at scale."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from linecad.cli.arguments import (
    add_confidence,
    add_detail,
    add_length,
    add_loudness,
    add_option,
    identity,
)
from linecad.cli.checks import check_kept, check_outputs, check_some
from linecad.cli.progress import ProgressDisplay

if TYPE_CHECKING:
    from collections.abc import Callable

    from exporters.formats import Format
    from exporters.options import Value
    from linecad.cli.arguments import Commands
    from linecad.scene import Scene


def add_to(commands: "Commands") -> None:
    """Add the command."""
    command = commands.add_parser(
        "elevation",
        help="a facade of a scene, or its plan, drawn at scale",
        description="Draw a facade of a scene from the front, or its plan, at scale, with dimensions.",
        epilog="example: linecad elevation facade.json -o front.pdf --camera-height 1.6 --scale 1:50 --paper A2",
    )
    command.set_defaults(run=run)
    command.add_argument("scene", type=Path, metavar="SCENE.json")
    command.add_argument(
        "-o", "--output", type=Path, action="append", default=[], metavar="OUT",
        help="file to write: .svg, .pdf, .dxf or .tif; repeat for more",
    )  # fmt: skip
    command.add_argument("--plan", action="store_true", help="the walls from above, in place of a facade")
    which = command.add_mutually_exclusive_group()
    which.add_argument("--plane", type=identity, metavar="ID", help="the facade in this plane of the scene file")
    which.add_argument("--facade", type=identity, metavar="N", help="a facade by its size, 0 is the largest (0)")
    command.add_argument("--scale", metavar="1:N", help="the scale of the drawing (the largest usual one that fits)")
    command.add_argument(
        "--paper", type=str.upper, choices=("A4", "A3", "A2", "A1", "A0"), metavar="SIZE",
        help="A4 to A0 (the smallest that the scale fits on, A3 without a scale)",
    )  # fmt: skip
    add_length(command)
    command.add_argument("--photo", type=Path, metavar="PHOTO", help="the scene's photo (else looked for)")
    command.add_argument(
        "--camera", type=Path, metavar="FILE", help="the photo's calibration, if it was given to convert"
    )
    add_confidence(command)
    add_detail(command)
    add_option(command, "an option of the drawing")
    add_loudness(command)


def run(parsed: argparse.Namespace) -> int:
    """Draw it."""
    check_some(parsed.output)
    from exporters.formats import drawing_format
    from exporters.options import read_options
    from linecad.camera.reread import find_beside
    from linecad.confidence import keep_probable
    from linecad.io.scene_file import read_scene
    from linecad.model.choice import keep_drawn
    from linecad.model.scale import set_scale
    from linecad.outputs import PhotoOfScene, pixels_for, write_outputs

    rows = {path: drawing_format(path, parsed.plan) for path in parsed.output}
    values = read_options(parsed.option, {path.suffix: row.options for path, row in rows.items()})
    check_outputs(parsed.output, [parsed.scene, parsed.photo, parsed.camera])
    with ProgressDisplay(parsed.quiet, parsed.verbose) as show:
        show.stage("reading the scene")
        scene = read_scene(parsed.scene)
        check_kept(parsed.output, [find_beside(scene.photo, parsed.scene)])
        if parsed.known is not None:
            scene = set_scale(scene, parsed.known)  # first, because the known line itself may be left out
        if parsed.confidence is not None:
            scene = keep_probable(scene, parsed.confidence)
        scene = keep_drawn(scene, parsed.detail)
        values |= _chosen(parsed, scene)
        photo = PhotoOfScene(parsed.photo, parsed.camera, parsed.scene)
        format_of: Callable[[Path], Format] = rows.__getitem__
        pixels = pixels_for(scene, parsed.output, values, photo, show.note, format_of)
        write_outputs(scene, pixels, parsed.output, values, show.stage, format_of)
    return 0


def _chosen(parsed: argparse.Namespace, scene: "Scene") -> "dict[str, Value]":
    """What arguments say of the options of drawings. Raises OutputError for a plane that is no facade."""
    from exporters.drawings.facades import number_of_plane
    from exporters.format_options import DRAWING_SCALE, FACADE, PAPER
    from exporters.model import build_model

    number = parsed.facade if parsed.plane is None else number_of_plane(build_model(scene), parsed.plane)
    given = {FACADE: number, DRAWING_SCALE: parsed.scale, PAPER: parsed.paper}
    return {key: value for key, value in given.items() if value is not None}
