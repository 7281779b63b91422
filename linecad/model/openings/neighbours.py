"""How rectangles of a wall lie to the likely ones among the others: what is told by none of them alone.

Panes stand as close as bars are wide, windows farther apart, and what holds panes or is held by a window is judged by
that too. Groups of rectangles as close as panes are proposed as one window.
"""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from linecad.arrays import Bool, Float, Int
from linecad.model.openings.lattice import large_ones, mates
from linecad.model.openings.raster import Raster

TIGHT, CLOSE = 0.2, 0.5  # of a rectangle's side: gaps to the next one, as bars between panes and posts between windows
MORE = 2  # columns or rows that these gaps may be wider
MOST_MATES = 5.0  # more in a row or column tell no more
PANES = 2  # mates so close in row and column that a rectangle may be a pane
WITHIN = 0.9  # of the area of one that lies in another
LARGER = 1.4  # times its area, from which another holds a rectangle and is not the same
ACROSS = 0.2  # of the smaller area, from which two that do not hold each other overlap
SURE = 6.0  # log-odds, at most and at least, that count
LIKELY_PANE = 0.1  # probability of a pane that covers a window
COVERED = 1.5  # of an area, by panes that overlap, at most
LEAST_GROUPED = -2.5  # log-odds of those that are grouped
NAMES = (
    "row, apart", "row, close", "row, tight", "column, apart", "column, close", "column, tight",
    "likeliest around", "likeliest inside", "panes inside", "others inside", "around", "across",
    "covered by panes", "covered by others",
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class Pairs:
    """How boxes (N, 4) lie to others (M, 4), in columns and rows."""

    gap_u: Int  # (N, M) columns between them, negative where they share some
    gap_v: Int  # (N, M) rows, negative where they share some
    shared_v: Int  # (N, M) rows that both have
    size: Int  # (N, 2) columns and rows of each box
    shared: Int  # (N, M) area
    area: Int  # (N, 1) of the boxes
    other_area: Int  # (1, M)

    def within(self, share: float) -> tuple[Bool, Bool]:
        """Which pairs are as near along u, and along v, as that share of the box's side."""
        wide, tall = self.size[:, :1], self.size[:, 1:]
        return np.asarray(self.gap_u < share * wide + MORE), np.asarray(self.gap_v < share * tall + MORE)


def pairs_of(box: Int, others: Int) -> Pairs:
    """How each of boxes (N, 4) lies to each of others (M, 4)."""
    left, right, low, high = (side[:, None] for side in box.T)
    gap_u = np.maximum(others[:, 0] - right, left - others[:, 1])
    gap_v = np.maximum(others[:, 2] - high, low - others[:, 3])
    shared_u = np.minimum(right, others[:, 1]) - np.maximum(left, others[:, 0])
    shared_v = np.maximum(np.minimum(high, others[:, 3]) - np.maximum(low, others[:, 2]), 0)
    other_area = (others[:, 1] - others[:, 0]) * (others[:, 3] - others[:, 2])
    size = np.column_stack([box[:, 1] - box[:, 0], box[:, 3] - box[:, 2]])
    shared = np.maximum(shared_u, 0) * shared_v
    return Pairs(gap_u, gap_v, shared_v, size, shared, size.prod(axis=1)[:, None], other_area[None])


def _close_mates(box: Int, raster: Raster, pairs: Pairs) -> tuple[Bool, Bool]:
    """Which boxes (N, 4) are of the size of another in its row, and in its column, and as close as panes, (N, N).

    `pairs` tells how they lie to each other.
    """
    row, column = mates(box, box, raster)
    near_u, near_v = pairs.within(CLOSE)
    return row & near_u, column & near_v


def compare(box: Int, raster: Raster, others: Int, other_log_odds: Float) -> Float:
    """Numbers (N, F), in the order of NAMES, of boxes (N, 4) beside others (M, 4) of log-odds (M,).

    Mates in row and column, what lies around, inside and across count by their probabilities, as log(1 + sum).
    """
    if not len(others):
        return np.where(np.char.startswith(NAMES, "likeliest"), -SURE, np.zeros((len(box), 1)))
    row, column = mates(box, others, raster)
    pairs = pairs_of(box, others)
    tight_u, tight_v = pairs.within(TIGHT)
    close_u, close_v = pairs.within(CLOSE)
    probability = 1 / (1 + np.exp(-other_log_odds))
    standing = [
        np.log1p(np.minimum(which @ probability, MOST_MATES))
        for mate, tight, close in ((row, tight_u, close_u), (column, tight_v, close_v))
        for which in (mate & ~close, mate & close & ~tight, mate & tight)
    ]
    around = (pairs.shared > WITHIN * pairs.area) & (pairs.other_area > LARGER * pairs.area)
    inside = (pairs.shared > WITHIN * pairs.other_area) & (pairs.area > LARGER * pairs.other_area)
    smaller = np.minimum(pairs.area, pairs.other_area)
    across = (pairs.shared > ACROSS * smaller) & (pairs.shared < WITHIN * smaller)
    close_row, close_column = _close_mates(others, raster, pairs_of(others, others))
    is_pane = close_row.sum(axis=1) + close_column.sum(axis=1) >= PANES
    panes, rest = inside & is_pane, inside & ~is_pane
    log_odds = np.clip(other_log_odds, -SURE, SURE)
    area = pairs.area[:, 0]
    return np.column_stack(
        [
            *standing,
            np.where(around, log_odds, -SURE).max(axis=1),
            np.where(inside, log_odds, -SURE).max(axis=1),
            *(np.log1p(which @ probability) for which in (panes, rest, around, across)),
            np.minimum((pairs.shared * panes) @ (probability > LIKELY_PANE) / area, COVERED),
            np.minimum((pairs.shared * rest) @ probability / area, COVERED),
        ]
    )


def windows_of_panes(box: Int, log_odds: Float, raster: Raster) -> Int:
    """What groups of boxes (N, 4) that stand as close as panes span, (M, 4), with a frame as wide as their gaps too."""
    box = box[log_odds >= LEAST_GROUPED]
    if len(box) < 2:
        return np.zeros((0, 4), np.int64)
    pairs = pairs_of(box, box)
    row, column = _close_mates(box, raster, pairs)
    near = (row & row.T) | (column & column.T)
    _, group = connected_components(coo_array(near), directed=False)
    found = []
    for number in np.flatnonzero(np.bincount(group) >= 2).tolist():
        own = np.flatnonzero(group == number)
        panes = box[own]
        whole = np.array([panes[:, 0].min(), panes[:, 1].max(), panes[:, 2].min(), panes[:, 3].max()])
        among = np.ix_(own, own)
        gaps = np.concatenate([pairs.gap_u[among][row[among]], pairs.gap_v[among][column[among]]])
        frame = round(float(np.median(gaps)))
        found += [whole, whole + frame * np.array([-1, 1, -1, 1])]
    if not found:
        return np.zeros((0, 4), np.int64)
    spans = np.array(found)
    spans[:, :2] = spans[:, :2].clip(0, len(raster.u) - 1)
    spans[:, 2:] = spans[:, 2:].clip(0, len(raster.v) - 1)
    return large_ones(spans)
