"""Which cycles of a line graph are unbalanced, and how to find those that a fractional or integer choice breaks.

An edge (i, j) states t_i - t_j = c within a tolerance, t the log depth of a line. Around a cycle the c, signed by the
direction of travel, would sum to zero; the cycle is *unbalanced* when they miss zero by more than the summed
tolerances, and then not all of its edges can be real.

Unbalanced simple cycles are all that stands between a set of edges and depths that fit it. The set has depths unless
its difference constraints, two arcs to an edge with widths tolerance + c and tolerance - c, contain a negative directed
cycle; a simple one of two arcs runs forth and back over one edge and has width 2 tolerance >= 0, and every other
simple directed cycle is a cycle of edges, of width (summed tolerances) +- (summed c). So the rows

    sum of b over the edges of a cycle <= length - 1        for every unbalanced simple cycle

describe exactly the choices that have depths.
"""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components, dijkstra, minimum_spanning_tree

from linecad.arrays import Bool, Float, Int
from linecad.line_graph import LineGraph
from solver.families import find_three_cycles, four_cycle_table
from solver.potentials import SLACK, fit_near_depths

LEAST_VIOLATION = 1e-3  # by which a fractional choice must break a cycle's row
SHORTEST_STEP = 1e-7  # added to every distance, since SciPy takes an edge of length zero for none
ROOT_BATCH = 4_000_000  # numbers in one table of (roots, edges)

Cycle = tuple[int, ...]  # edges, ascending


@dataclass(frozen=True, eq=False)
class Network:
    """The edges of a line graph that tell about depth and can be real: those that stand in cycles."""

    lines: int
    edge: Int  # (M,) index in the line graph
    head: Int  # (M,) i of each edge
    tail: Int  # (M,) j
    ratio: Float  # (M,) c
    width: Float  # (M,) tolerance with the slack that the re-check of depths allows


def build_network(graph: LineGraph, barred: Bool) -> Network:
    """The network of a line graph without the edges in `barred` (E,), which are annotated as fake."""
    edge = np.flatnonzero(graph.possible & graph.informative & ~barred)
    head, tail = graph.edges[edge].T
    return Network(len(graph.segments), edge, head, tail, graph.log_ratio[edge], graph.tolerance[edge] + SLACK)


def find_short_cycles(graph: LineGraph) -> list[Cycle]:
    """Every unbalanced xyz 3-cycle and xyzy 4-cycle of crossings; an xyxy cycle is always balanced.

    All four crossings of an xyxy cycle speak about one coordinate; the c are differences of log|d_i| there and cancel.
    """
    found: list[Cycle] = []
    for table in (np.array(find_three_cycles(graph), np.int64).reshape(-1, 3), four_cycle_table(graph)):
        off, width = _around(graph, table)
        found += [tuple(cycle) for cycle in np.sort(table[np.abs(off) > width], axis=1).tolist()]
    return found


def _around(graph: LineGraph, cycles: Int) -> tuple[Float, Float]:
    """The signed sum of c and the summed tolerance of cycles of one length, each in order around."""
    pairs = graph.edges[cycles]
    first, last = pairs[:, 0], pairs[:, -1]
    at = np.where((first[:, :1] == last).any(axis=1), first[:, 0], first[:, 1])
    off = np.zeros(len(cycles))
    for step in range(cycles.shape[1]):
        forward = pairs[:, step, 0] == at
        off += np.where(forward, 1, -1) * graph.log_ratio[cycles[:, step]]
        at = np.where(forward, pairs[:, step, 1], pairs[:, step, 0])
    return off, (graph.tolerance[cycles] + SLACK).sum(axis=1)


def is_balanced(graph: LineGraph, cycle: Cycle) -> bool:
    """Whether all edges of a simple cycle, in any order, can be real at once."""
    rest, around = list(cycle[1:]), [cycle[0]]
    at = int(graph.edges[cycle[0], 1])
    while rest:
        step = next(edge for edge in rest if at in graph.edges[edge])
        rest.remove(step)
        around.append(step)
        i, j = graph.edges[step].tolist()
        at = j if at == i else i
    off, width = _around(graph, np.array([around]))
    return bool(abs(off[0]) <= width[0])


def find_contradiction(graph: LineGraph, connected: Bool) -> Int:
    """Edges of an unbalanced cycle among the connected ones, ascending; empty where depths fit them all."""
    guess = np.zeros(len(graph.segments))
    return fit_near_depths(graph, graph.log_ratio, connected, np.inf, guess).contradiction


@dataclass(frozen=True, eq=False)
class _Trees:
    """Shortest-path trees of R roots, with what adds up along the way from the root."""

    before: Int  # (R, N) the node before, or the node itself at a root and where no path leads
    step: Int  # (R, N) the network edge that leads there, -1 at a root
    distance: Float  # (R, N) infinite where no path leads
    depth: Float  # (R, N) log depth over that of the root
    width: Float  # (R, N) tolerances along the path


