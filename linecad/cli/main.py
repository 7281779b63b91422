"""The command line: options, one call into the library, one line of output.

Results go to stdout or files, progress to stderr. Exit codes: 0 done, 1 an error that the user can act on (one line on
stderr), 2 wrong usage. argparse, because it costs nothing to load: `--help` answers at once and without any library.
"""

import argparse
import contextlib
import importlib.util
import math
import re
import shutil
import sys
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn, Self

from linecad import __version__
from linecad.errors import LinecadError, OutputError

if TYPE_CHECKING:
    from exporters.options import Value
    from linecad.batch.record import Row
    from linecad.batch.run import Progress as BatchProgress
    from linecad.camera.photo import Photo
    from linecad.model.scale import Known
    from linecad.options import Options
    from linecad.scene import Scene
    from solver.options import Progress

SCENE_SUFFIX = ".json"
SAME_CAMERA = 1e-9  # of the focal length, by which rounding may change a calibration
LARGEST_PORT = 65_535
LONGEST_ID = 17  # digits; ids are below 2^53
LARGEST_PIXEL = 1e6
GAIN_SECONDS, PAPER_SECONDS = 10.0, 60.0  # of the solver: gain starts near its end, the paper's program does not
LARGEST_EXTENSION = 500.0  # px at 3840 px width; the number of crossings grows with its square


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; the exit code."""
    parsed = _parser().parse_args(arguments)
    try:
        check_packages()
        code: int = parsed.run(parsed)
    except LinecadError as error:
        print(f"linecad: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("linecad: interrupted; a file that was not written yet is as it was before", file=sys.stderr)
        return 1
    return code


def check_packages() -> None:
    """Raise LinecadError when a file of the user's hides one of our packages with a generic name."""
    home = Path(__file__).resolve().parents[2]
    for name in ("solver", "exporters"):
        spec = importlib.util.find_spec(name)
        found = Path(spec.origin).resolve() if spec and spec.origin else None
        if found != home / name / "__init__.py":
            raise LinecadError(
                f"linecad's package '{name}' is hidden by {found or 'nothing installed'}; "
                "start linecad from another folder, or install linecad in an environment of its own"
            )


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(
        prog="linecad", description="From one photo of a Manhattan scene to 3D lines, planes and CAD files."
    )
    parser.add_argument("--version", action="version", version=f"linecad {__version__}")
    commands = parser.add_subparsers(dest="command", required=True)
    _add_convert(commands)
    _add_camera_command(commands)
    _add_batch(commands)
    _add_edit(commands)
    _add_evaluate(commands)
    _add_export(commands)
    _add_dataset(commands)
    return parser


class _Parser(argparse.ArgumentParser):
    """An argument parser that says what is wrong in one line, without the usage."""

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"{self.prog}: {message}; see {self.prog} --help\n")


def _add_convert(commands: "argparse._SubParsersAction[_Parser]") -> None:
    convert = commands.add_parser(
        "convert",
        help="a photo to a scene and CAD files",
        description="Reconstruct the lines and planes of a photo and write them.",
        epilog="example: linecad convert facade.jpg --camera facade.json -o facade.step -o facade.png",
    )
    convert.set_defaults(run=_convert)
    convert.add_argument("photo", type=Path, metavar="PHOTO")
    _add_outputs(convert)
    convert.add_argument(
        "--corrections", type=Path, metavar="FILE", help="what a person said about lines and crossings (linecad edit)"
    )
    _add_camera(convert)
    _add_reconstruction(convert)
    _add_scale(convert)
    _add_loudness(convert)


def _add_camera_command(commands: "argparse._SubParsersAction[_Parser]") -> None:
    command = commands.add_parser(
        "camera",
        help="the camera of a photo alone, and how sure it is",
        description="Find the camera and the Manhattan frame of a photo, print or write them (docs/guide/camera.md).",
        epilog="example: linecad camera facade.jpg -o facade.camera.json -o facade.camera.png",
    )
    command.set_defaults(run=_camera)
    command.add_argument("photo", type=Path, metavar="PHOTO")
    command.add_argument(
        "-o", "--output", type=Path, action="append", default=[], metavar="OUT",
        help="file to write: .json, which --camera reads, .fspy or .png, a picture; may be given again",
    )  # fmt: skip
    _add_camera(command)
    _add_loudness(command)


