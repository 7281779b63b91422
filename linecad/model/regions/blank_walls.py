"""Blank walls outdoors: nothing shows of them but where they meet the ground.

A wall without a window has no line of its own: it was sky above the horizon and clutter or ground below it. But what
stands on a line on the ground, looks the same from there to above the horizon, and is no sky is a wall.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.directions import UP, components, partner
from linecad.geometry import lengths, world_rays
from linecad.model.regions.heaven import Heaven
from linecad.model.regions.raster import Raster
from linecad.model.regions.roofs import Sketch
from linecad.model.regions.segments import View
from linecad.model.regions.surfaces import RELIEF, Surface, apart

LEAST_LENGTH = 0.03  # of the photo's width, of the lines of a foot together
SAME_WALL = 0.06  # log offset; a foot that is no farther from a wall of lines is that wall's
LEAST_ABOVE, LEAST_BELOW = 0.003, 0.0001  # of the photo, of what is seen above and below the horizon
HIGHER = 1.0  # heights of the camera, so far above the horizon a wall is looked at,
AT_FOOT = 0.06  # and from so far above its foot
BEFORE = (0.75, 0.97)  # of a wall's distance, where the ground before it is looked at
ALIKE = np.array([16, 4, 5])  # of L*, a* and b*, within which parts of a wall look the same
LEAST_ALIKE = 0.6  # share of a wall that does, above and below the horizon,
LEAST_AT_TOP = 0.5  # and of each part above, to where it ends
PART = 1.25  # of the height of the part below
OTHER = 5.0  # Lab, between a wall and the ground before it
MOST_LINES, MOST_SKY = 0.03, 0.1  # share of a wall on lines of the scene, and that is sky for sure


@dataclass(frozen=True, eq=False)
class _Place:
    """Where a wall would stand."""

    along: int
    offset: float
    reach: tuple[float, float]  # of its foot, along

    @property
    def normal(self) -> int:
        return int(partner(self.along))


@dataclass(frozen=True, eq=False)
class _Scene:
    """What is looked at."""

    raster: Raster
    heaven: Heaven
    ground: float  # its offset, negative

    @cached_property
    def _colour(self) -> Float:
        """(S, 3) CIE L*a*b* of all samples."""
        return self.raster.colour.reshape(-1, 3).astype(np.float64)

    @cached_property
    def _on_line(self) -> Bool:
        """Which samples (S,) are on a line of the scene."""
        return self.raster.marked(np.ones(len(self.raster.at), bool))

    def wall(self, place: _Place) -> Surface | None:
        """The wall at a place; None where the photo shows none."""
        at, up = self._on_wall(place)
        with np.errstate(invalid="ignore"):
            there = (at >= place.reach[0]) & (at <= place.reach[1])
            below = there & (up < 0) & (up > (1 - AT_FOOT) * self.ground)
            above = there & (up > 0) & (up < -HIGHER * self.ground)
        before = self._before(place)
        least = [LEAST_ABOVE * self.raster.size, *2 * [LEAST_BELOW * self.raster.size]]
        if any(part.sum() < few for part, few in zip((above, below, before), least, strict=True)):
            return None
        colour, on_line = self._colour, self._on_line
        if on_line[above | below].mean() > MOST_LINES or self.heaven.seed[above].mean() > MOST_SKY:
            return None
        is_like = np.asarray((np.abs(colour - np.median(colour[above | below], axis=0)) < ALIKE).all(axis=1), bool)
        step = np.linalg.norm(np.median(colour[before], axis=0) - np.median(colour[below], axis=0))
        if min(is_like[above].mean(), is_like[below].mean()) < LEAST_ALIKE or step < OTHER:
            return None
        box = np.full((2, self.raster.rays.shape[1]), place.offset)
        box[:, UP], box[:, place.along] = (self.ground, self._top(up, there, is_like)), place.reach
        return Surface("wall", place.normal, place.offset, np.zeros(0, np.int64), None, box)

    def _on_wall(self, place: _Place) -> tuple[Float, Float]:
        """Where (S,) along the wall and how high each sample shows it; NaN where it does not."""
        rays = self.raster.rays
        with np.errstate(divide="ignore", invalid="ignore"):
            depth = place.offset / rays[:, place.normal]
            depth = np.where(np.isfinite(depth) & (depth > 0), depth, np.nan)
            return rays[:, place.along] * depth, rays[:, UP] * depth

    def _before(self, place: _Place) -> Bool:
        """Which samples (S,) show the ground right before the wall."""
        rays = self.raster.rays
        with np.errstate(divide="ignore", invalid="ignore"):
            depth = self.ground / rays[:, UP]
            at, away = rays[:, place.along] * depth, rays[:, place.normal] * depth / place.offset
            near: Bool = (depth > 0) & (away > BEFORE[0]) & (away < BEFORE[1])
            return near & (at >= place.reach[0]) & (at <= place.reach[1])

    def _top(self, up: Float, there: Bool, is_like: Bool) -> float:
        """Up to where what is above the horizon looks like the wall."""
        top = -HIGHER * self.ground
        while True:
            with np.errstate(invalid="ignore"):
                part = there & (up >= top) & (up < PART * top)
            if part.sum() < LEAST_BELOW * self.raster.size or is_like[part].mean() < LEAST_AT_TOP:
                return top
            top *= PART


def with_blank_walls(
    surfaces: list[Surface], sketch: Sketch, raster: Raster, heaven: Heaven, view: View
) -> list[Surface]:
    """The surfaces, and walls of which the photo shows no line but their foot, and that no wall of lines is near."""
    ground = next((each.offset for each in surfaces if each.kind == "ground"), None)
    if ground is None:
        return surfaces
    scene, found = _Scene(raster, heaven, ground), list(surfaces)
    for place in _feet(sketch, ground, raster, view):
        walls = [each.offset for each in found if each.kind == "wall" and each.axis == place.normal]
        if all(apart(offset, place.offset) >= SAME_WALL for offset in walls):
            found += filter(None, [scene.wall(place)])
    return found


def _feet(sketch: Sketch, ground: float, raster: Raster, view: View) -> Iterable[_Place]:
    """Where level lines below the horizon are if they lie on the ground, those in one place as one, longest first."""
    axes = components(view.rotation, raster.turns)
    rays = world_rays(sketch.whole.reshape(-1, 2), view.camera.matrix, axes).reshape(-1, 2, axes.shape[1])
    is_low = (rays[:, :, UP] < 0).all(axis=1)
    length = lengths(sketch.whole[:, 1] - sketch.whole[:, 0]) / view.camera.width
    for along in (axis for axis in range(axes.shape[1]) if axis != UP):
        rows = np.flatnonzero((sketch.axis == along) & is_low)
        ends = rays[rows] * (ground / rays[rows, :, UP])[:, :, None]
        left: Int = np.argsort(-length[rows], kind="stable")
        offset = ends[:, :, int(partner(along))].mean(axis=1)
        while len(left):
            first = left[0]
            near = np.array([each == first or apart(offset[each], offset[first]) < RELIEF for each in left], bool)
            reach = ends[left[near], :, along]
            if length[rows[left[near]]].sum() >= LEAST_LENGTH:
                yield _Place(along, float(offset[first]), (float(reach.min()), float(reach.max())))
            left = left[~near]
