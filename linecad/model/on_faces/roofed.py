"""Lines that the photo shows on a roof: ridges, dormers, chimneys. They stand on it.

Nothing but their own crossings puts such a line anywhere, and those with lines of the wall below put it into the wall.
"""

import numpy as np
import shapely

from linecad.arrays import Float, Int
from linecad.directions import UP, components, directions_of
from linecad.geometry import depths_beside, world_rays
from linecad.model.on_faces.seen import NO_FACE, SeenFaces
from linecad.model.regions.roofs import Roof
from linecad.scene import Lines

INSIDE = 0.004  # of the photo's width, by which a line on a roof may end outside it: a ridge is its border
BEFORE = 0.95  # times the depth of the wall below; a line that is nearer stands before the house
APART = 0.01  # of the depth; what is nearer to the roof is relief of it


def on_roofs(lines: Lines, roofs: tuple[Roof, ...], seen: SeenFaces, rotation: Float) -> tuple[Float, Int]:
    """By which factor (N,) lines in the world are farther that a roof shows, and the face (N,) of the wall below it.

    1 and NO_FACE for all others. A line at another distance along its rays looks the same. What is level along the
    roof lies on it then; an upright stands on it, and what runs into it ends there.
    """
    factor, below = np.ones(len(lines)), np.full(len(lines), NO_FACE)
    turns, matrix = seen.turns, seen.camera.matrix
    rays = world_rays(lines.segment, matrix, rotation)
    for roof in roofs:
        face = _face_below(roof, seen)
        if face == NO_FACE:
            continue
        area = shapely.buffer(roof.polygon, INSIDE * seen.camera.width)
        inside = shapely.contains_xy(area, lines.segment.reshape(-1, 2)).reshape(-1, 2).all(axis=1)
        rows = np.flatnonzero(inside & (below == NO_FACE))
        level, normal = directions_of(turns)[roof.axis], roof.normal(turns)
        at = rays[rows, _anchors(lines, rows, roof, level)]
        on_wall, on_roof = (vector @ roof.eave / (at @ vector) for vector in (level, normal))
        axis = lines.axis[rows]
        own = depths_beside(components(at, turns), components(lines.ends[rows, 0], turns), axis)
        with np.errstate(invalid="ignore"):
            ratio = on_roof / own
            moves = (own > BEFORE * on_wall) & (on_roof > 0) & (np.abs(ratio - 1) > APART)
        factor[rows[moves]], below[rows[moves]] = ratio[moves], face
    return factor, below


def _anchors(lines: Lines, rows: Int, roof: Roof, level: Float) -> Int:
    """The end (M,) of lines at which they meet the roof: the lower one, or the one farther from the eave."""
    back = level if level @ roof.eave > 0 else -level
    ends = lines.ends[rows]
    upright = lines.axis[rows] == UP
    return np.asarray(np.where(upright, ends[:, :, UP].argmin(axis=1), (ends @ back).argmax(axis=1)))


def _face_below(roof: Roof, seen: SeenFaces) -> int:
    """The face of the wall that carries a roof: the one that is nearest to its eave; NO_FACE where there is none."""
    wall = roof.eave @ directions_of(seen.turns)[roof.axis]
    off = [
        abs(plane.offset / wall - 1) if plane.axis == roof.axis and face.kind == "wall" else np.inf
        for plane, face in zip(seen.plane, seen.face, strict=True)
    ]
    return int(np.argmin(off)) if off and np.isfinite(min(off)) else NO_FACE