def _add_edit(commands: "argparse._SubParsersAction[_Parser]") -> None:
    edit = commands.add_parser(
        "edit",
        help="the page: look, correct, solve again, label, export",
        description="Open a local page on a photo; its address is the first line on stdout. Ctrl-C ends it.",
        epilog="example: linecad edit facade.jpg --camera facade.json",
    )
    edit.set_defaults(run=_edit)
    edit.add_argument("input", type=Path, metavar="PHOTO|SCENE.json", help="a photo, or the scene file of one")
    edit.add_argument(
        "-o", "--output", type=Path, metavar="FILE",
        help="corrections file, read if it is there (beside the photo: PHOTO.corrections.json)",
    )  # fmt: skip
    edit.add_argument(
        "--labels", type=Path, metavar="FILE", help="also write the labels of crossings, for linecad evaluate"
    )
    edit.add_argument("--port", type=_port, default=0, metavar="N", help="port on 127.0.0.1 (any free one)")
    edit.add_argument("--no-browser", action="store_true", help="only print the address")
    edit.add_argument("--photo", type=Path, metavar="PHOTO", help="the photo of a scene file (else looked for)")
    _add_camera(edit)
    _add_reconstruction(edit)
    _add_loudness(edit)


def _add_camera(command: argparse.ArgumentParser) -> None:
    """Where the camera comes from."""
    camera = command.add_mutually_exclusive_group()
    camera.add_argument(
        "--camera", type=Path, metavar="FILE",
        help='calibration: JSON with width, height, K, "distortion", or an fSpy project',
    )  # fmt: skip
    camera.add_argument(
        "--focal", type=_positive, metavar="PX", help="focal length in px; else EXIF, else vanishing points"
    )


def _add_reconstruction(convert: argparse.ArgumentParser) -> None:
    """The graph, the program and its solver."""
    convert.add_argument(
        "--formulation", choices=["gain", "paper"], default="gain",
        help="how the program is stated: gain, fast, or as printed in the paper (gain)",
    )  # fmt: skip
    convert.add_argument("--backend", choices=["scip", "highs"], default="scip", help="the solver (scip)")
    convert.add_argument(
        "--without", type=_families, default=frozenset(), metavar="FAMILY[,FAMILY]",
        help="leave out families of constraints: cycles, planarity, boundary",
    )  # fmt: skip
    _add_objective(convert)
    convert.add_argument(
        "--fast", action="store_true", help="depths by a robust fit in tenths of a second, without a search or a proof"
    )
    convert.add_argument(
        "--time-limit", type=_positive, metavar="S",
        help=f"seconds for the solver ({GAIN_SECONDS:g}; with --formulation paper {PAPER_SECONDS:g})",
    )  # fmt: skip
    convert.add_argument(
        "--gap", type=_not_negative, default=0.0, metavar="G", help="relative gap that is good enough (0)"
    )
    convert.add_argument("--seed", type=_seed, default=0, metavar="N", help="seed of the solver (0)")
    convert.add_argument(
        "--extension", type=_extension, metavar="PX",
        help="how far segments are extended to find crossings, px on a photo 3840 px wide (75; with paper 30)",
    )  # fmt: skip
    convert.add_argument(
        "--collinear", action=argparse.BooleanOptionalAction, default=None,
        help="segments on one image line may be one line in space (on, but off with --formulation paper)",
    )  # fmt: skip
    convert.add_argument(
        "--faint", action="store_true",
        help="look a second time, for segments that the photo's grain hides: more depths, and more wrong ones",
    )  # fmt: skip
    convert.add_argument("--largest-component", action="store_true", help="only the largest connected group of lines")
    convert.add_argument(
        "--witnesses", type=_count, metavar="N",
        help="lines that must tie two bodies for one scale, 1 asks nothing (with paper 1; else lines must keep their "
        "depth when others are left out)",
    )  # fmt: skip


