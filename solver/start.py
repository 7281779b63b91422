"""A good feasible choice in a fraction of a second: depths by greedy union, then crossings by local search.

The exact solver starts from it and can only improve on it.
"""

import numpy as np

from linecad.scene import Bool, Float, LineGraph
from solver.choice import Choice, boundaries, planar_pairs
from solver.depths import near_log_ratio
from solver.families import Families
from solver.potentials import fit_near_depths
from solver.problem import SolveOptions

SAFETY = 1e-9  # log depth, kept from every limit so that rounding cannot push the start over it
CERTAIN = 1e6  # evidence of a crossing that a person called real
PASSES = 20  # of the local search; a number, not a time, so that the result does not depend on the machine
LEAST_GAIN = 1e-9  # of the objective, below which a move counts as none


def find_start(
    graph: LineGraph,
    families: Families,
    options: SolveOptions,
    ratios: Float,
    evidence: Float | None = None,
    real: Bool | None = None,
    fake: Bool | None = None,
) -> Choice:
    """A choice that satisfies every constraint of the model; `ratios` as `solver.depths.end_ratios` returns them.

    `evidence` (E,), the weights if None, says how much each crossing is believed when the depths are laid out.
    `real` and `fake` (E,) are a person's word; the real ones must not contradict each other (`solver.facts`).
    """
    none = np.zeros(len(graph.edges), bool)
    real, fake = none if real is None else real, none if fake is None else fake
    step = near_log_ratio(graph, ratios)
    log_range = float(np.log(options.depth_range)) if options.formulation == "paper" else np.inf
    evidence = np.where(real, CERTAIN, np.where(fake, 0.0, graph.weight if evidence is None else evidence))
    near = _greedy_near_depths(graph, step, log_range, evidence)
    _settle(near, graph, step, log_range, evidence)
    if real.any():
        near = fit_near_depths(graph, step, real, log_range, near).near
    i, j = graph.edges.T
    off = np.abs(near[i] - near[j] - step)
    agrees = ~fake & graph.possible & (~graph.informative | (off <= graph.tolerance - SAFETY))
    search = _Search(graph, families, options, agrees, real)
    search.run()
    connected = np.array(search.chosen, bool)
    return Choice(
        connected=connected,
        is_boundary=boundaries(graph, connected),
        planar_pairs=planar_pairs(families, connected),
        log_depth=near - np.log(ratios.min(axis=1)),
    )


def _greedy_near_depths(graph: LineGraph, step: Float, log_range: float, evidence: Float) -> Float:
    """(N,) log depth of each near end, from 0 to `log_range`: a union-find with potentials, best evidence first.

    An edge between two groups of lines ties them together unless the group would then be deeper than the range; an edge
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

    The union takes the first edge's word for a line; this takes the majority's.
    """
    edges = np.flatnonzero(graph.possible & graph.informative)
    i, j = graph.edges[edges].T
    line, other = np.concatenate([i, j]), np.concatenate([j, i])
    to_line = np.concatenate([step[edges], -step[edges]])
    order = np.argsort(line, kind="stable")
    starts = np.searchsorted(line[order], np.arange(len(near) + 1))
    nearest = SAFETY if np.isfinite(log_range) else -np.inf
    for _ in range(PASSES):
        moved = False
        for k in range(len(near)):
            own = order[starts[k] : starts[k + 1]]
            places = near[other[own]] + to_line[own]
            allowed = (places >= nearest) & (places <= log_range - SAFETY)
            candidates = np.append(near[k], places[allowed])
            agree = np.abs(places - candidates[:, None]) <= graph.tolerance[edges[own % len(edges)]] - SAFETY
            votes = agree @ evidence[edges[own % len(edges)]]
            best = int(np.argmax(votes))
            if votes[best] > votes[0] + LEAST_GAIN:
                near[k] = candidates[best]
                moved = True
        if not moved:
            return


