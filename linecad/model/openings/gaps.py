"""What the openings that were taken tell about others of their wall.

What alone is too uncertain to be an opening, such as a window half behind a bush, is likely one where openings of its
size stand in its row and its column, so that gaps are filled. Only taken ones ask here: rectangles of bricks cannot
support each other. And a rectangle that is tiny beside all others, with none of its size in its row or column, is none;
nor is the wall between two windows, which has their sides.
"""

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.model.openings.evidence import NAMES, measure
from linecad.model.openings.lattice import propose, support
from linecad.model.openings.neighbours import compare, pairs_of
from linecad.model.openings.odds import LEAST_ODDS, odds
from linecad.model.openings.pool import Pool
from linecad.model.openings.raster import Raster

BRIGHTER = 1.0  # than the wall around it, by LEVELS of the evidence, a window is from inside; shelves are not
TINY, FEWEST = 0.1, 4  # of the median area of taken ones, so many at least: smaller ones need a mate
LEAST_MATES = 0.9  # support by row and column in sum, which one mate does not reach and two do
LEAST_COVER = 1.2  # of the four sides in sum: between two windows is often wall
LOOK = [NAMES.index("contrast"), NAMES.index("edges inside")]
ALIKE = 0.5  # of what those taken show of these, in the median
STEPS = NAMES.index("steps")
NEXT = 0.3  # of a rectangle's width: how far off its neighbour in the row is, whose side it may have
OVER = 2  # columns by which the two may overlap
LEVEL = 0.6  # of a rectangle's height that both have
SURE = 3.0  # log-odds of what was taken, at least, for what it says about others


def may_be(odds: Float, least: float, evidence: Float, is_inside: bool) -> Bool:
    """Which rectangles (N,) may be openings; seen from inside, only those that light comes through."""
    found = odds >= least
    if is_inside:
        found &= evidence[:, NAMES.index("darker")] <= -BRIGHTER
    return np.asarray(found)


def are_odd(raster: Raster, taken: Int) -> Bool:
    """Which of those taken (T, 4) are tiny beside the others and have none of their size in their row or column."""
    if len(taken) < FEWEST:
        return np.zeros(len(taken), bool)
    area = (raster.u[taken[:, 1]] - raster.u[taken[:, 0]]) * (raster.v[taken[:, 3]] - raster.v[taken[:, 2]])
    has_mate = support(taken, raster, taken, np.zeros(len(taken))).any(axis=1)
    return np.asarray((area < TINY * np.median(area)) & ~has_mate)


def are_between(pool: Pool, taken: Int) -> Bool:
    """Which of those taken (T, 4) are wall beside a window: told from what is around them far less than a neighbour."""
    pairs = pairs_of(taken, taken)
    wide, tall = pairs.size[:, :1], pairs.size[:, 1:]
    is_next = (pairs.gap_u >= -OVER) & (pairs.gap_u < NEXT * wide) & (-pairs.gap_v > LEVEL * tall)
    steps = measure(taken, pool.edges, pool.sums, pool.raster)[:, STEPS]
    return np.asarray((is_next & (steps[:, None] < ALIKE * steps)).any(axis=1))


def find_gaps(pool: Pool, taken: Int, taken_odds: Float) -> tuple[Int, Float]:
    """Rectangles (M, 4) that the rows and columns of those taken (T, 4) ask for, and their log-odds (M,)."""
    if len(taken) < 2:
        return np.zeros((0, 4), np.int64), np.zeros(0)
    proposed = propose(taken[np.argsort(-taken_odds, kind="stable")], pool.raster)
    box = np.concatenate([pool.box, proposed])
    evidence = np.concatenate([pool.evidence, measure(proposed, pool.edges, pool.sums, pool.raster)])
    sure = np.maximum(taken_odds, SURE)
    mates = support(box, pool.raster, taken, sure)
    found = odds(evidence, compare(box, pool.raster, taken, sure))
    asked = may_be(found, LEAST_ODDS, evidence, pool.is_inside) & (mates.sum(axis=1) >= LEAST_MATES)
    asked &= pool.edges.cover(box).sum(axis=1) >= LEAST_COVER
    # The sides of its neighbours close a piece of wall too, but in it is nothing.
    own = measure(taken, pool.edges, pool.sums, pool.raster)
    asked &= (evidence[:, LOOK] >= ALIKE * np.median(own[:, LOOK], axis=0)).all(axis=1)
    return box[asked], found[asked]
