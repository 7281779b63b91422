"""The photo above a level line of a wall, column by column: how far up it goes before the sky begins."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.directions import UP
from linecad.geometry import directions_to, project, vanishing_points
from linecad.model.regions.profiles import Profile, Shown, Wall
from linecad.model.regions.raster import SHADES

STEP = 1.5  # samples between columns
REACH, BELOW = 260, 120  # samples along a column, above and below the line
FOOT = slice(2, 9)  # samples below the line, where the wall must be
GAP = 6  # columns that something may hide
LEAST_WIDTH = 0.05  # of the photo's width, of a line of a wall and of the ridge above it
BLURRED = 7  # samples by which the smooth sky may end before what it borders on
LEVEL = 1.5  # samples by which a ridge may be off its height
LEAST_RIDGE = 0.7  # of the open columns of a stretch, in which the sky begins at the height of its ridge
HIDDEN = 0.3  # of what is above the line in a column; more of other walls hide what is there
NEARLY_AS_HIGH, UNLIKE = 0.2, 0.45  # of the height of a ridge above the line; bits, of colours of two roofs
BESIDE = 2  # samples at a border that are of neither side
LEAST_TOLD = 20  # samples on each side whose colours are compared


def look_over(wall: Wall, pixel: Float, shown: Shown) -> list[Profile]:
    """What is above the level line of a wall through a pixel (2,), one for each stretch with a level border of the sky.

    Houses of a row that stand in one plane have a ridge each.
    """
    columns = _Columns.through(wall, pixel, shown)
    low = float(wall.heights(shown.rays(pixel)))
    found = [columns.profile(low, run, stretch) for run in columns.runs() for stretch in columns.stretches(run)]
    return [each for each in found if each is not None]


def _contrast(shade: Int, above: Int, below: Int) -> float:
    """Jensen-Shannon divergence, bits, of the colours of two sets of samples."""
    shares = np.stack([np.bincount(shade[own], minlength=SHADES) / len(own) for own in (above, below)])
    mean = np.broadcast_to(shares.mean(axis=0), shares.shape)
    told = shares > 0
    return float((shares[told] * np.log2(shares[told] / mean[told])).sum() / 2)


def _longest(level: Bool, is_open: Bool) -> tuple[int, int]:
    """First and last column of the stretch with most columns at a height, for the open ones that are not (J,)."""
    worth = np.where(level, 1 - LEAST_RIDGE, np.where(is_open, -LEAST_RIDGE, 0.0))
    total = np.concatenate([[0.0], np.cumsum(worth)])
    gain = total[1:] - np.minimum.accumulate(total)[:-1]
    last = int(gain.argmax())
    first = int(total[: last + 1].argmin())
    own = np.flatnonzero(level[first : last + 1]) + first
    return int(own[0]), int(own[-1])


@dataclass(frozen=True, eq=False)
class _SkyLine:
    """Where the sky begins above a line, in J columns."""

    top: Int  # (J,) samples above the line
    is_open: Bool  # (J,) nothing hides what is between
    height: Float  # (J,) on the wall's plane
    one: Float  # (J,) of one sample more


@dataclass(frozen=True, eq=False)
class _Stretch:
    """Columns above which the sky begins at one height."""

    first: int
    last: int
    high: float
    is_open: Bool  # (J,)
    is_ridge: Bool  # (J,)


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
        upright, level = vanishing_points(view.camera.matrix, view.rotation @ np.array([[0, 0, 1.0], wall.direction]).T)
        along = directions_to(pixel, level)
        along = along * (1.0 if along[0] >= 0 else -1.0)
        count = int(2 * width / STEP)
        eave = pixel + STEP * raster.step * np.arange(-count, count + 1)[:, None] * along
        place = raster.samples_of(eave)
        seen = (place[:, 0] >= 0) & (place[:, 0] <= width - 1) & (place[:, 1] <= rows - 1) & (place[:, 1] >= -rows)
        seen &= wall.is_ahead(shown.rays(eave))
        eave = eave[seen]
        up = directions_to(eave, upright)
        up = up * np.where(up[:, 1:] > 0, -1.0, 1.0)
        pixels = eave[:, None] + np.arange(-BELOW, REACH)[:, None] * raster.step * up[:, None]
        at = np.rint(raster.samples_of(pixels)).astype(np.int64)
        inside: Bool = np.asarray(((at >= 0) & (at < [width, rows])).all(axis=2))
        at = np.clip(at, 0, [width - 1, rows - 1])
        return _Columns(wall, shown, eave, pixels, inside, at[..., 1] * width + at[..., 0])

    @property
    def least(self) -> float:
        """Columns of a line of a wall, and of the ridge above it."""
        return LEAST_WIDTH * self.shown.raster.shape[1] / STEP

    @cached_property
    def is_above_wall(self) -> Bool:
        """Below which columns (J,) the wall is seen."""
        foot = slice(BELOW - FOOT.stop, BELOW - FOOT.start)
        seen = self.wall.is_shown.ravel()[self.sample[:, foot]] & self.is_inside[:, foot]
        return np.asarray(seen.mean(axis=1) > 1 / 2)

    def runs(self) -> list[tuple[int, int]]:
        """First and last column of each long stretch below which the wall is seen."""
        places = np.flatnonzero(self.is_above_wall)
        runs = np.split(places, np.flatnonzero(np.diff(places) > GAP) + 1)
        return [(int(run[0]), int(run[-1])) for run in runs if len(run) and len(run) >= self.least]

    @cached_property
    def sky_line(self) -> "_SkyLine":
        """Where the sky begins above the line."""
        top, has_top = self.tops()
        rows = np.arange(len(self.eave))
        height = self.wall.heights(self.shown.rays(self.pixels[rows, BELOW + top]))
        one = np.abs(self.wall.heights(self.shown.rays(self.pixels[rows, BELOW + top + 1])) - height)
        is_open = has_top & ~self.is_hidden(top) & np.isfinite(height) & np.isfinite(one)
        return _SkyLine(top, is_open, height, one)

    def stretches(self, run: tuple[int, int]) -> list["_Stretch"]:
        """Where in a run of columns the sky begins at one height, the widest at each step first."""
        sky, found = self.sky_line, []
        left = np.zeros(len(self.eave), bool)
        left[run[0] : run[1] + 1] = sky.is_open[run[0] : run[1] + 1]
        is_open = left.copy()
        while left.sum() >= self.least:
            here = np.flatnonzero(left)
            near = np.abs(sky.height[here][:, None] - sky.height[here]) <= LEVEL * sky.one[here][:, None]
            high = float(np.median(sky.height[here][near[:, near.sum(axis=0).argmax()]]))
            level = left & (np.abs(sky.height - high) <= LEVEL * sky.one)
            first, last = _longest(level, is_open)
            own = np.zeros(len(left), bool)
            own[first : last + 1] = True
            if (level & own).sum() < self.least:
                left &= ~level
                continue
            found.append(_Stretch(first, last, high, is_open & own, level & own))
            left &= ~own
        return found

    def profile(self, low: float, run: tuple[int, int], stretch: "_Stretch") -> Profile | None:
        """What is above a line of the wall at a height, in a stretch of it; None where it is too little to tell."""
        sky, ridge, is_ridge = self.sky_line, self.at_height(stretch.high), stretch.is_ridge.copy()
        outside = self.borders_on_sky(ridge)
        for way, end in ((-1, stretch.first), (1, stretch.last)):  # it may go on beyond the wall that is seen below it
            place = end + way
            while 0 <= place < len(outside) and outside[place] and not run[0] <= place <= run[1]:
                is_ridge[place] = True
                place += way
        told = stretch.is_ridge
        own = np.flatnonzero(told)
        above, (below, beyond) = self.above(own), self.beside(own)
        if min(len(above), len(below), len(beyond)) < LEAST_TOLD:
            return None
        shade, upright, plants = self.shown.raster.shade, self.shown.raster.votes[:, UP], self.shown.raster.plants
        return Profile(
            self.wall, low, stretch.high, self.eave, ridge, *run, stretch.is_open, is_ridge,
            float(np.median(sky.top[told])), self.down(told),
            _contrast(shade, above, below), _contrast(shade, above, beyond),
            (float(upright[above].mean()), float(upright[below].mean())), float(plants[above].mean()),
            float((told & self.is_above_wall).sum() / self.is_above_wall.sum()),
            (self._goes_on(low, stretch, -1), self._goes_on(low, stretch, 1)),
        )  # fmt: skip

    def _goes_on(self, low: float, stretch: "_Stretch", way: int) -> bool:
        """Whether the sky begins nearly at the height of a ridge beside its left (-1) or right (1) end too.

        Above things of the same colours: two roofs of a row may be of nearly one height.
        """
        sky, end = self.sky_line, stretch.last if way > 0 else stretch.first
        places = end + way * np.arange(BLURRED, 2 * BLURRED)
        places = places[(places >= 0) & (places < len(self.eave))]
        near = np.abs(sky.height[places] - stretch.high) < NEARLY_AS_HIGH * (stretch.high - low)
        if len(places) == 0 or (sky.is_open[places] & near).mean() <= 1 / 2:
            return False
        inside = np.clip(end - way * np.arange(1, 2 * BLURRED), stretch.first, stretch.last)
        here, there = self.above(inside), self.above(places)
        return min(len(here), len(there)) < LEAST_TOLD or _contrast(self.shown.raster.shade, here, there) < UNLIKE

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
        along = wall.along_of(self.shown.rays(self.eave))
        points = wall.offset * wall.normal + along[:, None] * wall.direction + height * np.eye(3)[UP]
        return project(points, view.camera.matrix, view.rotation)

    def borders_on_sky(self, pixels: Float) -> Bool:
        """Whether (J,) the sky is a little above pixels (J, 2) and not below them."""
        step = self.shown.raster.step
        up = self.pixels[:, 1] - self.pixels[:, 0]
        up = up / np.linalg.norm(up, axis=1, keepdims=True) * step
        above = self.shown.at(self.shown.sky, pixels + (BLURRED + 1) * up)
        return np.asarray(above & ~self.shown.at(self.shown.sky, pixels - BESIDE * up))

    def above(self, columns: Int) -> Int:
        """The samples above the line in some columns, up to the sky."""
        place, height = np.arange(REACH), self.sky_line.top[columns, None]
        above: Int = self.sample[columns, BELOW:][(place >= BESIDE) & (place <= height - BESIDE)]
        return above

    def beside(self, columns: Int) -> tuple[Int, Int]:
        """As many samples of the wall below the line in some columns as are above it, and of the sky above these."""
        own, height = self.sample[columns], self.sky_line.top[columns, None]
        under = own[:, :BELOW][:, ::-1]
        is_wall = self.wall.is_shown.ravel()[under] & self.is_inside[columns, :BELOW][:, ::-1]
        place = np.arange(BELOW)
        sky = self.is_inside[columns, BELOW:] & (np.arange(REACH) > height + BLURRED)
        beyond = own[:, BELOW:][sky & (np.arange(REACH) <= 2 * height + BLURRED)]
        return under[(place >= 1) & (place <= np.maximum(height, 2 * BESIDE)) & is_wall], beyond

    def down(self, chosen: Bool) -> float:
        """How many samples the wall goes down from the line, in the middle of the chosen columns (J,)."""
        own = self.wall.is_shown.ravel()[self.sample[chosen, : BELOW - BESIDE]][:, ::-1]
        ends = np.where(own.all(axis=1), own.shape[1], (~own).argmax(axis=1))
        return float(np.median(ends))
