"""The cells that the lines of a plane cut out of it, and unions of cells as polygons whose corners are of the lines.

In a Manhattan plane all lines run along its two directions u and v, so that their coordinates make a grid. Nothing is
computed that would have to be rounded: a corner of a union of cells is a coordinate of a line along v and one of a
line along u, the same numbers that the other planes of these lines have.
"""

from dataclasses import dataclass

import numpy as np
import shapely

from linecad.arrays import Bool, Float, Int


@dataclass(frozen=True, eq=False)
class Edges:
    """Lines of a plane that run along one of its directions."""

    at: Float  # (M,) their coordinate in the other direction
    ends: Float  # (M, 2) from and to in their own direction, ascending
    reach: Float  # (M,) across, by how much another line may differ that the photo does not tell apart
    end_reach: Float  # (M, 2) the same for each end, along
    goes_on: Bool  # (M,) the upper end is where the photo ends, so the line goes on


@dataclass(frozen=True, eq=False)
class Cells:
    """U x V cells between the coordinates of lines."""

    u: Float  # (U + 1,) ascending
    v: Float  # (V + 1,) ascending
    walls: tuple[Bool, Bool, Bool, Bool]  # each (U, V): a line is somewhere below in u, above in u, below in v, above
    framed: Bool  # (U, V) on both sides in u is a line along v that goes on above the photo

    @property
    def shape(self) -> tuple[int, int]:
        """Number of cells in u and v."""
        return len(self.u) - 1, len(self.v) - 1

    def find(self, points: Float) -> Int:
        """Flat index (M,) of the cell of each point (M, 2), -1 outside."""
        i = np.searchsorted(self.u, points[:, 0]) - 1
        j = np.searchsorted(self.v, points[:, 1]) - 1
        inside = (i >= 0) & (j >= 0) & (i < self.shape[0]) & (j < self.shape[1])
        found: Int = np.where(inside, i * self.shape[1] + j, -1)
        return found


def build_cells(along_u: Edges, along_v: Edges, preferred: tuple[Float, Float]) -> Cells | None:
    """The grid of lines along u and along v; None where they have no area.

    Coordinates that the photo does not tell apart become the one that is `preferred` (in u, in v), else the first.
    """
    u, at_u, from_to_u = _coordinates(along_v, along_u, preferred[0])
    v, at_v, from_to_v = _coordinates(along_u, along_v, preferred[1])
    if len(u) < 2 or len(v) < 2:
        return None
    lines_u, lines_v = np.zeros((len(u) - 1, len(v)), bool), np.zeros((len(u), len(v) - 1), bool)
    for at, (start, end) in zip(at_v.tolist(), from_to_u.tolist(), strict=True):
        lines_u[start:end, at] = True
    going_on = np.zeros_like(lines_v)
    for at, (start, end), goes_on in zip(at_u.tolist(), from_to_v.tolist(), along_v.goes_on.tolist(), strict=True):
        lines_v[at, start:end] = True
        going_on[at, start:end] |= goes_on
    below_v, above_v = (side.T for side in _beside(lines_u.T))
    framed = np.logical_and(*_beside(going_on))
    return Cells(u, v, (*_beside(lines_v), below_v, above_v), framed)


def _beside(lines: Bool) -> tuple[Bool, Bool]:
    """For the cells (C, V) between lines (C + 1, V): whether any line comes before, and whether any after."""
    return np.maximum.accumulate(lines)[:-1], np.maximum.accumulate(lines[::-1])[::-1][1:]


def _coordinates(across: Edges, along: Edges, preferred: Float) -> tuple[Float, Int, Int]:
    """Coordinates (C,) in one direction, the index of each line across (M,), and of the ends of those along (L, 2)."""
    merged = _merge(across.at, across.reach, preferred)
    lines = np.unique(merged)
    ends = along.ends.ravel()
    if len(lines):
        nearest = lines[np.abs(lines[:, None] - ends[None]).argmin(axis=0)]
        ends = np.where(np.abs(nearest - ends) <= along.end_reach.ravel(), nearest, ends)
    free = ~np.isin(ends, lines)
    ends[free] = _merge(ends[free], along.end_reach.ravel()[free], preferred)
    coordinates = np.unique(np.r_[lines, ends])
    return coordinates, np.searchsorted(coordinates, merged), np.searchsorted(coordinates, ends.reshape(-1, 2))


def _merge(values: Float, reach: Float, preferred: Float) -> Float:
    """Each value (M,) as the one that stands for all within reach of the smallest of its group."""
    order = np.argsort(values, kind="stable")
    merged = values.copy()
    group: list[int] = []
    for index in [*order.tolist(), -1]:
        if group and (index < 0 or values[index] - values[group[0]] > min(reach[index], reach[group[0]])):
            if len(group) > 1:
                own = values[group]
                known = own[np.isin(own, preferred)]
                merged[group] = known[0] if len(known) else own[len(own) // 2]
            group = []
        group.append(index)
    return merged


def without_slivers(kept: Bool, free: Bool, width: Float, height: Float, least: float) -> Bool:
    """Cells (U, V) with free gaps narrower than `least` filled and strips narrower than `least` left out.

    `width` and `height` (U, V) are the sizes of the cells along u and v in px, `least` too.
    """
    for size, turned in ((width, False), (height, True)):
        kept = _runs(kept, free, size, least, True, turned)
    for size, turned in ((width, False), (height, True)):
        kept = _runs(kept, np.ones_like(kept), size, least, False, turned)
    return kept


def _runs(kept: Bool, allowed: Bool, size: Float, least: float, fill: bool, turned: bool) -> Bool:
    """Narrow runs of one direction turned over: gaps between cells where `fill`, else strips."""
    cells, may, sizes = (kept.T, allowed.T, size.T) if turned else (kept, allowed, size)
    result = cells.copy()
    own = np.pad((cells != fill) & cells.any(axis=0), ((1, 1), (0, 0)))
    columns, changes = np.nonzero((own[1:] != own[:-1]).T)
    for column, (start, end) in zip(columns[::2].tolist(), changes.reshape(-1, 2).tolist(), strict=True):
        inner = start > 0 and end < len(cells)
        if (inner or not fill) and sizes[start:end, column].sum() < least and may[start:end, column].all():
            result[start:end, column] = fill
    return result.T if turned else result


def _without_touching_corners(kept: Bool) -> Bool:
    """The cells less one of each two that meet in a corner only, the one of fewer neighbours."""
    kept = kept.copy()
    while True:
        a, b, c, d = kept[:-1, :-1], kept[1:, :-1], kept[:-1, 1:], kept[1:, 1:]
        corners = np.argwhere((a & d & ~b & ~c) | (b & c & ~a & ~d))
        if len(corners) == 0:
            return kept
        i, j = corners[0]
        pair = [(i, j), (i + 1, j + 1)] if kept[i, j] else [(i + 1, j), (i, j + 1)]
        padded = np.pad(kept, 1)
        around = [padded[u : u + 3, v : v + 3].sum() for u, v in pair]
        kept[pair[int(np.argmin(around))]] = False


def outlines(kept: Bool) -> list[shapely.Polygon]:
    """The union of the kept cells (U, V): polygons with holes whose corners are whole numbers of coordinates.

    No ring touches itself or another one of the same polygon: where two kept cells meet in a corner only, one of them
    is left out, since a mesh would have to have one corner twice.
    """
    i, j = np.nonzero(_without_touching_corners(kept))
    union = shapely.coverage_union_all(shapely.box(i, j, i + 1, j + 1))
    parts = shapely.get_parts(shapely.simplify(union, 0.0))
    return sorted(parts, key=lambda part: part.bounds)
