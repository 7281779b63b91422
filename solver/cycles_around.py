"""Cycles as a person sees them, by NetworkX: it takes 0.2 s to load, and only annotations need it."""

import networkx as nx
import numpy as np

from linecad.arrays import Bool
from linecad.line_graph import LineGraph
from solver.cycles import Cycle, is_balanced


def shorter_cycle(graph: LineGraph, real: Bool, cycle: Cycle) -> Cycle:
    """The shortest unbalanced cycle that one edge closes in a tree of shortest paths, or `cycle` if none is shorter."""
    network = nx.Graph()
    for edge in np.flatnonzero(real & graph.informative).tolist():
        network.add_edge(*graph.edges[edge].tolist(), edge=edge)
    for root in sorted(network):
        paths = nx.single_source_shortest_path(network, root, cutoff=(len(cycle) - 1) // 2)
        for i, j, edge in network.subgraph(paths).edges(data="edge"):
            if paths[i][-2:] == [j, i] or paths[j][-2:] == [i, j] or len(paths[i]) + len(paths[j]) - 1 >= len(cycle):
                continue
            if set(paths[i]) & set(paths[j]) == {root}:
                steps = [*zip(paths[i], paths[i][1:], strict=False), *zip(paths[j], paths[j][1:], strict=False)]
                closed = (edge, *(network.edges[step]["edge"] for step in steps))
                if not is_balanced(graph, closed):
                    cycle = closed
    return cycle


def lines_around(graph: LineGraph, cycle: Cycle) -> str:
    """The lines of a cycle in order around, in words."""
    network = nx.Graph([graph.edges[edge].tolist() for edge in cycle])
    lines = [first for first, _ in nx.find_cycle(network, source=min(network))]
    return "lines " + ", ".join(map(str, [*lines, lines[0]]))
