"""Which weak ties between bodies of lines hold, and the scales that they give: an exact decision over bodies.

A tie says how large one body is beside another, and how many independent coincidences in the photo say so. No single
one is believed. Ties that contradict each other around a cycle cannot all hold: those are given up that say least
together. What is left is counted over whole groups: two groups become one when the coincidences between them are more
than chance explains.
"""

import heapq
from dataclasses import dataclass
from itertools import count as numbers

import numpy as np
from scipy.special import pdtrc

from linecad.arrays import Bool, Float, Int

ENOUGH = 1.6  # decades of evidence that join two groups of bodies
LEAST = 0.6  # decades; ties of less are as often wrong as right, and count nowhere
DOUBT = 0.3  # coincidences that are expected beside those that the photo tells: no tie is made of few alone
CLOSEST = 1e-9  # log scale; what is less is rounding, not a contradiction
MOST_BRANCHES = 2000  # sets of ties that are tried; then all ties of a contradiction are given up


@dataclass(frozen=True, eq=False)
class Ties:
    """T ties between bodies."""

    bodies: Int  # (T, 2) two different bodies
    log_ratio: Float  # (T,) log scale of the second less that of the first
    tolerance: Float  # (T,) half width of the interval about log_ratio, positive
    seen: Float  # (T,) coincidences that say so
    expected: Float  # (T,) coincidences of that kind if the bodies had nothing to do with each other

    def subset(self, keep: Int) -> "Ties":
        """The ties that an index array selects."""
        return Ties(self.bodies[keep], self.log_ratio[keep], self.tolerance[keep], self.seen[keep], self.expected[keep])

    @property
    def evidence(self) -> Float:
        """(T,) decades, see `evidence_of`."""
        return np.array([evidence_of(*pair) for pair in zip(self.seen, self.expected, strict=True)])


@dataclass(frozen=True, eq=False)
class Joined:
    """B bodies in groups of one scale."""

    group: Int  # (B,) the smallest body of each one's group
    log_scale: Float  # (B,) by which each body must grow to have its group's scale; 0 for the smallest
    held: Bool  # (T,) the ties that count and do not contradict each other


def evidence_of(seen: float, expected: float) -> float:
    """Decades by which `seen` coincidences or more are improbable where `expected` ones are usual (Poisson)."""
    if seen <= 0:
        return 0.0
    return float(-np.log10(max(float(pdtrc(seen - 1, expected + DOUBT)), np.finfo(float).tiny)))


def join_bodies(ties: Ties, count: int, enough: float = ENOUGH) -> Joined:
    """Groups of `count` bodies that ties hold together with `enough` decades of evidence, and their scales."""
    counted = np.flatnonzero(ties.evidence >= LEAST)
    held = np.zeros(len(ties.bodies), bool)
    held[counted] = find_held_ties(ties.subset(counted), count)
    group = np.arange(count)
    while True:
        between: dict[tuple[int, int], list[float]] = {}
        for tie in np.flatnonzero(held).tolist():
            first, second = sorted(group[ties.bodies[tie]].tolist())
            if first != second:
                sums = between.setdefault((first, second), [0.0, 0.0])
                sums[0] += float(ties.seen[tie])
                sums[1] += float(ties.expected[tie])
        judged = [(evidence_of(*sums), pair) for pair, sums in between.items()]
        best = max(judged, key=lambda entry: (entry[0], -entry[1][0], -entry[1][1]), default=(0.0, (0, 0)))
        if best[0] < enough:
            break
        group[group == best[1][1]] = best[1][0]
    return Joined(group, _log_scales(ties, held, group), held)


def find_held_ties(ties: Ties, count: int) -> Bool:
    """Mask (T,) of the most evidence that contradicts itself nowhere: scales exist that keep every tolerance.

    Exact, by branching on the ties of a contradiction: whatever is kept, one of them is not. After MOST_BRANCHES all
    ties of each contradiction are given up, since a wrong depth is worse than none.
    """
    worth = ties.evidence
    order = numbers()
    start: frozenset[int] = frozenset()
    waiting = [(0.0, next(order), start)]
    known = {start}
    dropped = start
    tried = 0
    while waiting:
        _, _, dropped = heapq.heappop(waiting)
        cycle = _contradiction(ties, count, dropped)
        tried += 1
        if not cycle:
            break
        if tried >= MOST_BRANCHES:
            while cycle:
                dropped = dropped | cycle
                cycle = _contradiction(ties, count, dropped)
            break
        for tie in sorted(cycle):
            more = dropped | {tie}
            if more not in known:
                known.add(more)
                heapq.heappush(waiting, (float(worth[list(more)].sum()), next(order), more))
    held = np.ones(len(ties.bodies), bool)
    held[list(dropped)] = False
    return held


def _contradiction(ties: Ties, count: int, dropped: frozenset[int]) -> frozenset[int]:
    """Ties that no scales satisfy together, none where all are satisfied: a negative cycle (Bellman and Ford)."""
    kept = np.array([tie for tie in range(len(ties.bodies)) if tie not in dropped], np.int64)
    if len(kept) == 0:
        return frozenset()
    first, second = ties.bodies[kept].T
    # The second's log scale is at most log_ratio + tolerance above the first's, the first's at most so much below.
    start, end = np.r_[first, second], np.r_[second, first]
    length = np.r_[ties.log_ratio[kept] + ties.tolerance[kept], ties.tolerance[kept] - ties.log_ratio[kept]]
    distance = np.zeros(count)
    came = np.full(count, -1)
    moved = -1
    for _ in range(count + 1):
        moved = -1
        for arc in np.flatnonzero(distance[start] + length < distance[end] - CLOSEST).tolist():
            if distance[start[arc]] + length[arc] < distance[end[arc]] - CLOSEST:
                distance[end[arc]] = distance[start[arc]] + length[arc]
                came[end[arc]] = arc
                moved = int(end[arc])
        if moved < 0:
            return frozenset()
    for _ in range(count):  # back into the cycle itself
        moved = int(start[came[moved]])
    found, body = set(), moved
    while True:
        arc = int(came[body])
        found.add(int(kept[arc % len(kept)]))
        body = int(start[arc])
        if body == moved:
            return frozenset(found)


def _log_scales(ties: Ties, held: Bool, group: Int) -> Float:
    """Weighted least squares of the held ties within each group, 0 for its smallest body (B,)."""
    first, second = ties.bodies.reshape(-1, 2).T
    used = np.flatnonzero(held & (group[first] == group[second]) & (ties.evidence > 0))
    rows = np.zeros((len(used) + len(group), len(group)))
    right = np.zeros(len(rows))
    weight = np.sqrt(ties.seen[used]) / ties.tolerance[used]
    at = np.arange(len(used))
    rows[at, second[used]], rows[at, first[used]] = weight, -weight
    right[at] = weight * ties.log_ratio[used]
    lead = np.flatnonzero(group == np.arange(len(group)))
    rows[len(used) + lead, lead] = 1.0
    scale = np.asarray(np.linalg.lstsq(rows, right, rcond=None)[0], np.float64)
    return scale - scale[group]
