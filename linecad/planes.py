"""Lines in space to the Manhattan planes they lie on, with simple faces.

Lines that share a plane offset after lifting lie in one plane exactly. Its face is the convex hull of its lines: as
large as the evidence, without openings.
"""

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from linecad.scene import Face, Float, Int, Plane

MIN_LINES = 3  # two crossing lines span a plane too, but so do most false pairs
HULL_TOLERANCE = 1e-9  # of the plane's extent; corners that lie nearer to the hull's straight edges are left out


def find_planes(ends: Float, offset: Float, shared: Int, line_ids: Int) -> tuple[Plane, ...]:
    """Manhattan planes of lines `ends` (N, 2, 3) with the coordinates `offset` (N, 3) numbered by `shared` (N, 3).

    `shared` tells which coordinates chosen crossings made equal (-1: the line's own axis). Planes come in the order of
    their number of lines, then of their first line.
    """
    planes: list[tuple[int, float, Int]] = []
    for axis in range(3):
        numbers, counts = np.unique(shared[:, axis][shared[:, axis] >= 0], return_counts=True)
        for number in numbers[counts >= MIN_LINES]:
            members = np.flatnonzero(shared[:, axis] == number)
            planes.append((axis, float(offset[members[0], axis]), members))
    planes.sort(key=lambda plane: (-len(plane[2]), int(plane[2][0]), plane[0]))
    found: list[Plane] = []
    for axis, place, members in planes:
        outline = _hull(ends[members].reshape(-1, 3), axis)
        faces = () if outline is None else (Face(sum(len(plane.faces) for plane in found), outline),)
        found.append(Plane(len(found), axis, place, tuple(line_ids[members].tolist()), faces))
    return tuple(found)


def _hull(points: Float, axis: int) -> Float | None:
    """Convex hull (V, 3) of points (M, 3) in a plane of normal `axis`; None when they span no area."""
    flat = np.delete(points, axis, axis=1)
    extent = np.ptp(flat, axis=0)
    if not (extent > 0).all():
        return None
    try:
        # Qhull merges facets within its own tolerance, so the hull has no collinear corners.
        corners = ConvexHull(flat / extent).vertices
    except QhullError:
        return None
    ring = points[corners]
    before, after = np.roll(flat[corners], 1, axis=0), np.roll(flat[corners], -1, axis=0)
    first, second = (flat[corners] - before) / extent, (after - flat[corners]) / extent
    turn = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
    ring = ring[np.abs(turn) > HULL_TOLERANCE]
    return ring if len(ring) >= 3 else None
