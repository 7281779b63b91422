"""Where walls meet the ground: a small network reads it off the strips of walls, each body a witness of one ground.

Houses that no crossing ties stand on one ground all the same. A wall's foot, seen so far below the horizon, gives the
scale of its body relative to the camera's height, and so relative to all other bodies with a foot. The network
(foot.onnx; tests/benchmarks/feet.py trains and measures it) gives each row of a strip the probability that the wall
meets the ground there; one more number says that the foot is not seen.
"""

from dataclasses import dataclass
from functools import cache
from pathlib import Path

import cv2
import numpy as np
from scipy.special import softmax

from linecad.arrays import Float
from linecad.ties.setting import Setting
from linecad.ties.walls import ROWS, StripDrawer, Strips, Wall, WallKey, find_walls

NETWORK = Path(__file__).with_name("foot.onnx")
AT_ONCE = 64  # strips
HALF = 2  # rows to both sides of a peak that belong to it
PEAKS = 2  # of a wall
LEAST_PROBABILITY = 0.02  # of a peak
SAME = 0.03  # log height within which walls of one body have one foot
MOST_FEET = 3  # of a body
MOST_LOG_ODDS = 4.0


@dataclass(frozen=True, eq=False)
class Foot:
    """Where the walls of a body may meet the ground."""

    body: int
    log_height: float  # below the camera, at the body's own scale
    probability: float  # of the wall that says so most clearly
    wall: Wall
    others: float  # sum of the probabilities of the body's other walls that say the same
    against: float  # the largest probability of another height, of any wall of the body
    unseen: float  # probability that this wall does not show its foot


@dataclass(frozen=True, eq=False)
class Reading:
    """What the network says of a wall."""

    peaks: tuple[tuple[float, float], ...]  # log height at the body's own scale and probability of its clearest feet
    unseen: float  # probability that the foot is not seen


class FootReader:
    """Reads the feet, or the heads, of one photo's walls, each wall once, whatever body it is a wall of."""

    def __init__(self, setting: Setting, is_above: bool = False) -> None:
        self._drawer = None if setting.sight.pixels is None else StripDrawer(setting, is_above)
        self._known: dict[WallKey, Reading | None] = {}

    def read(self, walls: list[Wall]) -> list[Reading | None]:
        """What the network says of each wall; None of those that cannot be drawn, and of all without pixels."""
        if self._drawer is None:
            return [None] * len(walls)
        new = {wall.key: wall for wall in walls if wall.key not in self._known}
        drawn = [(key, self._drawer.draw(wall)) for key, wall in new.items()]
        self._known.update(dict.fromkeys(new))
        strips = [(key, strip) for key, strip in drawn if strip is not None]
        if strips:
            probability = foot_probabilities(np.stack([strip.layers for _, strip in strips]))
            for (key, strip), rows in zip(strips, probability, strict=True):
                found = tuple((strip.log_height(row), share) for row, share in peaks(rows[:ROWS]))
                self._known[key] = Reading(found, float(rows[ROWS]))
        return [self._known[wall.key] for wall in walls]


def find_feet(setting: Setting, reader: FootReader) -> list[Foot]:
    """The feet of each body, its most probable one first, as the photo's `reader` sees them; none without pixels."""
    walls = find_walls(setting)
    seen: dict[int, list[tuple[float, float, float, Wall]]] = {}
    for wall, reading in zip(walls, reader.read(walls), strict=True):
        if reading is not None:
            own = seen.setdefault(wall.body, [])
            own += [(share, log_height, reading.unseen, wall) for log_height, share in reading.peaks]
    return [foot for body in sorted(seen) for foot in _feet(body, seen[body])]


def foot_probabilities(strips: Strips) -> Float:
    """(W, ROWS + 1) for W strips: that the foot is in each row, and, last, that it is not seen."""
    log_odds = np.concatenate([_run(strips[start : start + AT_ONCE]) for start in range(0, len(strips), AT_ONCE)])
    shares: Float = softmax(log_odds, axis=1)
    return shares


def peaks(rows: Float) -> list[tuple[float, float]]:
    """Row and probability of the PEAKS clearest feet, the clearest first, by the probabilities of all rows (ROWS,)."""
    rows, found = rows.copy(), []
    for _ in range(PEAKS):
        sums = np.convolve(rows, np.ones(2 * HALF + 1), "same")
        middle = int(sums.argmax())
        if sums[middle] < LEAST_PROBABILITY:
            break
        near = np.arange(max(0, middle - HALF), min(len(rows), middle + HALF + 1))
        found.append((float(np.average(near, weights=rows[near])), float(sums[middle])))
        rows[max(0, middle - 2 * HALF - 1) : middle + 2 * HALF + 2] = 0
    return found


def _feet(body: int, seen: list[tuple[float, float, float, Wall]]) -> list[Foot]:
    """Of probabilities, log heights and what else is known of single walls."""
    seen = sorted(seen, key=lambda one: -one[0])
    found: list[Foot] = []
    for probability, log_height, unseen, wall in seen:
        if len(found) == MOST_FEET or any(abs(log_height - foot.log_height) < SAME for foot in found):
            continue
        of_others = [other for other in seen if other[3] is not wall]
        others = sum(other[0] for other in of_others if abs(other[1] - log_height) < SAME)
        against = max((other[0] for other in seen if abs(other[1] - log_height) >= SAME), default=0.0)
        found.append(Foot(body, log_height, probability, wall, others, against, unseen))
    return found


@cache
def _network() -> cv2.dnn.Net:
    return cv2.dnn.readNetFromONNX(str(NETWORK))


def _run(strips: Strips) -> Float:
    network = _network()
    network.setInput(strips)
    return np.asarray(network.forward(), np.float64)
