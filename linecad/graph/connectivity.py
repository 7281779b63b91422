"""How a line graph hangs together: groups, components, spanning trees, lines on cycles."""

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import breadth_first_order, connected_components, minimum_spanning_tree

from linecad.arrays import Bool, Float, Int
from linecad.line_graph import LineGraph


def group_numbers(count: int, edges: Int) -> Int:
    """Number (N,) of the group that each of `count` lines is in by edges (E, 2)."""
    links = csr_matrix((np.ones(len(edges)), (edges[:, 0], edges[:, 1])), (count, count))
    return np.asarray(connected_components(links, directed=False)[1], np.int64)


def components(graph: LineGraph, chosen: Bool | None = None) -> list[Int]:
    """Node indices of each connected component, over all edges or the `chosen` ones (E,), the largest first.

    Equal sizes are ordered by their smallest index, so that the order is the same on every run.
    """
    edges = graph.edges if chosen is None else graph.edges[chosen]
    group = group_numbers(len(graph.segments), edges)
    order = np.argsort(group, kind="stable")
    parts = np.split(order, np.flatnonzero(np.diff(group[order])) + 1) if len(order) else []
    return sorted(parts, key=lambda part: (-len(part), int(part[0])))


def spanning_tree(graph: LineGraph, chosen: Bool, residual: Float) -> Bool:
    """Mask (E,) of the minimum spanning forest of the chosen edges, in order of residual (paper, MST).

    Of equal residuals those of the line come first that the chosen edges name first.
    """
    count, edges = len(graph.segments), np.flatnonzero(chosen)
    lines, named = np.unique(graph.edges[edges], return_index=True)
    first_named = np.zeros(count, np.int64)
    first_named[lines] = named
    edges = edges[np.lexsort([first_named[graph.edges[edges]].min(axis=1), residual[edges]])]
    tree = np.zeros(len(graph.edges), bool)
    tree[edges[spanning_forest(count, graph.edges[edges])]] = True
    return tree


def spanning_forest(count: int, edges: Int) -> Int:
    """Which of the edges (E, 2) between `count` lines form the spanning forest that prefers the first ones."""
    rank = np.arange(1, len(edges) + 1)  # instead of weights, since SciPy takes 0 for no edge
    forest = minimum_spanning_tree(csr_matrix((rank, (edges[:, 0], edges[:, 1])), (count, count)))
    return np.asarray(forest.data.astype(np.int64) - 1)


def in_no_block(count: int, edges: Int) -> Bool:
    """Mask (N,) of lines whose place depends on single edges (E, 2): they are in no biconnected block of three lines.

    So no cycle leads through them. Each edge outside a spanning tree closes one; what such cycles went through before
    is passed over in one step.
    """
    parent, depth = _forest(count, edges)
    lead = list(range(count + 1))  # of the lines that cycles join, one that is nearest to the root, or on the way to it

    def led(line: int) -> int:
        while lead[line] != line:
            lead[line] = lead[lead[line]]
            line = lead[line]
        return line

    outside = np.ones(count, bool)
    for first, second in edges.tolist():
        if parent[first] == second or parent[second] == first:
            continue
        outside[[first, second]] = False
        one, other = led(first), led(second)
        while one != other:
            deeper, one = (one, other) if depth[one] > depth[other] else (other, one)
            lead[deeper] = parent[deeper]
            outside[[deeper, parent[deeper]]] = False
            other = led(parent[deeper])
    return outside


def _forest(count: int, edges: Int) -> tuple[list[int], list[int]]:
    """The parents and depths of `count` lines in a spanning forest of edges (E, 2), whose roots are of one line more.

    That line, `count`, is its own parent.
    """
    roots = np.unique(group_numbers(count, edges), return_index=True)[1]
    first, second = np.concatenate([edges, np.column_stack([roots, np.full(len(roots), count)])]).T
    links = csr_matrix((np.ones(len(first)), (first, second)), (count + 1, count + 1))
    order, parent = breadth_first_order(links, count, directed=False)
    parent[count] = count
    parents, depth = parent.tolist(), [0] * (count + 1)
    for line in order[1:].tolist():
        depth[line] = depth[parents[line]] + 1
    return parents, depth