class Separator:
    """Finds cycles whose rows a choice breaks; keeps what does not depend on the choice."""

    def __init__(self, network: Network) -> None:
        self.network = network
        lookup = np.stack([np.minimum(network.head, network.tail), np.maximum(network.head, network.tail)])
        self.key = lookup[0] * network.lines + lookup[1]
        self.order = np.argsort(self.key)

    def along_forest(self, value: Float, most: int) -> list[Cycle]:
        """At most `most` broken cycles of one edge and a heaviest spanning forest; `value` (E,) of the line graph."""
        net = self.network
        if len(net.edge) == 0:
            return []
        x = value[net.edge]
        length = 1 - x + SHORTEST_STEP
        full = csr_array((1 + length, (net.head, net.tail)), shape=(net.lines, net.lines))
        forest = minimum_spanning_tree(full).tocoo()
        tree = csr_array((forest.data - 1, (forest.row, forest.col)), shape=full.shape)
        _, component = connected_components(tree, directed=False)
        _, roots = np.unique(component, return_index=True)
        trees = self._trees(tree, roots, np.inf, one_forest=True)
        off = np.abs(trees.depth[0, net.head] - trees.depth[0, net.tail] - net.ratio)
        suspects = np.flatnonzero((off > net.width) & (x > LEAST_VIOLATION))
        found = []
        for edge in suspects[np.argsort(-x[suspects], kind="stable")].tolist():
            cycle, missing = self._walk(trees, 0, edge, x)
            if missing < 1 - LEAST_VIOLATION and off[edge] > net.width[cycle].sum():
                found.append((missing, cycle))
        return self._best(found, most)

    def along_paths(self, value: Float, roots: Int, most: int) -> list[Cycle]:
        """At most `most` broken cycles through one of the `roots`, by shortest paths in the distance 1 - value."""
        net = self.network
        if len(net.edge) == 0:
            return []
        x = value[net.edge]
        use = x > LEAST_VIOLATION
        length = 1 - x[use] + SHORTEST_STEP
        matrix = csr_array((length, (net.head[use], net.tail[use])), shape=(net.lines, net.lines))
        found = []
        batch = max(1, ROOT_BATCH // len(net.edge))
        for start in range(0, len(roots), batch):
            trees = self._trees(matrix, roots[start : start + batch], 1.0)
            i, j = net.head, net.tail
            missing = trees.distance[:, i] + trees.distance[:, j] + (1 - x)
            with np.errstate(invalid="ignore"):
                off = np.abs(trees.depth[:, i] - trees.depth[:, j] - net.ratio)
            off -= trees.width[:, i] + trees.width[:, j] + net.width
            missing = np.where(off > 0, missing, np.inf)
            best = np.argmin(missing, axis=0)
            for edge in np.flatnonzero(missing.min(axis=0) < 1 - LEAST_VIOLATION).tolist():
                cycle, short = self._walk(trees, int(best[edge]), edge, x)
                found.append((short, cycle))
        return self._best(found, most)

    def _trees(self, matrix: csr_array, roots: Int, limit: float, one_forest: bool = False) -> _Trees:
        """One tree for each root, or the forest in which each node hangs on its nearest root as R = 1."""
        net = self.network
        found = dijkstra(
            matrix, directed=False, indices=roots, return_predecessors=True, limit=limit, min_only=one_forest
        )
        distance, before = np.atleast_2d(found[0]), np.atleast_2d(found[1])
        node = np.broadcast_to(np.arange(net.lines), before.shape)
        moved = before >= 0
        before = np.where(moved, before, node)
        key = np.minimum(before, node) * net.lines + np.maximum(before, node)
        at = np.minimum(np.searchsorted(self.key, key, sorter=self.order), len(self.order) - 1)
        step = np.where(moved, self.order[at], -1)
        forward = net.head[step] == before  # t_node = t_before - c
        depth = np.where(moved, np.where(forward, -1, 1) * net.ratio[step], 0.0)
        width = np.where(moved, net.width[step], 0.0)
        jump = before
        while True:  # each round doubles the length of the path that is summed up
            further = np.take_along_axis(jump, jump, axis=1)
            if (further == jump).all():
                return _Trees(before, step, distance, depth, width)
            depth = depth + np.take_along_axis(depth, jump, axis=1)
            width = width + np.take_along_axis(width, jump, axis=1)
            jump = further

    def _walk(self, trees: _Trees, root: int, edge: int, x: Float) -> tuple[list[int], float]:
        """The simple cycle that an edge closes in a tree, as network edges, and how much its values miss."""
        before, step = trees.before[root], trees.step[root]
        paths = []
        for node in (int(self.network.head[edge]), int(self.network.tail[edge])):
            path = []
            while step[node] >= 0:
                path.append(int(step[node]))
                node = int(before[node])
            paths.append(path)
        one, other = paths
        while one and other and one[-1] == other[-1]:
            one.pop()
            other.pop()
        cycle = [edge, *one, *other]
        return cycle, float((1 - x[cycle]).sum())

    def _best(self, found: list[tuple[float, list[int]]], most: int) -> list[Cycle]:
        """The most broken cycles, each once, as edges of the line graph."""
        found.sort(key=lambda entry: (entry[0], len(entry[1]), entry[1]))
        cycles: dict[Cycle, None] = {}
        for _, cycle in found:
            cycles[tuple(sorted(self.network.edge[cycle].tolist()))] = None
            if len(cycles) >= most:
                break
        return list(cycles)
