"""What a depth map says of the parts of a photo: how deep they are, and walls that no line shows.

The map has been laid onto the bodies, so that its depths are those of the scene but for the errors of its walls. A
surface that is off the map's depth by several widths of these errors is not what is seen there, unless the map has it
elsewhere as a whole. Where none is near it and the map is flat along an axis, the map has a wall that lines do not.
"""

from dataclasses import dataclass, replace

import cv2
import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.depth.depth_map import DepthMap, camera_depths
from linecad.directions import UP, across
from linecad.geometry import homogeneous
from linecad.model.regions.raster import Raster
from linecad.model.regions.surfaces import Kind, Surface, apart
from linecad.scene import Camera, DepthKind

LEAST_WIDTH, MOST_WIDTH = 0.012, 0.08  # log depth; a map's wall is as uneven in itself, the widest maps are as far off
OF_PARTS = 1.5  # times the width that bodies and corners tell, the larger, which is found too small more often
MAP_COST, MOST_BY_MAP = 0.6, 3.0  # of a surface off the map, for each unit of the log of a Cauchy density; at most
SOLID_COST = 0.7  # of the sky, and of clutter, where the map has something else
LEVEL_WIDTH = 0.08  # log depth; feet tell the height of the ground no better
NEAR_LINES = 18.0  # samples from the lines of a surface, where the map shows no other one that faces the same way
WITHIN = 3.0  # widths, within which a surface explains the map
FLAT = 7  # samples across a window in which a wall of the map is even
EVEN = 0.7  # widths, by which it may be uneven there
LEAST_WALL = 0.01  # of the photo's samples, of a wall that only the map shows
LEAST_LEVEL = 0.04  # the same of a ground or ceiling that neither feet nor lines show
MOST_WALLS = 8
SLACK = 0.06  # of its offset, by which a wall without lines may go on beyond its box, which has the map's errors
BESIDE_LINES, LEAST_BESIDE = 3.0, 40  # samples from lines, and so many, that tell by how much the map is off a surface
MOST_OFF = 1.0  # log depth, by which the map may have a surface elsewhere
AGREEING, MOST_RIGHT = 0.5, 0.2  # least share of them that says the same, and most that has the surface where it is
SAME_LEVEL = 0.12  # log height within which feet or lines know the ground better than the map


@dataclass(frozen=True, eq=False)
class MappedDepths:
    """A depth map on a photo's pixels, and how its numbers tell depths in the scene's unit."""

    depth: DepthMap
    kind: DepthKind  # of its numbers
    shift: float  # added to them
    factor: float  # depth in the scene over depth in units of the map
    matrix: Float  # (3, 3) K of the photo, px
    width: float  # of the Cauchy error of its walls, log depth
    width_of_parts: float = np.inf  # the larger of what bodies and corners tell: whether the map is exact

    def at(self, rows: Int, columns: Int) -> Float:
        """(R, C) camera depth in the pixels of those rows (R,) and columns (C,); NaN where the map has none.

        Of a map of 6 megapixels the faces ask for one pixel in some hundred.
        """
        v, u = np.meshgrid(rows, columns, indexing="ij")
        return self._in(np.ix_(rows, columns), np.stack([u, v], axis=2))

    def near(self, pixels: Float) -> Float:
        """(M,) camera depth in the pixels nearest to places (M, 2); NaN where the map has none, or outside of it."""
        column, row = np.rint(pixels).astype(np.int64).T
        inside = (column >= 0) & (column < self.depth.width) & (row >= 0) & (row < self.depth.height)
        place = np.where(inside, row, 0), np.where(inside, column, 0)
        return np.where(inside, self._in(place, np.rint(pixels)), np.nan)

    def _in(self, place: tuple[Int, ...], pixels: Float) -> Float:
        """Camera depth in places of the map's arrays that are at such pixels (..., 2)."""
        rays = homogeneous(pixels.astype(np.float64)) @ np.linalg.inv(self.matrix).T
        values = np.where(self.depth.valid[place], self.depth.values[place], np.nan).astype(np.float64)
        found = camera_depths(values, np.linalg.norm(rays, axis=-1), self.kind, self.shift)
        return np.asarray(found * self.factor, np.float64)


def laid_on(raster: Raster, mapped: MappedDepths | None, camera: Camera) -> Raster:
    """The raster with the depths of a map, if there is one."""
    if mapped is None:
        return raster
    height, width = raster.shape
    row = np.minimum(((np.arange(height) + 0.5) * raster.step).astype(np.int64), camera.height - 1)
    column = np.minimum(((np.arange(width) + 0.5) * raster.step).astype(np.int64), camera.width - 1)
    believed = max(mapped.width, LEAST_WIDTH, min(OF_PARTS * mapped.width_of_parts, MOST_WIDTH))
    return replace(raster, map_depth=mapped.at(row, column).ravel(), map_width=believed)


