"""The whole photo, photo by photo: `PYTHONPATH=. python tests/benchmarks/whole_photo.py DATASET ... [--fast]`.

DATASET is a folder that `linecad evaluate` knows and whose truth has depth. For each photo: recall and precision at 5 %
of component 0, the doubt about the photo and the support that was asked, and the seconds of each stage.
"""

import argparse
import time
from pathlib import Path

import numpy as np

from linecad.errors import LinecadError
from linecad.evaluation.datasets import Case, find_dataset
from linecad.evaluation.depth import score_depth
from linecad.evaluation.references import open_case
from linecad.finding import connect, find_lines
from linecad.model.build import place
from linecad.options import SHORT_REACH, Options
from solver.options import SolveOptions
from solver.solve import solve


def measure(case: Case, options: Options) -> tuple[float, float] | None:
    """Recall and precision of one photo, NaN where nothing was found; prints them."""
    photo, reference = open_case(case)
    if reference.edges is None:
        return None
    times = [time.monotonic()]
    found = find_lines(photo)
    times.append(time.monotonic())
    whole, graph = connect(found, options)
    times.append(time.monotonic())
    solution = solve(graph, options.solve)
    times.append(time.monotonic())
    scene = place(photo, found, graph, solution, options, len(whole.segments) - len(graph.segments))
    times.append(time.monotonic())
    score = score_depth(scene, reference.edges.pixels, reference.edges.depth, scene.lines.component == 0)
    precision = score.precision_5 if score.with_depth else np.nan
    seconds = " ".join(f"{second:5.2f}" for second in np.diff(times))
    main = int((scene.lines.component == 0).sum())
    print(
        f"{case.name:14} {len(graph.segments):5d} lines {len(graph.edges):6d} crossings, {main:5d} in component 0 | "
        f"recall {score.recall_5:.3f} precision {precision:.3f} | {solution.status}, gap {solution.gap:.2%} | "
        f"lines, graph, solve, place: {seconds} s",
        flush=True,
    )
    return score.recall_5, precision


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("dataset", type=Path, nargs="+")
    parser.add_argument("--only", default="", help="photos whose name starts so")
    parser.add_argument("--fast", action="store_true")
    parser.add_argument("--time-limit", type=float, default=6.0)
    parser.add_argument("--witnesses", type=int)
    parser.add_argument("--extension", type=float)
    parser.add_argument("--short", action="store_true", help="the reach and weights of the paper's graph")
    chosen = parser.parse_args()
    options = Options(
        extension=chosen.extension,
        reach=SHORT_REACH if chosen.short else None,
        weights="junctions" if chosen.short else None,
        witnesses=chosen.witnesses,
        solve=SolveOptions(time_limit_s=chosen.time_limit, fast=chosen.fast),
    )
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
