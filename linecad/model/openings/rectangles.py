"""Rectangles whose sides edges of a wall's raster show in good part, as columns and rows."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from linecad.arrays import Bool, Float, Int, true_places
from linecad.model.openings.raster import Raster

LEAST_SIDE = 5  # columns or rows; facades seen obliquely show no more of a window
LEAST_STICK = 7  # rows of an upright edge without gaps
GAP = 5  # rows, over which an upright edge goes on
MOST_STICKS = 1200  # the longest
MOST_LEVELS = 4  # sides that are tried above, and below, a pair of uprights
AWAY = 0.5  # what a level side loses that lies as far from the uprights' ends as it may
LEAST_COVER = 0.25  # of a level side
LEAST_COVERS = 1.7  # of the four sides in sum
COMMON = 0.4  # of the stretch that two uprights show together, which both show
ABOUT = 0.2  # of an upright's length: how far beyond or before its end the level side may lie
LARGEST_SHARE = 0.4  # of the raster's columns
BEYOND = 0.2  # of a side: how far beyond its ends it is looked whether the edge goes on
MOST = 2000  # rectangles of a wall
PAST = 1.3  # what edges that go on cost, by edges that are seen
SLENDER = 6.0  # ratio of sides, from which a rectangle is none


@dataclass(frozen=True, eq=False)
class Edges:
    """How many edge points lie before each column or row, edges being three points wide."""

    upright: NDArray[np.int32]  # (R + 1, C)
    level: NDArray[np.int32]  # (R, C + 1)

    def along_column(self, column: Int, start: Int, end: Int) -> Float:
        """Share (N,) of the rows from start to end that show an upright edge in a column."""
        last = len(self.upright) - 1
        start, end = start.clip(0, last), end.clip(0, last)
        share: Float = (self.upright[end, column] - self.upright[start, column]) / np.maximum(end - start, 1)
        return share

    def along_row(self, row: Int, start: Int, end: Int) -> Float:
        """Share (N,) of the columns from start to end that show a level edge in a row."""
        last = self.level.shape[1] - 1
        start, end = start.clip(0, last), end.clip(0, last)
        share: Float = (self.level[row, end] - self.level[row, start]) / np.maximum(end - start, 1)
        return share

    def cover(self, box: Int) -> Float:
        """Share (N, 4) of the left, right, low and high sides of boxes (N, 4) that show edges."""
        left, right, low, high = box.T
        return np.column_stack(
            [
                self.along_column(left, low, high),
                self.along_column(right, low, high),
                self.along_row(low, left, right),
                self.along_row(high, left, right),
            ]
        )

    def beyond(self, box: Int) -> Float:
        """The same (N, 4) of a stretch beyond both ends of each side: there the edge of an opening has ended."""
        left, right, low, high = box.T
        wide = np.maximum((BEYOND * (right - left)).astype(np.int64), 3)
        tall = np.maximum((BEYOND * (high - low)).astype(np.int64), 3)
        # One point beside the corner may belong to the other side.
        upright = [
            self.along_column(side, low - 1 - tall, low - 1) + self.along_column(side, high + 2, high + 2 + tall)
            for side in (left, right)
        ]
        level = [
            self.along_row(side, left - 1 - wide, left - 1) + self.along_row(side, right + 2, right + 2 + wide)
            for side in (low, high)
        ]
        return np.column_stack(upright + level) / 2


def count_edges(raster: Raster) -> Edges:
    """The edges of a raster, counted."""
    upright = cv2.dilate(raster.upright.astype(np.uint8), np.ones((1, 3), np.uint8))
    level = cv2.dilate(raster.level.astype(np.uint8), np.ones((3, 1), np.uint8))
    return Edges(
        np.pad(np.cumsum(upright, axis=0, dtype=np.int32), ((1, 0), (0, 0))),
        np.pad(np.cumsum(level, axis=1, dtype=np.int32), ((0, 0), (1, 0))),
    )


def find_rectangles(raster: Raster, edges: Edges) -> Int:
    """Left and right column, low and high row (N, 4) of rectangles that edges close, nested ones too, at most MOST.

    Those stay whose sides show the most edges that end at their corners.
    """
    column, run = _sticks(raster)
    first, second = _pairs(column, run, len(raster.u))
    if len(first) == 0:
        return np.zeros((0, 4), np.int64)
    left, right = column[first], column[second]
    low = _levels(edges, left, right, run[first, 0], run[second, 0], run[first], run[second])
    high = _levels(edges, left, right, run[first, 1], run[second, 1], run[first], run[second])
    pair, low_row, high_row = _joined(low, high, len(first))
    # One number a box, since rows of four are slow to sort.
    sizes = (len(raster.u), len(raster.u), len(raster.v) + 1, len(raster.v) + 1)
    number = np.unique(np.ravel_multi_index((left[pair], right[pair], low_row, high_row), sizes))
    box = np.column_stack(np.unravel_index(number, sizes))
    wide, tall = raster.u[box[:, 1]] - raster.u[box[:, 0]], raster.v[box[:, 3]] - raster.v[box[:, 2]]
    box = box[(box[:, 3] - box[:, 2] >= LEAST_SIDE) & (wide < SLENDER * tall) & (tall < SLENDER * wide)]
    covers = edges.cover(box).sum(axis=1)
    box, covers = box[covers >= LEAST_COVERS], covers[covers >= LEAST_COVERS]
    if len(box) > MOST:
        closed = covers - PAST * edges.beyond(box).sum(axis=1)
        box = box[np.sort(np.argsort(-closed, kind="stable")[:MOST])]
    return np.asarray(box, np.int64)


def _sticks(raster: Raster) -> tuple[Int, Int]:
    """Upright edges without gaps: the column (S,) of each and from which row to which it reaches (S, 2)."""
    thin = raster.upright.astype(np.uint8)
    wide = cv2.dilate(thin, np.ones((1, 3), np.uint8))
    closed = cv2.morphologyEx(wide, cv2.MORPH_CLOSE, np.ones((GAP, 1), np.uint8))
    opened = cv2.morphologyEx(closed, cv2.MORPH_OPEN, np.ones((LEAST_STICK, 1), np.uint8))
    change = np.diff(np.pad(opened, ((1, 1), (0, 0))).astype(np.int8), axis=0)
    column, start = true_places(change.T == 1)
    _, end = true_places(change.T == -1)
    own = np.pad(np.cumsum(thin, axis=0, dtype=np.int64), ((1, 0), (0, 0)))
    around = np.pad(np.cumsum(wide, axis=0, dtype=np.int64), ((1, 0), (0, 0)))
    weight = own[end, column] - own[start, column] + (around[end, column] - around[start, column])
    kept = np.flatnonzero(~_are_beaten(column, np.column_stack([start, end]), weight, thin.shape))
    kept = kept[np.argsort(-weight[kept], kind="stable")[:MOST_STICKS]]
    return column[kept], np.column_stack([start, end])[kept]


def _are_beaten(column: Int, run: Int, weight: Int, shape: tuple[int, ...]) -> Bool:
    """Whether a stick beside each stick (S,), at most two columns away, shows the same and has more weight.

    Where both have the same weight, the left one stays.
    """
    change = np.zeros((shape[0] + 1, shape[1] + 4), np.int64)
    np.add.at(change, (run[:, 0], column + 2), weight)
    np.add.at(change, (run[:, 1], column + 2), -weight)
    painted = change.cumsum(axis=0)
    length = run[:, 1] - run[:, 0]
    beaten = np.zeros(len(column), bool)
    for shift in (-2, -1, 1, 2):
        better = sum(
            (painted[run[:, 0] + length * quarter // 4, column + 2 + shift] >= weight + (shift > 0)).astype(np.int64)
            for quarter in (1, 2, 3)
        )
        beaten |= better >= 2
    return beaten


def _pairs(column: Int, run: Int, columns: int) -> tuple[Int, Int]:
    """Pairs of sticks that may be the two upright sides of an opening, the left one first."""
    order = np.argsort(column, kind="stable")
    first, second = np.triu_indices(len(order), 1)
    first, second = order[first], order[second]
    width = column[second] - column[first]
    fits = (width >= LEAST_SIDE) & (width <= LARGEST_SHARE * columns)
    first, second = first[fits], second[fits]
    common = np.minimum(run[first, 1], run[second, 1]) - np.maximum(run[first, 0], run[second, 0])
    whole = np.maximum(run[first, 1], run[second, 1]) - np.minimum(run[first, 0], run[second, 0])
    fits = common >= COMMON * whole
    return first[fits], second[fits]


def _levels(edges: Edges, left: Int, right: Int, one: Int, other: Int, run: Int, other_run: Int) -> tuple[Int, Int]:
    """The best level sides about one end of pairs of uprights: the pair (L,), ascending, and the row (L,)."""
    longest = np.maximum(run[:, 1] - run[:, 0], other_run[:, 1] - other_run[:, 0])
    reach = (ABOUT * longest).astype(np.int64) + 2
    last = len(edges.level) - 1
    start, stop = (np.minimum(one, other) - reach).clip(1, last), (np.maximum(one, other) + reach + 1).clip(1, last)
    count = stop - start
    pair = np.repeat(np.arange(len(left)), count)
    row = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count) + start[pair]
    a, b = left[pair], right[pair]
    shown = edges.along_row(row, a, b)
    kept = shown >= LEAST_COVER
    pair, row, a, b, shown = pair[kept], row[kept], a[kept], b[kept], shown[kept]
    # Edges are three rows wide here: the row between its neighbours is the edge itself.
    shown = shown + (edges.along_row(row - 1, a, b) + edges.along_row(row + 1, a, b)) / 4
    same_before, same_after = np.zeros(len(row), bool), np.zeros(len(row), bool)
    follows = (pair[1:] == pair[:-1]) & (row[1:] == row[:-1] + 1)
    same_before[1:] = follows & (shown[1:] <= shown[:-1])
    same_after[:-1] = follows & (shown[:-1] < shown[1:])
    peak = ~(same_before | same_after)
    pair, row, shown = pair[peak], row[peak], shown[peak]
    away = np.abs(row - (start + stop)[pair] / 2) / count[pair]
    order = np.lexsort((AWAY * away - shown, pair))
    pair, row = pair[order], row[order]
    rank = np.arange(len(pair)) - np.searchsorted(pair, pair)
    return pair[rank < MOST_LEVELS], row[rank < MOST_LEVELS]


def _joined(low: tuple[Int, Int], high: tuple[Int, Int], pairs: int) -> tuple[Int, Int, Int]:
    """Every low side with every high side of the same pair: the pair, the low row, the high row."""
    count = np.bincount(high[0], minlength=pairs)
    start = np.cumsum(count) - count
    times = count[low[0]]
    inner = np.arange(times.sum()) - np.repeat(np.cumsum(times) - times, times)
    pair = np.repeat(low[0], times)
    return pair, np.repeat(low[1], times), high[1][start[pair] + inner]
