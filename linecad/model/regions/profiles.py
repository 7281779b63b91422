"""The photo above a level line of a wall, column by column: how far up it goes before the sky begins.

A *column* is an upright image line. What is above a line of a wall is looked at along the columns through it, and told
by its *height* on the wall's plane, so that what is level is of one height, in whatever direction the photo looks.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from linecad.arrays import Bool, Float, Int
from linecad.directions import UP, components, directions_of, partner
from linecad.geometry import directions_to, project, vanishing_points, world_rays
from linecad.model.regions.labelling import Labels
from linecad.model.regions.raster import SHADES, Raster
from linecad.model.regions.segments import View

RELIEF = 0.03  # log offset within which parallel walls are one below a roof: gutters and dormers stand before the wall
STEP = 1.5  # samples between columns
REACH, BELOW = 260, 120  # samples along a column, above and below the line
FOOT = slice(2, 9)  # samples below the line, where the wall must be
GAP = 6  # columns that something may hide
LEAST_WIDTH = 0.05  # of the photo's width, of a line of a wall and of the ridge above it
BLURRED = 7  # samples by which the smooth sky may end before what it borders on
LEVEL = 1.5  # samples by which a ridge may be off its height
HIDDEN = 0.3  # of what is above the line in a column; more of other walls hide what is there
BESIDE = 2  # samples at a border that are of neither side
NEARLY_NONE = 0.02  # of the samples of a wall
LEAST_TOLD = 20  # samples on each side whose colours are compared


@dataclass(frozen=True, eq=False)
class Shown:
    """What the samples of a photo show."""

    raster: Raster
    view: View
    labels: Labels
    sky: Bool  # (H, W) for sure

    @property
    def label(self) -> Int:
        """(H, W)"""
        return self.labels.label[self.labels.cell].reshape(self.raster.shape)

    def rays(self, pixels: Float) -> Float:
        """(..., K) components of the rays of pixels (..., 2), camera depth 1."""
        return components(world_rays(pixels, self.view.camera.matrix, self.view.rotation), self.view.turns)

    def at(self, values: NDArray[Any], pixels: Float) -> NDArray[Any]:
        """Values (H, W) at pixels (..., 2); those of the border outside the photo."""
        rows, columns = self.raster.shape
        place = np.rint(self.raster.samples_of(pixels)).astype(np.int64)
        return np.asarray(values[np.clip(place[..., 1], 0, rows - 1), np.clip(place[..., 0], 0, columns - 1)])


@dataclass(frozen=True, eq=False)
class Wall:
    """A wall of the photo, with those that stand a little before and behind it."""

    axis: int  # its normal
    offset: float
    numbers: tuple[int, ...]  # of the surfaces
    is_shown: Bool  # (H, W)

    @property
    def along(self) -> int:
        """The level direction in it."""
        return int(partner(self.axis))

    def heights(self, rays: Float) -> Float:
        """Heights (...) of points of the wall on rays (..., K); not finite where a ray runs along it."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(self.offset * rays[..., UP] / rays[..., self.axis])

    def is_ahead(self, rays: Float) -> Bool:
        """Which rays (..., K) meet the wall before the camera."""
        return np.asarray(self.offset * rays[..., self.axis] > 0)

    def foot(self, shown: Shown) -> float:
        """The height down to which nearly all of it is seen."""
        return float(np.quantile(self.heights(shown.raster.rays[self.is_shown.ravel()]), NEARLY_NONE))

    def point(self, ray: Float, shown: Shown) -> Float:
        """(3,) world, of the wall on the ray (K,) of a pixel."""
        vectors = directions_of(shown.view.turns)
        point: Float = sum(
            self.offset * ray[axis] / ray[self.axis] * vectors[axis] for axis in (self.axis, self.along, UP)
        )
        return point


def walls_of(shown: Shown) -> list[Wall]:
    """The walls of the photo, the largest first; each surface is of one."""
    label, surfaces = shown.label, shown.labels.surfaces
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
        Wall(surfaces[group[0]].axis, surfaces[group[0]].offset, tuple(group), np.isin(label, group))
        for group in groups
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
    is_open: Bool  # (J,) nothing hides what is between line and sky
    is_ridge: Bool  # (J,) the sky begins at the height of the ridge
    top: Float  # (J, 2) px, where the sky begins above the wall; NaN where it is not seen
    rise: float  # samples from the line to the ridge
    depth: float  # samples from the line down to where the wall ends, BELOW at most
    contrast: float  # 0 to 1, of the colours above and below the line
    before_sky: float  # the same of what is above the line and of the sky above that
    uprights: tuple[float, float]  # pixels of upright edges a sample, above and below
    plants: float  # share of what is above


