"""Which scale cues between bodies of lines are accepted, and the scales that they give: an exact decision over bodies.

A *scale cue* says how large one body is beside another, and how many independent coincidences in the photo say so. No
single one is believed. Cues that contradict each other around a cycle cannot all be true: those are given up that say
least together. What is left is counted over whole groups: two groups become one when the coincidences between them are
more than chance explains.
"""

import heapq
from dataclasses import dataclass
from itertools import count as numbers

import numpy as np
from scipy.special import pdtrc

from linecad.arrays import Bool, Float, Int
from solver.bodies.contradiction import find_contradiction
from solver.least_squares import shortest_solution

ENOUGH = 1.6  # decades of evidence that join two groups of bodies
LEAST = 0.6  # decades; cues of less are as often wrong as right, and count nowhere
BASE_RATE = 0.3  # coincidences that are expected beside those that the photo tells: few alone are no evidence
MOST_BRANCHES = 2000  # sets of cues that are tried; then all cues of a contradiction are given up


@dataclass(frozen=True, eq=False)
class ScaleCues:
    """T cues, each for the scales of two bodies."""

    bodies: Int  # (T, 2) two different bodies
    log_ratio: Float  # (T,) log scale of the second less that of the first
    tolerance: Float  # (T,) half width of the interval about log_ratio, positive
    seen: Float  # (T,) coincidences that say so
    expected: Float  # (T,) coincidences of that kind if the bodies had nothing to do with each other

    def subset(self, keep: Int) -> "ScaleCues":
        """The cues that an index array selects."""
        return ScaleCues(
            self.bodies[keep], self.log_ratio[keep], self.tolerance[keep], self.seen[keep], self.expected[keep]
        )

    @property
    def evidence(self) -> Float:
        """(T,) decades, see `evidence_of`."""
        return np.array([evidence_of(*pair) for pair in zip(self.seen, self.expected, strict=True)])


@dataclass(frozen=True, eq=False)
class Joined:
    """B bodies in groups of one scale."""

    group: Int  # (B,) the smallest body of each one's group
    log_scale: Float  # (B,) by which each body must grow to have its group's scale; 0 for the smallest
    accepted: Bool  # (T,) the cues that count and do not contradict each other


def evidence_of(seen: float, expected: float) -> float:
    """Decades by which `seen` coincidences or more are improbable where `expected` ones are usual (Poisson)."""
    if seen <= 0:
        return 0.0
    return float(-np.log10(max(float(pdtrc(seen - 1, expected + BASE_RATE)), np.finfo(float).tiny)))


def join_bodies(cues: ScaleCues, count: int, enough: float = ENOUGH) -> Joined:
    """Groups of `count` bodies that cues join with `enough` decades of evidence, and their scales."""
    counted = np.flatnonzero(cues.evidence >= LEAST)
    accepted = np.zeros(len(cues.bodies), bool)
    accepted[counted] = find_accepted_cues(cues.subset(counted), count)
    group = np.arange(count)
    while True:
        between: dict[tuple[int, int], list[float]] = {}
        for cue in np.flatnonzero(accepted).tolist():
            first, second = sorted(group[cues.bodies[cue]].tolist())
            if first != second:
                sums = between.setdefault((first, second), [0.0, 0.0])
                sums[0] += float(cues.seen[cue])
                sums[1] += float(cues.expected[cue])
        judged = [(evidence_of(*sums), pair) for pair, sums in between.items()]
        best = max(judged, key=lambda entry: (entry[0], -entry[1][0], -entry[1][1]), default=(0.0, (0, 0)))
        if best[0] < enough:
            break
        group[group == best[1][1]] = best[1][0]
    return Joined(group, _log_scales(cues, accepted, group), accepted)


def find_accepted_cues(cues: ScaleCues, count: int) -> Bool:
    """Mask (T,) of the most evidence that contradicts itself nowhere: scales exist that keep every tolerance.

    Exact, by branching on the cues of a contradiction: whatever is kept, one of them is not. After MOST_BRANCHES all
    cues of each contradiction are given up, since a wrong depth is worse than none.
    """
    worth = cues.evidence
    order = numbers()
    start: frozenset[int] = frozenset()
    waiting = [(0.0, next(order), start)]
    known = {start}
    dropped = start
    tried = 0
    while waiting:
        _, _, dropped = heapq.heappop(waiting)
        cycle = _contradiction(cues, count, dropped)
        tried += 1
        if not cycle:
            break
        if tried >= MOST_BRANCHES:
            while cycle:
                dropped = dropped | cycle
                cycle = _contradiction(cues, count, dropped)
            break
        for cue in sorted(cycle):
            more = dropped | {cue}
            if more not in known:
                known.add(more)
                heapq.heappush(waiting, (float(worth[list(more)].sum()), next(order), more))
    accepted = np.ones(len(cues.bodies), bool)
    accepted[list(dropped)] = False
    return accepted


def _contradiction(cues: ScaleCues, count: int, dropped: frozenset[int]) -> frozenset[int]:
    """Cues that no scales satisfy together, none where all are satisfied."""
    kept = np.array([cue for cue in range(len(cues.bodies)) if cue not in dropped], np.int64)
    own = cues.subset(kept)
    return frozenset(kept[list(find_contradiction(own.bodies[:, ::-1], own.log_ratio, own.tolerance, count))].tolist())


def _log_scales(cues: ScaleCues, accepted: Bool, group: Int) -> Float:
    """Weighted least squares of the accepted cues within each group, 0 for its smallest body (B,)."""
    first, second = cues.bodies.reshape(-1, 2).T
    used = np.flatnonzero(accepted & (group[first] == group[second]) & (cues.evidence > 0))
    rows = np.zeros((len(used) + len(group), len(group)))
    right = np.zeros(len(rows))
    weight = np.sqrt(cues.seen[used]) / cues.tolerance[used]
    at = np.arange(len(used))
    rows[at, second[used]], rows[at, first[used]] = weight, -weight
    right[at] = weight * cues.log_ratio[used]
    lead = np.flatnonzero(group == np.arange(len(group)))
    rows[len(used) + lead, lead] = 1.0
    scale = shortest_solution(rows, right)
    return scale - scale[group]