def costs_by_map(raster: Raster, surfaces: list[Surface], depth: Float, limit: float) -> Float:
    """Costs (S, K + 2) of surfaces of such camera depths (S, K), of the sky and of clutter beside what a map says.

    0 where the map says nothing. Errors of walls are Cauchy's, and a whole wall of the map may be off by several
    widths: it tells which surface is seen, not that none is. So the nearest costs nothing, and a surface may be as
    deep as it stands or as the map has it as a whole. What has a depth within the `limit` is no sky, and what a surface
    explains no clutter.
    """
    assert raster.map_depth is not None
    levels = np.array([surface.kind in ("ground", "ceiling") for surface in surfaces], bool)
    width = np.where(levels, np.maximum(raster.map_width, LEVEL_WIDTH), raster.map_width)
    with np.errstate(divide="ignore", invalid="ignore"):
        off = np.log(raster.map_depth[:, None] / depth)
        off = np.minimum(np.abs(off), np.abs(off - _factors(raster, surfaces))) / width
        costs = np.minimum(MAP_COST * np.log1p(off**2), MOST_BY_MAP)
    costs = np.where(np.isfinite(depth), costs, MOST_BY_MAP)
    least = costs.min(axis=1, initial=MOST_BY_MAP)
    with np.errstate(invalid="ignore"):
        sky = SOLID_COST * (raster.map_depth < limit)
    clutter = SOLID_COST * (least < MAP_COST * np.log1p(WITHIN**2))
    found = np.column_stack([costs - least[:, None], sky, clutter])
    return np.where(np.isfinite(raster.map_depth)[:, None], found, 0.0)


def with_mapped(surfaces: list[Surface], raster: Raster, sure: Surface | None = None) -> list[Surface]:
    """The surfaces with walls that the map alone shows, the largest first; ground and ceiling where it has them.

    One of them that is `sure` stays where it is.
    """
    if raster.map_depth is None:
        return surfaces
    facing = _facing(raster)
    surfaces = [each if each is sure else _levelled(each, raster, facing) for each in surfaces]
    kinds = {surface.kind for surface in surfaces}
    levels: tuple[tuple[Kind, float], ...] = (("ground", -1.0), ("ceiling", 1.0))
    for kind, side in levels:
        count, level = _wall(UP, side, facing == UP, raster)
        if kind not in kinds and level is not None and count > LEAST_LEVEL * raster.size:
            surfaces = [*surfaces, Surface(kind, UP, level.offset, level.lines, None)]
    free = np.isfinite(raster.map_depth)
    for surface in surfaces:
        own = raster.distance(raster.marked(np.isin(raster.line, surface.lines))) < NEAR_LINES
        free &= ~((facing == surface.axis) & (own | _explains(surface, raster)))
    added: list[Surface] = []
    axes = [axis for axis in range(raster.rays.shape[1]) if axis != UP]
    while len(added) < MOST_WALLS:
        found = [_wall(axis, side, free & (facing == axis), raster) for axis in axes for side in (1.0, -1.0)]
        best = max(found, key=lambda each: each[0])
        if best[0] < LEAST_WALL * raster.size or best[1] is None:
            break
        added.append(best[1])
        free &= ~_explains(best[1], raster)
    return [*surfaces, *added]


def _explains(surface: Surface, raster: Raster) -> Bool:
    """Which samples (S,) the map has as deep as a surface."""
    assert raster.map_depth is not None
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = raster.map_depth * raster.rays[:, surface.axis] / surface.offset
        return np.asarray(np.abs(np.log(ratio)) < WITHIN * raster.map_width)


def _facing(raster: Raster) -> Int:
    """The axis (S,) along which the map's offset is even around each sample; -1 where along none."""
    assert raster.map_depth is not None
    facing, least = np.full(raster.size, -1), np.full(raster.size, EVEN * raster.map_width)
    for axis in range(raster.rays.shape[1]):
        with np.errstate(divide="ignore", invalid="ignore"):
            offset = np.log(np.abs(raster.map_depth * raster.rays[:, axis]))
        known = np.isfinite(offset)
        image = np.where(known, offset, 0.0).reshape(raster.shape)
        share = cv2.blur(known.astype(np.float64).reshape(raster.shape), (FLAT, FLAT))
        mean, square = (cv2.blur(each, (FLAT, FLAT)) / np.maximum(share, 1e-9) for each in (image, image**2))
        spread = np.sqrt(np.maximum(square - mean**2, 0)).ravel()
        better = known & (share.ravel() > 0.5) & (spread < least)
        facing[better], least[better] = axis, spread[better]
    return facing