def look_over(wall: Wall, pixel: Float, shown: Shown) -> Profile | None:
    """What is above the level line of a wall through a pixel (2,); None where no level border with the sky is."""
    columns = _Columns.through(wall, pixel, shown)
    run = columns.run()
    if run is None:
        return None
    first, last = run
    count = len(columns.eave)
    seen = np.zeros(count, bool)
    seen[first : last + 1] = True
    top, has_top = columns.tops()
    is_open = seen & has_top & ~columns.is_hidden(top)
    rows = np.arange(count)
    rays = shown.rays(columns.pixels[rows, BELOW + top])
    height = wall.heights(rays)
    one = np.abs(wall.heights(shown.rays(columns.pixels[rows, BELOW + top + 1])) - height)
    is_open &= np.isfinite(height) & np.isfinite(one)
    here = np.flatnonzero(is_open)
    if len(here) * STEP < LEAST_WIDTH * shown.raster.shape[1]:
        return None
    near = np.abs(height[here][:, None] - height[here]) <= LEVEL * one[here][:, None]
    high = float(np.median(height[here][near[:, near.sum(axis=0).argmax()]]))
    is_ridge = is_open & (np.abs(height - high) <= LEVEL * one)
    if is_ridge.sum() * STEP < LEAST_WIDTH * shown.raster.shape[1]:
        return None
    low = float(wall.heights(shown.rays(pixel)))
    ridge = columns.at_height(high)
    ends = np.flatnonzero(is_ridge)
    outside = columns.borders_on_sky(ridge)
    for way, end in ((-1, ends[0]), (1, ends[-1])):  # it may go on beyond the wall that is seen below it
        place = end + way
        while 0 <= place < count and outside[place] and not seen[place]:
            is_ridge[place] = True
            place += way
    above, below, beyond = columns.sides(np.flatnonzero(is_ridge & is_open), top)
    if min(len(above), len(below), len(beyond)) < LEAST_TOLD:
        return None
    shade, upright, plants = shown.raster.shade, shown.raster.votes[:, UP], shown.raster.plants
    return Profile(
        wall, low, high, columns.eave, ridge, first, last, is_open, is_ridge,
        np.where((seen & has_top)[:, None], columns.pixels[rows, BELOW + top], np.nan),
        float(np.median(top[is_ridge & is_open])), columns.down(is_ridge & is_open), _contrast(shade, above, below),
        _contrast(shade, above, beyond),
        (float(upright[above].mean()), float(upright[below].mean())), float(plants[above].mean()),
    )  # fmt: skip


def _contrast(shade: Int, above: Int, below: Int) -> float:
    """Jensen-Shannon divergence, bits, of the colours of two sets of samples."""
    shares = np.stack([np.bincount(shade[own], minlength=SHADES) / len(own) for own in (above, below)])
    mean = np.broadcast_to(shares.mean(axis=0), shares.shape)
    told = shares > 0
    return float((shares[told] * np.log2(shares[told] / mean[told])).sum() / 2)


