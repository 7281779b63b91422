"""Where planes and faces differ from planar pairs and boundary flags, in words for the notes.

The decision makes both from crossings alone (the paper's pi and B); planes and faces come from the lines in space.
"""

import numpy as np
import shapely

from linecad.arrays import Bool, Int
from linecad.directions import MAIN, Turns, across, components, count_of, third
from linecad.scene import Lines, Plane

ROUNDING = 1e-9  # of an offset
ON_FACE = 1e-6  # of a plane's extent; a line so near to a face lies on it or on its edge


def disagreements(planes: tuple[Plane, ...], lines: Lines, planar_pairs: Int, turns: Turns = ()) -> list[str]:
    """One note for each kind of difference; none where all agree.

    `planar_pairs` (P, 3) are two parallel lines, by their place in `lines`, and the other axis of the plane in which
    the real crossings put them; `turns` are of further frames.
    """
    notes = []
    apart = int((~in_one_plane(lines, planar_pairs, turns)).sum())
    if apart:
        notes.append(
            f"{apart} of {len(planar_pairs)} pairs of parallel lines that real crossings put in one plane lie in two"
        )
    bounds, shown = bounding(planes, lines, turns)
    differ = int((shown & (bounds != lines.is_boundary)).sum())
    if differ:
        notes.append(
            f"{differ} of {int(shown.sum())} lines at faces are boundaries by their crossings and touch faces of one "
            "direction only, or the other way round"
        )
    return notes


def in_one_plane(lines: Lines, planar_pairs: Int, turns: Turns = ()) -> Bool:
    """Which pairs (P,) have both lines in one plane of the normal that is neither theirs nor the pair's other axis."""
    first, second, other = planar_pairs.reshape(-1, 3).T
    normal = third(lines.axis[first], other)
    ends = components(lines.ends[:, 0], turns)
    apart = np.abs(ends[first, normal] - ends[second, normal])
    # Coordinates of further frames are turned ones, and exact to rounding.
    return np.asarray(apart <= ROUNDING * np.abs(ends[first, normal]) * (normal >= MAIN))


def bounding(planes: tuple[Plane, ...], lines: Lines, turns: Turns = ()) -> tuple[Bool, Bool]:
    """Which lines (N,) touch faces of both planes' directions that they can lie in, and which touch any."""
    row = {number: index for index, number in enumerate(lines.id.tolist())}
    touched = np.zeros((len(lines), count_of(turns)), bool)
    ends = components(lines.ends, turns)
    for plane in planes:
        members = np.array([row[number] for number in plane.lines], np.int64)
        if len(members) == 0:
            continue
        flat = sorted(across(np.array(plane.axis)).tolist())
        pieces = shapely.linestrings(ends[members][:, :, flat])
        reach = ON_FACE * float(np.ptp(ends[members][:, :, flat], axis=(0, 1)).max())
        for face in plane.faces:
            shell, *holes = (components(ring, turns)[:, flat] for ring in (face.outline, *face.holes))
            polygon = shapely.Polygon(shell, holes)
            area = polygon.buffer(reach)
            shapely.prepare(area)
            near = np.flatnonzero(shapely.intersects(area, pieces))
            along = shapely.length(shapely.intersection(pieces[near], area))
            touched[members[near], plane.axis] |= along > 2 * reach
    count = touched.sum(axis=1)
    return count == 2, count > 0
