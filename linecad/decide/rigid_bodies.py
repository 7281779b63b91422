"""Which lines of a solved graph hold each other: bodies that no few lines part, and hinges that nothing supports.

A vertical edge of a near wall hides the courses of a farther one, and every one of these crossings agrees with the edge
lying in the far wall: thirty agree with each other, and hang on one line. So lines are counted as witnesses, not
crossings. A *body* is a set of lines that no WITNESSES - 1 lines part from each other in the graph of the chosen
crossings: from each line of it, WITNESSES paths without a common line lead to each other (a k-block: Carmesin, Diestel,
Hundertmark and Stein 2014). A true corner of two walls is one body when enough courses meet across it; a hidden wall
hangs on the few edges that hide it. A *hinge* is what joins two bodies by fewer lines. It is supported by a pair of
collinear pieces, one in each body: no occlusion makes such a pair.
"""

from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass

import networkx as nx
import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.decide.disjoint import disjoint_paths
from linecad.line_graph import LineGraph

WITNESSES = 3  # lines without which a body stays whole, and one more
LEAST_BODY = 4  # lines
LEAST_SUPPORTED = 6  # lines of a body that a collinear pair may tie to another one
HANGING = 4  # lines of a group that may hang on a body by less: too few to carry a false wall
SEED_CANDIDATES = 40  # lines near the first one of a body among which the next ones are looked for

Graph = dict[int, set[int]]


@dataclass(frozen=True, eq=False)
class Held:
    """What holds the lines of a solved graph."""

    body: Int  # (N,) the body that a line belongs to, the largest first; those after the last hold nothing together
    bodies: int  # how many of them are bodies; the rest are groups that hang on bodies too loosely, and single lines
    within: Bool  # (N,) the line is in a body itself, not in a small group that hangs on it

    def joins(self, graph: LineGraph) -> Bool:
        """Mask (E,) of the crossings of two lines that are held together."""
        first, second = graph.edges.T
        together: Bool = self.body[first] == self.body[second]
        return together


def agreeing(graph: LineGraph, chosen: Bool, log_depth: Float) -> Bool:
    """Mask (E,) of the chosen crossings and of those others that agree with the depths (N,) which these give.

    A line gives up the crossings of one direction rather than become a boundary (family B), so the courses that meet
    at a true corner are often not chosen; they are witnesses of the corner all the same.
    """
    group = np.empty(len(graph.segments), np.int64)
    net = _adjacency(range(len(graph.segments)), graph.edges[chosen & graph.informative])
    for number, part in enumerate(_components(net, list(net))):
        group[list(part)] = number
    first, second = graph.edges.T
    apart = graph.misfit(log_depth)
    agrees: Bool = graph.informative & (group[first] == group[second]) & (apart <= graph.tolerance)
    return chosen | agrees


def find_held(graph: LineGraph, chosen: Bool, witnesses: int = WITNESSES) -> Held:
    """Part the lines of a graph into bodies, as the `chosen` crossings (E,) that say something about depth hold them.

    Lines of no body go with the body that most of their group's crossings lead to, if the group is small. A component
    without a body stays together: no hinge is in question there.
    """
    used = chosen & graph.informative
    net = _adjacency(range(len(graph.segments)), graph.edges[used])
    pieces = graph.edges[used & (graph.kind == "collinear")]
    cores = _joined_by_pieces(find_bodies(net, witnesses), pieces)
    count = len(graph.segments)
    corners = _adjacency(range(count), graph.edges[used & (graph.kind == "L")])
    body = np.full(count, -1)
    for line in range(count):
        own = [number for number, core in enumerate(cores) if line in core]
        if own:  # a hinge line is in several: it belongs to the body that ends where it ends, an edge to its own wall
            body[line] = max(
                own, key=lambda number: (len(corners[line] & cores[number]), len(net[line] & cores[number]), -number)
            )
    within = body >= 0
    others = len(cores)
    for group in _components(net, np.flatnonzero(~within).tolist()):
        touched = [int(body[other]) for line in group for other in net[line] if within[other]]
        if touched and len(group) <= HANGING:
            body[list(group)] = max(set(touched), key=lambda number: (touched.count(number), -number))
        else:
            body[list(group)] = others
            others += 1
    return Held(body, len(cores), within)


def tied(held: Held, pairs: Int) -> Held:
    """The same with bodies made one where a pair of lines (P, 2) is known to meet; the largest first again."""
    if len(pairs) == 0:
        return held
    net = _adjacency(range(int(held.body.max()) + 1), held.body[pairs])
    groups = _components(net, list(net))
    size = [int(np.isin(held.body, list(group)).sum()) for group in groups]
    # Groups that hold a body come before those that only hang together.
    order = sorted(range(len(groups)), key=lambda k: (min(groups[k]) >= held.bodies, -size[k], min(groups[k])))
    new = np.empty(len(net), np.int64)
    for number, k in enumerate(order):
        new[list(groups[k])] = number
    bodies = sum(min(group) < held.bodies for group in groups)
    return Held(new[held.body], bodies, held.within)


