"""How many segments run along another axis than their label says: python tests/benchmarks/labels.py DATASET ...

DATASET is York Urban, whose photos have lines marked with their axes, or a folder of made scenes. A segment counts
where it lies on one of these lines and has a label along the first frame. For each dataset prints the share that is
labelled wrongly, of all and by the slope of the ray through the line's middle: near the horizon, slope 0, all level
lines look alike.
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
from linecad.evaluation.references import MarkedLines, Reference, open_case
from linecad.finding import find_lines
from linecad.geometry import lengths, unit_normals, world_rays

ACROSS = 3.0  # px from a line to both ends of a segment on it
TURNED = np.sin(np.radians(3.0))  # of a segment on it
COVERED = 0.5  # of a segment, by the line it lies on
ALONG_AXIS = 0.999  # cosine, of the edges of made scenes that count
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
    kept = along.max(axis=1) > ALONG_AXIS
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
    ends, axis = found.segments.ends, found.segments.axis
    length = lengths(ends[:, 1] - ends[:, 0])
    along = lines.ends[:, 1] - lines.ends[:, 0]
    normals, of_line = unit_normals(along), lengths(along)
    rays = world_rays(lines.ends.mean(axis=1), found.camera.matrix, found.frame.rotation)
    slope = rays[:, 2] / lengths(rays[:, :2])
    rows = []
    for number in np.flatnonzero(of_line > 0).tolist():
        from_start = ends - lines.ends[number, 0]
        across = from_start @ normals[number]
        at = from_start @ along[number] / of_line[number]
        overlap = np.minimum(at.max(axis=1), of_line[number]) - np.maximum(at.min(axis=1), 0.0)
        on = (np.abs(across).max(axis=1) < ACROSS) & (np.abs(across[:, 1] - across[:, 0]) < TURNED * length)
        on &= (overlap > COVERED * length) & (axis < MAIN)
        wrong = names[axis[on]] != lines.axis[number]
        rows.append(np.column_stack([np.full(len(wrong), slope[number]), wrong]))
    return np.concatenate([np.zeros((0, 2)), *rows])


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
