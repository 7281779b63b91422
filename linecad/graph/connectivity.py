"""How a line graph hangs together: groups, components, spanning trees, biconnected blocks."""

import networkx as nx
import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components

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
    """Mask (E,) of the minimum spanning forest of the chosen edges by Kruskal, in order of residual (paper, MST)."""
    net = nx.Graph()
    for edge in np.flatnonzero(chosen):
        net.add_edge(*graph.edges[edge].tolist(), weight=float(residual[edge]), edge=int(edge))
    tree = np.zeros(len(graph.edges), bool)
    for _, _, data in nx.minimum_spanning_edges(net, algorithm="kruskal", data=True):
        tree[data["edge"]] = True
    return tree


def as_network(count: int, edges: Int) -> "nx.Graph[int]":
    """The lines and edges (E, 2) of a graph of `count` lines, for NetworkX."""
    net: nx.Graph[int] = nx.Graph()
    net.add_nodes_from(range(count))
    net.add_edges_from(map(tuple, edges.tolist()))
    return net


def biconnected_blocks(edges: Int) -> list[set[int]]:
    """The sets of three lines or more that edges (E, 2) connect so that no single line parts them."""
    net: nx.Graph[int] = nx.Graph()
    net.add_edges_from(map(tuple, edges.tolist()))
    return [set(block) for block in nx.biconnected_components(net) if len(block) > 2]


def in_no_block(graph: LineGraph, chosen: Bool) -> Bool:
    """Mask (N,) of lines whose place depends on a single crossing: they are in no biconnected block."""
    outside = np.ones(len(graph.segments), bool)
    for block in biconnected_blocks(graph.edges[chosen]):
        outside[list(block)] = False
    return outside
