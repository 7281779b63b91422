"""Annotations of crossings by a person: checked before a search, so that a contradiction has a name."""

from collections.abc import Callable
from typing import NoReturn

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.errors import ContradictionError, SolverError
from linecad.line_graph import LineGraph
from solver.cycles import Cycle, find_contradiction
from solver.depths import near_log_ratio
from solver.families import Families
from solver.options import SolveOptions
from solver.potentials import fit_near_depths


def read_annotations(graph: LineGraph, options: SolveOptions) -> tuple[Bool, Bool]:
    """(E,) crossings annotated as real and as fake; SolverError for one that cannot be."""
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
        _contradict(
            graph, (edge,), f"{_name(graph, edge)} is called real, but these lines cannot meet before the camera"
        )
    return real, fake


def check_annotations(graph: LineGraph, families: Families, options: SolveOptions, real: Bool, ratios: Float) -> None:
    """Raise ContradictionError, naming the shortest one found, unless some answer has all of these crossings real.

    None of the crossings that are named can be left out: without any one of them the others fit depths. They are the
    shortest unbalanced cycle among all cycles that one edge closes in a tree of shortest paths; where only longer
    cycles contradict each other, any of them.
    """
    if not real.any():
        return
    from solver.cycles_around import shorter_cycle

    step, log_range = near_log_ratio(graph, ratios), np.inf
    if options.formulation == "paper":
        log_range = float(np.log(options.depth_range))
    cycles = [set(cycle) for cycle in families.cycles]

    def contradiction_of(edges: Bool) -> Int:
        return fit_near_depths(graph, step, edges, log_range, np.zeros(len(graph.segments))).contradiction

    def fits(edges: Bool) -> bool:
        chosen = set(np.flatnonzero(edges).tolist())
        return len(contradiction_of(edges)) == 0 and not any(cycle <= chosen for cycle in cycles)

    found = [cycle for cycle in families.cycles if real[list(cycle)].all()]
    around, beyond = find_contradiction(graph, real), contradiction_of(real)
    if len(around):
        found.append(shorter_cycle(graph, real, tuple(around.tolist())))
    if len(beyond):
        found.append(tuple(beyond.tolist()))
    if found:
        needed = _needed(graph, min(found, key=len), fits)
        _contradict(graph, needed, _why(graph, needed, options))


def _why(graph: LineGraph, edges: Cycle, options: SolveOptions) -> str:
    """What is wrong with edges that close a cycle, or that lead further than the range of depths."""
    from solver.cycles_around import lines_around

    lines = np.unique(graph.edges[list(edges)]).tolist()
    if len(edges) == len(lines):
        return f"the crossings of {lines_around(graph, edges)} cannot all be real; take one back"
    return (
        f"the crossings that are called real put lines {', '.join(map(str, lines))} further apart than a depth "
        f"range of {options.depth_range:g}; allow a larger one or take one back"
    )


def _needed(graph: LineGraph, edges: Cycle, fits: Callable[[Bool], bool]) -> Cycle:
    """Edges of which none can be left out without what remains fitting depths."""
    kept = np.zeros(len(graph.edges), bool)
    kept[list(edges)] = True
    for edge in edges:
        kept[edge] = False
        kept[edge] = fits(kept)
    return tuple(np.flatnonzero(kept).tolist())


def _contradict(graph: LineGraph, edges: Cycle, text: str) -> NoReturn:
    """Raise the contradiction of these edges."""
    pairs = tuple((i, j) for i, j in graph.edges[list(edges)].tolist())
    raise ContradictionError(text, tuple(sorted({line for pair in pairs for line in pair})), pairs)


def _name(graph: LineGraph, edge: int) -> str:
    i, j = graph.edges[edge].tolist()
    return f"the crossing of lines {i} and {j}"
