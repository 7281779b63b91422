"""A good feasible choice in a fraction of a second: depths by greedy union or robust fit, then local search.

The exact solver starts from it and can only improve on it.
"""

import time

import numpy as np

from linecad.arrays import Bool, Float
from linecad.line_graph import LineGraph
from solver.choice import Choice, boundaries, objective_of, planar_pairs
from solver.depths import near_log_ratio
from solver.families import Families
from solver.local_search import LEAST_GAIN, PASSES, LocalSearch
from solver.options import SolveOptions
from solver.potentials import fit_near_depths
from solver.robust import RobustFit

SAFETY = 1e-9  # log depth, kept from every limit so that rounding cannot push the start over it
HALF = 0.5  # of a crossing in a relaxation, from which a choice begins with it
MOST_REPAIRS = 60  # rounds in which edges of contradicting cycles are given up
CERTAIN = 1e6  # evidence of a crossing annotated as real


class Starter:
    """Makes choices that satisfy every constraint of the model; keeps what one call can use of another."""

    def __init__(
        self, graph: LineGraph, families: Families, options: SolveOptions, ratios: Float, real: Bool, fake: Bool
    ) -> None:
        """`ratios` as `solver.depths.end_ratios` returns them.

        `real` and `fake` (E,) are annotations; the real ones must not contradict each other (`solver.annotations`).
        """
        self.graph, self.families = graph, families
        self.real, self.fake = real, fake
        self.step = near_log_ratio(graph, ratios)
        self.to_middle = np.log(ratios.min(axis=1))
        self.log_range = float(np.log(options.depth_range)) if options.formulation == "paper" else np.inf
        self.options = options
        self.search = LocalSearch(graph, families, options)

    def find(self) -> Choice:
        """A choice made from the weights alone.

        With formulation gain the better of two: depths from one crossing at a time, and from all at once.
        """
        graph, real, fake = self.graph, self.real, self.fake
        evidence = np.where(real, CERTAIN, np.where(fake, 0.0, graph.weight))
        near = _greedy_near_depths(graph, self.step, self.log_range, evidence)
        best = self._best_for(self._majority(near, evidence), None)
        if np.isfinite(self.log_range):
            return best
        fitted = self._best_for(self._majority(RobustFit(graph).depths(evidence) + self.to_middle, evidence), None)
        value, other = (objective_of(graph, self.options, choice) for choice in (best, fitted))
        return fitted if other > value else best

    def round(self, value: Float, until: float) -> Choice | None:
        """A choice near the values (E,) of a relaxation, or None if it is not ready at `until` (`time.monotonic()`).

        The edges above one half, less the weakest of each cycle that contradicts itself, fix the depths; where too
        many do, as in graphs of thousands of lines, the majority of each line's edges.
        """
        graph, real = self.graph, self.real
        value = np.where(real, CERTAIN, np.where(self.fake | ~graph.possible, 0.0, value))
        near = _greedy_near_depths(graph, self.step, self.log_range, value)
        likely = value > HALF
        for _ in range(MOST_REPAIRS):
            if time.monotonic() >= until:
                return None
            fit = fit_near_depths(graph, self.step, likely, self.log_range, near, slack=-2 * SAFETY)
            if not fit.contradictions:
                return self._best_for(fit.near, likely)
            for cycle in fit.contradictions:
                likely[cycle[np.argmin(value[cycle])]] = False
        return self._best_for(self._majority(near, value), likely)

    def _majority(self, near: Float, evidence: Float) -> Float:
        """(N,) depths at which the most evidence agrees, moved as far as the real crossings ask."""
        _settle(near, self.graph, self.step, self.log_range, evidence)
        if not self.real.any():
            return near
        return fit_near_depths(self.graph, self.step, self.real, self.log_range, near).near

    def _best_for(self, near: Float, likely: Bool | None) -> Choice:
        graph = self.graph
        i, j = graph.edges.T
        off = np.abs(near[i] - near[j] - self.step)
        agrees = ~self.fake & graph.possible & (~graph.informative | (off <= graph.tolerance - SAFETY))
        connected = self.search.run(agrees, self.real, agrees if likely is None else agrees & likely)
        return Choice(
            connected=connected,
            is_boundary=boundaries(graph, connected),
            planar_pairs=planar_pairs(self.families, connected),
            log_depth=near - self.to_middle,
        )


def _greedy_near_depths(graph: LineGraph, step: Float, log_range: float, evidence: Float) -> Float:
    """(N,) log depth of each near end, from 0 to `log_range`: a union-find with potentials, best evidence first.

    An edge between two groups of lines joins them unless the group would then be deeper than the range; an edge
    within a group decides nothing any more.
    """
    near = np.zeros(len(graph.segments))
    group = list(range(len(near)))
    members = [[line] for line in group]
    usable = graph.possible & graph.informative
    for edge in np.argsort(-evidence, kind="stable").tolist():
        i, j = graph.edges[edge].tolist()
        a, b = group[i], group[j]
        if not usable[edge] or a == b:
            continue
        shift = near[i] - step[edge] - near[j]  # of j's group, to meet i's
        if len(members[a]) < len(members[b]):
            a, b, shift = b, a, -shift
        moved = near[members[b]] + shift
        together = np.concatenate([near[members[a]], moved])
        if np.ptp(together) > log_range - 2 * SAFETY:
            continue
        near[members[b]] = moved
        for line in members[b]:
            group[line] = a
        members[a] += members[b]
        members[b] = []
    for lines in members:
        if lines:
            near[lines] += SAFETY - near[lines].min()
    return near


def _settle(near: Float, graph: LineGraph, step: Float, log_range: float, evidence: Float) -> None:
    """Move one line at a time to the depth, in `near`, at which the most evidence agrees, until none moves.

    The union takes the first edge's word for a line; this takes the majority's. A line is asked again only after a
    neighbour of it has moved.
    """
    edges = np.flatnonzero(graph.possible & graph.informative)
    i, j = graph.edges[edges].T
    line, other, edge = np.concatenate([i, j]), np.concatenate([j, i]), np.concatenate([edges, edges])
    order = np.argsort(line, kind="stable")
    starts = np.searchsorted(line[order], np.arange(len(near) + 1)).tolist()
    to_line = np.concatenate([step[edges], -step[edges]])[order]
    other, tolerance, belief = other[order], graph.tolerance[edge[order]] - SAFETY, evidence[edge[order]]
    nearest = SAFETY if np.isfinite(log_range) else -np.inf
    asked = set(range(len(near)))
    for _ in range(PASSES):
        turn, asked = sorted(asked), set()
        for k in turn:
            own = slice(starts[k], starts[k + 1])
            places = near[other[own]] + to_line[own]
            allowed = places[(places >= nearest) & (places <= log_range - SAFETY)]
            if len(allowed) == 0:
                continue
            candidates = np.append(near[k], allowed)
            votes = (np.abs(places - candidates[:, None]) <= tolerance[own]) @ belief[own]
            best = int(np.argmax(votes))
            if votes[best] > votes[0] + LEAST_GAIN:
                near[k] = candidates[best]
                asked.update(other[own].tolist())
        if not asked:
            return
