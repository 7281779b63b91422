"""The walls of a made scene: which parallelograms are one surface to whoever guesses depth from a photo.

A *wall* is a surface of one body that is flat but for relief: a facade with its windows, sills and courses, the ground
with its kerbs, one side of a car, the crown of a tree.
"""

import numpy as np

from linecad.arrays import Float, Int
from linecad.dataset.truth import NOTHING, planes_of

# A network that guesses depth sees a facade as one thing, and errs in all of it alike. Had each pane and sill an error
# of its own, panes would stand metres before their walls.
RELIEF = 0.3  # m; parallel planes this near to each other are one wall, and what is narrower is none by itself
SAME_DIRECTION = 1e-3  # between the components of parallel unit normals


def walls_of_quads(quads: Float, body: Int) -> Int:
    """The wall (Q,), counted from 0, that each of the parallelograms (Q, 4, 3), m, of bodies (Q,) is part of."""
    normal, offset, group = _planes(quads, body)
    broad = np.flatnonzero(_breadth(quads) >= RELIEF)
    order = broad[np.lexsort((offset[broad], group[broad]))]
    place, of_group = offset[order], group[order]
    starts = np.ones(len(order), bool)
    starts[1:] = (np.diff(of_group) != 0) | (np.diff(place) > RELIEF)
    walls: Int = np.full(len(quads), NOTHING)
    walls[order] = np.cumsum(starts) - 1
    first = np.flatnonzero(starts)
    last = np.append(first[1:], len(order)) - 1
    reach = np.stack([place[first], place[last]])
    middles = quads.mean(axis=1)
    count = len(first)
    relief = np.flatnonzero(walls == NOTHING)
    for number in np.unique(body[relief]).tolist():
        narrow = relief[body[relief] == number]
        own = np.flatnonzero(body[order[first]] == number)
        if len(own):
            walls[narrow] = own[_nearest(middles[narrow], normal[order[first[own]]], reach[:, own])]
        else:
            walls[narrow] = count
            count += 1
    return walls


def _planes(quads: Float, body: Int) -> tuple[Float, Float, Int]:
    """Unit normals (Q, 3), alike for parallel quads, offsets (Q,), m, and what parallel quads of a body share (Q,)."""
    normal, offset = planes_of(quads)
    direction = np.rint(normal / SAME_DIRECTION).astype(np.int64)
    leading = direction[np.arange(len(direction)), (direction != 0).argmax(axis=1)]
    sign = np.where(leading < 0, -1, 1)
    keys = np.column_stack([body, direction * sign[:, None]])
    _, group = np.unique(keys, axis=0, return_inverse=True)
    return normal * sign[:, None], offset * sign, group.ravel()


def _breadth(quads: Float) -> Float:
    """The distance (Q,), m, between the two long sides of parallelograms (Q, 4, 3)."""
    first, second = quads[:, 1] - quads[:, 0], quads[:, 3] - quads[:, 0]
    longest = np.maximum(np.linalg.norm(first, axis=1), np.linalg.norm(second, axis=1))
    breadth: Float = np.linalg.norm(np.cross(first, second), axis=1) / longest
    return breadth


def _nearest(points: Float, normal: Float, reach: Float) -> Int:
    """Which of W walls each of N points (N, 3) is nearest to: unit normals (W, 3), lowest and highest offset (2, W)."""
    height = points @ normal.T
    away = np.maximum(reach[0] - height, height - reach[1]).clip(min=0)
    nearest: Int = away.argmin(axis=1)
    return nearest