def _factors(raster: Raster, surfaces: list[Surface]) -> Float:
    """Logs (K,) of the depths that the map gives surfaces over theirs: beside their lines, a level without by its own.

    0 where it says nothing, or not one thing, or something that can hardly be the same surface.
    """
    assert raster.map_depth is not None
    facing = _facing(raster)
    found = np.zeros(len(surfaces))
    for number, surface in enumerate(surfaces):
        seen = facing == surface.axis
        if len(surface.lines):
            seen &= raster.distance(raster.marked(np.isin(raster.line, surface.lines))) < BESIDE_LINES
            with np.errstate(divide="ignore", invalid="ignore"):
                off = np.log(raster.map_depth[seen] * raster.rays[seen, surface.axis] / surface.offset)
            off = off[np.isfinite(off)]
            if len(off) < LEAST_BESIDE:
                continue
            middle = float(np.median(off))
            from_middle = np.abs(off - middle)
            if (from_middle < WITHIN * raster.map_width).mean() >= AGREEING and (
                np.abs(off) < from_middle
            ).mean() <= MOST_RIGHT:
                found[number] = middle
        elif surface.kind in ("ground", "ceiling"):
            count, level = _wall(UP, float(np.sign(surface.offset)), seen, raster)
            if level is not None and count >= LEAST_LEVEL * raster.size:
                found[number] = np.log(level.offset / surface.offset)
    return np.where(np.abs(found) < MOST_OFF, found, 0.0)


def _wall(axis: int, side: float, free: Bool, raster: Raster) -> tuple[int, Surface | None]:
    """The wall across an axis, on one side of the camera, that most of the free samples (S,) show, and how many."""
    assert raster.map_depth is not None
    offset = raster.map_depth * raster.rays[:, axis]
    rows = np.flatnonzero(free & (offset * side > 0))
    if len(rows) == 0:
        return 0, None
    log_offset = np.sort(np.log(np.abs(offset[rows])))
    last = np.searchsorted(log_offset, log_offset + WITHIN * raster.map_width, side="right")
    first = int((last - np.arange(len(rows))).argmax())
    middle = float(np.median(log_offset[first : last[first]]))
    own = rows[np.abs(np.log(np.abs(offset[rows])) - middle) < WITHIN * raster.map_width]
    points = raster.rays[own] * raster.map_depth[own, None]
    box = np.percentile(points, [1, 99], axis=0)
    return len(own), Surface("wall", axis, side * float(np.exp(middle)), np.zeros(0, np.int64), None, box)


def _levelled(surface: Surface, raster: Raster, facing: Int) -> Surface:
    """A ground or ceiling at the map's height, where the height that feet or ends of lines gave is far off."""
    if surface.kind not in ("ground", "ceiling") or surface.plane is not None or len(surface.lines):
        return surface
    count, level = _wall(UP, float(np.sign(surface.offset)), facing == UP, raster)
    if level is None or count < LEAST_WALL * raster.size:
        return surface
    off = apart(level.offset, surface.offset)
    return replace(surface, offset=level.offset) if off > SAME_LEVEL else surface


def level_of_map(raster: Raster) -> float | None:
    """The offset, below 0, of the level below the camera that most of a map shows; None where none is large enough."""
    count, level = _wall(UP, -1.0, _facing(raster) == UP, raster)
    return None if level is None or count < LEAST_LEVEL * raster.size else level.offset


def is_of_map_at(surface: Surface, place: Surface) -> bool:
    """Whether a surface is a wall without lines, such as a map shows, where another one is, within SAME_LEVEL."""
    is_without = surface.box is not None and len(surface.lines) == 0
    return is_without and surface.axis == place.axis and apart(surface.offset, place.offset) < SAME_LEVEL


def cost_outside(surface: Surface, raster: Raster, depth: Float) -> Float:
    """Cost (S,) of a wall without lines, of such depths (S,), beyond its box."""
    assert surface.box is not None
    outside = np.zeros(raster.size, bool)
    met = np.where(np.isfinite(depth), depth, 0.0)
    for axis in across(np.array(surface.axis)).tolist():
        low, high = surface.box[:, axis]
        slack = SLACK * abs(surface.offset) * (raster.map_depth is not None)
        at = raster.rays[:, axis] * met
        outside |= (at < low - slack) | (at > high + slack)
    return np.where(outside, MOST_BY_MAP, 0.0)
