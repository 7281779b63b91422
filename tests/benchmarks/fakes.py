"""Why crossings are fake, and which fakes the solver takes: python tests/benchmarks/fakes.py DATASET [--limit N]

For the largest component of the paper's line graph of each made scene: the exact label of every candidate crossing,
the cause of every fake one, and how many of each kind formulation gain calls real. A fake between two true lines is
relief where their depths differ by less than RELIEF (the two edges of a recess or a pilaster), else it joins what does
not touch.
"""

import argparse
from pathlib import Path

import numpy as np

from linecad.camera.photo import read_photo
from linecad.dataset.store import read_list, read_truth
from linecad.evaluation.labels import REAL, UNDECIDED, depths_at_crossings, find_true_lines, judge_crossings
from linecad.finding import connect, find_lines
from linecad.options import Options
from solver.options import SolveOptions
from solver.solve import solve

RELIEF = 0.03  # of the depth
KINDS = ("real", "undecided", "spurious line", "wrong axis", "relief", "join of distant bodies")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("dataset", type=Path)
    parser.add_argument("--limit", type=int, default=None, help="of scenes")
    parser.add_argument("--time-limit", type=float, default=10.0, help="s, for each solve")
    arguments = parser.parse_args()
    candidates, taken = np.zeros(len(KINDS), int), np.zeros(len(KINDS), int)
    for name in read_list(arguments.dataset).scenes[: arguments.limit]:
        kind, connected = look(arguments.dataset / name, arguments.time_limit)
        candidates += np.bincount(kind, minlength=len(KINDS))
        taken += np.bincount(kind[connected], minlength=len(KINDS))
    print("| crossing | candidates | share % | called real | of its kind % |")
    print("| --- | --- | --- | --- | --- |")
    for name, count, chosen in zip(KINDS, candidates.tolist(), taken.tolist(), strict=True):
        share, rate = 100 * count / max(1, candidates.sum()), 100 * chosen / max(1, count)
        print(f"| {name} | {count} | {share:.1f} | {chosen} | {rate:.1f} |")


def look(folder: Path, time_limit: float) -> tuple[np.ndarray, np.ndarray]:
    """The kind of each candidate crossing, an index of KINDS, and which of them the solver calls real."""
    truth, photo = read_truth(folder), read_photo(folder / "photo.jpg", folder / "camera.json")
    found = find_lines(photo)
    graph = connect(found, Options(collinear=False, largest_component=True))[1]
    lines = find_true_lines(truth, graph.segments, found.frame.axes)
    label = judge_crossings(truth, graph, lines)
    i, j = graph.edges.T
    depth = depths_at_crossings(truth, graph, lines)
    with np.errstate(invalid="ignore", divide="ignore"):
        is_relief = np.abs(np.log(np.abs(depth[0] / depth[1]))) < RELIEF
    is_spurious = (lines.kind[i] == "spurious") | (lines.kind[j] == "spurious")
    is_wrong = ~(lines.right[i] & lines.right[j])
    kind = np.select(
        [label == REAL, label == UNDECIDED, is_spurious, is_wrong, is_relief], range(len(KINDS) - 1), len(KINDS) - 1
    )
    return kind, solve(graph, SolveOptions(time_limit_s=time_limit)).connected


if __name__ == "__main__":
    main()
