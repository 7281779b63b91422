"""`linecad batch`: many photos, on all cores or a cluster."""

import argparse
import time
from pathlib import Path
from typing import TYPE_CHECKING

from linecad.cli.arguments import (
    add_camera,
    add_camera_height,
    add_confidence,
    add_depth_maps,
    add_detail,
    add_groups,
    add_loudness,
    add_reconstruction,
    count,
    options_of,
    positive,
    wanted_of,
)
from linecad.cli.former import add_former
from linecad.cli.progress import ProgressDisplay

if TYPE_CHECKING:
    from linecad.batch.record import Row
    from linecad.batch.run import Progress
    from linecad.cli.arguments import Commands


def add_to(commands: "Commands") -> None:
    """Add the command."""
    command = commands.add_parser(
        "batch",
        help="many photos, on all cores or a cluster; goes on where it was stopped",
        description="Convert many photos into a folder, with a record, a page and a summary (docs/guide/batch.md).",
        epilog="example: linecad batch survey/ -o models --format step,usdz,png --camera camera.json",
    )
    command.set_defaults(run=run)
    command.add_argument("photos", nargs="+", metavar="PHOTO|FOLDER|GLOB")
    command.add_argument("-o", "--output", type=Path, required=True, metavar="DIR", help="made when it is not there")
    command.add_argument(
        "--format", type=_suffixes, default=(".json", ".png"), metavar="FORMAT[,FORMAT]",
        help="what is made of each photo (json,png); see linecad export --formats",
    )  # fmt: skip
    _add_means(command)
    add_camera(command)
    add_depth_maps(command)
    add_camera_height(command)
    add_confidence(command)
    add_detail(command)
    add_groups(command)
    add_reconstruction(command, "any other option, of the reconstruction or a format")
    add_loudness(command)
    add_former(command)


def _add_means(command: argparse.ArgumentParser) -> None:
    """With what the batch works."""
    command.add_argument("--workers", type=count, metavar="N", help="photos at a time (as cores and memory allow)")
    command.add_argument(
        "--photo-limit", type=positive, metavar="S",
        help="seconds after which a photo is given up (3 times --time-limit and 10 minutes)",
    )  # fmt: skip
    command.add_argument(
        "--memory-limit", type=count, metavar="MB", help="memory of one photo (its share of what is free)"
    )
    command.add_argument("--scheduler", metavar="ADDRESS", help="of a Dask cluster, such as tcp://10.0.0.1:8786")
    command.add_argument(
        "--shared-files", action="store_true", help="the cluster sees the same folders: no photo travels"
    )


def run(parsed: argparse.Namespace) -> int:
    """Convert many photos."""
    from linecad.batch.start import Means, make_plan, run_plan
    from linecad.batch.summary import bar, line, table
    from linecad.convert import Conversion

    means = Means(parsed.workers, parsed.scheduler, parsed.shared_files, parsed.photo_limit, parsed.memory_limit)
    options, values = options_of(parsed, [Path(f"photo{suffix}") for suffix in parsed.format])
    conversion = Conversion(parsed.camera, parsed.focal, options, values, wanted=wanted_of(parsed))
    plan, workers = make_plan(parsed.photos, parsed.output, parsed.format, conversion, means, parsed.depth_maps)
    with ProgressDisplay(parsed.quiet, parsed.verbose) as show:
        where = f"with {workers} at a time" if workers else f"on {parsed.scheduler}"
        mapped = f", {len(plan.maps)} of them with a depth map," if plan.maps else ""
        show.stage(f"{len(plan.photos)} photos{mapped} {where}, at most {plan.limits.memory_mb} MiB each")
        began = time.monotonic()

        def on_row(progress: "Progress", row: "Row | None") -> None:
            if row is not None:
                show.line(line(progress, row), row.outcome.status != "done")
            show.bar(bar(progress, time.monotonic() - began))

        result = run_plan(plan, workers, means, on_row)
    print(table(result))
    print(f"page: {plan.folder / 'index.html'}")
    return 1 if result.progress.failed else 0


def _suffixes(text: str) -> tuple[str, ...]:
    from exporters.formats import FORMATS, SCENE_FILE

    suffixes = tuple(dict.fromkeys(f".{name.strip().lower().removeprefix('.')}" for name in text.split(",")))
    known = (SCENE_FILE, *FORMATS)
    for suffix in suffixes:
        if suffix not in known:
            raise argparse.ArgumentTypeError(f"{suffix[1:]!r} is no format; use {', '.join(s[1:] for s in known)}")
    return suffixes
