"""`linecad dataset`: made scenes, and views of given buildings, with exact ground truth."""

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

SIZE, SIZE_OF_VIEWS = (3840, 2160), (1920, 1080)  # px, of drawn scenes and of views of given buildings
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
    command.add_argument("--scenes", type=int, metavar="N", help="how many scenes the dataset has")
    command.add_argument("--seed", type=int, metavar="S", help="the same seed gives the same scenes")
    command.add_argument(
        "--size", type=_size, metavar="WxH", help="of the photos (3840x2160; with --buildings 1920x1080)"
    )
    command.add_argument("--samples", type=int, default=32, metavar="N", help="rays a pixel: time against noise (32)")
    command.add_argument(
        "--depth-maps", type=positive, nargs="?", const=DEFAULT_PERCENT, metavar="PERCENT",
        help=f"also photo.depth.npz, depth as a network would guess it: Cauchy width of the errors ({DEFAULT_PERCENT})",
    )  # fmt: skip
    command.add_argument(
        "--depth-kind", choices=("z", "affine-inverse"), metavar="KIND",
        help="of the depth maps: z (the default), or affine-inverse, disparity with a shift",
    )  # fmt: skip
    kinds = command.add_mutually_exclusive_group()
    kinds.add_argument(
        "--towns", dest="kind", action="store_const", const="town",
        help="streets of several horizontal frames, with sloped roofs, instead of streets, courtyards and rooms",
    )  # fmt: skip
    kinds.add_argument(
        "--gardens", dest="kind", action="store_const", const="garden",
        help="streets of houses behind lawns, hedges, low walls and steps, instead of streets, courtyards and rooms",
    )  # fmt: skip
    command.add_argument(
        "--buildings", type=Path, metavar="FILE", help="polygons of buildings to render; see --cameras"
    )
    command.add_argument("--cameras", type=Path, metavar="FILE", help="the views of these buildings")
    command.add_argument("--views", metavar="NAME[,NAME...]", help="of the cameras, those to render (all)")
    add_loudness(command)


def run(parsed: argparse.Namespace) -> int:
    """Make the scenes that are not there yet."""
    from linecad.dataset.make import DatasetOptions, make_dataset, plan_scenes

    _check_together(parsed)
    share = None if parsed.depth_maps is None else parsed.depth_maps / 100
    kind: MapKind = parsed.depth_kind or "z"
    plan, seed = None, parsed.seed or 0
    if parsed.buildings is not None:
        from linecad.dataset.plans import plan_views

        names = tuple(parsed.views.split(",")) if parsed.views is not None else ()
        plan = plan_views(parsed.buildings, parsed.cameras, seed, names)
    scenes = parsed.scenes if plan is None else len(plan.names)
    width, height = parsed.size or (SIZE if plan is None else SIZE_OF_VIEWS)
    options = DatasetOptions(scenes, seed, width, height, parsed.samples, share, kind)
    if parsed.kind is not None:
        plan = plan_scenes(options, parsed.kind)
    with ProgressDisplay(parsed.quiet, parsed.verbose) as show:
        made = make_dataset(parsed.folder, options, show.stage, plan)
    print(f"{made.new} scenes made, {made.kept} were there already, in {parsed.folder}")
    return 0


def _check_together(parsed: argparse.Namespace) -> None:
    """Raise LinecadError where options do not go together."""
    if parsed.depth_kind is not None and parsed.depth_maps is None:
        raise LinecadError("--depth-kind says which depth maps to write, but none are asked for; add --depth-maps")
    if (parsed.buildings is None) != (parsed.cameras is None):
        raise LinecadError("--buildings and --cameras go together; give both files")
    if parsed.buildings is None:
        if parsed.scenes is None or parsed.seed is None:
            raise LinecadError("--scenes and --seed say what to draw; give both, or --buildings and --cameras")
        if parsed.views is not None:
            raise LinecadError("--views names views of --cameras; give --buildings and --cameras too")
    elif parsed.scenes is not None or parsed.kind is not None:
        raise LinecadError("--buildings renders what is given; leave --scenes, --towns and --gardens out")


def _size(text: str) -> tuple[int, int]:
    found = re.fullmatch(r"(\d{1,6})x(\d{1,6})", text)
    if found is None:
        raise argparse.ArgumentTypeError(f"{text!r} is no size; write it like 1920x1080")
    return int(found[1]), int(found[2])
