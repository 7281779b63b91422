"""The lines of a scene as arrays to work on, with the numbers of the plane offsets that they share.

A line of axis x is the meeting of its y and its z plane, so two lines are one where both offsets are one number, and
two lines of different axes meet where their common third offset is. All that cleaning does is to make offsets equal,
for all lines that have them at once, and to move ends along their lines: no line is bent, and lines that met meet.
"""

from dataclasses import dataclass, replace

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.scene import Lines

# Of the depth, in which parallel lines are one: a thousandth, which is a pixel in a small photo and three in a large
# one, as near as the two edges of one joint, and 5 % for rounding.
SAME = 0.00105
FREE = -1  # no offset: along a line's own axis, or an end that lies on no plane


@dataclass(eq=False)
class Strokes:
    """N lines while they are cleaned."""

    axis: Int  # (N,)
    component: Int  # (N,)
    forward: Float  # (3,) the camera's z, in the axes that all lines have; (N, 3) where each has its own
    weight: Float  # (N,) px, the length of segments that show the line
    offset: Float  # (N, 3) its coordinates, 0 along its own axis
    number: Int  # (N, 3) of each offset; FREE along its own axis
    reach: Float  # (N, 2) where it starts and ends along its axis, ascending

    @property
    def rows(self) -> Int:
        """(N,) 0 to N - 1."""
        return np.arange(len(self.axis))

    def points(self, reach: Float) -> Float:
        """The world points (N, K, 3) of each line at places (N, K) along it."""
        points = np.repeat(self.offset[:, None], reach.shape[1], axis=1)
        points[self.rows[:, None], np.arange(reach.shape[1]), self.axis[:, None]] = reach
        return points

    def of(self, chosen: Bool) -> "Strokes":
        """The masked lines (N,) alone."""
        return replace(
            self,
            axis=self.axis[chosen],
            forward=self.forward if self.forward.ndim == 1 else self.forward[chosen],
            component=self.component[chosen],
            weight=self.weight[chosen],
            offset=self.offset[chosen],
            number=self.number[chosen],
            reach=self.reach[chosen],
        )

    @property
    def end_depth(self) -> Float:
        """(N, 2) camera depth of both ends."""
        points = self.points(self.reach)
        depth: Float = points @ self.forward if self.forward.ndim == 1 else (points * self.forward[:, None]).sum(axis=2)
        return depth

    @property
    def depth(self) -> Float:
        """(N,) camera depth of the middle."""
        depth: Float = self.end_depth.mean(axis=1)
        return depth


def strokes_of(lines: Lines, forward: Float) -> Strokes:
    """The lines as strokes; offsets of one axis that are equal to the last digit have one number."""
    rows = np.arange(len(lines))
    offset = lines.ends[:, 0].copy()
    offset[rows, lines.axis] = 0.0
    along = lines.ends[rows[:, None], np.arange(2), lines.axis[:, None]]
    return Strokes(
        axis=lines.axis,
        component=lines.component,
        forward=forward,
        weight=np.linalg.norm(lines.segment[:, 1] - lines.segment[:, 0], axis=1),
        offset=offset,
        number=numbers_of(offset, lines.axis),
        reach=np.sort(along, axis=1),
    )


def numbers_of(offset: Float, axis: Int) -> Int:
    """Numbers (N, 3) that are equal where offsets (N, 3) of one axis are; FREE along each line's own axis (N,)."""
    number = np.full(offset.shape, FREE)
    count = 0
    for normal in range(3):
        across = axis != normal
        values, places = np.unique(offset[across, normal], return_inverse=True)
        number[across, normal] = places + count
        count += len(values)
    return number


def pairs_within(queries: Float, values: Float, reach: Float) -> tuple[Int, Int]:
    """Pairs of a query (Q, K) and a value (V, K) that differ by at most the query's `reach` (Q,) in one column.

    It is the column that leaves the fewest pairs.
    """
    order = np.argsort(values, axis=0, kind="stable")
    windows = []
    for column in range(values.shape[1]):
        ordered = values[order[:, column], column]
        low = np.searchsorted(ordered, queries[:, column] - reach, "left")
        windows.append((low, np.searchsorted(ordered, queries[:, column] + reach, "right") - low))
    best = int(np.argmin([count.sum() for _, count in windows]))
    query, place = ragged(*windows[best])
    return query, order[place, best]


def ragged(start: Int, count: Int) -> tuple[Int, Int]:
    """Row and index of each of `count` (N,) successive indices from `start` (N,) on, row by row."""
    row = np.repeat(np.arange(len(count)), count)
    return row, np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count) + np.repeat(start, count)


def parallel_pairs(strokes: Strokes, share: float) -> tuple[Int, Int, Float, Float]:
    """Parallel lines of one component that lie within a `share` of the depth of the nearer one.

    Both lines of each pair, the distance between them, and by how much they overlap along their axis, negative for a
    gap; each in scene units. Smaller row first.
    """
    depth, firsts, seconds = np.abs(strokes.depth), [], []
    for axis in range(3):
        own = np.flatnonzero(strokes.axis == axis)
        across = np.delete(strokes.offset[own], axis, axis=1)
        first, second = pairs_within(across, across, share * depth[own])
        firsts.append(own[first])
        seconds.append(own[second])
    first, second = np.concatenate(firsts), np.concatenate(seconds)
    # Each line finds the other where both are near by its own depth, so one way round is enough.
    same = (strokes.component[first] == strokes.component[second]) & (first < second)
    first, second = first[same], second[same]
    apart = np.linalg.norm(strokes.offset[first] - strokes.offset[second], axis=1)
    near = np.flatnonzero(apart <= share * np.minimum(depth[first], depth[second]))
    near = near[np.lexsort((second[near], first[near]))]
    first, second, apart = first[near], second[near], apart[near]
    low, high = strokes.reach.T
    overlap = np.minimum(high[first], high[second]) - np.maximum(low[first], low[second])
    return first, second, apart, overlap
