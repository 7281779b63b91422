"""Closed rectangles of lines: four lines of one plane that end at each other, as the sides of a window do."""

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.model.clean.strokes import Strokes

CORNER = 0.003  # of the depth, by which a side may end short of a corner
SMALLEST, LARGEST = 0.015, 0.5  # sides: of the depth, and of what the lines of the plane cover
FEWEST_LINES = 8  # of a plane in which openings are looked for: four more than one has


def closed_rectangles(strokes: Strokes) -> Float:
    """Rectangles (W, 6) that lines close in planes of many lines, without those that lie in others.

    A row is the axis and the offset of the plane, and from where to where the rectangle reaches along the other two
    axes, the smaller axis first.
    """
    found = []
    for normal in range(3):
        order = np.lexsort((strokes.component, strokes.number[:, normal]))
        order = order[strokes.axis[order] != normal]
        plane = np.column_stack([strokes.number[order, normal], strokes.component[order]])
        starts = np.flatnonzero((np.diff(plane, axis=0, prepend=-1) != 0).any(axis=1))
        for own in np.split(order, starts[1:]):
            if len(own) >= FEWEST_LINES and np.ptp(strokes.axis[own]) > 0:
                found.append(_in_plane(strokes, normal, own))
    return np.concatenate([np.zeros((0, 6)), *found])


def _in_plane(strokes: Strokes, normal: int, own: Int) -> Float:
    u, v = (axis for axis in range(3) if axis != normal)
    along_u, along_v = own[strokes.axis[own] == u], own[strokes.axis[own] == v]
    extent = np.array([np.ptp(strokes.reach[each]) for each in (along_u, along_v)])
    depth = float(np.abs(strokes.depth[own]).min())
    offset, found = float(strokes.offset[own[0], normal]), []
    # Lines that end at the same two lines are opposite sides, or bars between them.
    ends, group = np.unique(strokes.reach[along_u], axis=0, return_inverse=True)
    for number, (left, right) in enumerate(ends.tolist()):
        levels = np.sort(strokes.offset[along_u[group.ravel() == number], v])
        if len(levels) < 2:
            continue
        left_sides, right_sides = (strokes.reach[along_v[strokes.offset[along_v, u] == at]] for at in (left, right))
        reach, stretch = CORNER * depth, (levels[:-1], levels[1:])
        closed = _spans(left_sides, *stretch, reach) & _spans(right_sides, *stretch, reach)
        starts = np.flatnonzero(closed & ~np.r_[False, closed[:-1]])
        stops = np.flatnonzero(closed & ~np.r_[closed[1:], False]) + 1
        found += [(normal, offset, left, right, levels[a], levels[b]) for a, b in zip(starts, stops, strict=True)]
    rows = np.array(found).reshape(-1, 6)
    size = np.column_stack([rows[:, 3] - rows[:, 2], rows[:, 5] - rows[:, 4]])
    rows = rows[(size >= SMALLEST * depth).all(axis=1) & (size <= LARGEST * extent).all(axis=1)]
    within = (rows[:, None, [2, 4]] >= rows[None, :, [2, 4]]).all(axis=2)
    within &= (rows[:, None, [3, 5]] <= rows[None, :, [3, 5]]).all(axis=2)
    outer: Float = rows[within.sum(axis=1) == 1]  # in none but itself
    return outer


def _spans(reach: Float, low: Float, high: Float, tolerance: float) -> Bool:
    """Which stretches (K,) from `low` to `high` one of the reaches (S, 2) covers."""
    covers = (reach[:, 0] <= low[:, None] + tolerance) & (reach[:, 1] >= high[:, None] - tolerance)
    return np.asarray(covers.any(axis=1))