def find_bodies(net: Graph, witnesses: int) -> list[set[int]]:
    """The bodies of a graph, the largest first; two may share fewer than `witnesses` lines."""
    found: list[set[int]] = []
    for block in _blocks(net):
        found += _bodies_of(_part(net, block), block, witnesses)
    return sorted(found, key=lambda body: (-len(body), min(body)))


def _bodies_of(net: Graph, lines: set[int], witnesses: int) -> list[set[int]]:
    """The bodies in a graph that hold at least one of `lines`.

    What a body leaves over is searched piece by piece: from a piece, the body looks like its lines that touch the
    piece, all joined to each other.
    """
    net = _core(net, witnesses)
    free = lines & net.keys()
    for first in sorted(free, key=lambda line: (-len(net[line]), line)):
        body = _grown(net, _seed(net, first, witnesses), witnesses)
        if len(body) < LEAST_BODY:
            continue
        found = [body]
        for piece in _components(net, [line for line in net if line not in body]):
            shore = set().union(*(net[line] for line in piece)) & body
            rest = {line: net[line] & (piece | shore) for line in piece | shore}
            for line in shore:
                rest[line] |= shore - {line}
            found += _bodies_of(rest, free & piece, witnesses)
        return found
    return []


def _seed(net: Graph, first: int, witnesses: int) -> set[int]:
    """`witnesses` lines about the first that none fewer part from each other, or none."""
    seed = [first]
    for line in _nearest(net, first):
        if all(disjoint_paths(net, line, {other}, witnesses, joint=True) >= witnesses for other in seed):
            seed.append(line)
            if len(seed) == witnesses:
                return set(seed)
    return set()


def _grown(net: Graph, seed: set[int], witnesses: int) -> set[int]:
    """The seed and all lines with so many paths to it: by the fan lemma, no fewer part them from any line of it."""
    body = set(seed)
    waiting = deque(line for first in sorted(seed)[:1] for line in _nearest(net, first, len(net)))
    tried = 0
    while waiting and tried < len(waiting):
        line = waiting.popleft()
        if line in body:
            continue
        if disjoint_paths(net, line, body, witnesses) >= witnesses:
            body.add(line)
            tried = 0
        else:
            waiting.append(line)
            tried += 1
    return body if seed else set()


def _nearest(net: Graph, first: int, count: int = SEED_CANDIDATES) -> list[int]:
    """The lines nearest to one, by crossings between."""
    reached, order = {first}, [first]
    for line in order:
        if len(order) > count:
            break
        for other in sorted(net[line] - reached):
            reached.add(other)
            order.append(other)
    return order[1 : count + 1]


def _joined_by_pieces(bodies: list[set[int]], pieces: Int) -> list[set[int]]:
    """The bodies, those of LEAST_SUPPORTED lines joined where the two lines of a collinear pair are in two of them."""
    net = nx.Graph()
    net.add_nodes_from(range(len(bodies)))
    large = [body if len(body) >= LEAST_SUPPORTED else set() for body in bodies]
    for first, second in pieces.tolist():
        of_first = [number for number, body in enumerate(large) if first in body]
        of_second = [number for number, body in enumerate(large) if second in body]
        net.add_edges_from((one, other) for one in of_first for other in of_second)
    joined = [set().union(*(bodies[number] for number in group)) for group in nx.connected_components(net)]
    return sorted(joined, key=lambda body: (-len(body), min(body)))


def _adjacency(lines: Iterable[int], edges: Int) -> Graph:
    net: Graph = {line: set() for line in lines}
    for first, second in edges.tolist():
        net[first].add(second)
        net[second].add(first)
    return net


def _part(net: Graph, lines: set[int]) -> Graph:
    return {line: net[line] & lines for line in lines}


def _core(net: Graph, least: int) -> Graph:
    """What is left when lines of fewer than `least` neighbours are taken away, again and again."""
    core = nx.k_core(_network(net), least)
    return {line: set(core[line]) for line in core}


def _blocks(net: Graph) -> list[set[int]]:
    """Biconnected blocks: what the articulation lines part."""
    return sorted((set(block) for block in nx.biconnected_components(_network(net)) if len(block) > 2), key=min)


def _components(net: Graph, lines: list[int]) -> list[set[int]]:
    return sorted((set(part) for part in nx.connected_components(_network(_part(net, set(lines))))), key=min)


def _network(net: Graph) -> "nx.Graph[int]":
    found: nx.Graph[int] = nx.Graph()
    found.add_nodes_from(net)
    found.add_edges_from((line, other) for line, others in net.items() for other in others if line < other)
    return found
