"""How many segments run along another axis than their label says: python tests/benchmarks/labels.py DATASET ...

DATASET is York Urban, whose photos have lines marked with their axes, or a folder of made scenes. A segment counts
where half of it or more lies on one of these lines, the one along which it is longest, and it has a label along the
first frame. For each dataset prints the share that is labelled wrongly, of all and by the slope of the ray through the
line's middle: near the horizon, slope 0, all level lines look alike.
"""

import argparse
from concurrent.futures import ProcessPoolExecutor
from itertools import pairwise
from pathlib import Path

import numpy as np

from linecad.dataset.truth import Truth
from linecad.directions import MAIN
from linecad.evaluation.datasets import Case, find_dataset
from linecad.evaluation.frames import true_axes
from linecad.evaluation.measure import MARKED_ANGLE, MARKED_REACH
from linecad.evaluation.overlap import find_overlaps
from linecad.evaluation.references import MANHATTAN, MarkedLines, Reference, open_case
from linecad.finding import find_lines
from linecad.geometry import lengths, world_rays

COVERED = 0.5  # of a segment, by the line it lies on
SLOPES = (-np.inf, -0.2, -0.1, -0.05, 0.05, 0.1, 0.2, np.inf)


def lines_of(reference: Reference) -> MarkedLines:
    """Those that were marked, or the visible edges of a made scene along its axes."""
    if reference.lines is not None:
        return reference.lines
    truth = reference.truth
    return MarkedLines(np.zeros((0, 2, 2)), np.zeros(0, np.int64)) if truth is None else edges_of(truth)


def edges_of(truth: Truth) -> MarkedLines:
    along = truth.edges[:, 1] - truth.edges[:, 0]
    along = np.abs(along / np.linalg.norm(along, axis=1, keepdims=True))[truth.piece_edge]
    kept = along.max(axis=1) >= MANHATTAN
    return MarkedLines(truth.pieces[kept], along[kept].argmax(axis=1))


def measure(case: Case) -> np.ndarray:
    """(S, 2) of each segment on a line: slope of the ray there, is it labelled wrongly."""
    photo, reference = open_case(case)
    found = find_lines(photo, with_details=False)
    lines = lines_of(reference)
    if reference.rotation is None or len(lines.ends) == 0:
        return np.zeros((0, 2))
    # A made scene's rotation is that of its world, in which the axes are the columns too.
    names = true_axes(found.frame.rotation, reference.rotation)
    main = found.segments.subset(found.segments.axis < MAIN)
    rays = world_rays(lines.ends.mean(axis=1), found.camera.matrix, found.frame.rotation)
    slope = rays[:, 2] / lengths(rays[:, :2])
    rows = []
    for ends, axis, length in zip(main.ends, names[main.axis].tolist(), main.length.tolist(), strict=True):
        along = find_overlaps(ends, lines.ends, MARKED_REACH, MARKED_ANGLE)
        overlap = along.end - along.start
        if overlap.max(initial=0.0) > COVERED * length:
            line = along.piece[overlap.argmax()]
            rows.append((slope[line], axis != lines.axis[line]))
    return np.array(rows, np.float64).reshape(-1, 2)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("datasets", nargs="+", type=Path)
    parser.add_argument("--workers", type=int, default=2, help="processes")
    chosen = parser.parse_args()
    with ProcessPoolExecutor(chosen.workers) as pool:
        for folder in chosen.datasets:
            found = np.concatenate(list(pool.map(measure, find_dataset(folder).cases)))
            print(f"{folder.name}: {found[:, 1].mean():.2%} of {len(found)} segments labelled wrongly")
            for low, high in pairwise(SLOPES):
                own = found[(found[:, 0] > low) & (found[:, 0] <= high)]
                if len(own):
                    print(f"  slope {low:5.2f} to {high:5.2f}: {own[:, 1].mean():6.2%} of {len(own)}")


if __name__ == "__main__":
    main()