class _Search:
    """Crossings taken and given up one by one, or a side of a line at a time, while the objective rises.

    Only edges that agree with the greedy depths are ever taken, so every state fits the depths; cycles are kept open.
    """

    def __init__(self, graph: LineGraph, families: Families, options: SolveOptions, agrees: Bool, real: Bool) -> None:
        edges = range(len(graph.edges))
        self.weight: list[float] = graph.weight.tolist()
        self.agrees = agrees.tolist()
        self.real = real.tolist()
        self.mu_planarity, self.mu_boundary = options.mu_planarity, options.mu_boundary
        self.families = families
        self.chosen = [False for _ in edges]
        self.missing = [len(cycle) for cycle in families.cycles]  # edges of each cycle that are not chosen
        self.cycles_of: list[list[int]] = [[] for _ in edges]
        for number, cycle in enumerate(families.cycles):
            for edge in cycle:
                self.cycles_of[edge].append(number)
        self.kept = [[0, 0] for _ in families.two_sides]  # chosen edges on either side of a line
        self.sides_of: list[list[tuple[int, int]]] = [[] for _ in edges]
        for number, line in enumerate(families.two_sides):
            for side, members in enumerate(line.sides):
                for edge in members:
                    self.sides_of[edge].append((number, side))
        self.conflicts = [[0, 0] for _ in families.pairs]  # neighbours that contradict each of the two planes
        self.partners_of: list[list[tuple[int, int, int]]] = [[] for _ in edges]  # pair, plane along m, other edge of m
        for number, pair in enumerate(families.pairs):
            for m in pair.shared:
                along = pair.axes.index(m.axis)
                self.partners_of[m.first].append((number, along, m.second))
                self.partners_of[m.second].append((number, along, m.first))

    def run(self) -> None:
        for edge in range(len(self.chosen)):
            if self.real[edge]:
                self._toggle(edge)
        by_weight = sorted(range(len(self.chosen)), key=lambda edge: (-self.weight[edge], edge))
        for edge in by_weight:
            if self._may_take(edge):
                self._toggle(edge)
        for _ in range(PASSES):
            gain = sum(self._give_up_a_side(number) for number in range(len(self.kept)))
            gain += sum(self._try([edge]) for edge in by_weight if self.chosen[edge] or self._may_take(edge))
            if gain <= LEAST_GAIN:
                break

    def _may_take(self, edge: int) -> bool:
        free = self.agrees[edge] and not self.chosen[edge]
        return free and all(self.missing[cycle] > 1 for cycle in self.cycles_of[edge])

    def _give_up_a_side(self, number: int) -> float:
        gain = 0.0
        for side in self.families.two_sides[number].sides:
            if all(self.kept[number]):
                gain += self._try([edge for edge in side if self.chosen[edge]])
        return gain

    def _try(self, edges: list[int]) -> float:
        """Toggle `edges`; take it back unless the objective rises. Returns by how much it rose."""
        if any(self.real[edge] for edge in edges):
            return 0.0
        gain = sum(self._toggle(edge) for edge in edges)
        if gain > LEAST_GAIN:
            return gain
        for edge in reversed(edges):
            self._toggle(edge)
        return 0.0

    def _toggle(self, edge: int) -> float:
        """Take or give up one edge; returns the change of the objective."""
        sign = -1 if self.chosen[edge] else 1
        self.chosen[edge] = not self.chosen[edge]
        change: float = sign * self.weight[edge]
        for cycle in self.cycles_of[edge]:
            self.missing[cycle] -= sign
        for number, side in self.sides_of[edge]:
            kept = self.kept[number]
            before = all(kept)
            kept[side] += sign
            change += self.mu_boundary * (before - all(kept))
        for number, along, partner in self.partners_of[edge]:
            conflicts = self.conflicts[number]
            before = 0 in conflicts
            conflicts[along] += -sign if self.chosen[partner] else sign
            conflicts[1 - along] += sign if self.chosen[partner] else 0
            change += self.mu_planarity * ((0 in conflicts) - before)
        return change
