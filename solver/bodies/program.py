"""The scene program for SCIP: a Boolean for each tie, scales that are as the ties that count ask."""

from dataclasses import dataclass
from itertools import combinations, product

import numpy as np
from pyscipopt import Model, Variable, quicksum
from pyscipopt.scip import PY_SCIP_PARAMSETTING as SCIP_PARAMSETTING

from linecad.arrays import Float
from solver.bodies.ties import Ties

FARTHEST = 1.5  # log scale of any body from the reference's: beyond a factor of 4.5 nothing is looked for
SAFETY = 1e-9  # log ratio within which sums of tolerances are taken for equal


@dataclass(frozen=True, eq=False)
class Program:
    """A model with its variables."""

    model: Model
    scale: list[Variable]  # (B,) log scales
    tie: list[Variable]  # (T,) whether each counts

    def log_scale(self) -> Float:
        """(B,) of the best solution."""
        return np.array([self.model.getVal(variable) for variable in self.scale])

    def offer(self, ties: Ties, log_scale: Float) -> None:
        """Give SCIP a solution to begin with."""
        solution = self.model.createSol()
        for variable, value in zip(self.scale, log_scale.tolist(), strict=True):
            self.model.setSolVal(solution, variable, value)
        for variable, counts in zip(self.tie, ties.counted(log_scale).tolist(), strict=True):
            self.model.setSolVal(solution, variable, float(counts))
        self.model.addSol(solution)


def build(ties: Ties, count: int, reference: int) -> Program:
    """The program for ties between `count` bodies; the scale of the reference is 0.

    Rows beside those that tie Booleans to scales: of two ties of one pair whose intervals do not meet at most one
    counts, and so of three that cannot close around a triangle; ties of a group are given to one of their two bodies
    each, and a body takes one (`solver.bodies.ties`).
    """
    model = Model()
    model.hideOutput()
    # Branching is three times faster than cuts on these small programs. The local search is nearly always right before,
    # so that SCIP's own search for solutions and restarts take 40 % of the time for nothing.
    model.setParam("separating/maxroundsroot", 0)
    model.setHeuristics(SCIP_PARAMSETTING.OFF)
    model.setParam("estimation/restarts/restartpolicy", "n")
    scale = [model.addVar(lb=-FARTHEST, ub=FARTHEST, name=f"s{body}") for body in range(count)]
    tie = [model.addVar(vtype="B", obj=weight, name=f"y{number}") for number, weight in enumerate(ties.weight.tolist())]
    model.setMaximize()
    model.addCons(scale[reference] == 0)
    for variable, (first, second), ratio, tolerance in zip(
        tie, ties.bodies.tolist(), ties.log_ratio.tolist(), ties.tolerance.tolist(), strict=True
    ):
        apart = scale[first] - scale[second]
        for sign in (1.0, -1.0):
            limit = sign * ratio + tolerance
            model.addCons(sign * apart <= limit + (2 * FARTHEST - limit) * (1 - variable))
    _add_groups(model, ties, tie)
    pairs = _by_pair(ties)
    for own in pairs.values():
        for (one, low, high), (other, other_low, other_high) in combinations(own, 2):
            if low > other_high + SAFETY or other_low > high + SAFETY:
                model.addCons(tie[one] + tie[other] <= 1)
    for (a, b), (c, d) in combinations(sorted(pairs), 2):
        if a == c and (b, d) in pairs:  # both pairs are of body a, so the third side of the triangle is b, d
            _add_triangles(model, tie, pairs[a, b], pairs[b, d], pairs[a, d])
    return Program(model, scale, tie)


Interval = tuple[int, float, float]  # a tie, and the least and largest log ratio of the smaller body to the larger


def _by_pair(ties: Ties) -> dict[tuple[int, int], list[Interval]]:
    """The intervals of each pair of bodies, the smaller body's scale over the larger's."""
    pairs: dict[tuple[int, int], list[Interval]] = {}
    for number, (first, second) in enumerate(ties.bodies.tolist()):
        ratio = float(ties.log_ratio[number]) * (1 if first < second else -1)
        tolerance = float(ties.tolerance[number])
        pair = (min(first, second), max(first, second))
        pairs.setdefault(pair, []).append((number, ratio - tolerance, ratio + tolerance))
    return pairs


def _add_triangles(
    model: Model, tie: list[Variable], near: list[Interval], far: list[Interval], across: list[Interval]
) -> None:
    """Of three ties a-b, b-d and a-d that cannot hold at once at most two count."""
    for (one, low, high), (other, other_low, other_high) in product(near, far):
        for third, least, most in across:
            if low + other_low > most + SAFETY or high + other_high < least - SAFETY:
                model.addCons(tie[one] + tie[other] + tie[third] <= 2)


def _add_groups(model: Model, ties: Ties, tie: list[Variable]) -> None:
    for group in np.unique(ties.group[ties.group >= 0]).tolist():
        taken: dict[int, list[Variable]] = {}
        for number in np.flatnonzero(ties.group == group).tolist():
            shares = [model.addVar(lb=0, ub=1) for _ in range(2)]
            model.addCons(tie[number] <= quicksum(shares))
            for body, share in zip(ties.bodies[number].tolist(), shares, strict=True):
                taken.setdefault(body, []).append(share)
        for shares in taken.values():
            if len(shares) > 1:
                model.addCons(quicksum(shares) <= 1)
