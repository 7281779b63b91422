"""How exact a depth map is, told by itself: surfaces that meet along a line of the photo have one depth there.

A foot of a wall on its ground, a corner of two walls, an eave: each side of the line is a plane along known axes, by
the map, and both reach the line at the same depth, or the map is off. Where one side hides the other they do not, so
some of the jumps that are found say nothing.
"""

from dataclasses import dataclass

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.depth.depth_map import DepthMap, Kind, camera_depths
from linecad.directions import MAIN
from linecad.geometry import lengths, unit_normals, world_rays
from linecad.line_graph import Segments
from linecad.ties.setting import Sight

ALONG = np.linspace(0.06, 0.94, 10)  # of a line's length
BESIDE = np.array([0.005, 0.007, 0.009, 0.012, 0.015, 0.019, 0.024])  # of the photo's width, beyond bleeding edges
LEAST_LENGTH = 0.02  # of the photo's width
LEAST_SEEN = 0.7  # share of the samples of a side that the map has
FLAT = 0.012  # log depth, the median by which samples of a side are off its plane
SAME_PLANE = 0.03  # log of the distance from the camera
WIDTHS = np.geomspace(0.01, 0.5, 48)  # log depth, half widths at half maximum of a wall's error
USUAL, SPREAD = 0.02, 1.0  # before anything is seen: the middle of published networks; log, standard deviation
MEET, EXACT = 0.95, 0.01  # share of jumps that are at corners; log depth, width of those of an exact map
ELSEWHERE = 0.4  # log depth, mean of the other jumps


@dataclass(frozen=True, eq=False)
class _Sides:
    """What a map shows on one side of each of N lines."""

    normal: Int  # (N,) the axis across which it is flattest; -1 where it is not flat
    log_offset: Float  # (N,) log of the distance of that plane from the camera


def jumps_at_corners(depth: DepthMap, kind: Kind, shift: float, segments: Segments, sight: Sight) -> Float:
    """By how much the log depths of both sides differ at lines (J,), for pairs of planes along other axes, each once.

    The longest line of each pair counts. Lines of further frames, and short ones, tell nothing.
    """
    along = np.diff(segments.ends, axis=1)[:, 0]
    length = lengths(along)
    chosen = np.flatnonzero((segments.axis >= 0) & (segments.axis < MAIN) & (length > LEAST_LENGTH * sight.width))
    if len(chosen) == 0:
        return np.zeros(0)
    chosen = chosen[np.argsort(-length[chosen], kind="stable")]
    ends, axis = segments.ends[chosen], segments.axis[chosen]
    on = ends[:, None, 0] + ALONG[:, None] * (ends[:, 1] - ends[:, 0])[:, None]  # lines, along, x and y
    across = unit_normals(along[chosen])
    one, other = (_side(depth, kind, shift, on, sign * sight.width * across, axis, sight) for sign in (1, -1))
    told = (one.normal >= 0) & (other.normal >= 0) & (one.normal != other.normal)
    if not told.any():
        return np.zeros(0)
    one, other, on = (
        _Sides(one.normal[told], one.log_offset[told]),
        _Sides(other.normal[told], other.log_offset[told]),
        on[told],
    )
    jumps = _log_depth_on(one, on, sight) - _log_depth_on(other, on, sight)
    return np.abs(jumps[_distinct(one, other)])


def _side(depth: DepthMap, kind: Kind, shift: float, on: Float, across: Float, axis: Int, sight: Sight) -> _Sides:
    """The planes on the side of lines along axes (N,) to which `across` (N, 2) points; points on them are (N, P, 2)."""
    pixels = on[:, :, None] + BESIDE[:, None] * across[:, None, None]
    column, row = np.moveaxis(np.rint(pixels).astype(np.int64), -1, 0)
    inside = (column >= 0) & (column < depth.width) & (row >= 0) & (row < depth.height)
    column, row = np.where(inside, column, 0), np.where(inside, row, 0)
    seen: Bool = inside & depth.valid[row, column]
    rays = world_rays(pixels.reshape(-1, 2), sight.matrix, sight.rotation)[:, :MAIN].reshape(*pixels.shape[:3], MAIN)
    found = camera_depths(depth.values[row, column].astype(np.float64), np.linalg.norm(rays, axis=-1), kind, shift)
    normal, log_offset = np.full(len(on), -1), np.zeros(len(on))
    flattest = np.full(len(on), FLAT)
    for number in np.flatnonzero(seen.mean(axis=(1, 2)) >= LEAST_SEEN).tolist():
        own = seen[number]
        for turn in (1, 2):
            across_axis = int(axis[number] + turn) % MAIN
            towards = rays[number][own][:, across_axis]
            if not ((towards > 0).all() or (towards < 0).all()):
                continue
            offset = np.log(found[number][own] * np.abs(towards))
            offset = offset[np.isfinite(offset)]
            if len(offset) == 0:
                continue
            middle = float(np.median(offset))
            off = float(np.median(np.abs(offset - middle)))
            if off < flattest[number]:
                normal[number], log_offset[number], flattest[number] = across_axis, middle, off
    return _Sides(normal, log_offset)


def _log_depth_on(sides: _Sides, on: Float, sight: Sight) -> Float:
    """(N,) log depth of planes on lines, by points on them (N, P, 2)."""
    rays = world_rays(on.reshape(-1, 2), sight.matrix, sight.rotation).reshape(*on.shape[:2], -1)
    towards = np.abs(np.take_along_axis(rays, sides.normal[:, None, None], axis=2))[:, :, 0]
    return np.asarray(sides.log_offset - np.log(np.median(towards, axis=1)))


def _distinct(one: _Sides, other: _Sides) -> Int:
    """The first line of each pair of planes."""
    swapped = one.normal > other.normal
    normals = np.sort(np.column_stack([one.normal, other.normal]), axis=1)
    offsets = np.column_stack([one.log_offset, other.log_offset])
    offsets[swapped] = offsets[swapped, ::-1]
    kept: list[int] = []
    for number in range(len(offsets)):
        same = (normals[kept] == normals[number]).all(axis=1)
        same &= (np.abs(offsets[kept] - offsets[number]) < SAME_PLANE).all(axis=1)
        if not same.any():
            kept.append(number)
    return np.array(kept, np.int64)


def width_by_corners(jumps: Float) -> float:
    """The most likely width of a map's errors, by its jumps at lines (J,): of corners the errors of two walls."""
    both = 2 * WIDTHS[:, None] + EXACT
    corner = 2 * both / (np.pi * (both**2 + jumps**2))
    density = MEET * corner + (1 - MEET) * np.exp(-jumps / ELSEWHERE) / ELSEWHERE
    likely = np.log(density).sum(axis=1) - 0.5 * (np.log(WIDTHS / USUAL) / SPREAD) ** 2
    return float(WIDTHS[int(likely.argmax())])
