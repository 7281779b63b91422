"""Lines in space to the Manhattan planes they lie on.

Lines that share a plane offset after lifting lie in one plane exactly.
"""

import numpy as np

from linecad.arrays import Float, Int
from linecad.scene import Plane

MIN_LINES = 3  # two crossing lines span a plane too, but so do most false pairs


def find_planes(offset: Float, shared: Int, line_ids: Int) -> tuple[Plane, ...]:
    """Manhattan planes, without faces, of lines with coordinates `offset` (N, 3) numbered by `shared` (N, 3).

    `shared` tells which coordinates chosen crossings made equal (-1: the line's own axis). Planes come in the order of
    their number of lines, then of their first line.
    """
    planes: list[tuple[int, float, Int]] = []
    for axis in range(3):
        numbers, counts = np.unique(shared[:, axis][shared[:, axis] >= 0], return_counts=True)
        for number in numbers[counts >= MIN_LINES]:
            members = np.flatnonzero(shared[:, axis] == number)
            # The pieces of one line share its coordinates too, but one direction spans no plane.
            if len(np.unique((shared[members] < 0).argmax(axis=1))) == 2:
                planes.append((axis, float(offset[members[0], axis]), members))
    planes.sort(key=lambda plane: (-len(plane[2]), int(plane[2][0]), plane[0]))
    return tuple(
        Plane(number, axis, place, tuple(line_ids[members].tolist()))
        for number, (axis, place, members) in enumerate(planes)
    )
