"""The whole photo, photo by photo: `PYTHONPATH=. python tests/benchmarks/whole_photo.py DATASET ... [--fast]`.

DATASET is a folder that `linecad evaluate` knows and whose truth has depth. For each photo: recall and precision at 5 %
of component 0 and of everything that is written, the inconsistency of the photo, and the seconds of each stage.
"""

import argparse
import time
from pathlib import Path

import numpy as np

from linecad.errors import LinecadError
from linecad.evaluation.datasets import Case, find_dataset
from linecad.evaluation.depth import score_depth
from linecad.evaluation.references import open_case
from linecad.finding import find_lines
from linecad.options import SHORT_REACH, Options, read_options
from linecad.pipeline import reconstruct_lines
from solver.options import SolveOptions


def measure(case: Case, options: Options) -> tuple[float, float] | None:
    """Recall and precision of one photo, NaN where nothing was found; prints them."""
    photo, reference = open_case(case)
    if reference.edges is None:
        return None
    times = {}
    began = time.monotonic()
    found = find_lines(photo)
    times["finding"] = time.monotonic() - began
    began, stage = time.monotonic(), "connecting"

    def on_stage(text: str) -> None:
        nonlocal began, stage
        times[stage] = time.monotonic() - began
        began, stage = time.monotonic(), text.split()[0]

    made = reconstruct_lines(photo.name, found, options, on_stage=on_stage)
    on_stage("end")
    graph, solution, scene = made.graph, made.solution, made.scene
    score = score_depth(scene, reference.edges.pixels, reference.edges.depth, scene.lines.component == 0)
    every = score_depth(scene, reference.edges.pixels, reference.edges.depth)
    precision = score.precision_5 if score.with_depth else np.nan
    seconds = ", ".join(f"{name} {second:.2f}" for name, second in times.items())
    everything = f"{every.recall_5:.3f} / {every.precision_5:.3f}" if every.with_depth else "nothing"
    main = int((scene.lines.component == 0).sum())
    print(
        f"{case.name:14} {len(graph.segments):5d} lines {len(graph.edges):6d} crossings, {main:5d} in component 0 | "
        f"recall {score.recall_5:.3f} precision {precision:.3f}, everything {everything} | {solution.status}, "
        f"gap {solution.gap:.2%} | inconsistency {found.inconsistency:.2f} | {seconds} s",
        flush=True,
    )
    return score.recall_5, precision


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("dataset", type=Path, nargs="+")
    parser.add_argument("--only", default="", help="photos whose name starts so")
    parser.add_argument("--fast", action="store_true")
    parser.add_argument("--time-limit", type=float, default=6.0)
    parser.add_argument("--option", action="append", default=[], metavar="KEY=VALUE", help="see linecad options")
    parser.add_argument("--short", action="store_true", help="the reach and weights of the paper's graph")
    chosen = parser.parse_args()
    options = Options(
        reach=SHORT_REACH if chosen.short else None,
        weights="junctions" if chosen.short else None,
        solve=SolveOptions(time_limit_s=chosen.time_limit, fast=chosen.fast),
    )
    options = read_options(chosen.option, options)
    for folder in chosen.dataset:
        rows = []
        for case in find_dataset(folder).cases:
            if not case.name.startswith(chosen.only):
                continue
            try:
                row = measure(case, options)
            except LinecadError as error:
                print(f"{case.name}: {error}")
                continue
            if row is not None:
                rows.append(row)
        if rows:
            recall, precision = np.array(rows).T
            print(
                f"{folder.name}, {len(rows)} photos: recall {recall.mean():.3f}, precision {np.nanmean(precision):.3f} "
                f"(lowest {np.nanmin(precision):.3f})"
            )


if __name__ == "__main__":
    main()
