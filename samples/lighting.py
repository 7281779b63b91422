"""Soft light from the sky, from windows and between walls, computed on coarse grids over the faces.

All values are irradiance divided by pi, so that a face's radiance is its albedo times its light.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from modelling import PLANE_AXES, Face, Float
from raycaster import TOUCHING, blocked
from surfaces import linear

OCCLUDER_AREA = 0.12  # m^2, smaller faces throw no soft shadow
LONGEST_GRID = 160  # points along a side of a light map
FROM_BELOW = 0.3  # what comes up through a window, from the ground, in units of what comes down from the sky


@dataclass(frozen=True, eq=False)
class LightMap:
    """Soft light on a face: irradiance / pi on a grid of points, read between them bilinearly."""

    face: Face
    values: Float  # (V, U, 3)

    def at(self, u: Float, v: Float) -> Float:
        """(N, 3) at plane points."""
        rows, columns = self.values.shape[:2]
        x = np.clip((u - self.face.low[0]) / (self.face.high[0] - self.face.low[0]) * columns - 0.5, 0, columns - 1)
        y = np.clip((v - self.face.low[1]) / (self.face.high[1] - self.face.low[1]) * rows - 0.5, 0, rows - 1)
        x0, y0 = x.astype(int), y.astype(int)
        x1, y1 = np.minimum(x0 + 1, columns - 1), np.minimum(y0 + 1, rows - 1)
        fx, fy = (x - x0)[:, None], (y - y0)[:, None]
        upper = self.values[y0, x0] * (1 - fx) + self.values[y0, x1] * fx
        lower = self.values[y1, x0] * (1 - fx) + self.values[y1, x1] * fx
        light: Float = upper * (1 - fy) + lower * fy
        return light


Light = Callable[[list[Face], Float, Float], Float]  # occluders, points (N, 3), normals (N, 3) -> light (N, 3)


def light_maps(faces: list[Face], seen: NDArray[np.int64], light: Light, spacing: float) -> dict[int, LightMap]:
    """Light maps of the faces that are seen, computed for all of them at once; `spacing` of their points in m."""
    if len(seen) == 0:
        return {}
    grids, points, normals = [], [], []
    for number in seen:
        face = faces[number]
        columns, rows = (int(np.clip(np.ceil((face.high[i] - face.low[i]) / spacing), 1, LONGEST_GRID)) for i in (0, 1))
        u = face.low[0] + (np.arange(columns) + 0.5) / columns * (face.high[0] - face.low[0])
        v = face.low[1] + (np.arange(rows) + 0.5) / rows * (face.high[1] - face.low[1])
        grid = np.empty((rows, columns, 3))
        grid[..., face.axis] = face.offset + 2 * TOUCHING * face.sign
        grid[..., PLANE_AXES[face.axis][0]], grid[..., PLANE_AXES[face.axis][1]] = u[None], v[:, None]
        normal = np.zeros(3)
        normal[face.axis] = face.sign
        grids.append((number, grid.shape))
        points.append(grid.reshape(-1, 3))
        normals.append(np.broadcast_to(normal, (rows * columns, 3)))
    occluders = [face for face in faces if face.surface.casts and face.area > OCCLUDER_AREA]
    values = light(occluders, np.concatenate(points), np.concatenate(normals))
    maps, start = {}, 0
    for (number, shape), flat in zip(grids, points, strict=True):
        here = values[start : start + len(flat)].reshape(shape)
        start += len(flat)
        buried = _buried(faces, faces[number], flat).reshape(shape[:2])
        maps[int(number)] = LightMap(faces[number], _filled(here, buried))
    return maps


def _buried(faces: list[Face], face: Face, points: Float) -> NDArray[np.bool_]:
    """Which points (N, 3) on a face lie inside a box that stands on it.

    Looking up from there, the first thing that is met is met from behind.
    """
    nearest, from_behind = np.full(len(points), np.inf), np.zeros(len(points), bool)
    first, second = PLANE_AXES[face.axis]
    u, v = points[:, first], points[:, second]
    for other in faces:
        if other.axis != face.axis:
            continue
        above = (other.offset - face.offset) * face.sign
        if above > 2 * TOUCHING:
            closer = (above < nearest) & other.covers(u, v)
            nearest[closer], from_behind[closer] = above, other.sign == face.sign
    return from_behind


def _filled(values: Float, buried: NDArray[np.bool_]) -> Float:
    """Light (V, U, 3) with the buried points given the mean of their neighbours, from the rim inwards."""
    values, known = values.copy(), ~buried
    while known.any() and not known.all():
        weight = np.pad(known.astype(float), 1)
        light = np.pad(values * known[..., None], ((1, 1), (1, 1), (0, 0)))
        corners = [(y, x) for y in range(3) for x in range(3)]
        size = np.s_[: known.shape[0], : known.shape[1]]
        total = sum(weight[y:, x:][size] for y, x in corners)
        mean = sum(light[y:, x:][size] for y, x in corners) / np.maximum(total, 1)[..., None]
        new = ~known & (total > 0)
        values[new] = mean[new]
        known |= new
    return values


def hemisphere(count: int) -> Float:
    """Directions (count, 3) about z with a density that follows the cosine, evenly spread (a Fibonacci lattice)."""
    order = np.arange(count) + 0.5
    radius, turn = np.sqrt(order / count), order * np.pi * (3 - np.sqrt(5))
    return np.column_stack([radius * np.cos(turn), radius * np.sin(turn), np.sqrt(1 - order / count)])


def about(normals: Float, direction: Float) -> Float:
    """A direction (3,) given about z, turned to lie about each normal (N, 3), which is a world axis."""
    axis = np.argmax(np.abs(normals), axis=1)
    turned = np.empty_like(normals)
    for number in range(3):
        here = axis == number
        first, second = PLANE_AXES[number]
        turned[here, first], turned[here, second] = direction[0], direction[1]
        turned[here, number] = direction[2] * normals[here, number]
    return turned


def outdoor_light(directions: int) -> Light:
    """Light of an overcast-to-blue sky, of sunlit ground, and of the walls around."""
    zenith, horizon = linear("#86aede"), linear("#e3e8ec")
    from_ground, from_walls = 0.42 * linear("#a89f90"), 0.30 * linear("#b8a78f")

    def light(occluders: list[Face], points: Float, normals: Float) -> Float:
        total = np.zeros_like(points)
        for direction in hemisphere(directions):
            towards = about(normals, direction)
            height = np.clip(towards[:, 2:], 0, 1)
            free = np.where(towards[:, 2:] > 0, horizon + (zenith - horizon) * height**0.6, from_ground)
            total += np.where(blocked(occluders, points, towards, 30.0)[:, None], from_walls, free)
        return total / directions

    return light


@dataclass(frozen=True)
class Lamp:
    """A rectangle that shines like a window: brighter downwards than upwards."""

    axis: int  # of its normal
    sign: int
    offset: float  # m
    low: tuple[float, float]  # m, plane coordinates
    high: tuple[float, float]  # m
    radiance: tuple[float, float, float]


def indoor_light(lamps: list[Lamp], ambient: tuple[float, float, float], samples: int, directions: int) -> Light:
    """Light of windows and lamps with soft shadows, and ambient light that corners and furniture keep off."""
    reach = 1.3  # m; things farther away take no ambient light

    def light(occluders: list[Face], points: Float, normals: Float) -> Float:
        free = np.zeros(len(points))
        for direction in hemisphere(directions):
            free += ~blocked(occluders, points, about(normals, direction), reach)
        total: Float = (free / directions)[:, None] * np.array(ambient)
        for lamp in lamps:
            area = (lamp.high[0] - lamp.low[0]) * (lamp.high[1] - lamp.low[1])
            for u, v in _spread(samples):
                spot = np.empty(3)
                spot[lamp.axis] = lamp.offset
                first, second = PLANE_AXES[lamp.axis]
                spot[first] = lamp.low[0] + u * (lamp.high[0] - lamp.low[0])
                spot[second] = lamp.low[1] + v * (lamp.high[1] - lamp.low[1])
                towards = spot - points
                square = (towards**2).sum(axis=1)
                leaves = np.maximum(-lamp.sign * towards[:, lamp.axis], 0)
                arrives = np.maximum((towards * normals).sum(axis=1), 0)
                weight = leaves * arrives / np.maximum(square, 0.04) ** 2
                weight *= np.where(towards[:, 2] < 0, FROM_BELOW, 1.0)
                weight *= ~blocked(occluders, points, towards, 0.999)
                total += weight[:, None] * np.array(lamp.radiance) * (area / samples / np.pi)
        return total

    return light


def _spread(count: int) -> Float:
    """Points (count, 2) evenly over the unit square (the R2 sequence)."""
    order = np.arange(1.0, count + 1)
    spread: Float = np.column_stack([order * 0.7548776662466927 % 1, order * 0.5698402909980532 % 1])
    return spread