def _add_batch(commands: "argparse._SubParsersAction[_Parser]") -> None:
    batch = commands.add_parser(
        "batch",
        help="many photos, on all cores or a cluster; goes on where it was stopped",
        description="Convert many photos into a folder, with a record, a page and a summary (docs/guide/batch.md).",
        epilog="example: linecad batch survey/ -o models --format step,usdz,png --camera camera.json",
    )
    batch.set_defaults(run=_batch)
    batch.add_argument("photos", nargs="+", metavar="PHOTO|FOLDER|GLOB")
    batch.add_argument("-o", "--output", type=Path, required=True, metavar="DIR", help="made when it is not there")
    batch.add_argument(
        "--format", type=_suffixes, default=(SCENE_SUFFIX, ".png"), metavar="FORMAT[,FORMAT]",
        help="what is made of each photo (json,png); see linecad export --formats",
    )  # fmt: skip
    batch.add_argument("--workers", type=_count, metavar="N", help="photos at a time (as cores and memory allow)")
    batch.add_argument(
        "--photo-limit", type=_positive, metavar="S",
        help="seconds after which a photo is given up (3 times --time-limit and 10 minutes)",
    )  # fmt: skip
    batch.add_argument(
        "--memory-limit", type=_count, metavar="MB", help="memory of one photo (its share of what is free)"
    )
    batch.add_argument("--scheduler", metavar="ADDRESS", help="of a Dask cluster, such as tcp://10.0.0.1:8786")
    batch.add_argument(
        "--shared-files", action="store_true", help="the cluster sees the same folders: no photo travels"
    )
    _add_camera(batch)
    _add_reconstruction(batch)
    batch.add_argument(
        "--camera-height", type=_camera_height, dest="known", metavar="METRES",
        help="of the camera above the ground, the lowest horizontal plane",
    )  # fmt: skip
    batch.add_argument(
        "--option", action="append", default=[], metavar="KEY=VALUE",
        help="what one format alone needs (see linecad export --formats); may be given again",
    )  # fmt: skip
    _add_loudness(batch)


def _add_objective(command: argparse.ArgumentParser) -> None:
    """What the objective of the program is made of."""
    command.add_argument(
        "--weights",
        choices=["ones", "junctions", "fitted", "odds"],
        help="weights of crossings (odds; for the paper's graph junctions)",
    )
    command.add_argument(
        "--mu-planarity", type=_not_negative, default=0.5, metavar="MU1", help="reward of planar pairs (0.5)"
    )
    command.add_argument(
        "--mu-boundary", type=_not_negative, metavar="MU2",
        help="reward of non-boundary lines (1 for gain, 10 for paper)",
    )  # fmt: skip


def _add_evaluate(commands: "argparse._SubParsersAction[_Parser]") -> None:
    evaluate = commands.add_parser(
        "evaluate",
        help="the paper's tables and more on photos with ground truth",
        description="Measure reconstructions of a dataset against its truth (docs/reference/evaluation.md).",
        epilog="example: linecad evaluate streets --json streets.json --report streets.html --workers 4",
    )
    evaluate.set_defaults(run=_evaluate)
    evaluate.add_argument(
        "dataset", type=Path, metavar="DATASET",
        help="a folder: our own dataset, York Urban, points with depth, or labels made by hand",
    )  # fmt: skip
    evaluate.add_argument("--json", type=Path, metavar="OUT", help="write everything that was measured")
    evaluate.add_argument("--markdown", type=Path, metavar="OUT", help="write the tables as Markdown")
    evaluate.add_argument(
        "--report", type=Path, metavar="OUT", help="write a page (HTML) with plots and the worst photos"
    )
    evaluate.add_argument("--workers", type=_count, default=1, metavar="N", help="photos measured at a time (1)")
    evaluate.add_argument("--limit", type=_count, metavar="N", help="only the first N photos")
    evaluate.add_argument("--formulation", choices=["gain", "paper", "both"], default="both", help="for table 1 (both)")
    evaluate.add_argument(
        "--ablation", action=argparse.BooleanOptionalAction, default=True,
        help="solve every row of table 1 (on), or only the default settings",
    )  # fmt: skip
    _add_objective(evaluate)
    evaluate.add_argument("--time-limit", type=_positive, default=60.0, metavar="S", help="seconds for each solve (60)")
    _add_loudness(evaluate)


def _add_export(commands: "argparse._SubParsersAction[_Parser]") -> None:
    export = commands.add_parser(
        "export",
        help="a scene file to CAD files",
        description="Write a scene, as `linecad convert` saved it, in other formats.",
        epilog="example: linecad export facade.json -o facade.dxf -o facade.usdz",
    )
    export.set_defaults(run=_export)
    export.add_argument("scene", type=Path, metavar="SCENE.json", nargs="?")
    _add_outputs(export)
    export.add_argument(
        "--photo", type=Path, metavar="PHOTO", help="the scene's photo, for formats that show it (else looked for)"
    )
    export.add_argument(
        "--camera", type=Path, metavar="FILE", help="the photo's calibration, if it was given to convert"
    )
    _add_scale(export)
    export.add_argument("--formats", action="store_true", help="list the formats and end")
    _add_loudness(export)


