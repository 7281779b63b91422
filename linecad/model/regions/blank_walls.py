"""Blank walls outdoors: nothing shows of them but where they meet the ground.

A wall without a window has no line of its own: it was sky above the horizon and clutter or ground below it. But what
stands on a line on the ground, looks the same from there to above the horizon, and is no sky is a wall.
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.directions import UP, components, partner
from linecad.geometry import lengths, segment_coordinates, world_rays
from linecad.model.regions.heaven import Heaven
from linecad.model.regions.raster import Raster
from linecad.model.regions.roofs import Sketch
from linecad.model.regions.segments import View
from linecad.model.regions.surfaces import RELIEF, Surface, apart
from linecad.scene import Lines

LEAST_LENGTH = 0.03  # of the photo's width, of the lines of a foot together
SAME_LINE = 2.0  # px of a photo of 1000, from a line of the scene, within which a line is the same one
AT_GROUND = 0.04  # log height; what is farther from the ground lies on something else
SAME_WALL = 0.06  # log offset; a foot that is no farther from a wall is that wall's
LEAST_ABOVE, LEAST_SAMPLES = 0.003, 0.0001  # of the photo: above the horizon, and of any other part that is looked at
HIGHER = 1.0  # heights of the camera above the horizon, up to which a wall is compared with what is below
AT_FOOT = (0.03, 0.13)  # heights of the camera above the foot, between which the wall itself must begin
BEFORE = (0.75, 0.97)  # of a wall's distance, where the ground before it is looked at
ALIKE = np.array([16, 4, 5])  # of L*, a* and b*, within which parts of a wall look the same
LEAST_ALIKE = 0.6  # share that does of what is above the horizon, of what is below, and of what is at the foot
FIRST_PART, PART, LEAST_IN_PART = 0.3, 1.1, 0.5  # a wall ends where less of the next tenth of its height looks the same
OTHER = 5.0  # Lab, between a wall at its foot and the ground before it
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
            below = there & (up < 0) & (up > (1 - AT_FOOT[0]) * self.ground)
            foot = below & (up < (1 - AT_FOOT[1]) * self.ground)
            above = there & (up > 0) & (up < -HIGHER * self.ground)
        before = self._before(place)
        if min(part.mean() for part in (foot, before)) < LEAST_SAMPLES or above.mean() < LEAST_ABOVE:
            return None
        colour, on_line = self._colour, self._on_line
        if on_line[above | below].mean() > MOST_LINES or self.heaven.seed[above].mean() > MOST_SKY:
            return None
        is_like = np.asarray((np.abs(colour - np.median(colour[above | below], axis=0)) < ALIKE).all(axis=1), bool)
        step = np.linalg.norm(np.median(colour[before], axis=0) - np.median(colour[foot], axis=0))
        if min(is_like[part].mean() for part in (above, below, foot)) < LEAST_ALIKE or step < OTHER:
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
        """Up to where what is above the horizon looks like the wall, and a part more."""
        top = -FIRST_PART * self.ground
        while True:
            with np.errstate(invalid="ignore"):
                part = there & (up >= top) & (up < PART * top)
            top *= PART
            if part.mean() < LEAST_SAMPLES or is_like[part].mean() < LEAST_IN_PART:
                return top


def with_blank_walls(
    surfaces: list[Surface], sketch: Sketch, lines: Lines, raster: Raster, heaven: Heaven, view: View
) -> list[Surface]:
    """The surfaces, and walls of which the photo shows no line but their foot, and that no other wall is near."""
    ground = next((each.offset for each in surfaces if each.kind == "ground"), None)
    if ground is None:
        return surfaces
    scene, found = _Scene(raster, heaven, ground), list(surfaces)
    for place in _feet(_not_above(sketch, lines, ground, raster), ground, raster, view):
        walls = [each.offset for each in found if each.kind == "wall" and each.axis == place.normal]
        if all(apart(offset, place.offset) >= SAME_WALL for offset in walls):
            found += filter(None, [scene.wall(place)])
    return found


def _not_above(sketch: Sketch, lines: Lines, ground: float, raster: Raster) -> Sketch:
    """The sketch without the lines that the scene has somewhere else than on the ground: plinths and sills."""
    height = components(lines.ends, raster.turns)[:, 0, UP].tolist()
    elsewhere = np.array([apart(each, ground) >= AT_GROUND for each in height], bool)
    near = SAME_LINE / 1000 * raster.step * raster.shape[1]
    middle, kept = sketch.whole.mean(axis=1), np.ones(len(sketch.whole), bool)
    for line in np.flatnonzero(elsewhere).tolist():
        own = np.flatnonzero(sketch.axis == lines.axis[line])
        along, beside = segment_coordinates(middle[own], lines.segment[line])
        is_on = (along > 0) & (along < np.linalg.norm(lines.segment[line, 1] - lines.segment[line, 0]))
        kept[own[is_on & (np.abs(beside) < near)]] = False
    return replace(sketch, whole=sketch.whole[kept], axis=sketch.axis[kept])


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
