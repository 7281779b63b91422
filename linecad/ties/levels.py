"""Levels: the heights of sills, courses and eaves of two bodies match at one ratio of scales more often than chance."""

from dataclasses import dataclass

import numpy as np

from linecad.arrays import Float
from linecad.ties.setting import Setting

ONE_LEVEL = 0.004  # log height: lines nearer than this are of one level
WIDTH = 0.004  # log ratio, half of the window in which matches are counted
AROUND = 0.15  # log ratio to both sides from which chance is known
BESIDE = 0.012  # log ratio about a window that does not count as chance
FLATTEST = 0.02  # ray component: at eye level a height says nothing
WIDEST = 1.2  # log ratio beyond which no scale is looked for
APART = 0.03  # log ratio between two peaks
MOST = 3  # peaks of two bodies
LEAST_MATCHES = 4  # of a peak
ONE_EAVE = 0.008  # log height


@dataclass(frozen=True, eq=False)
class Levels:
    """The levels of one body: logs of heights below and above the camera, ascending."""

    below: Float
    above: Float

    @property
    def count(self) -> int:
        """How many there are."""
        return len(self.below) + len(self.above)


@dataclass(frozen=True)
class Match:
    """How two bodies' levels match at one ratio."""

    log_ratio: float
    matches: int
    by_chance: float

    @property
    def excess(self) -> float:
        """Matches beyond chance, in standard deviations of chance."""
        return (self.matches - self.by_chance) / float(np.sqrt(self.by_chance + 1))


class LevelPair:
    """The levels of two bodies against each other."""

    def __init__(self, first: Levels, second: Levels) -> None:
        apart = [
            (other[None] - own[:, None]).ravel()
            for own, other in ((first.below, second.below), (first.above, second.above))
        ]
        self.log_ratio = np.sort(np.concatenate(apart))  # at which each level of the one meets each of the other
        self.fewest = min(first.count, second.count)
        self.eaves = float(second.above[-1] - first.above[-1]) if len(first.above) and len(second.above) else np.inf
        self.peaks = self._find_peaks()

    def at(self, log_ratio: float) -> Match:
        """The best match of three windows about a ratio."""
        places = log_ratio + np.array([-WIDTH, 0.0, WIDTH])
        matches = int(self._within(places, WIDTH).max())
        return Match(log_ratio, matches, float(self._chance(np.array([log_ratio]))[0]))

    def lead(self, match: Match) -> float:
        """By how much a match exceeds the best peak elsewhere; 0 where it is next to nothing itself."""
        other = max((peak.excess for peak in self.peaks if abs(peak.log_ratio - match.log_ratio) > APART), default=0.0)
        return match.excess - other if match.matches > 2 else 0.0

    def same_eaves(self, log_ratio: float) -> bool:
        """Whether the highest levels of the two bodies are one at a ratio."""
        return abs(self.eaves - log_ratio) < ONE_EAVE

    def _within(self, places: Float, width: float) -> Float:
        low = np.searchsorted(self.log_ratio, places - width)
        return np.asarray(np.searchsorted(self.log_ratio, places + width, side="right") - low, np.float64)

    def _chance(self, places: Float) -> Float:
        beside = self._within(places, AROUND) - self._within(places, BESIDE)
        return beside * (WIDTH / (AROUND - BESIDE))

    def _find_peaks(self) -> list[Match]:
        """The peaks of matches over chance, the highest first; one more than are used, to compare with."""
        if len(self.log_ratio) < LEAST_MATCHES:
            return []
        places = self.log_ratio + WIDTH
        matches, chance = self._within(places, WIDTH), self._chance(places)
        excess = (matches - chance) / np.sqrt(chance + 1)
        excess[np.abs(places) > WIDEST] = -np.inf
        found: list[Match] = []
        while len(found) <= MOST and np.isfinite(excess.max()):
            best = int(excess.argmax())
            found.append(Match(float(places[best]), int(matches[best]), float(chance[best])))
            excess[np.abs(places - places[best]) <= APART] = -np.inf
        return found


def find_levels(setting: Setting) -> list[Levels]:
    """The levels of each body, from its horizontal lines."""
    graph = setting.graph
    height = graph.rays[:, 2]
    telling = (graph.axis != 2) & (np.abs(height) > FLATTEST)
    log_height = np.log(np.where(telling, np.abs(height), 1.0)) + setting.log_depth
    found = []
    for lines in setting.lines:
        own = lines[telling[lines]]
        found.append(Levels(*(_levels(log_height[own[np.sign(height[own]) == sign]]) for sign in (-1, 1))))
    return found


def _levels(log_height: Float) -> Float:
    """The heights that lie more than ONE_LEVEL above the one before."""
    levels: list[float] = []
    for height in np.sort(log_height).tolist():
        if not levels or height - levels[-1] > ONE_LEVEL:
            levels.append(height)
    return np.array(levels)
