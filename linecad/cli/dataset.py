"""`linecad dataset`: made scenes with exact ground truth."""

import argparse
import re
from pathlib import Path
from typing import TYPE_CHECKING

from linecad.cli.arguments import add_loudness, positive
from linecad.cli.progress import ProgressDisplay
from linecad.errors import LinecadError

if TYPE_CHECKING:
    from linecad.cli.arguments import Commands
    from linecad.dataset.depth_maps import MapKind

DEFAULT_PERCENT = 1.2  # what the best network reaches


def add_to(commands: "Commands") -> None:
    """Add the command."""
    command = commands.add_parser(
        "dataset",
        help="street scenes of our own with exact ground truth",
        description="Draw, render and measure scenes; a run that was stopped goes on where it was.",
        epilog="example: linecad dataset scenes --scenes 50 --seed 1 --size 1920x1080",
    )
    command.set_defaults(run=run)
    command.add_argument("folder", type=Path, metavar="DIR")
    command.add_argument("--scenes", type=int, required=True, metavar="N", help="how many scenes the dataset has")
    command.add_argument("--seed", type=int, required=True, metavar="S", help="the same seed gives the same scenes")
    command.add_argument("--size", type=_size, default=(3840, 2160), metavar="WxH", help="of the photos (3840x2160)")
    command.add_argument("--samples", type=int, default=32, metavar="N", help="rays a pixel: time against noise (32)")
    command.add_argument(
        "--depth-maps", type=positive, nargs="?", const=DEFAULT_PERCENT, metavar="PERCENT",
        help=f"also photo.depth.npz, depth as a network would guess it: Cauchy width of the errors ({DEFAULT_PERCENT})",
    )  # fmt: skip
    command.add_argument(
        "--depth-kind", choices=("z", "affine-inverse"), metavar="KIND",
        help="of the depth maps: z (the default), or affine-inverse, disparity with a shift",
    )  # fmt: skip
    add_loudness(command)


def run(parsed: argparse.Namespace) -> int:
    """Make the scenes that are not there yet."""
    from linecad.dataset.make import DatasetOptions, make_dataset

    width, height = parsed.size
    if parsed.depth_kind is not None and parsed.depth_maps is None:
        raise LinecadError("--depth-kind says which depth maps to write, but none are asked for; add --depth-maps")
    share = None if parsed.depth_maps is None else parsed.depth_maps / 100
    kind: MapKind = parsed.depth_kind or "z"
    options = DatasetOptions(parsed.scenes, parsed.seed, width, height, parsed.samples, share, kind)
    with ProgressDisplay(parsed.quiet, parsed.verbose) as show:
        made = make_dataset(parsed.folder, options, show.stage)
    print(f"{made.new} scenes made, {made.kept} were there already, in {parsed.folder}")
    return 0


def _size(text: str) -> tuple[int, int]:
    found = re.fullmatch(r"(\d{1,6})x(\d{1,6})", text)
    if found is None:
        raise argparse.ArgumentTypeError(f"{text!r} is no size; write it like 1920x1080")
    return int(found[1]), int(found[2])
