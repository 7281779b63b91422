"""Ends in the air drawn on to where they stop: at a line of their plane, or at the outline of a face in the photo.

Detection loses an edge where it grows faint. So an end that meets no line goes on to the first stop on its way if the
photo shows the edge between. Outlines stop a line in the photo: that of its own face, and that of a face before it,
behind which nobody sees where the line ends. An end that is near an outline already ends there.
"""

from dataclasses import dataclass, replace

import numpy as np

from linecad.arrays import Bool, Float, Int, true_places
from linecad.geometry import depths_beside, ring_sides, world_rays
from linecad.model.clean.ends import (
    MEETS,
    NEAR,
    close_ends,
    ends_that_meet,
    nearest_crossings,
    without_lost,
    without_new_twins,
)
from linecad.model.clean.joining import with_ends
from linecad.model.clean.sight import NEAREST, Sight
from linecad.model.clean.strokes import Strokes, strokes_of
from linecad.scene import Lines, Plane

FURTHEST = 3.0  # times what was seen of a line, that it is drawn on at most
OVERSHOOT = 0.025  # of the depth, and
MOST_CUT = 0.25  # of what was seen of a line: as much of it beyond the last line that it crosses is cut off
MOST_ROUNDS = 2  # a line that was drawn on stops others


@dataclass(frozen=True, eq=False)
class Stops:
    """The nearest stop of each of P ends."""

    place: Float  # (P,) along the line; nan for none
    is_sure: Bool  # (P,) so near that the end belongs there, whatever the photo shows


def settled(lines: Lines, outlines: Float, sight: Sight, meets: Bool | None = None) -> Lines:
    """The lines with their ends drawn on to where they stop; `outlines` (E, 2, 3) are edges of faces.

    Ends that meet others than these lines, `meets` (N, 2), stay.
    """
    strokes = settle_ends(strokes_of(lines, sight.forward), outlines, sight, meets)
    return with_ends(lines, strokes)


def outlines_of(planes: tuple[Plane, ...]) -> Float:
    """The edges (E, 2, 3) of all faces, of their holes, and of what hides parts of them."""
    faces = [face for plane in planes for face in plane.faces]
    return ring_sides(ring for face in faces for ring in (face.outline, *face.holes, *face.hidden))


def settle_ends(strokes: Strokes, outlines: Float, sight: Sight, meets: Bool | None = None) -> Strokes:
    """The strokes with the ends that meet no line at their stops; `outlines` (E, 2, 3) are edges of faces.

    Ends that meet lines that are not among the strokes, `meets` (N, 2), stay.
    """
    stays = np.zeros(strokes.reach.shape, bool) if meets is None else meets
    edges, depths = _seen(outlines, sight)
    found = strokes
    for _ in range(MOST_ROUNDS):
        drawn = without_new_twins(found, _drawn_once(found, strokes, edges, depths, sight, stays))
        if np.array_equal(drawn.reach, found.reach):
            break
        found = close_ends(drawn)[0]
    found = close_ends(_cut(found, strokes, at_outlines(found, outlines, sight) | stays))[0]
    return without_new_twins(strokes, found)  # closing ends may bring pieces of one line near, too


def _drawn_once(found: Strokes, seen: Strokes, edges: Float, depths: Float, sight: Sight, stays: Bool) -> Strokes:
    """The strokes `found` with each end in the air at its stop, where the photo leads `seen` strokes there.

    Not those that stay (N, 2).
    """
    line, end = np.nonzero(~ends_that_meet(found) & ~stays)
    stops = _nearest(found, line, end, edges, depths, sight)
    way = np.abs(stops.place - found.reach[line, end])
    goes = (way > MEETS * np.abs(found.end_depth[line, end])) & (way <= FURTHEST * np.ptp(seen.reach[line], axis=1))
    ask = np.flatnonzero(goes & ~stops.is_sure)
    ways = found.points(found.reach)[line[ask], end[ask]][:, None].repeat(2, axis=1)
    ways[np.arange(len(ask)), 1, found.axis[line[ask]]] = stops.place[ask]
    goes[ask] = sight.shows(sight.pixels(seen.points(seen.reach)[line[ask]]), sight.pixels(ways))
    reach = found.reach.copy()
    reach[line[goes], end[goes]] = stops.place[goes]
    # Both ends of a short line may be near one outline, which would leave nothing of it.
    return without_lost(found, replace(found, reach=reach))


