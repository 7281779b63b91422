"""Ends of lines closed: an end that nearly meets a line meets it, by a move along its own line.

Lines of different axes that have their third offset in common meet somewhere. Where an end is near that place, it goes
there; where the other line ends short of it too, that one is drawn on, and both form a corner.
"""

from dataclasses import dataclass, fields, replace
from itertools import permutations

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.model.clean.strokes import FREE, SAME, Strokes, pairs_within, parallel_pairs, ragged

NEAR = 0.0105  # of the depth; an end so near to a line ends there (5 % beyond what counts as a miss, for rounding)
MEETS = 1e-9  # of the depth; rounding
MOST_SWEEPS = 12  # ends that moved bring others near; two or three are usual
SEVERAL = 4.0  # times that is as far as all its moves together may take it
LEAST_LEFT = 0.5  # of a line's length that its moved ends must leave


def close_ends(strokes: Strokes, further: "Pairs | None" = None) -> tuple[Strokes, Bool]:
    """The strokes with every end at the nearest line that it nearly meets, and which ends (N, 2) meet one.

    Lines only move along themselves. One that would lose more than half of its length on the way stays as it was.
    `further` are pairs that meet beside those along two axes of one frame.
    """
    pairs, found = _meeting(strokes, SEVERAL * NEAR), strokes
    pairs = pairs if further is None else pairs.joined(further)
    for _ in range(MOST_SWEEPS):
        reach, meets = _closed_once(found, pairs)
        if np.array_equal(reach, found.reach):
            break
        found = replace(found, reach=reach)
    kept = without_lost(strokes, found)
    if kept is not found:
        meets = _closed_once(kept, pairs)[1]
    return kept, meets


def without_lost(before: Strokes, after: Strokes) -> Strokes:
    """The strokes `after` their ends were moved, but for those that lost more than half of their length by it."""
    lost = np.diff(after.reach)[:, 0] < LEAST_LEFT * np.ptp(before.reach, axis=1)
    return replace(after, reach=np.where(lost[:, None], before.reach, after.reach)) if lost.any() else after


@dataclass(frozen=True, eq=False)
class Pairs:
    """Lines that would meet if they were long enough, both ways round."""

    line: Int  # (P,)
    other: Int  # (P,)
    place: Float  # (P,) along the line
    across: Float  # (P,) along the other
    sine: Float  # (P,) of the angle between them

    def joined(self, others: "Pairs") -> "Pairs":
        """These pairs, then others."""
        names = [each.name for each in fields(Pairs)]
        return Pairs(*(np.concatenate([getattr(self, name), getattr(others, name)]) for name in names))


def _meeting(strokes: Strokes, share: float) -> Pairs:
    """Pairs of lines of different axes that have their third offset in common and would meet near an end of the first.

    Near is within a `share` of the depth.
    """
    firsts, seconds = [np.zeros(0, np.int64)], [np.zeros(0, np.int64)]
    near = share * np.abs(strokes.end_depth).max(axis=1)
    for axis, other in permutations(range(3), 2):
        third = 3 - axis - other
        line, others = np.flatnonzero(strokes.axis == axis), np.flatnonzero(strokes.axis == other)
        places = np.unique(strokes.offset[others, axis])
        # One number for the plane in which they meet and the place in it, so that a window of it is a range.
        step = len(places) + 1
        key = strokes.number[others, third] * step + np.searchsorted(places, strokes.offset[others, axis])
        order = np.argsort(key, kind="stable")
        key, others = key[order], others[order]
        for end in range(2):
            at, number = strokes.reach[line, end], strokes.number[line, third] * step
            low = np.searchsorted(key, number + np.searchsorted(places, at - near[line], "left"))
            high = np.searchsorted(key, number + np.searchsorted(places, at + near[line], "right"))
            row, place = ragged(low, high - low)
            firsts.append(line[row])
            seconds.append(others[place])
    first, second = np.concatenate(firsts), np.concatenate(seconds)
    across = strokes.offset[first, strokes.axis[second]]
    keep = strokes.component[first] == strokes.component[second]
    keep[keep] = short_of(strokes, second[keep], across[keep]) <= near[first[keep]]
    first, second, across = first[keep], second[keep], across[keep]
    return Pairs(first, second, strokes.offset[second, strokes.axis[first]], across, np.ones(len(first)))


