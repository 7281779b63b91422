"""How often scale cues between bodies are right: `PYTHONPATH=. python tests/benchmarks/window_grids.py DATASET ...`.

Made scenes only. Each photo is solved by the program over crossings, which joins bodies by such cues, and parted into
bodies; the true scale of a body is the median ratio of true to found depth of its lines. Prints, for cues from window
grids (by evidence) and for crossings between bodies that are not taken for real, how many relative scales are within
5 % and the median error.
"""

import argparse
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from linecad.arrays import Float
from linecad.dataset.truth import Truth
from linecad.errors import DatasetError, LinecadError
from linecad.evaluation.datasets import Case, find_dataset
from linecad.evaluation.labels import find_true_lines
from linecad.evaluation.references import open_case
from linecad.finding import find_lines
from linecad.graph.connectivity import components
from linecad.line_graph import LineGraph
from linecad.model.window_grids import find_window_grid_cues
from linecad.options import MIN_COMPONENT, Options
from linecad.pipeline import reconstruct_lines
from solver.options import SolveOptions

EVIDENCE = [0.0, 0.3, 0.6, 1.0, 1.3, 1.6, 2.0, 3.0, np.inf]  # decades
RIGHT = 0.05  # log scale


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("dataset", type=Path, nargs="+")
    parser.add_argument("--time-limit", type=float, default=6.0, help="s, for each solve")
    arguments = parser.parse_args()
    found: dict[str, list[float]] = {}
    for folder in arguments.dataset:
        for case in find_dataset(folder).cases:
            try:
                for kind, off in errors_of(case, arguments.time_limit):
                    found.setdefault(kind, []).append(off)
            except LinecadError as error:
                print(f"{case.name}: {error}", flush=True)
    print("| cue | number | within 5 % | median error % |")
    print("| --- | --- | --- | --- |")
    for kind in sorted(found):
        errors = np.abs(found[kind])
        print(f"| {kind} | {len(errors)} | {(errors < RIGHT).mean():.2f} | {100 * np.median(errors):.1f} |")


def errors_of(case: Case, limit: float) -> Iterator[tuple[str, float]]:
    """Kind of cue and error of its log scale, for each cue between two bodies whose true scales are known."""
    photo, reference = open_case(case)
    if reference.truth is None:
        raise DatasetError("not a made scene: its true lines are not known")
    found = find_lines(photo)
    options = Options(over_bodies=False, solve=SolveOptions(time_limit_s=limit))
    made = reconstruct_lines(photo.name, found, options)
    graph, real, offset = made.graph, made.decision.real, made.lifted.offset
    rays = np.where(np.isnan(offset), 0, graph.components)
    log_depth = np.log(np.maximum((rays * np.nan_to_num(offset)).sum(axis=1) / (rays**2).sum(axis=1), 1e-9))
    parts = [p for p in components(graph, real & graph.informative) if len(p) >= MIN_COMPONENT]
    missing = log_true_depths(reference.truth, graph, found.frame.axes) - log_depth
    parts = [part for part in parts if np.isfinite(missing[part]).any()]
    grow = np.array([np.nanmedian(missing[part]) for part in parts])
    cues = find_window_grid_cues(graph, found.camera, found.frame.axes, parts, offset)
    for (one, other), ratio, evidence in zip(cues.bodies, cues.log_ratio, cues.evidence, strict=True):
        step = int(np.searchsorted(EVIDENCE, evidence, side="right"))
        yield f"grids, {EVIDENCE[step - 1]} to {EVIDENCE[step]} decades", grow[other] - grow[one] - ratio
    body = np.full(len(graph.segments), -1)
    for number, part in enumerate(parts):
        body[part] = number
    joins: dict[tuple[int, int], list[float]] = {}
    for edge in np.flatnonzero(graph.informative & ~real):
        i, j = graph.edges[edge]
        one, other = body[i], body[j]
        if one >= 0 and other >= 0 and one != other:
            ratio = log_depth[i] - log_depth[j] - graph.log_ratio[edge]
            joins.setdefault((min(one, other), max(one, other)), []).append(ratio if one < other else -ratio)
    for (one, other), ratios in joins.items():
        near = max(([r for r in ratios if abs(r - at) < 0.02] for at in ratios), key=len)
        count = min(len(near), 4)
        kind = f"{count}{' or more' if count == 4 else ''} crossings that agree"
        yield kind, grow[other] - grow[one] - float(np.median(near))


def log_true_depths(truth: Truth, graph: LineGraph, axes: Float) -> Float:
    """Log of the true camera depth (N,) at the middle of each line; NaN where a line shows nothing true."""
    lines = find_true_lines(truth, graph.segments, axes)
    rays = truth.rays(graph.segments.ends.mean(axis=1))
    along = (rays * lines.direction).sum(axis=1)
    onto = (rays * lines.point).sum(axis=1) - along * (lines.direction * lines.point).sum(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        depth = onto / ((rays**2).sum(axis=1) - along**2)
        return np.asarray(np.where(lines.right & (depth > 0), np.log(depth), np.nan))


if __name__ == "__main__":
    main()
