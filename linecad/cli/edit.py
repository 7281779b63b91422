"""`linecad edit`: the page."""

import argparse
import contextlib
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from linecad.cli.arguments import add_camera, add_depth, add_loudness, add_reconstruction, reconstruction_of
from linecad.cli.checks import check_outputs
from linecad.cli.former import add_former
from linecad.cli.progress import ProgressDisplay
from linecad.errors import LinecadError

if TYPE_CHECKING:
    from linecad.camera.photo import Photo
    from linecad.cli.arguments import Commands

LARGEST_PORT = 65_535


def add_to(commands: "Commands") -> None:
    """Add the command."""
    command = commands.add_parser(
        "edit",
        help="the page: look, correct, solve again, label, export",
        description="Open a local page on a photo; its address is the first line on stdout. Ctrl-C ends it.",
        epilog="example: linecad edit facade.jpg --camera facade.json",
    )
    command.set_defaults(run=run)
    command.add_argument("input", type=Path, metavar="PHOTO|SCENE.json", help="a photo, or the scene file of one")
    command.add_argument(
        "-o", "--output", type=Path, metavar="FILE",
        help="corrections file, read if it is there (beside the photo: PHOTO.corrections.json)",
    )  # fmt: skip
    command.add_argument(
        "--labels", type=Path, metavar="FILE", help="also write the labels of crossings, for linecad evaluate"
    )
    command.add_argument("--port", type=_port, default=0, metavar="N", help="port on 127.0.0.1 (any free one)")
    command.add_argument("--no-browser", action="store_true", help="only print the address")
    command.add_argument("--photo", type=Path, metavar="PHOTO", help="the photo of a scene file (else looked for)")
    add_camera(command)
    add_depth(command)
    add_reconstruction(command, "any other option of the reconstruction")
    add_loudness(command)
    add_former(command)


def run(parsed: argparse.Namespace) -> int:
    """Serve the page."""
    options = reconstruction_of(parsed, parsed.option)
    from linecad.corrections.file import SUFFIX
    from linecad.depth.for_photo import check_depth_options
    from linecad.editing.labelling import check_labels
    from linecad.editing.run import EditOptions, edit

    check_depth_options(options, parsed.depth is not None)
    with ProgressDisplay(parsed.quiet, parsed.verbose) as show:
        show.stage("reading the photo")
        photo, path = _photo_to_edit(parsed)
        output = parsed.output or path.with_name(path.name + SUFFIX)
        outputs = [output, *([parsed.labels] if parsed.labels else [])]
        check_outputs(outputs, [parsed.input, path, parsed.camera, parsed.depth])
        if parsed.labels:
            check_labels(parsed.labels, path, parsed.camera)

        def ready(address: str) -> None:
            show.finish()
            print(address, flush=True)
            if not parsed.no_browser:
                import webbrowser  # takes as long to load as all the rest of the command line

                webbrowser.open(address)

        with contextlib.suppress(KeyboardInterrupt):  # the way to end it
            chosen = EditOptions(output, parsed.port, options, parsed.labels, parsed.camera, parsed.depth)
            edit(photo, chosen, ready, show.stage)
    return 0


def _photo_to_edit(parsed: argparse.Namespace) -> "tuple[Photo, Path]":
    """The photo that is named, or that of the scene that is named, and where it lies."""
    from exporters.formats import SCENE_FILE
    from linecad.camera.distortion import open_photo

    if parsed.input.suffix.lower() != SCENE_FILE:
        if parsed.photo is not None:
            raise LinecadError("--photo is for scene files; the photo is named already")
        return open_photo(parsed.input, parsed.camera, parsed.focal), parsed.input
    from linecad.camera.reread import check_size, find_beside, reread_photo
    from linecad.io.scene_file import read_scene

    scene = read_scene(parsed.input)
    path = parsed.photo or find_beside(scene.photo, parsed.input)
    if path is None or not path.is_file():
        path = path or parsed.input.parent / Path(scene.photo).name
        raise LinecadError(f"{path} is not there, the photo of {parsed.input}; name it with --photo")
    if parsed.focal or (parsed.camera is None and not scene.camera.is_given):
        # What was estimated from the photo is estimated again, so that its standard errors are known.
        photo = open_photo(path, None, parsed.focal)
        check_size(photo, path, scene.camera)
        return photo, path
    photo = reread_photo(path, scene.photo, scene.camera, parsed.camera)
    # Without a calibration the pixels are those of the file, so the scene's own camera is theirs.
    return (photo if parsed.camera else replace(photo, camera=scene.camera)), path


def _port(text: str) -> int:
    if not text.isdecimal() or not 0 <= int(text) <= LARGEST_PORT:
        raise argparse.ArgumentTypeError(f"{text!r} is no port; give a number from 1 to {LARGEST_PORT}")
    return int(text)
