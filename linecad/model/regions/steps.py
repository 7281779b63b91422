"""Steps between parallel walls of one row: where the nearer one ends.

The side of the nearer wall is seen as a strip between both. What cells are labelled as may take that strip for either
wall, but lines of the nearer wall end at its outer corner and lines of the farther one at the inner corner: measured
along the walls both are at one place, which no line of the nearer wall goes beyond and none of the farther one reaches.
Where lines leave room, that place is taken at whose two corners the colour changes most.
"""

from dataclasses import dataclass

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.model.regions.raster import Raster

WINDOW = 2.0  # widths of the strip on either side of the border between both walls, in which their end may be
SLACK = 0.02  # share of the points on lines there, that may be on the wrong side more than at the best place
CORNER = 1.0  # samples, by which a line along a corner may be beyond it
BESIDE = 2  # samples on either side of a corner, whose colours are compared
LEAST_CHANGE = 10.0  # of colours at both corners together, in bytes; less is the grain of the walls
CHANGES = 0.9  # of the most that colours change; of places where they do, the one nearest to the border is taken
SEEN = 0.2  # of what is seen beside it, of a strip that can be bare
BARE = 0.25  # times as many lines as beside it has a strip that is neither wall


@dataclass(frozen=True, eq=False)
class Pair:
    """Two parallel walls, the nearer one first, along whose common direction x grows from its end inwards."""

    near: float  # distances from the camera
    far: float
    at: Float  # (S,) x of samples on the photo, per unit of distance; 0 where neither wall can be
    seen: Bool  # (S,) where their end may be seen: above the ground, below their tops, no plants before it
    near_points: Int  # samples of points on the lines of each, where seen
    far_points: Int
    sample: float  # width of one sample, of x


@dataclass(frozen=True)
class Step:
    """The end of the nearer of two parallel walls."""

    place: float  # its distance from the foot of the camera along the walls
    is_bare: bool  # hardly a line of either wall runs in the strip that its side is


def find_step(pair: Pair, border: float, raster: Raster) -> Step:
    """Where the nearer wall of a pair ends, near to the place of its `border` in the photo with the farther one."""
    ratio = pair.far / pair.near
    places = np.arange(border / ratio**WINDOW, border * ratio**WINDOW, pair.sample * pair.near / 2)
    near, far = pair.at[pair.near_points] * pair.near, pair.at[pair.far_points] * pair.far
    near, far = (np.sort(x[(x >= places[0]) & (x <= places[-1])]) for x in (near, far))
    off = CORNER * pair.sample * pair.near
    wrong = np.searchsorted(near, places - off) + len(far) - np.searchsorted(far, places + off)
    possible = np.flatnonzero(wrong <= wrong.min() + SLACK * (len(near) + len(far)))
    change = _changes(pair, places / pair.near, raster) + _changes(pair, places / pair.far, raster)
    change = np.where(change > LEAST_CHANGE, change, 0.0)
    most = possible[change[possible] >= CHANGES * change[possible].max()]
    place = float(places[most[np.abs(places[most] - border).argmin()]])
    return Step(place, _is_bare(pair, place))


def _changes(pair: Pair, at: Float, raster: Raster) -> Float:
    """How much the colour changes across uprights (P,), CIE L*a*b* in bytes; 0 where not both sides are seen."""
    low = float(at.min()) - (BESIDE + 1) * pair.sample
    count = int((at.max() - low) / pair.sample) + 2 * BESIDE + 2
    bins = np.floor(np.clip((pair.at - low) / pair.sample, -1, count)).astype(np.int64)
    own = pair.seen & (bins >= 0) & (bins < count)
    colour = raster.colour.reshape(-1, 3)[own].astype(np.float64)
    seen = np.bincount(bins[own], minlength=count)
    sums = np.column_stack([np.bincount(bins[own], each, count) for each in colour.T])
    total, number = np.cumsum(np.vstack([np.zeros(3), sums]), axis=0), np.cumsum([0, *seen])
    middle = np.floor((at - low) / pair.sample + 0.5).astype(np.int64)
    halves = ((middle - BESIDE, middle), (middle, middle + BESIDE))
    counts = [number[stop] - number[start] for start, stop in halves]
    means = [
        (total[stop] - total[start]) / np.maximum(count, 1)[:, None]
        for (start, stop), count in zip(halves, counts, strict=True)
    ]
    return np.where(np.minimum(*counts) > 0, np.linalg.norm(means[1] - means[0], axis=1), 0.0)


def _is_bare(pair: Pair, place: float) -> bool:
    inner, outer = place / pair.far, place / pair.near
    width = outer - inner

    def shown(points: Int, low: float, high: float) -> tuple[int, int]:
        """How many samples are seen, and points of lines in them."""
        inside = (pair.at[points] >= low) & (pair.at[points] < high)
        return int((pair.seen & (pair.at >= low) & (pair.at < high)).sum()), int(inside.sum())

    area, points = shown(np.concatenate([pair.near_points, pair.far_points]), inner, outer)
    beside = shown(pair.near_points, outer, outer + width), shown(pair.far_points, inner - width, inner)
    if area < SEEN * max(own for own, _ in beside) or min(own for own, _ in beside) == 0:
        return False
    return points / area < BARE * min(count / own for own, count in beside)
