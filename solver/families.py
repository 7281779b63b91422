"""The sub-graphs that the paper's families of constraints speak about: short cycles, parallel pairs, sides of a line.

Edges and lines are given by their indices in the LineGraph. Collinear edges stand in none of these sub-graphs, since
the families speak about lines of different axes that meet, nor do edges between level lines of two frames: each
sub-graph is one of the lines of a single frame (`LineGraph.home`). All are found by sorting half edges, an edge as seen
from one of its lines, so that graphs of thousands of lines take a fraction of a second.
"""

from collections.abc import Iterator, Set
from dataclasses import dataclass

import numpy as np

from linecad.arrays import Bool, Int
from linecad.directions import UP, partner
from linecad.line_graph import LineGraph
from solver.options import Family


@dataclass(frozen=True)
class SharedNeighbour:
    """A line m that may meet both lines of a parallel pair."""

    axis: int  # of m
    first: int  # edge from the pair's first line to m
    second: int  # edge from the pair's second line to m


@dataclass(frozen=True)
class ParallelPair:
    """Two lines of one axis with at least one neighbour in common, the paper's {l_k, l_l}."""

    lines: tuple[int, int]  # ascending
    axes: tuple[int, int]  # the two other axes, the paper's e and f: the plane runs along the pair and one of these
    shared: tuple[SharedNeighbour, ...]


@dataclass(frozen=True, eq=False)
class ParallelPairs:
    """P parallel pairs with their M shared neighbours, pair by pair; iterating gives each as a ParallelPair."""

    lines: Int  # (P, 2) ascending
    axes: Int  # (P, 2) the two other axes, ascending
    start: Int  # (P + 1,) where the neighbours of each pair begin
    neighbour_axis: Int  # (M,)
    first: Int  # (M,) edge from the pair's first line to the neighbour
    second: Int  # (M,) edge from the pair's second line to the neighbour

    def __len__(self) -> int:
        return len(self.lines)

    def __iter__(self) -> Iterator[ParallelPair]:
        members = np.column_stack([self.neighbour_axis, self.first, self.second]).tolist()
        begins = self.start.tolist()
        for number, (lines, axes) in enumerate(zip(self.lines.tolist(), self.axes.tolist(), strict=True)):
            shared = tuple(SharedNeighbour(*member) for member in members[begins[number] : begins[number + 1]])
            yield ParallelPair((lines[0], lines[1]), (axes[0], axes[1]), shared)

    @property
    def pair(self) -> Int:
        """(M,) the pair of each shared neighbour."""
        return np.repeat(np.arange(len(self)), np.diff(self.start))

    @property
    def along(self) -> Bool:
        """(M,) whether the neighbour runs along the plane of the pair and its first other axis."""
        found: Bool = self.neighbour_axis == self.axes[self.pair, 0]
        return found

    def subset(self, keep: Bool) -> "ParallelPairs":
        """The pairs that a mask (P,) selects."""
        size = np.diff(self.start)
        inside = np.repeat(keep, size)
        return ParallelPairs(
            lines=self.lines[keep],
            axes=self.axes[keep],
            start=np.concatenate([[0], np.cumsum(size[keep])]),
            neighbour_axis=self.neighbour_axis[inside],
            first=self.first[inside],
            second=self.second[inside],
        )


@dataclass(frozen=True)
class TwoSides:
    """A line with crossings of both other axes: a boundary if it keeps one of each."""

    line: int
    sides: tuple[tuple[int, ...], tuple[int, ...]]  # edges to lines of the lower and of the higher other axis


@dataclass(frozen=True)
class Families:
    """Everything that the switched-on families constrain; a family that is off is empty."""

    three_cycles: tuple[tuple[int, ...], ...]  # edges of each xyz cycle
    four_cycles: tuple[tuple[int, ...], ...]  # edges of each xyzy cycle
    pairs: ParallelPairs
    two_sides: tuple[TwoSides, ...]

    @property
    def cycles(self) -> tuple[tuple[int, ...], ...]:
        """All cycles of which at least one edge must be fake."""
        return self.three_cycles + self.four_cycles


def find_families(graph: LineGraph, without: Set[Family]) -> Families:
    """The sub-graphs of the families that are not in `without`, each list in ascending order of lines."""
    cycles = "cycles" not in without
    planarity = "planarity" not in without
    return Families(
        three_cycles=find_three_cycles(graph) if cycles else (),
        four_cycles=find_four_cycles(graph) if cycles else (),
        pairs=find_parallel_pairs(graph) if planarity else _pairs(graph, np.zeros(len(graph.edges), bool)),
        two_sides=find_two_sides(graph) if "boundary" not in without else (),
    )


def find_three_cycles(graph: LineGraph) -> tuple[tuple[int, ...], ...]:
    """Edges (ij, jk, ik) of every cycle of three lines, i < j < k; their axes are x, y and z in some order."""
    neighbours = _neighbours(graph)
    found = []
    for i, near in enumerate(neighbours):
        for j in sorted(near):
            if j > i:
                common = sorted(neighbours[j].keys() & near.keys())
                found += [(near[j], neighbours[j][k], near[k]) for k in common if k > j]
    return tuple(found)