def _add_dataset(commands: "argparse._SubParsersAction[_Parser]") -> None:
    dataset = commands.add_parser(
        "dataset",
        help="street scenes of our own with exact ground truth",
        description="Draw, render and measure scenes; a run that was stopped goes on where it was.",
        epilog="example: linecad dataset scenes --scenes 50 --seed 1 --size 1920x1080",
    )
    dataset.set_defaults(run=_dataset)
    dataset.add_argument("folder", type=Path, metavar="DIR")
    dataset.add_argument("--scenes", type=int, required=True, metavar="N", help="how many scenes the dataset has")
    dataset.add_argument("--seed", type=int, required=True, metavar="S", help="the same seed gives the same scenes")
    dataset.add_argument("--size", type=_size, default=(3840, 2160), metavar="WxH", help="of the photos (3840x2160)")
    dataset.add_argument("--samples", type=int, default=32, metavar="N", help="rays a pixel: time against noise (32)")
    _add_loudness(dataset)


def _add_scale(parser: argparse.ArgumentParser) -> None:
    scale = parser.add_mutually_exclusive_group()
    scale.add_argument(
        "--scale", type=_scale, dest="known", metavar="LINE=METRES",
        help="a known length: a line by its id in the scene file, or U,V:U,V=METRES between two px of the photo on one "
        "line or in one plane",
    )  # fmt: skip
    scale.add_argument(
        "--camera-height", type=_camera_height, dest="known", metavar="METRES",
        help="of the camera above the ground, the lowest horizontal plane",
    )  # fmt: skip


def _add_outputs(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "-o", "--output", type=Path, action="append", default=[], metavar="OUT",
        help="file to write, its suffix chooses the format (see linecad export --formats); may be given again",
    )  # fmt: skip
    parser.add_argument(
        "--option", action="append", default=[], metavar="KEY=VALUE",
        help="what one format alone needs (see linecad export --formats); may be given again",
    )  # fmt: skip


def _add_loudness(parser: argparse.ArgumentParser) -> None:
    loudness = parser.add_mutually_exclusive_group()
    loudness.add_argument("--quiet", action="store_true", help="no progress")
    loudness.add_argument("--verbose", action="store_true", help="the time of every stage")


def _count(text: str) -> int:
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number of 1 or more")
    return int(text)


def _seed(text: str) -> int:
    from solver.options import LARGEST_SEED

    if not (text.isascii() and text.isdecimal() and len(text) < LONGEST_ID and int(text) <= LARGEST_SEED):
        raise argparse.ArgumentTypeError(f"{text!r} is no seed; give a whole number from 0 to {LARGEST_SEED}")
    return int(text)


def _port(text: str) -> int:
    if not text.isdecimal() or not 0 <= int(text) <= LARGEST_PORT:
        raise argparse.ArgumentTypeError(f"{text!r} is no port; give a number from 1 to {LARGEST_PORT}")
    return int(text)


def _positive(text: str) -> float:
    value = _not_negative(text)
    if value == 0:
        raise argparse.ArgumentTypeError(f"{text} is not a positive number")
    return value