def _cut(found: Strokes, seen: Strokes, stopped: Bool) -> Strokes:
    """The strokes with the ends in the air that overshoot a line by little at that line; not those `stopped` (N, 2)."""
    line, end = np.nonzero(~ends_that_meet(found) & ~stopped)
    over = nearest_crossings(found, line, end)[1]
    most = np.minimum(OVERSHOOT * np.abs(found.end_depth[line, end]), MOST_CUT * np.ptp(seen.reach[line], axis=1))
    cut = over <= most
    reach = found.reach.copy()
    reach[line[cut], end[cut]] -= np.where(end[cut] == 1, 1.0, -1.0) * over[cut]
    return replace(found, reach=reach)


def at_outlines(strokes: Strokes, outlines: Float, sight: Sight) -> Bool:
    """Which ends (N, 2) lie on an outline in the photo."""
    line, end = np.nonzero(np.ones(strokes.reach.shape, bool))
    place = _outlines_on(strokes, line, *_seen(outlines, sight), sight)
    off = np.abs(place - strokes.reach[line, end][:, None]) / np.abs(strokes.end_depth[line, end])[:, None]
    found: Bool = np.nan_to_num(off, nan=np.inf).min(axis=1, initial=np.inf) <= MEETS
    return found.reshape(strokes.reach.shape)


def _nearest(strokes: Strokes, line: Int, end: Int, edges: Float, depths: Float, sight: Sight) -> Stops:
    """The nearest stop of the ends `end` (P,) of lines (P,): an outline within NEAR, else the first ahead."""
    at, outwards = strokes.reach[line, end], np.where(end == 1, 1.0, -1.0)
    near = NEAR * np.abs(strokes.end_depth[line, end])
    way = (_outlines_on(strokes, line, edges, depths, sight) - at[:, None]) * outwards[:, None]
    closest = np.where(np.isnan(way), np.inf, np.abs(way)).min(axis=1, initial=np.inf)
    is_sure = closest <= near
    ahead = np.where(way > 0, way, np.inf).min(axis=1, initial=np.inf)
    ahead = np.minimum(ahead, nearest_crossings(strokes, line, end)[0])
    if way.shape[1]:
        pick = np.where(np.isnan(way), np.inf, np.abs(way)).argmin(axis=1)
        ahead = np.where(is_sure, way[np.arange(len(line)), pick], ahead)
    return Stops(np.where(np.isfinite(ahead), at + outwards * ahead, np.nan), is_sure)


def _seen(outlines: Float, sight: Sight) -> tuple[Float, Float]:
    """The edges (E, 2, 2) px of faces that lie before the camera, and the depths (E, 2) of their ends."""
    depths = outlines @ sight.forward
    before = (depths > NEAREST).all(axis=1)
    return sight.pixels(outlines[before]), depths[before]


def _outlines_on(strokes: Strokes, line: Int, edges: Float, depths: Float, sight: Sight) -> Float:
    """Where (P, E) along lines (P,) they cross edges in the photo that are not behind them; nan for nowhere."""
    ends = sight.pixels(strokes.points(strokes.reach))[line]  # (P, 2, 2)
    start, along = ends[:, 0], ends[:, 1] - ends[:, 0]
    first, across = edges[:, 0], edges[:, 1] - edges[:, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        turn = along[:, :1] * across[:, 1] - along[:, 1:] * across[:, 0]
        off_x, off_y = (start[:, axis, None] - first[:, axis] for axis in range(2))
        share = (off_x * along[:, 1:] - off_y * along[:, :1]) / -turn  # along the edge
        row, edge = true_places((share >= -MEETS) & (share <= 1 + MEETS))
        pixel = first[edge] + share[row, edge, None] * across[edge]
    seen = np.isfinite(pixel).all(axis=1)
    row, edge, pixel = row[seen], edge[seen], pixel[seen]
    place = np.full(turn.shape, np.nan)
    own = line[row]
    rays = world_rays(pixel, sight.matrix, sight.rotation)
    depth = depths_beside(rays, strokes.offset[own], strokes.axis[own])
    near, far = depths[edge].T
    behind = 1 / ((1 - share[row, edge]) / near + share[row, edge] / far) > depth * (1 + NEAR)
    keeps = (depth > NEAREST) & ~behind
    place[row[keeps], edge[keeps]] = (rays[np.arange(len(row)), strokes.axis[own]] * depth)[keeps]
    return place
