"""What the openings that were taken tell about others of their wall.

What alone is too uncertain to be an opening, such as a window half behind a bush, is likely one where openings of its
size stand in its row and its column, so that gaps are filled. Only taken ones ask here: rectangles of bricks cannot
support each other. And a rectangle that is tiny beside all others, with none of its size in its row or column, is none;
nor is the wall beside a window, of which one side is the window's.
"""

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.model.openings.evidence import NAMES, measure
from linecad.model.openings.lattice import mates, new_ones, propose, support
from linecad.model.openings.neighbours import compare, pairs_of
from linecad.model.openings.odds import LEAST_LOG_ODDS, log_odds_beside
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


def may_be(log_odds: Float, evidence: Float, is_inside: bool) -> Bool:
    """Which rectangles (N,) may be openings; seen from inside, only those that light comes through."""
    found = log_odds >= LEAST_LOG_ODDS
    if is_inside:
        found &= evidence[:, NAMES.index("darker")] <= -BRIGHTER
    return np.asarray(found)


def are_odd(raster: Raster, taken: Int) -> Bool:
    """Which of those taken (T, 4) are tiny beside the others and have none of their size in their row or column."""
    if len(taken) < FEWEST:
        return np.zeros(len(taken), bool)
    area = (raster.u[taken[:, 1]] - raster.u[taken[:, 0]]) * (raster.v[taken[:, 3]] - raster.v[taken[:, 2]])
    has_mate = np.logical_or(*mates(taken, taken, raster)).any(axis=1)
    return np.asarray((area < TINY * np.median(area)) & ~has_mate)


def are_beside_clearer(taken: Int, evidence: Float) -> Bool:
    """Which of those taken (T, 4) are wall beside a window: told from what is around them far less than a neighbour.

    By their evidence (T, F).
    """
    pairs = pairs_of(taken, taken)
    wide, tall = pairs.size[:, :1], pairs.size[:, 1:]
    is_next = (pairs.gap_u >= -OVER) & (pairs.gap_u < NEXT * wide) & (pairs.shared_v > LEVEL * tall)
    steps = evidence[:, STEPS]
    return np.asarray((is_next & (steps[:, None] < ALIKE * steps)).any(axis=1))


def find_gaps(
    pool: Pool, taken: Int, taken_log_odds: Float, taken_evidence: Float, is_inside: bool
) -> tuple[Int, Float, Float]:
    """Rectangles (M, 4) that rows and columns of those taken (T, 4) ask for, with log-odds (M,) and evidence (M, F)."""
    if len(taken) < 2:
        return np.zeros((0, 4), np.int64), np.zeros(0), taken_evidence[:0]
    proposed = new_ones(propose(taken[np.argsort(-taken_log_odds, kind="stable")], pool.raster), pool.box)
    box = np.concatenate([pool.box, proposed])
    evidence = np.concatenate([pool.evidence, measure(proposed, pool.edges, pool.sums, pool.raster)])
    sure = np.maximum(taken_log_odds, SURE)
    standing = support(box, pool.raster, taken, sure)
    found = log_odds_beside(evidence, compare(box, pool.raster, taken, sure))
    asked = may_be(found, evidence, is_inside) & (standing.sum(axis=1) >= LEAST_MATES)
    asked &= pool.edges.cover(box).sum(axis=1) >= LEAST_COVER
    # The sides of its neighbours close a piece of wall too, but in it is nothing.
    asked &= (evidence[:, LOOK] >= ALIKE * np.median(taken_evidence[:, LOOK], axis=0)).all(axis=1)
    return box[asked], found[asked], evidence[asked]
