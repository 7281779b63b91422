"""The sub-graphs that the paper's families of constraints speak about: short cycles, parallel pairs, sides of a line.

Edges and lines are given by their indices in the LineGraph. Collinear edges stand in none of these sub-graphs, since
the families speak about lines of different axes that meet.
"""

from collections.abc import Set
from dataclasses import dataclass
from itertools import combinations, product

from linecad.scene import LineGraph
from solver.problem import Family


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
    pairs: tuple[ParallelPair, ...]
    two_sides: tuple[TwoSides, ...]

    @property
    def cycles(self) -> tuple[tuple[int, ...], ...]:
        """All cycles of which at least one edge must be fake."""
        return self.three_cycles + self.four_cycles


def find_families(graph: LineGraph, without: Set[Family]) -> Families:
    """The sub-graphs of the families that are not in `without`, each list in ascending order of lines."""
    cycles = "cycles" not in without
    return Families(
        three_cycles=find_three_cycles(graph) if cycles else (),
        four_cycles=find_four_cycles(graph) if cycles else (),
        pairs=find_parallel_pairs(graph) if "planarity" not in without else (),
        two_sides=find_two_sides(graph) if "boundary" not in without else (),
    )


def find_three_cycles(graph: LineGraph) -> tuple[tuple[int, ...], ...]:
    """Edges (ij, jk, ik) of every cycle of three lines, i < j < k; their axes are x, y and z in some order."""
    neighbours = _neighbours(graph, only_informative=True)
    found = []
    for i, near in enumerate(neighbours):
        for j in sorted(near):
            if j > i:
                common = sorted(neighbours[j].keys() & near.keys())
                found += [(near[j], neighbours[j][k], near[k]) for k in common if k > j]
    return tuple(found)


def find_four_cycles(graph: LineGraph) -> tuple[tuple[int, ...], ...]:
    """The four edges, in order around, of every cycle of xyzy type: two lines of one axis, one of each other axis."""
    neighbours = _neighbours(graph, only_informative=True)
    axis = graph.axis.tolist()
    found = []
    for first, second in _parallel_with_common_neighbour(axis, neighbours):
        near, far = neighbours[first], neighbours[second]
        common = sorted(near.keys() & far.keys())
        lower, higher = ([m for m in common if axis[m] == a] for a in _other_axes(axis[first]))
        found += [(near[i], near[k], far[k], far[i]) for i, k in product(lower, higher)]
    return tuple(found)


def find_parallel_pairs(graph: LineGraph) -> tuple[ParallelPair, ...]:
    """Every two lines of one axis with a neighbour in common that both of them can meet.

    Without such a neighbour nothing would hold the pair's pi back, and the objective would pay for it.
    """
    neighbours = _neighbours(graph)
    axis = graph.axis.tolist()
    possible = graph.possible.tolist()
    found = []
    for first, second in _parallel_with_common_neighbour(axis, neighbours):
        near, far = neighbours[first], neighbours[second]
        shared = tuple(SharedNeighbour(axis[m], near[m], far[m]) for m in sorted(near.keys() & far.keys()))
        if any(possible[m.first] and possible[m.second] for m in shared):
            found.append(ParallelPair((first, second), _other_axes(axis[first]), shared))
    return tuple(found)


def find_two_sides(graph: LineGraph) -> tuple[TwoSides, ...]:
    """Every line that has crossings with lines of both other axes."""
    axis = graph.axis.tolist()
    found = []
    for i, near in enumerate(_neighbours(graph)):
        lower, higher = (tuple(near[m] for m in sorted(near) if axis[m] == a) for a in _other_axes(axis[i]))
        if lower and higher:
            found.append(TwoSides(i, (lower, higher)))
    return tuple(found)


def _other_axes(axis: int) -> tuple[int, int]:
    lower, higher = (a for a in range(3) if a != axis)
    return lower, higher


def _neighbours(graph: LineGraph, only_informative: bool = False) -> list[dict[int, int]]:
    """For each line its neighbours by crossing, with the edge that leads there."""
    neighbours: list[dict[int, int]] = [{} for _ in range(len(graph.segments))]
    use = graph.kind != "collinear"
    if only_informative:
        use = use & graph.informative & graph.possible
    for edge in use.nonzero()[0].tolist():
        i, j = graph.edges[edge].tolist()
        neighbours[i][j] = neighbours[j][i] = edge
    return neighbours


def _parallel_with_common_neighbour(axis: list[int], neighbours: list[dict[int, int]]) -> list[tuple[int, int]]:
    """All pairs of lines of one axis with a common neighbour, the smaller line first, in ascending order."""
    pairs = set()
    for near in neighbours:
        pairs |= {pair for pair in combinations(sorted(near), 2) if axis[pair[0]] == axis[pair[1]]}
    return sorted(pairs)