def short_of(strokes: Strokes, line: Int, place: Float) -> Float:
    """(P,) how far lines end short of places (P,) along them."""
    low, high = strokes.reach.T
    short: Float = np.maximum(np.maximum(low[line] - place, place - high[line]), 0)
    return short


def _closed_once(strokes: Strokes, pairs: Pairs) -> tuple[Float, Bool]:
    """New reaches (N, 2), and which ends met a line before."""
    if len(pairs.line) == 0:
        return strokes.reach, np.zeros(strokes.reach.shape, bool)
    length = np.ptp(strokes.reach, axis=1)
    depth = np.abs(strokes.end_depth)
    short = short_of(strokes, pairs.other, pairs.across)
    nearest = [_nearest(strokes.reach[:, end], depth[:, end], pairs, short) for end in range(2)]
    pair, apart = (np.stack([each[k] for each in nearest], axis=1) for k in range(2))
    moves = (pair != FREE) & (apart > MEETS)
    meets = apart <= MEETS
    reach = np.where(moves, pairs.place[pair], strokes.reach)
    # Both ends of a short line may be near to one line: then the nearer end goes there and the other stays.
    shrunk = np.diff(reach)[:, 0] < LEAST_LEFT * length
    nearer = np.where(moves, apart, np.inf).argmin(axis=1)
    alone = moves & (np.arange(2) == nearer[:, None])
    kept = np.where(shrunk[:, None], alone, moves)
    reach = np.where(kept, pairs.place[pair], strokes.reach)
    kept &= (np.diff(reach) >= LEAST_LEFT * length[:, None]) | ~shrunk[:, None]
    reach = np.where(kept, pairs.place[pair], strokes.reach)
    met = pair[kept]
    np.minimum.at(reach[:, 0], pairs.other[met], pairs.across[met])
    np.maximum.at(reach[:, 1], pairs.other[met], pairs.across[met])
    return reach, meets


def _nearest(end: Float, depth: Float, pairs: Pairs, short: Float) -> tuple[Int, Float]:
    """Which pair (N,) brings each end (N,) nearest to a line, FREE for none within NEAR, and the share of the depth."""
    along, limit = pairs.place - end[pairs.line], depth[pairs.line]
    along = along * pairs.sine  # away from the other line
    near = np.flatnonzero(np.abs(along) <= 2 * NEAR * limit)  # few, for which alone the distance is worth its time
    apart = np.hypot(along[near], short[near]) / limit[near]
    order = np.argsort(apart, kind="stable")[::-1]
    order = order[apart[order] <= NEAR]
    nearest, line = near[order], pairs.line[near[order]]
    pair, distance = np.full(len(end), FREE), np.full(len(end), np.inf)
    pair[line], distance[line] = nearest, apart[order]  # the nearest is written last
    return pair, distance


def missed_offsets(strokes: Strokes, meets: Bool) -> Int:
    """Pairs (P, 2) of numbers of offsets, nearest first, that keep an end from the line that it nearly meets.

    `meets` (N, 2) are the ends that meet a line.
    """
    line, _, other = _missed(strokes, meets)
    third = 3 - strokes.axis[line] - strokes.axis[other]
    pairs = np.column_stack([strokes.number[line, third], strokes.number[other, third]])
    missed: Int = pairs[pairs[:, 0] != pairs[:, 1]]
    return missed


def ends_that_miss(strokes: Strokes, meets: Bool) -> Bool:
    """Which ends (N, 2) nearly meet a line of another axis and do not, as all but those of `meets` (N, 2) may."""
    line, end, _ = _missed(strokes, meets)
    misses = np.zeros(meets.shape, bool)
    misses[line, end] = True
    return misses