def _not_negative(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number") from None
    if not 0 <= value < float("inf"):
        raise argparse.ArgumentTypeError(f"{text} is not a number of zero or more")
    return value


def _scale(text: str) -> "Known":
    from linecad.model.scale import LineLength, PointDistance

    what, equals, length = text.rpartition("=")
    if not equals:
        raise argparse.ArgumentTypeError(f"{text!r} is no length; write it like 12=3.5 or 840,310:840,655=2.1")
    metres = _positive(length)
    if what.isascii() and what.isdecimal() and len(what) < LONGEST_ID:
        return LineLength(int(what), metres)
    numbers = re.split("[,:]", what)
    if len(numbers) != 4 or not re.fullmatch("[^:]*:[^:]*", what):
        raise argparse.ArgumentTypeError(f"{what!r} is neither the id of a line nor two px like 840,310:840,655")
    a, b, c, d = map(_pixel, numbers)
    return PointDistance(((a, b), (c, d)), metres)


def _pixel(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number of px") from None
    if not abs(value) <= LARGEST_PIXEL:
        raise argparse.ArgumentTypeError(f"{text} px lies outside every photo")
    return value


def _camera_height(text: str) -> "Known":
    from linecad.model.scale import CameraHeight

    return CameraHeight(_positive(text))


def _extension(text: str) -> float:
    value = _positive(text)
    if value > LARGEST_EXTENSION:
        raise argparse.ArgumentTypeError(
            f"{text} px would let all lines cross; at most {LARGEST_EXTENSION:.0f} make sense"
        )
    return value


def _size(text: str) -> tuple[int, int]:
    found = re.fullmatch(r"(\d{1,6})x(\d{1,6})", text)
    if found is None:
        raise argparse.ArgumentTypeError(f"{text!r} is no size; write it like 1920x1080")
    return int(found[1]), int(found[2])


def _families(text: str) -> frozenset[str]:
    from solver.options import FAMILIES

    names = frozenset(name for name in text.split(",") if name)
    unknown = sorted(names - set(FAMILIES))
    if unknown:
        raise argparse.ArgumentTypeError(f"{unknown[0]!r} is no family of constraints; use {', '.join(FAMILIES)}")
    return names


def _suffixes(text: str) -> tuple[str, ...]:
    from exporters.formats import FORMATS

    suffixes = tuple(dict.fromkeys(f".{name.strip().lower().removeprefix('.')}" for name in text.split(",")))
    known = (SCENE_SUFFIX, *FORMATS)
    for suffix in suffixes:
        if suffix not in known:
            raise argparse.ArgumentTypeError(f"{suffix[1:]!r} is no format; use {', '.join(s[1:] for s in known)}")
    return suffixes


def _reconstruct_options(parsed: argparse.Namespace) -> "Options":
    from linecad.options import Options
    from solver.options import SolveOptions

    return Options(
        extension=parsed.extension,
        weights=parsed.weights,
        collinear=parsed.collinear,
        largest_component=parsed.largest_component,
        faint=parsed.faint,
        solve=SolveOptions(
            formulation=parsed.formulation,
            without=parsed.without,
            mu_planarity=parsed.mu_planarity,
            mu_boundary=parsed.mu_boundary,
            backend=parsed.backend,
            time_limit_s=parsed.time_limit,
            gap=parsed.gap,
            seed=parsed.seed,
            fast=parsed.fast,
        ),
    )


def _convert(parsed: argparse.Namespace) -> int:
    values = _check_outputs(parsed.output, [parsed.photo, parsed.camera, parsed.corrections], parsed.option)
    from linecad.camera.distortion import open_photo
    from linecad.camera.text import summary
    from linecad.corrections.file import check_belongs, read_corrections
    from linecad.outputs import write_outputs
    from linecad.pipeline import reconstruct

    options = _reconstruct_options(parsed)
    corrections = None if parsed.corrections is None else read_corrections(parsed.corrections)
    with _Shown(parsed) as show:
        show.stage("reading the photo")
        photo = open_photo(parsed.photo, parsed.camera, parsed.focal)
        if corrections is not None:
            check_belongs(corrections, str(parsed.corrections), photo.width, photo.height)
        scene = _measured(reconstruct(photo, options, show.progress, show.stage, corrections), parsed.known)
        write_outputs(scene, photo.pixels, parsed.output, values, show.stage)
    real = int(scene.intersections.real.sum())
    print(
        f"{len(scene.lines)} lines, {real} of {len(scene.intersections)} crossings real, {len(scene.planes)} planes; "
        f"{scene.solve.status} in {scene.solve.seconds:.1f} s, gap "
        + (f"{scene.solve.gap:.2%}" if math.isfinite(scene.solve.gap) else "unknown")
    )
    if scene.certainty is not None:
        print(summary(scene.camera, scene.certainty))
    _print_notes(scene.notes)
    return 0


def _camera(parsed: argparse.Namespace) -> int:
    from linecad.camera.camera_file import check_suffix, write_camera
    from linecad.camera.report import find_camera
    from linecad.camera.text import summary, table
    from linecad.io.files import check_output

    for path in parsed.output:
        check_suffix(path)
        check_output(path)
    _check_kept(parsed.output, [parsed.photo, *([parsed.camera] if parsed.camera else [])])
    _check_distinct(parsed.output)
    with _Shown(parsed) as show:
        report = find_camera(parsed.photo, parsed.camera, parsed.focal, show.stage)
        for path in parsed.output:
            show.stage(f"writing {path}")
            write_camera(report, path)
    if parsed.output:
        print(summary(report.camera, report.certainty))
        _print_notes(report.notes)
    else:
        print("\n".join(table(report)))
    return 0


def _batch(parsed: argparse.Namespace) -> int:
    from exporters.formats import options_for
    from linecad.batch.start import Means, make_plan, run_plan
    from linecad.batch.summary import bar, line, table
    from linecad.convert import Conversion

    means = Means(
        parsed.workers, parsed.scheduler, parsed.shared_files, parsed.photo_limit, parsed.memory_limit
    )  # fmt: skip
    formats = [Path(f"photo{suffix}") for suffix in parsed.format if suffix != SCENE_SUFFIX]
    values = options_for(formats, parsed.option)
    conversion = Conversion(parsed.camera, parsed.focal, _reconstruct_options(parsed), parsed.known, values)
    plan, workers = make_plan(parsed.photos, parsed.output, parsed.format, conversion, means)
    with _Shown(parsed) as show:
        where = f"with {workers} at a time" if workers else f"on {parsed.scheduler}"
        show.stage(f"{len(plan.photos)} photos {where}, at most {plan.limits.memory_mb} MiB each")
        began = time.monotonic()

        def on_row(progress: "BatchProgress", row: "Row | None") -> None:
            if row is not None:
                show.line(line(progress, row), row.outcome.status != "done")
            show.bar(bar(progress, time.monotonic() - began))

        result = run_plan(plan, workers, means, on_row)
    print(table(result))
    print(f"page: {plan.folder / 'index.html'}")
    return 1 if result.progress.failed else 0


def _edit(parsed: argparse.Namespace) -> int:
    from linecad.corrections.file import SUFFIX
    from linecad.editing.labelling import check_labels
    from linecad.editing.run import EditOptions, edit

    with _Shown(parsed) as show:
        show.stage("reading the photo")
        photo, path = _photo_to_edit(parsed)
        output = parsed.output or path.with_name(path.name + SUFFIX)
        inputs = [parsed.input, path, *([parsed.camera] if parsed.camera else [])]
        outputs = [output, *([parsed.labels] if parsed.labels else [])]
        _check_kept(outputs, inputs)
        _check_distinct(outputs)
        if parsed.labels:
            check_labels(parsed.labels, path, parsed.camera)

        def ready(address: str) -> None:
            show.finish()
            print(address, flush=True)
            if not parsed.no_browser:
                import webbrowser  # takes as long to load as all the rest of the command line

                webbrowser.open(address)

        options = EditOptions(output, parsed.port, _reconstruct_options(parsed), parsed.labels, parsed.camera)
        with contextlib.suppress(KeyboardInterrupt):  # the way to end it
            edit(photo, options, ready, show.stage)
    return 0


def _photo_to_edit(parsed: argparse.Namespace) -> "tuple[Photo, Path]":
    """The photo that is named, or that of the scene that is named, and where it lies."""
    from linecad.camera.distortion import open_photo

    if parsed.input.suffix.lower() != SCENE_SUFFIX:
        if parsed.photo is not None:
            raise LinecadError("--photo is for scene files; the photo is named already")
        return open_photo(parsed.input, parsed.camera, parsed.focal), parsed.input
    from linecad.io.scene_file import read_scene

    scene = read_scene(parsed.input)
    parsed.scene = parsed.input
    path = parsed.photo or parsed.input.parent / Path(scene.photo).name
    if parsed.focal or (parsed.camera is None and not scene.camera.is_given):
        # What was estimated from the photo is estimated again, so that its standard errors are known.
        if not path.is_file():
            raise LinecadError(f"{path} is not there, the photo of {parsed.input}; name it with --photo")
        photo = open_photo(path, None, parsed.focal)
        _check_size_of(photo, path, scene)
        return photo, path
    found = _photo_of(scene, parsed)
    if found is None:
        raise LinecadError(f"{path} is not there, the photo of {parsed.input}; name it with --photo")
    # Without a calibration the pixels are those of the file, so the scene's own camera is theirs.
    return (found if parsed.camera else replace(found, camera=scene.camera)), path


def _evaluate(parsed: argparse.Namespace) -> int:
    from linecad.evaluation.datasets import find_dataset
    from linecad.evaluation.document import markdown, write_json, write_markdown
    from linecad.evaluation.methods import Settings
    from linecad.evaluation.report import write_report
    from linecad.evaluation.run import evaluate
    from linecad.evaluation.tables import all_tables
    from linecad.io.files import check_output
    from linecad.options import Options

    outputs = [path for path in (parsed.json, parsed.markdown, parsed.report) if path is not None]
    for path in outputs:
        check_output(path)
    _check_distinct(outputs)
    settings = Settings(
        formulations=("paper", "gain") if parsed.formulation == "both" else (parsed.formulation,),
        ablation=parsed.ablation,
        reconstruction=Options(weights=parsed.weights),
        pictures=parsed.report is not None,
    )
    dataset = find_dataset(parsed.dataset)
    _check_kept(outputs, [file for case in dataset.cases for file in (case.photo, case.truth)])
    with _Shown(parsed) as show:
        show.stage(f"measuring {len(dataset.cases[: parsed.limit])} photos of {dataset.name}")
        results = evaluate(
            dataset.cases[: parsed.limit], settings, parsed.workers,
            lambda done, total, last: show.stage(f"{done} of {total} photos, {last.name}: {last.error or 'measured'}"),
        )  # fmt: skip
    failed = [result for result in results if result.error is not None]
    if len(failed) == len(results):
        raise LinecadError(f"none of {len(results)} photos could be measured; the first: {failed[0].error}")
    tables = all_tables(results, settings)
    if parsed.json is not None:
        write_json(parsed.json, dataset.name, settings, results, tables)
    if parsed.markdown is not None:
        write_markdown(parsed.markdown, dataset.name, results, tables)
    if parsed.report is not None:
        write_report(parsed.report, dataset.name, results, tables)
    print(markdown(dataset.name, results, tables), end="")
    return 0


def _export(parsed: argparse.Namespace) -> int:
    if parsed.formats:
        return _print_formats()
    if parsed.scene is None:
        raise OutputError("no scene file was given; name the .json that `linecad convert` wrote")
    values = _check_outputs(parsed.output, [parsed.scene, parsed.photo, parsed.camera], parsed.option)
    from linecad.io.scene_file import read_scene
    from linecad.outputs import write_outputs

    with _Shown(parsed) as show:
        show.stage("reading the scene")
        scene = _measured(read_scene(parsed.scene), parsed.known)
        photo = _photo_for_outputs(scene, parsed, values, show)
        write_outputs(scene, None if photo is None else photo.pixels, parsed.output, values, show.stage)
    return 0


def _measured(scene: "Scene", known: "Known | None") -> "Scene":
    from linecad.model.scale import set_scale

    return scene if known is None else set_scale(scene, known)


def _show_photo(outputs: list[Path]) -> bool:
    """Whether a format of any of them shows the photo."""
    from exporters.formats import find_format

    return any(path.suffix.lower() != SCENE_SUFFIX and find_format(path).shows_photo for path in outputs)


def _dataset(parsed: argparse.Namespace) -> int:
    from linecad.dataset.make import DatasetOptions, make_dataset

    width, height = parsed.size
    options = DatasetOptions(parsed.scenes, parsed.seed, width, height, parsed.samples)
    with _Shown(parsed) as show:
        made = make_dataset(parsed.folder, options, show.stage)
    print(f"{made.new} scenes made, {made.kept} were there already, in {parsed.folder}")
    return 0


def _photo_for_outputs(
    scene: "Scene", parsed: argparse.Namespace, values: "dict[str, Value]", show: "_Shown"
) -> "Photo | None":
    """The scene's photo if an output shows it. Textures do without it, and say so, unless they were asked for."""
    from exporters.formats import TEXTURES, find_format
    from exporters.model import photo_name

    drawn = _show_photo(parsed.output)
    switch = TEXTURES[0]
    formats = [find_format(path) for path in parsed.output if path.suffix.lower() != SCENE_SUFFIX]
    able = bool(scene.faces) and any(switch in row.options for row in formats)
    textured = able and values.get(switch.key, switch.default) is True
    if not drawn and not textured:
        return None
    asked = able and values.get(switch.key) is True
    try:
        photo = _photo_of(scene, parsed)
    except LinecadError as error:
        if drawn or asked or parsed.photo is not None:
            raise
        show.note(f"{error}; the faces have no textures")
        return None
    if photo is None and textured:
        missing = f"the photo {photo_name(scene)!r} is not beside {parsed.scene}; name it with --photo"
        if asked:
            raise OutputError(f"textures were asked for, but {missing}")
        show.note(f"{missing}; the faces have no textures")
    return photo


def _photo_of(scene: "Scene", parsed: argparse.Namespace) -> "Photo | None":
    """The photo of a scene: as named, else beside the scene file, else none (the picture then says so)."""
    from linecad.camera.photo import read_photo, read_photo_of

    beside = parsed.scene.parent / Path(scene.photo).name  # a scene file does not send us to other folders
    path = parsed.photo if parsed.photo is not None else beside if beside.is_file() else None
    if path is None:
        return None
    if parsed.camera is None and scene.camera.distortion and scene.camera.source != "file":
        return read_photo_of(path, scene.camera)  # the photo's own lines told the distortion, all of it is in the scene
    # Only the camera file can say how its pixels were made square; that it did is told by a note alone.
    resampled = bool(scene.camera.distortion) or any("pixels made square" in note for note in scene.notes)
    if resampled and parsed.camera is None:
        raise LinecadError(f"{scene.photo} was straightened by its calibration; give that with --camera")
    photo = read_photo(path, parsed.camera, None if parsed.camera else scene.camera.focal)
    _check_size_of(photo, path, scene)
    if photo.camera is not None and parsed.camera is not None:
        same = abs(photo.camera.matrix - scene.camera.matrix).max() <= SAME_CAMERA * scene.camera.focal
        if not same or photo.camera.distortion != scene.camera.distortion:
            raise LinecadError(f"{parsed.camera} is not the calibration that the scene was made with; give that one")
    return photo


def _check_size_of(photo: "Photo", path: Path, scene: "Scene") -> None:
    if (photo.width, photo.height) != (scene.camera.width, scene.camera.height):
        raise LinecadError(
            f"{path} has {photo.width} x {photo.height} px, the scene's photo {scene.camera.width} x "
            f"{scene.camera.height}; name the right one with --photo"
        )


def _check_outputs(outputs: list[Path], inputs: list[Path | None], options: list[str]) -> "dict[str, Value]":
    """Refuse, before the long work starts, everything that can be known to fail; the values of the formats' options."""
    from exporters.formats import options_for
    from linecad.io.files import check_output

    if not outputs:
        raise OutputError("no output was named; give one or more, such as -o scene.json -o scene.step")
    values = options_for([path for path in outputs if path.suffix.lower() != SCENE_SUFFIX], options)
    for path in outputs:
        check_output(path)
    _check_kept(outputs, [path for path in inputs if path is not None])
    _check_distinct(outputs)
    return values


def _check_kept(outputs: list[Path], inputs: list[Path]) -> None:
    """Raise OutputError where writing an output would overwrite an input."""
    for path in outputs:
        for given in inputs:
            if given.exists() and path.exists() and path.samefile(given):
                raise OutputError(f"{path} is an input too and would be lost; choose another name")


def _check_distinct(outputs: list[Path]) -> None:
    if len({path.resolve() for path in outputs}) < len(outputs):
        raise OutputError("the same output was named twice; name each once")


def _print_formats() -> int:
    from exporters.formats import FORMATS

    print(f"{SCENE_SUFFIX:6} the scene file, which `linecad export` reads (docs/reference/scene-file.md)")
    for suffix, row in FORMATS.items():
        print(f"{suffix:6} {row.phrase} (in {row.unit})")
        for option in row.options:
            print(f"         --option {option.key}={option.usual}: {option.phrase}; {option.accepted}")
    return 0


def _print_notes(notes: tuple[str, ...]) -> None:
    for note in notes:
        print(f"note: {note}")


class _Shown:
    """Progress for a person: one line that is written over on a terminal, a plain line a stage otherwise."""

    def __init__(self, parsed: argparse.Namespace) -> None:
        self.quiet: bool = parsed.quiet
        self.verbose: bool = parsed.verbose
        self.live = sys.stderr.isatty() and not self.quiet
        self.started = time.monotonic()
        self.stage_started = self.started
        self.current = ""

    def stage(self, text: str) -> None:
        """A new stage begins."""
        self._finish_stage()
        self.current, self.stage_started = text, time.monotonic()
        if self.live:
            self._over(f"{text} ...")
        elif not self.quiet and not self.verbose:
            print(text, file=sys.stderr, flush=True)

    def note(self, text: str) -> None:
        """What the user should know of the result, in any loudness."""
        if self.live:
            self._over("")
        print(f"linecad: {text}", file=sys.stderr, flush=True)

    def progress(self, at: "Progress") -> None:
        """The solver has come further."""
        if self.live:
            self._over(
                f"{self.current} ... {at.seconds:.1f} s, best {at.objective:.1f}, bound {at.bound:.1f}, "
                f"gap {at.gap:.2%} (Ctrl-C keeps the best)"
            )

    def line(self, text: str, is_important: bool) -> None:
        """One of many photos is over; on a terminal only what is important stays above the bar."""
        if self.live:
            if is_important or self.verbose:
                print(f"\r\033[K{text}", file=sys.stderr, flush=True)
        elif not self.quiet:
            print(text, file=sys.stderr, flush=True)

    def bar(self, text: str) -> None:
        """How far many photos are, on a terminal alone, cut to its width."""
        if self.live:
            self._over(text[: shutil.get_terminal_size().columns - 1])

    def finish(self) -> None:
        """No stage any more; the next line on a terminal is a clean one."""
        self._finish_stage()
        self.current = ""
        if self.live:
            self._over("")

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_exception: object) -> None:
        """Nothing more to show; an error's line begins on a clean one."""
        self.finish()

    def _finish_stage(self) -> None:
        if self.verbose and self.current:
            line = f"{time.monotonic() - self.stage_started:7.2f} s  {self.current}"
            print(f"\r\033[K{line}" if self.live else line, file=sys.stderr, flush=True)

    def _over(self, text: str) -> None:
        print(f"\r\033[K{text}", end="", file=sys.stderr, flush=True)
