"""Walls whose upper edges are looked at, and what is above a level line of one.

It is told along *columns*, upright image lines, by its *height* on the wall's plane, so that what is level is of one
height, in whatever direction the photo looks.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from linecad.arrays import Bool, Float, Int
from linecad.directions import MAIN, UP, directions_of, is_first, partner
from linecad.geometry import rotation_about, world_rays
from linecad.model.regions.labels import Labels
from linecad.model.regions.raster import Raster
from linecad.model.regions.segments import View

RELIEF = 0.03  # log offset within which parallel walls are one below a roof: gutters and dormers stand before the wall
NORMAL_WIDTH = 1280.0  # px
NEARLY_NONE = 0.02  # of the samples of a wall


@dataclass(frozen=True, eq=False)
class Shown:
    """What the samples of a photo show."""

    raster: Raster
    view: View
    labels: Labels
    sky: Bool  # (H, W) for sure

    @property
    def pixel(self) -> float:
        """What a length of one pixel in a photo of NORMAL_WIDTH is in this one, px; no less than 1."""
        return max(self.view.camera.width / NORMAL_WIDTH, 1.0)

    @cached_property
    def label(self) -> Int:
        """(H, W)"""
        return self.labels.label[self.labels.cell].reshape(self.raster.shape)

    def rays(self, pixels: Float) -> Float:
        """(..., 3) world rays of pixels (..., 2), camera depth 1."""
        return world_rays(pixels, self.view.camera.matrix, self.view.rotation)

    def at(self, values: NDArray[Any], pixels: Float) -> NDArray[Any]:
        """Values (H, W) at pixels (..., 2); those of the border outside the photo."""
        rows, columns = self.raster.shape
        place = np.rint(self.raster.samples_of(pixels)).astype(np.int64)
        return np.asarray(values[np.clip(place[..., 1], 0, rows - 1), np.clip(place[..., 0], 0, columns - 1)])


def about_upright(angle: float) -> Float:
    """Rotation matrix (3, 3) about the upright, rad, from the first level axis of the world to the second."""
    return rotation_about(np.array([0.0, 0.0, angle]))


@dataclass(frozen=True, eq=False)
class Wall:
    """A wall of the photo, with those that stand a little before and behind it."""

    axis: int  # the axis of its frame that is nearest to its normal
    offset: float  # of its own plane
    normal: Float  # (3,) unit, level, in the world
    numbers: tuple[int, ...]  # of the surfaces
    is_shown: Bool  # (H, W)

    @property
    def along(self) -> int:
        """The axis nearest to the level direction in it."""
        return int(partner(self.axis))

    @property
    def direction(self) -> Float:
        """(3,) unit, the level direction in it."""
        sign = 1.0 if is_first(self.axis) else -1.0
        direction: Float = sign * np.array([-self.normal[1], self.normal[0], 0.0])
        return direction

    def turned(self, angle: float, pixel: Float, shown: Shown) -> "Wall":
        """The wall turned by an angle, rad, about the upright through the point of it that a pixel (2,) shows."""
        normal = about_upright(angle) @ self.normal
        return replace(self, normal=normal, offset=float(normal @ self.point(shown.rays(pixel))))

    def depths(self, rays: Float) -> Float:
        """How far (...) along world rays (..., 3) it is; not finite where a ray runs along it."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(self.offset / (rays @ self.normal))

    def heights(self, rays: Float) -> Float:
        """Heights (...) of points of the wall on world rays (..., 3); not finite where a ray runs along it."""
        with np.errstate(invalid="ignore"):
            return np.asarray(self.depths(rays) * rays[..., UP])

    def is_ahead(self, rays: Float) -> Bool:
        """Which world rays (..., 3) meet the wall before the camera."""
        return np.asarray(self.offset * (rays @ self.normal) > 0)

    def foot(self, shown: Shown) -> float:
        """The height down to which nearly all of it is seen."""
        return float(np.quantile(self.heights(shown.raster.rays[self.is_shown.ravel(), :MAIN]), NEARLY_NONE))

    def point(self, ray: Float) -> Float:
        """(3,) world, of the wall on the ray (3,) of a pixel."""
        point: Float = ray * self.depths(ray)
        return point

    def along_of(self, rays: Float) -> Float:
        """Places (...) along the wall of its points on world rays (..., 3)."""
        return np.asarray(self.depths(rays) * (rays @ self.direction))


def walls_of(shown: Shown) -> list[Wall]:
    """The walls of the photo, the largest first; each surface is of one."""
    label, surfaces, vectors = shown.label, shown.labels.surfaces, directions_of(shown.view.turns)
    area = np.bincount(label.ravel(), minlength=len(surfaces))
    groups: list[list[int]] = []
    for number in sorted(range(len(surfaces)), key=lambda number: (-int(area[number]), number)):
        own = surfaces[number]
        if own.kind != "wall" or area[number] == 0:
            continue
        for group in groups:
            lead = surfaces[group[0]]
            ratio = own.offset / lead.offset if own.axis == lead.axis else -1.0
            if ratio > 0 and abs(np.log(ratio)) < RELIEF:
                group.append(number)
                break
        else:
            groups.append([number])
    return [
        Wall(lead.axis, lead.offset, vectors[lead.axis], tuple(group), np.isin(label, group))
        for group in groups
        for lead in (surfaces[group[0]],)
    ]


@dataclass(frozen=True, eq=False)
class Profile:
    """J columns across the photo along a line of a wall, and what is above it."""

    wall: Wall
    low: float  # height of the line
    high: float  # height of the ridge
    eave: Float  # (J, 2) px, where the columns cross the line
    ridge: Float  # (J, 2) px, where they cross the ridge's height
    first: int  # column, and the last, below which the wall is seen
    last: int
    is_open: Bool  # (J,) of its stretch, nothing hides what is between line and sky
    is_ridge: Bool  # (J,) of its stretch, the sky begins at the height of the ridge
    rise: float  # samples from the line to the ridge
    depth: float  # samples from the line down to where the wall ends, BELOW at most
    contrast: float  # 0 to 1, of the colours above and below the line
    before_sky: float  # the same of what is above the line and of the sky above that
    uprights: tuple[float, float]  # pixels of upright edges a sample, above and below
    plants: float  # share of what is above
    of_wall: float  # share of the columns in which the wall is seen below the line, that the ridge is above
    goes_on: tuple[bool, bool]  # left and right, the sky begins nearly at the height of the ridge beside it too

    @property
    def ends(self) -> tuple[int, int]:
        """First and last column of the ridge."""
        own = np.flatnonzero(self.is_ridge)
        return int(own[0]), int(own[-1])

    @property
    def middle(self) -> int:
        """The column in the middle of what is seen of the wall below the ridge."""
        low, high = self.ends
        return (max(low, self.first) + min(high, self.last)) // 2

    def shares(self, other: "Profile") -> float:
        """Share of the narrower of two ridges, across the photo, that is above or below the other."""
        (low, high), (start, stop) = (np.sort(each.ridge[list(each.ends), 0]) for each in (self, other))
        return float((min(high, stop) - max(low, start)) / max(min(high - low, stop - start), 1e-9))