def _missed(strokes: Strokes, meets: Bool) -> tuple[Int, Int, Int]:
    """Line, end and nearest other line (P,) of the ends that nearly meet one, nearest first."""
    line, end = np.nonzero(~meets)
    if len(line) == 0:
        return line, end, line
    point, depth = strokes.points(strokes.reach)[line, end], np.abs(strokes.end_depth)[line, end]
    rows, others = [np.zeros(0, np.int64)], [np.zeros(0, np.int64)]
    for axis, other_axis in permutations(range(3), 2):
        own, there = np.flatnonzero(strokes.axis[line] == axis), np.flatnonzero(strokes.axis == other_axis)
        across = [each for each in range(3) if each != other_axis]
        row, other = pairs_within(point[own][:, across], strokes.offset[there][:, across], NEAR * depth[own])
        rows.append(own[row])
        others.append(there[other])
    row, other = np.concatenate(rows), np.concatenate(others)
    same = strokes.component[line[row]] == strokes.component[other]
    row, other = row[same], other[same]
    off = strokes.offset[other] - point[row]
    along = strokes.axis[other]
    pick = np.arange(len(row))
    off[pick, along] = short_of(strokes, other, point[row, along])
    apart = np.linalg.norm(off, axis=1) / depth[row]
    order = np.lexsort((other, apart, row))
    first = order[np.unique(row[order], return_index=True)[1]]  # the nearest line of each end
    first = first[apart[first] <= NEAR]
    first = first[np.argsort(apart[first], kind="stable")]
    return line[row[first]], end[row[first]], other[first]


def ends_that_meet(strokes: Strokes, further: Pairs | None = None) -> Bool:
    """Which ends (N, 2) meet a line of another axis, or of the `further` pairs."""
    pairs = _meeting(strokes, 2 * MEETS)
    return _closed_once(strokes, pairs if further is None else pairs.joined(further))[1]


def nearest_crossings(strokes: Strokes, line: Int, end: Int) -> tuple[Float, Float]:
    """How far (P,) the ends `end` (P,) of lines (P,) are from the first line of their plane that crosses their way,
    and how far from the last that crosses the line itself.

    Lines that end short of the way by no more than NEAR cross it too. Infinite where there is none.
    """
    ahead, back = np.full(len(line), np.inf), np.full(len(line), np.inf)
    at, outwards = strokes.reach[line, end], np.where(end == 1, 1.0, -1.0)
    near = NEAR * np.abs(strokes.end_depth[line, end])
    for axis, other in permutations(range(3), 2):
        third = 3 - axis - other
        own, others = np.flatnonzero(strokes.axis[line] == axis), np.flatnonzero(strokes.axis == other)
        order = others[np.argsort(strokes.number[others, third], kind="stable")]
        numbers, wanted = strokes.number[order, third], strokes.number[line[own], third]
        low = np.searchsorted(numbers, wanted, "left")
        row, place = ragged(low, np.searchsorted(numbers, wanted, "right") - low)
        row, crossed = own[row], order[place]
        way = (strokes.offset[crossed, axis] - at[row]) * outwards[row]
        crosses = strokes.component[crossed] == strokes.component[line[row]]
        crosses &= short_of(strokes, crossed, strokes.offset[line[row], other]) <= near[row]
        for found, side in ((ahead, way), (back, -way)):
            there = crosses & (side > 0)
            np.minimum.at(found, row[there], side[there])
    return ahead, back


def without_new_twins(before: Strokes, after: Strokes) -> Strokes:
    """The strokes `after` their ends were drawn on, but for those that would come NEAR another piece of their line."""
    first, second, _, overlap = parallel_pairs(after, SAME)
    near = overlap >= -NEAR * np.minimum(np.abs(after.depth[first]), np.abs(after.depth[second]))
    twins = np.union1d(first[near], second[near])
    reach = after.reach.copy()
    reach[twins] = before.reach[twins]
    return replace(after, reach=reach)