def find_four_cycles(graph: LineGraph) -> tuple[tuple[int, ...], ...]:
    """The four edges, in order around, of every cycle of xyzy type: two lines of one axis, one of each other axis."""
    return tuple((a, b, c, d) for a, b, c, d in four_cycle_table(graph).tolist())


def four_cycle_table(graph: LineGraph) -> Int:
    """(C, 4) the same cycles as an array."""
    pairs = _pairs(graph, (graph.kind != "collinear") & graph.informative & graph.possible)
    along = pairs.along
    order = np.lexsort([~along, pairs.pair])  # in each pair first the neighbours of the lower axis
    lower = np.zeros(len(pairs), np.int64)
    np.add.at(lower, pairs.pair, along)
    higher = np.diff(pairs.start) - lower
    begin = pairs.start[:-1]
    times = np.repeat(higher, lower)  # the cycles that each neighbour of the lower axis stands in
    i = np.repeat(order[along[order]], times)
    k = order[_ranges(np.repeat(begin + lower, lower), times)]
    return np.column_stack([pairs.first[i], pairs.first[k], pairs.second[k], pairs.second[i]])


def find_parallel_pairs(graph: LineGraph) -> ParallelPairs:
    """Every two lines of one axis with a neighbour in common that both of them can meet, in ascending order.

    Without such a neighbour nothing would hold the pair's pi back, and the objective would pay for it.
    """
    pairs = _pairs(graph, graph.kind != "collinear")
    can_meet = graph.possible[pairs.first] & graph.possible[pairs.second]
    keep = np.zeros(len(pairs), bool)
    np.logical_or.at(keep, pairs.pair, can_meet)
    return pairs.subset(keep)


def find_two_sides(graph: LineGraph) -> tuple[TwoSides, ...]:
    """Every line that has crossings with lines of both other axes."""
    line, other, edge = _half_edges(graph, graph.kind != "collinear")
    if len(line) == 0:
        return ()
    group = _group_starts(line, graph.axis[other])
    begins, ends = group.tolist(), [*group[1:].tolist(), len(line)]
    owners, edges = line[group].tolist(), edge.tolist()
    found = []
    for k in range(len(begins) - 1):
        if owners[k] == owners[k + 1]:
            sides = tuple(edges[begins[k] : ends[k]]), tuple(edges[begins[k + 1] : ends[k + 1]])
            found.append(TwoSides(owners[k], sides))
    return tuple(found)


def _half_edges(graph: LineGraph, use: Bool) -> tuple[Int, Int, Int]:
    """(line, other line, edge) of both directions of the edges to use, by line, then axis and number of the other."""
    edge = np.flatnonzero(use & graph.in_one_frame)
    i, j = graph.edges[edge].T
    line, other, edge = np.concatenate([i, j]), np.concatenate([j, i]), np.concatenate([edge, edge])
    order = np.lexsort([other, graph.axis[other], line])
    return line[order], other[order], edge[order]


def _group_starts(*keys: Int) -> Int:
    """Where runs of equal keys begin."""
    change = np.zeros(len(keys[0]), bool)
    change[:1] = True
    for key in keys:
        change[1:] |= key[1:] != key[:-1]
    return np.flatnonzero(change)


def _ranges(begin: Int, count: Int) -> Int:
    """begin, begin + 1, ... begin + count - 1 of each entry, one after another."""
    offset = np.cumsum(count) - count
    found: Int = np.arange(count.sum()) - np.repeat(offset, count) + np.repeat(begin, count)
    return found


def _pairs(graph: LineGraph, use: Bool) -> ParallelPairs:
    """All pairs of lines of one axis with a common neighbour by the edges to use."""
    line, other, edge = _half_edges(graph, use)
    starts = _group_starts(line, graph.axis[other])
    ends = np.append(starts, len(line))[1:]
    after = np.repeat(ends, ends - starts) - np.arange(len(line)) - 1  # entries of the same group behind each
    one = np.repeat(np.arange(len(line)), after)
    two = _ranges(np.arange(len(line)) + 1, after)
    order = np.lexsort([line[one], other[two], other[one]])
    one, two = one[order], two[order]
    start = _group_starts(other[one], other[two])
    lines = np.column_stack([other[one[start]], other[two[start]]])
    return ParallelPairs(
        lines=lines,
        axes=_other_axes(graph.axis[lines[:, 0]], graph.axis[line[one[start]]]),
        start=np.append(start, len(one)),
        neighbour_axis=graph.axis[line[one]],
        first=edge[one],
        second=edge[two],
    )


def _other_axes(axis: Int, neighbour: Int) -> Int:
    """(P, 2) the two other axes, ascending, of the frame that lines of an axis have with neighbours of another (P,)."""
    second = np.where(axis == UP, partner(neighbour), np.where(neighbour == UP, partner(axis), UP))
    return np.sort(np.column_stack([neighbour, second]), axis=1)


def _neighbours(graph: LineGraph) -> list[dict[int, int]]:
    """For each line its neighbours by a crossing that says something, with the edge that leads there."""
    neighbours: list[dict[int, int]] = [{} for _ in range(len(graph.segments))]
    use = (graph.kind != "collinear") & graph.informative & graph.possible & graph.in_one_frame
    for edge in use.nonzero()[0].tolist():
        i, j = graph.edges[edge].tolist()
        neighbours[i][j] = neighbours[j][i] = edge
    return neighbours
