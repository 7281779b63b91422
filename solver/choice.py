"""A choice of real crossings with what belongs to it, its value, and the re-check that no solver is excused from."""

from dataclasses import dataclass
from typing import NoReturn

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.directions import count_of
from linecad.errors import SolverError
from linecad.line_graph import LineGraph
from solver.depths import end_ratios
from solver.families import Families
from solver.options import SolveOptions

MEASURES = (1.0, 0.5, 0.25, 0.1, 0.05, 0.02, 0.01)  # of weights and rewards
MEASURE_ROUNDING = 1e-9  # relative to the measure, of a weight
BOUND_ROUNDING = 0.01  # relative to the measure, what the arithmetic of a solver may take from its bound
RECHECK_TOLERANCE = 1e-6  # log depth, what rounding may add to an edge's own tolerance


@dataclass(frozen=True, eq=False)
class Choice:
    """One point of the search space for a line graph of N lines and E edges."""

    connected: Bool  # (E,)
    is_boundary: Bool  # (N,)
    planar_pairs: Int  # (P, 3) two parallel lines and the other axis of their plane, ascending
    log_depth: Float  # (N,) of each segment's middle


def boundaries(graph: LineGraph, connected: Bool) -> Bool:
    """(N,) the lines that meet lines of both other axes of their frame.

    The smallest B that (19) allows for these crossings.
    """
    i, j = graph.edges[connected & (graph.kind != "collinear") & graph.in_one_frame].T
    met = np.zeros((len(graph.segments), count_of(graph.turns)), bool)
    met[i, graph.axis[j]] = True
    met[j, graph.axis[i]] = True
    found: Bool = met.sum(axis=1) == 2
    return found


def planar_pairs(families: Families, connected: Bool) -> Int:
    """(P, 3) every pair that fits one of its planes, (12) to (17), with the first of the two that it fits."""
    pairs = families.pairs
    if len(pairs) == 0:
        return np.zeros((0, 3), np.int64)
    unequal = connected[pairs.first] != connected[pairs.second]
    both = connected[pairs.first] & connected[pairs.second]
    along, start = pairs.along, pairs.start[:-1]
    fits = [~np.logical_or.reduceat(np.where(along == (plane == 0), unequal, both), start) for plane in range(2)]
    rows = np.column_stack([pairs.lines, np.where(fits[0], pairs.axes[:, 0], pairs.axes[:, 1])])
    return rows[fits[0] | fits[1]]


def objective_of(graph: LineGraph, options: SolveOptions, choice: Choice) -> float:
    """The paper's objective (21), without the terms of the families that are off."""
    value = float(graph.weight[choice.connected].sum())
    if "planarity" not in options.without:
        value += options.mu_planarity * len(choice.planar_pairs)
    if "boundary" not in options.without:
        value += options.boundary_reward * int((~choice.is_boundary).sum())
    return value


def trivial_bound(graph: LineGraph, families: Families, options: SolveOptions) -> float:
    """A value that no choice exceeds: every possible crossing real, every pair planar, no line a boundary."""
    bound = float(graph.weight[graph.possible].sum()) + options.mu_planarity * len(families.pairs)
    if "boundary" not in options.without:
        bound += options.boundary_reward * len(graph.segments)
    return bound


def common_measure(graph: LineGraph, options: SolveOptions) -> float:
    """The largest of a few round numbers that all weights and rewards are multiples of, or 0.

    Then every objective is a multiple of it, and nothing lies between two of them.
    """
    terms = np.concatenate([graph.weight, [options.mu_planarity, options.boundary_reward]])
    for measure in MEASURES:
        if np.abs(terms / measure - np.rint(terms / measure)).max() < MEASURE_ROUNDING:
            return measure
    return 0.0


def round_down(bound: float, measure: float) -> float:
    """The largest objective that a bound allows, with room for what a solver's arithmetic may have taken from it."""
    return float(np.floor(bound / measure + BOUND_ROUNDING) * measure) if measure else bound


def recheck(graph: LineGraph, families: Families, options: SolveOptions, choice: Choice) -> None:
    """Raise SolverError unless the choice keeps every promise of the model: depths, cycles, planes, boundaries.

    Works from the graph and the choice alone, without the solver's model, so that a fault in the model or in its
    numbers cannot pass as an answer.
    """
    connected = choice.connected
    if (connected & ~graph.possible).any():
        _fail(f"connects edge {int(np.argmax(connected & ~graph.possible))}, whose lines cannot meet")
    against = [edge for edge in options.real if not connected[edge]] + [
        edge for edge in options.fake if connected[edge]
    ]
    if against:
        _fail(f"goes against the annotation of edge {against[0]}")
    off = graph.misfit(choice.log_depth) - graph.tolerance
    off = np.where(connected & graph.informative, off, -np.inf)
    if (off > RECHECK_TOLERANCE).any():
        _fail(f"leaves edge {int(np.argmax(off))} outside its tolerance by {off.max():.3g} in log depth")
    if options.formulation == "paper":
        near = choice.log_depth + np.log(end_ratios(graph).min(axis=1))
        if len(near) and not (
            near.min() >= -RECHECK_TOLERANCE and near.max() <= np.log(options.depth_range) + RECHECK_TOLERANCE
        ):
            _fail(f"puts line ends outside the depths 1 to {options.depth_range:g}")
    for cycle in families.cycles:
        if connected[list(cycle)].all():
            _fail(f"connects all edges {cycle} of a cycle that must keep one open")
    if "boundary" not in options.without and (boundaries(graph, connected) & ~choice.is_boundary).any():
        _fail("does not mark a line as boundary that meets lines of both other axes")
    _recheck_planes(families, choice)


def _recheck_planes(families: Families, choice: Choice) -> None:
    pairs = families.pairs
    known = {(first, second): k for k, (first, second) in enumerate(pairs.lines.tolist())}
    axes = pairs.axes.tolist()
    plane = np.full(len(pairs), -1)
    for first, second, axis in choice.planar_pairs.tolist():
        k = known.pop((first, second), None)
        if k is None or axis not in axes[k]:
            _fail(f"names lines {first} and {second} as a planar pair, which they cannot be or are already")
        plane[k] = axis
    both = choice.connected[pairs.first].astype(int) + choice.connected[pairs.second]
    of = plane[pairs.pair]
    broken = np.flatnonzero((of >= 0) & (both == np.where(pairs.neighbour_axis == of, 1, 2)))
    if len(broken):
        m = int(broken[0])
        first, second = pairs.lines[pairs.pair[m]].tolist()
        _fail(f"breaks the plane of lines {first} and {second} at edges {pairs.first[m]} and {pairs.second[m]}")


def _fail(what: str) -> NoReturn:
    raise SolverError(f"the solver's answer {what}; this is a fault of linecad, please report it with the photo")
