"""Rigid bodies as biconnected blocks: lines that no single line parts from each other.

A vertical edge of a near wall hides the courses of a farther one, and every one of these crossings agrees with the edge
lying in the far wall: thirty agree with each other, and all of them are on one line. So what counts is how many
lines join two bodies, not how many crossings. A true corner of two walls is one block when two courses or more meet
across it. A pair of collinear pieces, one in each of two larger blocks, makes them one body: no occlusion makes such a
pair.
"""

import networkx as nx
import numpy as np

from linecad.arrays import Bool, Int
from linecad.decide.bodies import Bodies, with_hanging
from linecad.line_graph import LineGraph

LEAST_BODY = 4  # lines
LEAST_JOINED = 6  # lines of a block that a collinear pair may join to another one


def find_blocks(graph: LineGraph, chosen: Bool) -> Bodies:
    """Part the lines of a graph into biconnected blocks of the `chosen` crossings (E,) that tell about depth.

    Lines of no block go with the body that most of their group's crossings lead to, if the group is small.
    """
    used = chosen & graph.informative
    edges = graph.edges[used]
    blocks = [block for block in biconnected_blocks(edges) if len(block) >= LEAST_BODY]
    blocks.sort(key=lambda block: (-len(block), min(block)))
    blocks = _joined_by_pieces(blocks, graph.edges[used & (graph.kind == "collinear")])
    count = len(graph.segments)
    net, corners = _as_network(count, edges), _as_network(count, graph.edges[used & (graph.kind == "L")])
    body = np.full(count, -1)
    for line in range(count):
        own = [number for number, block in enumerate(blocks) if line in block]
        if own:  # a line may be in several: it belongs to the block that ends where it ends, an edge to its own wall
            corner, near = set(corners[line]), set(net[line])
            body[line] = max(own, key=lambda k: (len(corner & blocks[k]), len(near & blocks[k]), -k))
    return Bodies(with_hanging(body, len(blocks), edges), len(blocks), body >= 0)


def _joined_by_pieces(blocks: list[set[int]], pieces: Int) -> list[set[int]]:
    """The blocks, those of LEAST_JOINED lines joined where the two lines of a collinear pair (P, 2) are in two."""
    net: nx.Graph[int] = nx.Graph()
    net.add_nodes_from(range(len(blocks)))
    large = [block if len(block) >= LEAST_JOINED else set() for block in blocks]
    for first, second in pieces.tolist():
        of_first = [number for number, block in enumerate(large) if first in block]
        of_second = [number for number, block in enumerate(large) if second in block]
        net.add_edges_from((one, other) for one in of_first for other in of_second)
    joined = [set().union(*(blocks[number] for number in group)) for group in nx.connected_components(net)]
    return sorted(joined, key=lambda block: (-len(block), min(block)))


def _as_network(count: int, edges: Int) -> "nx.Graph[int]":
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
