"""Lines that go on where others end, or repeat them, taken into these."""

from dataclasses import replace

import numpy as np

from linecad.arrays import Bool, Float, Int, rows_of
from linecad.model.clean.ends import NEAR, without_new_twins
from linecad.model.clean.joining import with_ends, with_pieces
from linecad.model.clean.strokes import SAME, parallel_pairs, strokes_of
from linecad.scene import Lines

MOST_ROUNDS = 6  # a line that became longer may touch more; two or three are usual


def absorbed(lines: Lines, spare: Bool, forward: Float) -> tuple[Lines, Int]:
    """The lines that are left of N, as far as they reach with the `spare` ones (N,) that they took in, and their rows.

    A spare line goes into the longest line that it repeats or goes on from, spare or not; no other line changes its
    place, only its ends and its pieces. `forward` (3,) is the camera's z in the world.
    """
    rows = np.arange(len(lines))
    for _ in range(MOST_ROUNDS if spare.any() else 0):
        lines, left = _absorbed_once(lines, spare[rows], forward)
        lines, rows = rows_of(lines, left), rows[left]
        if left.all():
            break
    return lines, rows


def _absorbed_once(lines: Lines, spare: Bool, forward: Float) -> tuple[Lines, Bool]:
    """The lines (N) after one round, and which (N,) are left."""
    strokes = strokes_of(lines, forward)
    first, second, _, overlap = parallel_pairs(strokes, SAME)
    depth = np.abs(strokes.depth)
    touch = overlap >= -NEAR * np.minimum(depth[first], depth[second])
    home = _homes(first[touch], second[touch], spare, np.ptp(strokes.reach, axis=1))
    reach = strokes.reach.copy()
    lone = _staying_beside(first[touch], second[touch], spare) < 2  # what bridges two that stay would make these touch
    for row in np.flatnonzero(home != np.arange(len(lines))).tolist():
        into = int(home[row])
        if lone[row]:
            reach[into] = min(reach[into, 0], reach[row, 0]), max(reach[into, 1], reach[row, 1])
    stay = np.flatnonzero(~spare)
    longer = without_new_twins(strokes.of(~spare), replace(strokes, reach=reach).of(~spare))
    reach[stay] = longer.reach
    found = with_ends(with_pieces(lines, home), replace(strokes, reach=reach))
    return found, home == np.arange(len(lines))


def _staying_beside(first: Int, second: Int, spare: Bool) -> Int:
    """How many lines that are not spare each line (N,) touches, of pairs of lines that touch."""
    line, other = np.r_[first, second], np.r_[second, first]
    return np.bincount(line[~spare[other]], minlength=len(spare))


def _homes(first: Int, second: Int, spare: Bool, length: Float) -> Int:
    """The line (N,) that each goes into, itself for most; of pairs of lines that touch."""
    beside: dict[int, list[int]] = {}
    for one, other in zip(first.tolist(), second.tolist(), strict=True):
        beside.setdefault(one, []).append(other)
        beside.setdefault(other, []).append(one)
    home = np.arange(len(spare))
    rank = np.lexsort((home, -length, spare))  # lines that stay first, then the longest
    order = np.empty(len(rank), np.int64)
    order[rank] = np.arange(len(rank))
    for row in rank.tolist():
        better = [each for each in beside.get(row, []) if order[each] < order[row] and home[each] == each]
        if spare[row] and better:
            home[row] = min(better, key=lambda each: int(order[each]))
    return home
