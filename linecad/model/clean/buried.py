"""Uprights that run on below the ground end on it: what the photo shows there is the ground, and what it mirrors.

An edge of a wall and the joint of the paving before it, or a locker and its reflection in the floor, are one line in
the photo. Where most of a line or another one that crosses it is below the ground, the ground may be what is wrong.
"""

from dataclasses import dataclass, replace

import numpy as np
import shapely

from linecad.arrays import Bool
from linecad.directions import UP
from linecad.geometry import project
from linecad.model.clean.ends import NEAR, ends_that_meet, nearest_crossings
from linecad.model.clean.joining import with_ends
from linecad.model.clean.sight import Sight
from linecad.model.clean.strokes import strokes_of
from linecad.scene import Lines, Plane

MOST_BURIED = 0.5  # of a line


@dataclass(frozen=True, eq=False)
class Ground:
    """A face of the ground in the photo, with what stands before it."""

    polygon: shapely.Geometry  # px
    height: float  # along the upright axis


def grounds_of(planes: tuple[Plane, ...], sight: Sight) -> tuple[Ground, ...]:
    """All faces of ground."""
    found = []
    for plane in planes:
        for face in plane.faces if plane.axis == UP else ():
            if face.kind == "ground":
                rings = [project(ring, sight.matrix, sight.rotation) for ring in (face.outline, *face.holes)]
                polygon = shapely.make_valid(shapely.Polygon(rings[0], rings[1:]))
                shapely.prepare(polygon)
                found.append(Ground(polygon, plane.offset))
    return tuple(found)


def ending_on_ground(lines: Lines, grounds: tuple[Ground, ...], sight: Sight, stays: Bool) -> Lines:
    """The lines with uprights cut off at the ground that end below it, in the air, where the photo has this ground.

    Ends that `stays` (N, 2) marks are not asked.
    """
    strokes = strokes_of(lines, sight.forward)
    upright = np.flatnonzero((strokes.axis == UP) & ~(ends_that_meet(strokes) | stays)[:, 0])
    if not grounds or len(upright) == 0:
        return lines
    pixel = sight.pixels(strokes.points(strokes.reach)[upright, 0])
    before = np.isfinite(pixel).all(axis=1)
    upright, pixel = upright[before], pixel[before]
    last_crossing = strokes.reach[upright, 0] + nearest_crossings(strokes, upright, np.zeros_like(upright))[1]
    (low, high), near = strokes.reach[upright].T, NEAR * np.abs(strokes.end_depth[upright])
    reach = strokes.reach.copy()
    for ground in grounds:
        buried = (low < ground.height - near[:, 0]) & (high > ground.height + near[:, 1])
        buried &= (ground.height - low <= MOST_BURIED * (high - low)) & (last_crossing >= ground.height - near[:, 0])
        reach[upright[buried & shapely.contains_xy(ground.polygon, pixel)], 0] = ground.height
    return with_ends(lines, replace(strokes, reach=reach))
