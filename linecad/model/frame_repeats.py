"""Pieces of one edge that were given to two frames.

Where two frames are turned by a few degrees, noise may label a piece of a wall's edge as of the other. In the photo it
lies on the edge, in space it crosses it: the longer of the two is the edge.
"""

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.directions import UP
from linecad.geometry import gaps_between, segment_coordinates
from linecad.lines.details import TWIN
from linecad.model.clean.ends import NEAR
from linecad.scene import Lines

LEAST_COMMON = 0.5  # of a piece, that must lie beside the edge in the photo
MOST_OFF = 2.0  # times what parts two segments of one edge on average, at an end of the piece


def edges_repeated(lines: Lines, frame: Int, forward: Float, width: float, spare: Bool | None = None) -> Int:
    """The row (N,) of the level line of another frame that each line is a piece of, its own for most.

    `lines` are in the world, `frame` (N,) is that of each, `forward` (3,) the camera's z and `width` that of the photo,
    px. With `spare` (N,), the others stay as they are.

    A piece may reach beyond the edge by as much as lies beside it: two walls that meet in a corner do not overlap in
    the photo, but two detections of one edge do.
    """
    home = np.arange(len(lines))
    if not frame.any():
        return home
    spare = np.ones(len(lines), bool) if spare is None else spare
    length = np.linalg.norm(lines.segment[:, 1] - lines.segment[:, 0], axis=1)
    level = np.flatnonzero(lines.axis != UP)
    order = level[np.argsort(-length[level], kind="stable")]
    for place, row in enumerate(order.tolist()):
        longer = order[:place] if spare[row] else order[:0]
        other = longer[(home[longer] == longer) & (frame[longer] != frame[row])]
        other = other[lines.component[other] == lines.component[row]]
        on = other[_lies_on(lines, row, other, width) & _is_near(lines, row, other, forward)]
        if len(on):
            home[row] = int(on[0])
    return home


def _lies_on(lines: Lines, row: int, others: Int, width: float) -> Bool:
    """Which of the other lines (K,) the segment of a line lies on in the photo over half of it, on average."""
    segments, twin = lines.segment[others], TWIN.px(width)
    along, off = segment_coordinates(lines.segment[row], segments[:, None])  # (K, 2)
    length = np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1)
    common = np.minimum(along.max(axis=1), length) - np.maximum(along.min(axis=1), 0.0)
    # Noise turns a short segment, so that it crosses the edge: a corner or a second edge lies on one side of it.
    size, crosses = np.abs(off), off[:, 0] * off[:, 1] < 0
    mean = np.where(crosses, (off**2).sum(axis=1) / np.maximum(size.sum(axis=1), 1.0), size.sum(axis=1)) / 2
    lies: Bool = (
        (mean <= twin) & (size.max(axis=1) <= MOST_OFF * twin) & (common >= LEAST_COMMON * np.ptp(along, axis=1))
    )
    return lies


def _is_near(lines: Lines, row: int, others: Int, forward: Float) -> Bool:
    """Which of the other lines (K,) a line comes near to in space, anywhere along both.

    Near the horizon lines of all level directions look alike, so that the pieces of an edge may part behind.
    """
    depth = abs(float(lines.ends[row].mean(axis=0) @ forward))
    return np.asarray(gaps_between(lines.ends[row], lines.ends[others]) <= NEAR * depth)
