"""Strips of walls with the row in which the wall truly meets the ground, or the ceiling; used by feet.py."""

from dataclasses import dataclass

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.dataset.truth import NOTHING, Truth
from linecad.ties.setting import Setting
from linecad.ties.walls import COLUMNS, ROW, ROWS, Strip, StripDrawer, find_walls

STEPPED = 0.2  # m: the ground is flat and at most so much higher than the lowest that is seen, as pavements are
SAME_PLANE = 0.04  # log offset
SAME_HEIGHT = 0.03  # log
ASIDE = 2  # rows above and below the foot that are looked at
OF_CORNICE = 8  # rows below a ceiling that may show a cornice, not the wall
LEAST_SEEN = 0.12  # of the columns that must show the foot; with fewer, but some, an example is left out
UNSEEN = -1.0


@dataclass(frozen=True, eq=False)
class Example:
    """A strip and what is true of it."""

    scene: str
    strip: Strip
    row: float  # of the foot, or UNSEEN
    is_clear: bool  # hardly seen otherwise
    log_height: float  # true, of the foot; NaN where it is not seen


def examples_of(scene: str, setting: Setting, true_scale: Float, truth: Truth, is_above: bool = False) -> list[Example]:
    """The walls of all bodies of known scale (B,), NaN where it is not known; with their heads where `is_above`."""
    drawer, known = StripDrawer(setting, is_above), GroundTruth(truth, setting, is_above)
    found = []
    for wall in find_walls(setting):
        strip = drawer.draw(wall) if np.isfinite(true_scale[wall.body]) else None
        if strip is not None:
            row, share = known.foot(strip, drawer, float(true_scale[wall.body]))
            clear = share >= LEAST_SEEN or share < LEAST_SEEN / 3
            height = strip.log_height(row) + float(true_scale[wall.body]) if share >= LEAST_SEEN else np.nan
            found.append(Example(scene, strip, row if share >= LEAST_SEEN else UNSEEN, clear, height))
    return found


class GroundTruth:
    """Where walls meet the ground, or, where `is_above`, the ceiling."""

    def __init__(self, truth: Truth, setting: Setting, is_above: bool = False) -> None:
        self._truth, self._way = truth, 1.0 if is_above else -1.0
        self._wall_ends = OF_CORNICE if is_above else ASIDE
        normal, offset = truth.planes()
        # (Q, K) along all directions, by which walls are numbered: those that were found, not those of the truth.
        self.normal = normal @ truth.rotation.T @ setting.sight.rotation
        self._offset = np.abs(offset)
        flat = np.abs(self.normal[:, 2]) > 0.99
        away = self._way * truth.quads[..., 2].mean(axis=1)
        self._log_height = np.log(np.maximum(away, 1e-9))
        shown = np.isin(np.arange(len(flat)), truth.ids) & flat  # cellars lie lower
        self._is_ground = flat & (away > away[shown].max(initial=-np.inf) - STEPPED)

    def foot(self, strip: Strip, drawer: StripDrawer, scale: float) -> tuple[float, float]:
        """The lowest row at which a share of the columns shows the wall above and the ground below, and that share."""
        rows = np.arange(ROWS)
        log_height = np.asarray(strip.log_height(0) + ROW * rows, np.float64)
        shown = self._shown(strip, drawer, log_height)
        is_wall, below = self._is_wall(shown, strip, scale), np.roll(shown, -ASIDE, axis=0)
        meets = self._is_ground[below] & (below != NOTHING)
        meets &= np.logical_or.reduce([np.roll(is_wall, by, axis=0) for by in range(ASIDE, self._wall_ends + 1)])
        meets &= np.abs(self._log_height[below] - log_height[:, None] - scale) < SAME_HEIGHT
        meets[: self._wall_ends] = meets[-ASIDE:] = False
        share = meets.mean(axis=1)
        if share.max() == 0:
            return UNSEEN, 0.0
        # The rows that match are a few about the foot: their middle, of the lowest ones that are as good as any.
        lowest = int(np.flatnonzero(share >= 0.7 * share.max())[-1])
        near = np.arange(max(0, lowest - 2 * ASIDE), lowest + 1)
        return float(np.average(near, weights=share[near])), float(share[near].max())

    def _is_wall(self, quads: Int, strip: Strip, scale: float) -> Bool:
        plane = strip.wall.plane
        apart = np.abs(np.log(np.maximum(self._offset[quads], 1e-9)) - plane.log_offset - scale)
        wall: Bool = (quads != NOTHING) & (np.abs(self.normal[quads, plane.normal]) > 0.99) & (apart < SAME_PLANE)
        return wall

    def _shown(self, strip: Strip, drawer: StripDrawer, log_height: Float) -> Int:
        """The quads (ROWS, COLUMNS) that the photo shows where the strip looks at it."""
        pixels, depth = drawer.seen_at(strip.wall, strip.along[None], self._way * np.exp(log_height)[:, None])
        quads = self._truth.quad_at(pixels.reshape(-1, 2)).reshape(ROWS, COLUMNS)
        return np.asarray(np.where(depth > 0, quads, NOTHING))
