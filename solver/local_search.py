"""Which of the crossings that fit given depths are best taken: local search on the objective, depths unchanged."""

from dataclasses import dataclass

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.directions import count_of
from linecad.line_graph import LineGraph
from solver.families import Families
from solver.options import SolveOptions

PASSES = 20  # a number, not a time, so that the result does not depend on the machine
LEAST_GAIN = 1e-9  # of the objective, below which a move counts as none


@dataclass(frozen=True, eq=False)
class _Removals:
    """What giving up a whole side of a line touches in family P: T shared neighbours in K combinations (side, pair)."""

    member: Int  # (T,) shared neighbour
    first: Bool  # (T,) whether its edge to the pair's first line is on the side
    second: Bool  # (T,) whether its edge to the pair's second line is
    combination: Int  # (T,)
    side: Int  # (K,)
    pair: Int  # (K,)


class LocalSearch:
    """Crossings taken and given up one by one, or a side of a line at a time, while the objective rises.

    Cycles of family C are kept open. In each pass the gains of all moves are computed at once; those that would gain
    are then tried one after another, the best first, each with its gain at that moment.
    """

    def __init__(self, graph: LineGraph, families: Families, options: SolveOptions) -> None:
        self.weight = graph.weight
        self.mu_planarity, self.mu_boundary = options.mu_planarity, options.boundary_reward
        self.pairs, self.pair, self.along = families.pairs, families.pairs.pair, families.pairs.along
        edges = range(len(graph.edges))
        self.cycles = families.cycles
        self.cycles_of: list[list[int]] = [[] for _ in edges]
        for number, cycle in enumerate(families.cycles):
            for edge in cycle:
                self.cycles_of[edge].append(number)
        # Two sides for each line, the lower axis first, so that the other side of a line is that with the last bit
        # turned over.
        self.sides = [list(members) for line in families.two_sides for members in line.sides]
        sizes = np.array([len(members) for members in self.sides], np.int64)
        self.side_edge = np.array([edge for members in self.sides for edge in members], np.int64)
        self.side = np.repeat(np.arange(len(sizes)), sizes)
        self.sides_of: list[list[int]] = [[] for _ in edges]
        for edge, side in zip(self.side_edge.tolist(), self.side.tolist(), strict=True):
            self.sides_of[edge].append(side)
        # Of each edge: a pair, the plane that needs it and another edge to be both or none, that other edge.
        self.partners_of: list[list[tuple[int, int, int]]] = [[] for _ in edges]
        members = np.column_stack([self.pair, np.where(self.along, 0, 1), self.pairs.first, self.pairs.second])
        for pair, plane, first, second in members.tolist():
            self.partners_of[first].append((pair, plane, second))
            self.partners_of[second].append((pair, plane, first))
        self.removals = self._find_removals(graph, families)

    def run(self, agrees: Bool, real: Bool, begin: Bool) -> Bool:
        """(E,) the edges to connect, among those that agree with the depths; the real ones always.

        The search begins with the edges in `begin`, as far as no cycle closes.
        """
        self.agrees, self.real = (agrees | real).tolist(), real.tolist()
        self._begin(begin, real)
        for _ in range(PASSES):
            gain = 0.0
            gains = self._side_gains()
            for side in _best_first(gains):
                if self.kept[side] and self.kept[side ^ 1]:
                    gain += self._try([edge for edge in self.sides[side] if self.chosen[edge]])
            gains = self._edge_gains()
            for edge in _best_first(gains):
                if self.chosen[edge] or self._may_take(edge):
                    gain += self._try([edge])
            if gain <= LEAST_GAIN:
                break
        return np.array(self.chosen, bool)

    def _begin(self, edges: Bool, real: Bool) -> None:
        """Take the edges, heaviest first, as far as no cycle closes; and what follows from that."""
        chosen = edges | real
        if self.cycles:
            taken = real.tolist()
            self.missing = [sum(not taken[edge] for edge in cycle) for cycle in self.cycles]
            for edge in np.argsort(-self.weight, kind="stable").tolist():
                if not taken[edge] and chosen[edge] and all(self.missing[cycle] > 1 for cycle in self.cycles_of[edge]):
                    taken[edge] = True
                    for cycle in self.cycles_of[edge]:
                        self.missing[cycle] -= 1
            chosen = np.array(taken, bool)
        self.chosen: list[bool] = chosen.tolist()
        kept = np.bincount(self.side, weights=chosen[self.side_edge], minlength=len(self.sides))
        self.kept: list[int] = kept.astype(np.int64).tolist()
        self.conflicts: list[list[int]] = self._count_conflicts(chosen).tolist()

    def _count_conflicts(self, chosen: Bool) -> Int:
        """(P, 2) neighbours that contradict each of the two planes of a pair."""
        count = len(self.pairs)
        one, other = chosen[self.pairs.first], chosen[self.pairs.second]
        both = one & other
        found = [
            np.bincount(self.pair, weights=np.where(self.along == (plane == 0), one != other, both), minlength=count)
            for plane in range(2)
        ]
        return np.column_stack(found).astype(np.int64)

    def _edge_gains(self) -> Float:
        """(E,) the change of the objective if this edge alone changes; of no use for edges that must not change."""
        chosen, kept, conflicts = np.array(self.chosen, bool), np.array(self.kept), np.array(self.conflicts)
        gain = np.where(chosen, -self.weight, self.weight)
        if len(self.sides):
            only = kept[self.side] == chosen[self.side_edge]  # this edge decides whether the side is kept
            decides = only & (kept[self.side ^ 1] > 0)
            change = np.where(chosen[self.side_edge], self.mu_boundary, -self.mu_boundary) * decides
            gain += np.bincount(self.side_edge, weights=change, minlength=len(gain))
        if len(self.pairs):
            one, other = chosen[self.pairs.first], chosen[self.pairs.second]
            members = np.arange(len(self.pair))
            for edge, after in ((self.pairs.first, (~one, other)), (self.pairs.second, (one, ~other))):
                change = self._planar_change(conflicts, members, (one, other), after, members, self.pair)
                gain += np.bincount(edge, weights=change, minlength=len(gain))
        return gain

    def _side_gains(self) -> Float:
        """(S,) the change of the objective if all chosen edges of a side are given up at once."""
        chosen, kept, conflicts = np.array(self.chosen, bool), np.array(self.kept), np.array(self.conflicts)
        if not self.sides:
            return np.zeros(0)
        has = chosen[self.side_edge]
        given = np.where(has, -self.weight[self.side_edge], 0.0)
        other = self.opposite
        frees = has & (other >= 0) & (kept[other] == 1) & (kept[other ^ 1] > 0)  # the line at the edge's other end
        gain = np.bincount(self.side, weights=given + self.mu_boundary * frees, minlength=len(kept))
        both = (kept > 0) & (kept[np.arange(len(kept)) ^ 1] > 0)
        gain += self.mu_boundary * both
        if len(self.pairs):
            out = self.removals
            one, two = chosen[self.pairs.first[out.member]], chosen[self.pairs.second[out.member]]
            after = (one & ~out.first, two & ~out.second)
            change = self._planar_change(conflicts, out.member, (one, two), after, out.combination, out.pair)
            gain += np.bincount(out.side, weights=change, minlength=len(kept))
        return np.where(both, gain, 0.0)

    def _planar_change(
        self, conflicts: Int, member: Int, before: tuple[Bool, Bool], after: tuple[Bool, Bool], group: Int, pair: Int
    ) -> Float:
        """(K,) by how much the reward of `pair` (K,) changes if, in each group, the edges of its members change."""
        unequal = (after[0] != after[1]).astype(np.int64) - (before[0] != before[1])
        both = (after[0] & after[1]).astype(np.int64) - (before[0] & before[1])
        along = self.along[member]
        left = [
            conflicts[pair, plane]
            + np.bincount(group, weights=np.where(along == (plane == 0), unequal, both), minlength=len(pair))
            for plane in range(2)
        ]
        was = (conflicts == 0).any(axis=1)[pair]
        now = (left[0] == 0) | (left[1] == 0)
        change: Float = self.mu_planarity * (now.astype(np.float64) - was)
        return change

    def _find_removals(self, graph: LineGraph, families: Families) -> _Removals:
        """Also sets `opposite`, the side of an edge at its other line, -1 where that line has not two sides."""
        side_at = np.full((len(graph.segments), count_of(graph.turns)), -1, np.int64)  # by the axis of the lines met
        lines = np.array([two.line for two in families.two_sides], np.int64)
        for number in range(2):
            met = np.array([two.sides[number][0] for two in families.two_sides], np.int64)
            axis = graph.axis[graph.edges[met].sum(axis=1) - lines]
            side_at[lines, axis] = 2 * np.arange(len(lines)) + number
        owner = np.repeat(lines, 2)[self.side]
        other = graph.edges[self.side_edge].sum(axis=1) - owner
        self.opposite = side_at[other, graph.axis[owner]]
        pairs = families.pairs
        one, two = pairs.lines[self.pair].T
        between = graph.edges[pairs.first].sum(axis=1) - one
        yes, no = np.ones(len(between), bool), np.zeros(len(between), bool)
        member = np.tile(np.arange(len(between)), 3)
        side = np.concatenate(
            [side_at[one, graph.axis[between]], side_at[two, graph.axis[between]], side_at[between, graph.axis[one]]]
        )
        first, second = np.concatenate([yes, no, yes]), np.concatenate([no, yes, yes])
        use = side >= 0
        key = side[use] * max(1, len(pairs)) + self.pair[member[use]]
        keys, combination = np.unique(key, return_inverse=True)
        return _Removals(
            member=member[use],
            first=first[use],
            second=second[use],
            combination=combination,
            side=keys // max(1, len(pairs)),
            pair=keys % max(1, len(pairs)),
        )

    def _may_take(self, edge: int) -> bool:
        free = self.agrees[edge] and not self.chosen[edge]
        return free and all(self.missing[cycle] > 1 for cycle in self.cycles_of[edge])

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
        change = sign * float(self.weight[edge])
        for cycle in self.cycles_of[edge]:
            self.missing[cycle] -= sign
        kept = self.kept
        for side in self.sides_of[edge]:
            before = kept[side] > 0
            kept[side] += sign
            if kept[side ^ 1]:
                change += self.mu_boundary * (before - (kept[side] > 0))
        for number, along, partner in self.partners_of[edge]:
            conflicts = self.conflicts[number]
            before = 0 in conflicts
            conflicts[along] += -sign if self.chosen[partner] else sign
            conflicts[1 - along] += sign if self.chosen[partner] else 0
            change += self.mu_planarity * ((0 in conflicts) - before)
        return change


def _best_first(gains: Float) -> list[int]:
    """The moves that gain, the best first."""
    good = np.flatnonzero(gains > LEAST_GAIN)
    found: list[int] = good[np.argsort(-gains[good], kind="stable")].tolist()
    return found
