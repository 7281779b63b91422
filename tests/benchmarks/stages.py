"""Where the length of lines marked by hand is lost: `PYTHONPATH=. python tests/benchmarks/stages.py DATASET ...`.

For each dataset with marked lines (York Urban) prints the share of the marked length along which the lines of each
stage run, as `linecad evaluate` measures it for the scene: all segments, the labelled ones, the grouped ones, those
that are long enough for the line graph, those that touch enough others to be solved, those that the chosen crossings
tie to a group, and those left when joins that are not stable are refused. In front, how many lines a stage has.
"""

import argparse
from dataclasses import replace
from pathlib import Path

import numpy as np

from linecad.errors import LinecadError
from linecad.evaluation.datasets import Case, find_dataset
from linecad.evaluation.frames import true_axes
from linecad.evaluation.measure import covered_length
from linecad.evaluation.references import open_case
from linecad.finding import find_lines
from linecad.line_graph import Segments
from linecad.lines.segments import find_segments, group_segments, label_segments
from linecad.options import Options
from linecad.pipeline import reconstruct_lines
from solver.options import SolveOptions

STAGES = ("detected", "labelled", "grouped", "long enough", "solved", "tied", "in the scene")


def measure(case: Case, limit: float) -> np.ndarray:
    """Rows of STAGES: lines, covered px, marked px."""
    photo, reference = open_case(case)
    marked = reference.lines
    if marked is None or reference.rotation is None:
        raise LinecadError(f"{case.name} has no marked lines")
    options = Options(solve=SolveOptions(time_limit_s=limit))
    raw = find_segments(photo.grey)
    found = find_lines(photo)
    names = true_axes(found.frame.rotation, reference.rotation)
    stages = [label_segments(raw, found.camera, found.frame), group_segments(found.segments, found.camera, found.frame)]
    length = float(np.linalg.norm(marked.ends[:, 1] - marked.ends[:, 0], axis=1).sum())
    anything = covered_length(marked.ends, np.zeros(len(marked.axis), int), raw.ends, np.zeros(len(raw), int))
    rows = [(len(raw), anything, length)]
    try:
        for joins in ("all", "stable"):
            made = reconstruct_lines(photo.name, found, replace(options, joins=joins))
            stages += [made.whole.segments, made.graph.segments] if joins == "all" else []
            stages.append(Segments(made.scene.lines.segment, made.scene.lines.axis))
    except LinecadError as error:
        print(f"{case.name}: {error}")
    rows += [
        (len(part), covered_length(marked.ends, marked.axis, part.ends, names[part.axis]), length) for part in stages
    ]
    return np.array(rows + [(0, 0.0, length)] * (len(STAGES) - len(rows)))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("dataset", type=Path, nargs="+")
    parser.add_argument("--limit", type=int, default=None, help="only the first photos")
    parser.add_argument("--time-limit", type=float, default=20.0)
    chosen = parser.parse_args()
    for folder in chosen.dataset:
        table = np.array([measure(case, chosen.time_limit) for case in find_dataset(folder).cases[: chosen.limit]])
        print(f"{folder.name}, {len(table)} photos")
        for number, stage in enumerate(STAGES):
            lines, covered, length = table[:, number].T
            print(f"{stage:14} {lines.mean():6.0f} lines a photo, {covered.sum() / length.sum():.3f} of the length")


if __name__ == "__main__":
    main()
