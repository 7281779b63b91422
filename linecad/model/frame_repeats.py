"""Pieces of one edge that were given to two frames.

Where two frames are turned by a few degrees, noise may label a piece of a wall's edge as of the other. In the photo it
lies on the edge, in space it crosses it: the longer of the two is the edge.
"""

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.directions import UP
from linecad.geometry import segment_coordinates
from linecad.lines.details import TWIN
from linecad.model.clean.ends import NEAR
from linecad.scene import Lines


def edges_repeated(lines: Lines, frame: Int, forward: Float, width: float, spare: Bool | None = None) -> Int:
    """The row (N,) of the level line of another frame that each line is a piece of, its own for most.

    `lines` are in the world, `frame` (N,) is that of each, `forward` (3,) the camera's z and `width` that of the photo,
    px. With `spare` (N,), the others stay as they are.
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
    """Which of the other lines (K,) the segment of a line lies on in the photo, from end to end."""
    segments, twin = lines.segment[others], TWIN.px(width)
    along, off = segment_coordinates(lines.segment[row], segments[:, None])  # (K, 2)
    length = np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1)
    lies: Bool = (np.abs(off) <= twin).all(axis=1) & (along.min(axis=1) >= -twin) & (along.max(axis=1) <= length + twin)
    return lies


def _is_near(lines: Lines, row: int, others: Int, forward: Float) -> Bool:
    """Which of the other lines (K,) pass the middle of a line in space."""
    middle = lines.ends[row].mean(axis=0)
    start = lines.ends[others, 0]
    along = lines.ends[others, 1] - start
    along = along / np.linalg.norm(along, axis=1)[:, None]
    off = middle - start
    away = np.linalg.norm(off - (off * along).sum(axis=1)[:, None] * along, axis=1)
    return np.asarray(away <= NEAR * abs(float(middle @ forward)))
