"""`linecad evaluate`: reconstructions measured against what is known of the photos."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from linecad.cli.arguments import add_depth_maps, add_loudness, add_reconstruction, count, reconstruction_of
from linecad.cli.checks import check_kept, check_outputs
from linecad.cli.former import OBJECTIVE, add_former
from linecad.cli.progress import ProgressDisplay
from linecad.errors import LinecadError, OutputError

if TYPE_CHECKING:
    from linecad.cli.arguments import Commands
    from linecad.evaluation.datasets import Dataset
    from linecad.evaluation.measure import PhotoResult
    from linecad.evaluation.methods import Settings


def add_to(commands: "Commands") -> None:
    """Add the command."""
    command = commands.add_parser(
        "evaluate",
        help="the paper's tables and more on photos with ground truth",
        description="Measure reconstructions of a dataset against its truth (docs/reference/evaluation.md).",
        epilog="example: linecad evaluate streets --json streets.json --report streets.html --workers 4",
    )
    command.set_defaults(run=run)
    command.add_argument(
        "dataset", type=Path, metavar="DATASET",
        help="a folder: our own dataset, York Urban, points with depth, or labels made by hand",
    )  # fmt: skip
    command.add_argument("--json", type=Path, metavar="OUT", help="write everything that was measured")
    command.add_argument("--markdown", type=Path, metavar="OUT", help="write the tables as Markdown")
    command.add_argument(
        "--report", type=Path, metavar="OUT", help="write a page (HTML) with plots and the worst photos"
    )
    command.add_argument(
        "--turned", type=Path, metavar="DIR", help="write a picture of each model from where the camera was not"
    )
    command.add_argument("--workers", type=count, default=1, metavar="N", help="photos measured at a time (1)")
    command.add_argument("--limit", type=count, metavar="N", help="only the first N photos")
    command.add_argument("--formulation", choices=["gain", "paper", "both"], default="both", help="for table 1 (both)")
    command.add_argument(
        "--ablation", action=argparse.BooleanOptionalAction, default=True,
        help="solve every row of table 1 (on), or only the default settings",
    )  # fmt: skip
    add_depth_maps(command)
    add_reconstruction(command, "any other option of the reconstruction")
    add_loudness(command)
    add_former(command, OBJECTIVE)


def run(parsed: argparse.Namespace) -> int:
    """Measure the photos of a dataset."""
    outputs = [path for path in (parsed.json, parsed.markdown, parsed.report) if path is not None]
    check_outputs(outputs, [])
    if parsed.turned is not None and not parsed.turned.is_dir():
        raise OutputError(f"{parsed.turned} is not a folder; make it first")
    from linecad.depth.for_photo import check_depth_options
    from linecad.evaluation.datasets import find_dataset
    from linecad.evaluation.measure import TURNED
    from linecad.evaluation.methods import Settings
    from linecad.evaluation.run import evaluate

    settings = Settings(
        formulations=("paper", "gain") if parsed.formulation == "both" else (parsed.formulation,),
        ablation=parsed.ablation,
        reconstruction=reconstruction_of(parsed, parsed.option),
        pictures=parsed.report is not None,
        turned=parsed.turned,
    )
    check_depth_options(settings.reconstruction, parsed.depth_maps)
    dataset = find_dataset(parsed.dataset)
    if parsed.depth_maps:
        dataset = dataset.with_depth_maps()
    pictures = [] if parsed.turned is None else [parsed.turned / f"{case.name}{TURNED}" for case in dataset.cases]
    check_kept([*outputs, *pictures], [file for case in dataset.cases for file in case.files])
    with ProgressDisplay(parsed.quiet, parsed.verbose) as show:
        show.stage(f"measuring {len(dataset.cases[: parsed.limit])} photos of {dataset.name}")
        results = evaluate(
            dataset.cases[: parsed.limit], settings, parsed.workers,
            lambda done, total, last: show.stage(f"{done} of {total} photos, {last.name}: {last.error or 'measured'}"),
        )  # fmt: skip
    failed = [result for result in results if result.error is not None]
    if len(failed) == len(results):
        raise LinecadError(f"none of {len(results)} photos could be measured; the first: {failed[0].error}")
    _write(parsed, dataset, settings, results)
    return 0


def _write(parsed: argparse.Namespace, dataset: "Dataset", settings: "Settings", results: "list[PhotoResult]") -> None:
    from linecad.evaluation.document import markdown, write_json, write_markdown
    from linecad.evaluation.report import write_report
    from linecad.evaluation.tables import all_tables

    tables = all_tables(results, settings)
    if parsed.json is not None:
        write_json(parsed.json, dataset.name, settings, results, tables)
    if parsed.markdown is not None:
        write_markdown(parsed.markdown, dataset.name, results, tables)
    if parsed.report is not None:
        write_report(parsed.report, dataset.name, results, tables)
    print(markdown(dataset.name, results, tables), end="")
