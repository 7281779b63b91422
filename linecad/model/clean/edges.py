"""Edges of faces and openings, the lines that lie on them, and ends of lines drawn on to the corners of edges."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.geometry import ring_sides
from linecad.model.clean.strokes import Strokes, pairs_within

ON_EDGE = 0.003  # of the depth, between a line and an edge that it is
LEAST_SHARE = 0.5  # of a line that must lie on edges
LEAST_SEEN = 0.5  # of a line that is drawn on to a corner, which it must have been before


@dataclass(frozen=True, eq=False)
class Edges:
    """E edges along axes."""

    axis: Int  # (E,) that they run along
    offset: Float  # (E, 3) their coordinates, 0 along their axis
    reach: Float  # (E, 2) ascending

    @classmethod
    def between(cls, starts: Float, ends: Float) -> "Edges":
        """Those of the edges from points (E, 3) to points (E, 3) that run along an axis, to the last digit."""
        along = starts != ends
        straight = along.sum(axis=1) == 1
        starts, ends, axis = starts[straight], ends[straight], along[straight].argmax(axis=1)
        rows = np.arange(len(axis))
        offset = starts.copy()
        offset[rows, axis] = 0.0
        return cls(axis, offset, np.sort(np.column_stack([starts[rows, axis], ends[rows, axis]]), axis=1))

    @classmethod
    def joined(cls, parts: "Sequence[Edges]") -> "Edges":
        """All edges of several sets."""
        return cls(*(np.concatenate([getattr(part, name) for part in parts]) for name in ("axis", "offset", "reach")))


def ring_edges(rings: list[Float]) -> Edges:
    """The edges of rings (V, 3) that run along axes."""
    sides = ring_sides(rings)
    return Edges.between(sides[:, 0], sides[:, 1])


def sides_of(openings: Float) -> Edges:
    """The four sides of each rectangle (W, 6)."""
    corners = np.zeros((len(openings), 4, 3))
    normal = openings[:, 0].astype(np.int64)
    for axis in range(3):
        own = normal == axis
        u, v = (each for each in range(3) if each != axis)
        corners[own, :, axis] = openings[own, 1, None]
        corners[own, :, u] = openings[own][:, [2, 3, 3, 2]]
        corners[own, :, v] = openings[own][:, [4, 4, 5, 5]]
    return Edges.between(corners.reshape(-1, 3), np.roll(corners, -1, axis=1).reshape(-1, 3))


def lie_on(strokes: Strokes, edges: Edges) -> Bool:
    """Which strokes (N,) lie on edges for LEAST_SHARE of their length."""
    line, edge = _on(strokes, edges)
    low = np.maximum(strokes.reach[line, 0], edges.reach[edge, 0])
    high = np.minimum(strokes.reach[line, 1], edges.reach[edge, 1])
    common = high > low
    covered = _covered(line[common], low[common], high[common], len(strokes.axis))
    length = np.ptp(strokes.reach, axis=1)
    lies: Bool = (covered >= LEAST_SHARE * length) & (length > 0)
    return lies


def drawn_to_corners(strokes: Strokes, edges: Edges, free: Bool) -> Strokes:
    """The strokes with `free` ends (N, 2) at the end of the edge that they lie on, if it is not too far."""
    line, edge = _on(strokes, edges)
    reach = strokes.reach.copy()
    for end, outwards in ((0, -1.0), (1, 1.0)):
        at, corner = strokes.reach[line, end], edges.reach[edge, end]
        lies = free[line, end] & (edges.reach[edge, 0] <= at) & (at <= edges.reach[edge, 1])
        further = np.full(len(reach), np.inf)
        np.minimum.at(further, line[lies], outwards * (corner - at)[lies])
        most = (1 / LEAST_SEEN - 1) * np.ptp(strokes.reach, axis=1)
        goes = further <= most
        reach[goes, end] += outwards * further[goes]
    return replace(strokes, reach=reach)


def _on(strokes: Strokes, edges: Edges) -> tuple[Int, Int]:
    """Pairs of a stroke and an edge on whose line it lies."""
    lines, others = [np.zeros(0, np.int64)], [np.zeros(0, np.int64)]
    for axis in range(3):
        own, there = np.flatnonzero(strokes.axis == axis), np.flatnonzero(edges.axis == axis)
        across = [each for each in range(3) if each != axis]
        near = ON_EDGE * np.abs(strokes.depth[own])
        line, edge = pairs_within(strokes.offset[own][:, across], edges.offset[there][:, across], near)
        lines.append(own[line])
        others.append(there[edge])
    line, edge = np.concatenate(lines), np.concatenate(others)
    off = np.abs(strokes.offset[line] - edges.offset[edge]).max(axis=1)
    on = off <= ON_EDGE * np.abs(strokes.depth[line])
    return line[on], edge[on]


def _covered(line: Int, low: Float, high: Float, count: int) -> Float:
    """How much of each of `count` lines the stretches (K,) from `low` to `high` cover together."""
    if len(line) == 0:
        return np.zeros(count)
    span = 2 * float(high.max() - low.min()) + 1.0
    # Each line has a range of its own, so that what was covered of one does not count for the next.
    order = np.lexsort((low, line))
    line, low, high = (
        line[order],
        low[order] - low.min() + span * line[order],
        high[order] - low.min() + span * line[order],
    )
    before = np.r_[-np.inf, np.maximum.accumulate(high)[:-1]]
    covered = np.zeros(count)
    np.add.at(covered, line, np.maximum(high - np.maximum(low, before), 0))
    return covered
