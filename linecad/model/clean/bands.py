"""Lines that run across most of a face from side to side: eaves, cornices, plinths, the edges of pilasters."""

import numpy as np
import shapely
from numpy.typing import NDArray

from linecad.arrays import Bool, Float, Int
from linecad.model.clean.strokes import Strokes
from linecad.scene import Face, Plane

LEAST_ACROSS = 0.6  # of the way from side to side of a face, at the place of the line
LEAST_WAY = 0.5  # of the extent of the face, that the way from side to side must have there
RELIEF = 0.05  # of the depth, by which a line may stand before or behind the face


def run_across(strokes: Strokes, planes: tuple[Plane, ...]) -> Bool:
    """Which strokes (N,) run across a face, as the camera sees them on it."""
    across = np.zeros(len(strokes.axis), bool)
    for plane in planes:
        near = np.abs(strokes.offset[:, plane.axis] - plane.offset) <= RELIEF * np.abs(strokes.depth)
        beside = near & (strokes.axis != plane.axis) & (strokes.offset[:, plane.axis] * plane.offset > 0)
        for face in plane.faces:
            for axis in (each for each in range(3) if each != plane.axis):
                own = np.flatnonzero(beside & (strokes.axis == axis) & ~across)
                across[own] = _crosses(strokes, own, plane, face, axis)
    return across


def _crosses(strokes: Strokes, own: Int, plane: Plane, face: Face, axis: int) -> Bool:
    """Which of the strokes in the rows `own` (P,), which run along `axis`, cross a face."""
    other = 3 - plane.axis - axis
    polygon = shapely.Polygon(face.outline[:, [axis, other]])
    low, high = face.outline[:, axis].min(), face.outline[:, axis].max()
    onto = plane.offset / strokes.offset[own, plane.axis]  # along the rays of the camera
    at, reach = strokes.offset[own, other] * onto, strokes.reach[own] * onto[:, None]
    crosses: Bool = np.ptp(reach, axis=1) >= LEAST_ACROSS * LEAST_WAY * (high - low)  # others are soon left out
    at, reach = at[crosses], reach[crosses]
    way = shapely.intersection(polygon, _level(np.tile([low, high], (len(at), 1)), at))
    length = np.asarray(shapely.length(way))
    run = np.asarray(shapely.length(shapely.intersection(way, _level(reach, at))))
    crosses[crosses] = (length > 0) & (length >= LEAST_WAY * (high - low)) & (run >= LEAST_ACROSS * length)
    return crosses


def _level(reach: Float, at: Float) -> NDArray[np.object_]:
    """Straight lines over `reach` (P, 2) of the first coordinate at places (P,) of the second."""
    ends = np.stack([reach, np.repeat(at[:, None], 2, axis=1)], axis=2)
    return np.asarray(shapely.linestrings(ends), object)
