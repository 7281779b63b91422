"""What a person said about crossings: checked before a search, so that a contradiction has a name."""

import networkx as nx
import numpy as np

from linecad.errors import SolverError
from linecad.scene import Bool, Float, LineGraph
from solver.cycles import Cycle, find_contradiction, is_balanced
from solver.depths import near_log_ratio
from solver.families import Families
from solver.potentials import fit_near_depths
from solver.problem import SolveOptions


def read_facts(graph: LineGraph, options: SolveOptions) -> tuple[Bool, Bool]:
    """(E,) crossings that are real and that are fake by a person's word; SolverError for one that cannot be."""
    flags = []
    for name, edges in (("real", options.real), ("fake", options.fake)):
        beyond = [edge for edge in edges if not 0 <= edge < len(graph.edges)]
        if beyond:
            raise SolverError(f"crossing {beyond[0]} is called {name}, but the graph has {len(graph.edges)} crossings")
        flag = np.zeros(len(graph.edges), bool)
        flag[list(edges)] = True
        flags.append(flag)
    real, fake = flags
    for edge in np.flatnonzero(real & fake).tolist():
        raise SolverError(f"{_name(graph, edge)} is called both real and fake; take one of the two back")
    for edge in np.flatnonzero(real & ~graph.possible).tolist():
        raise SolverError(f"{_name(graph, edge)} is called real, but these lines cannot meet before the camera")
    return real, fake


def check_facts(graph: LineGraph, families: Families, options: SolveOptions, real: Bool, ratios: Float) -> None:
    """Raise SolverError, naming the shortest contradiction found, unless some answer has all of these crossings real.

    The shortest unbalanced cycle among all cycles that one edge closes in a tree of shortest paths; where only longer
    cycles contradict each other, any of them.
    """
    if not real.any():
        return
    closed = [cycle for cycle in families.cycles if real[list(cycle)].all()]
    contradiction = find_contradiction(graph, real)
    found = [*closed, tuple(contradiction.tolist())] if len(contradiction) else [*closed]
    if len(contradiction):
        found += _unbalanced_cycles(graph, real)
    if found:
        raise SolverError(f"the crossings of {_around(graph, min(found, key=len))} cannot all be real; take one back")
    if options.formulation == "paper":
        step, log_range = near_log_ratio(graph, ratios), float(np.log(options.depth_range))
        fit = fit_near_depths(graph, step, real, log_range, np.zeros(len(graph.segments)))
        if len(fit.contradiction):
            lines = np.unique(graph.edges[fit.contradiction]).tolist()
            raise SolverError(
                f"the crossings that are called real put lines {', '.join(map(str, lines))} further apart than a depth "
                f"range of {options.depth_range:g}; allow a larger one or take one back"
            )


def _unbalanced_cycles(graph: LineGraph, real: Bool) -> list[Cycle]:
    network = nx.Graph()
    for edge in np.flatnonzero(real & graph.informative).tolist():
        network.add_edge(*graph.edges[edge].tolist(), edge=edge)
    found = []
    for root in sorted(network):
        paths = nx.single_source_shortest_path(network, root)
        for i, j, edge in network.edges(data="edge"):
            if i not in paths or paths[i][-2:] == [j, i] or paths[j][-2:] == [i, j]:
                continue
            if set(paths[i]) & set(paths[j]) == {root}:
                steps = [*zip(paths[i], paths[i][1:], strict=False), *zip(paths[j], paths[j][1:], strict=False)]
                cycle = (edge, *(network.edges[step]["edge"] for step in steps))
                if not is_balanced(graph, cycle):
                    found.append(cycle)
    return found


def _around(graph: LineGraph, cycle: Cycle) -> str:
    """The lines of a cycle in order around, in words."""
    network = nx.Graph([graph.edges[edge].tolist() for edge in cycle])
    lines = [first for first, _ in nx.find_cycle(network, source=min(network))]
    return "lines " + ", ".join(map(str, [*lines, lines[0]]))


def _name(graph: LineGraph, edge: int) -> str:
    i, j = graph.edges[edge].tolist()
    return f"the crossing of lines {i} and {j}"
