"""Uprights that run on below the ground end on it: what the photo shows there is the ground, and what it mirrors.

An edge of a wall and the joint of the paving before it, or a locker and its reflection in the floor, are one line in
the photo.
"""

from dataclasses import dataclass, replace

import numpy as np
import shapely

from linecad.arrays import Bool
from linecad.directions import UP
from linecad.geometry import project
from linecad.model.clean.ends import NEAR, ends_that_meet
from linecad.model.clean.joining import with_ends
from linecad.model.clean.sight import Sight
from linecad.model.clean.strokes import strokes_of
from linecad.scene import Lines, Plane


@dataclass(frozen=True, eq=False)
class Ground:
    """A face of the ground as the photo shows it."""

    polygon: shapely.Geometry  # px
    height: float  # along the upright axis


def grounds_of(planes: tuple[Plane, ...], sight: Sight) -> tuple[Ground, ...]:
    """All faces of ground; what a thing before them hides of them is part of them."""
    found = []
    for plane in planes:
        for face in plane.faces if plane.axis == UP else ():
            if face.kind == "ground":
                rings = [project(ring, sight.matrix, sight.rotation) for ring in (face.outline, *face.holes)]
                polygon = shapely.make_valid(shapely.Polygon(rings[0], rings[1:]))
                shapely.prepare(polygon)
                found.append(Ground(polygon, plane.offset))
    return tuple(found)


def ending_on_ground(lines: Lines, grounds: tuple[Ground, ...], sight: Sight, meets: Bool) -> Lines:
    """The lines with uprights cut off at the ground that end below it, in the air, where the photo shows it.

    Ends that meet others than these lines, `meets` (N, 2), stay, and so do lines of which no more than a miss is above
    the ground.
    """
    strokes = strokes_of(lines, sight.forward)
    upright = np.flatnonzero((strokes.axis == UP) & ~(ends_that_meet(strokes) | meets)[:, 0])
    if not grounds or len(upright) == 0:
        return lines
    pixel = sight.pixels(strokes.points(strokes.reach)[upright, 0])
    shown = np.flatnonzero(np.isfinite(pixel).all(axis=1))
    reach = strokes.reach.copy()
    for ground in grounds:
        on_it = upright[shown[shapely.contains_xy(ground.polygon, pixel[shown])]]
        near = NEAR * np.abs(strokes.end_depth[on_it])
        low, high = strokes.reach[on_it].T
        buried = on_it[(low < ground.height - near[:, 0]) & (high > ground.height + near[:, 1])]
        reach[buried, 0] = ground.height
    return with_ends(lines, replace(strokes, reach=reach))