@dataclass(frozen=True, eq=False)
class _Columns:
    """J columns through a level line of a wall, with places from BELOW samples below it to REACH above."""

    wall: Wall
    shown: Shown
    eave: Float  # (J, 2) px
    pixels: Float  # (J, BELOW + REACH, 2)
    is_inside: Bool  # (J, BELOW + REACH) the photo
    sample: Int  # (J, BELOW + REACH)

    @staticmethod
    def through(wall: Wall, pixel: Float, shown: Shown) -> "_Columns":
        """Those through the line along the wall that a pixel (2,) shows, from left to right."""
        raster, view = shown.raster, shown.view
        rows, width = raster.shape
        points = vanishing_points(view.camera.matrix, components(view.rotation, view.turns))
        along = directions_to(pixel, points[wall.along])
        along = along * (1.0 if along[0] >= 0 else -1.0)
        count = int(2 * width / STEP)
        eave = pixel + STEP * raster.step * np.arange(-count, count + 1)[:, None] * along
        place = raster.samples_of(eave)
        seen = (place[:, 0] >= 0) & (place[:, 0] <= width - 1) & (place[:, 1] <= rows - 1) & (place[:, 1] >= -rows)
        seen &= wall.is_ahead(shown.rays(eave))
        eave = eave[seen]
        up = directions_to(eave, points[UP])
        up = up * np.where(up[:, 1:] > 0, -1.0, 1.0)
        pixels = eave[:, None] + np.arange(-BELOW, REACH)[:, None] * raster.step * up[:, None]
        at = np.rint(raster.samples_of(pixels)).astype(np.int64)
        inside: Bool = np.asarray(((at >= 0) & (at < [width, rows])).all(axis=2))
        at = np.clip(at, 0, [width - 1, rows - 1])
        return _Columns(wall, shown, eave, pixels, inside, at[..., 1] * width + at[..., 0])

    def run(self) -> tuple[int, int] | None:
        """First and last column of the longest stretch below which the wall is seen; None where none is long."""
        foot = slice(BELOW - FOOT.stop, BELOW - FOOT.start)
        own = (self.wall.is_shown.ravel()[self.sample[:, foot]] & self.is_inside[:, foot]).mean(axis=1) > 1 / 2
        places = np.flatnonzero(own)
        if len(places) == 0:
            return None
        runs = np.split(places, np.flatnonzero(np.diff(places) > GAP) + 1)
        longest = max(runs, key=len)
        if len(longest) * STEP < LEAST_WIDTH * self.shown.raster.shape[1]:
            return None
        return int(longest[0]), int(longest[-1])

    def tops(self) -> tuple[Int, Bool]:
        """How many samples (J,) above the line the sky begins, and whether it is seen to begin."""
        sky = self.shown.sky.ravel()[self.sample] & self.is_inside
        begins = sky[:, BELOW:-1] & sky[:, BELOW + 1 :]
        has_top, top = np.asarray(begins.any(axis=1)), begins.argmax(axis=1)
        # The seed of the sky is where it is smooth, some samples above the edge itself.
        gradient = np.where(self.is_inside, self.shown.raster.gradient[self.sample], 0.0)
        back = np.maximum(top[:, None] - np.arange(BLURRED), 0)
        edge = np.take_along_axis(gradient[:, BELOW:], back, axis=1).argmax(axis=1)
        return np.where(has_top, np.maximum(top - edge, 0), 0), has_top

    def is_hidden(self, top: Int) -> Bool:
        """In which columns (J,) other walls are before what is between the line and the sky."""
        label = self.shown.label.ravel()[self.sample[:, BELOW:]]
        between = np.arange(REACH) < top[:, None]
        other = (label < self.shown.labels.sky) & ~self.wall.is_shown.ravel()[self.sample[:, BELOW:]] & between
        hidden: Bool = other.sum(axis=1) > HIDDEN * np.maximum(top, 1)
        return hidden

    def at_height(self, height: float) -> Float:
        """(J, 2) px, where the columns are so high on the wall."""
        view, wall = self.shown.view, self.wall
        rays = self.shown.rays(self.eave)
        along = wall.offset * rays[:, wall.along] / rays[:, wall.axis]
        vectors = directions_of(view.turns)
        points = wall.offset * vectors[wall.axis] + along[:, None] * vectors[wall.along] + height * vectors[UP]
        return project(points, view.camera.matrix, view.rotation)

    def borders_on_sky(self, pixels: Float) -> Bool:
        """Whether (J,) the sky is a little above pixels (J, 2) and not below them."""
        step = self.shown.raster.step
        up = self.pixels[:, 1] - self.pixels[:, 0]
        up = up / np.linalg.norm(up, axis=1, keepdims=True) * step
        above = self.shown.at(self.shown.sky, pixels + (BLURRED + 1) * up)
        return np.asarray(above & ~self.shown.at(self.shown.sky, pixels - BESIDE * up))

    def sides(self, columns: Int, top: Int) -> tuple[Int, Int, Int]:
        """The samples above the line in some columns, up to the sky, as many of the wall below it, and of the sky."""
        place = np.arange(REACH)
        own, height = self.sample[columns], top[columns, None]
        above = own[:, BELOW:][(place >= BESIDE) & (place <= height - BESIDE)]
        under = own[:, :BELOW][:, ::-1]
        is_wall = self.wall.is_shown.ravel()[under] & self.is_inside[columns, :BELOW][:, ::-1]
        place = np.arange(BELOW)
        sky = self.is_inside[columns, BELOW:] & (np.arange(REACH) > height + BLURRED)
        beyond = own[:, BELOW:][sky & (np.arange(REACH) <= 2 * height + BLURRED)]
        return above, under[(place >= 1) & (place <= np.maximum(height, 2 * BESIDE)) & is_wall], beyond

    def down(self, chosen: Bool) -> float:
        """How many samples the wall goes down from the line, in the middle of the chosen columns (J,)."""
        own = self.wall.is_shown.ravel()[self.sample[chosen, : BELOW - BESIDE]][:, ::-1]
        ends = np.where(own.all(axis=1), own.shape[1], (~own).argmax(axis=1))
        return float(np.median(ends))
