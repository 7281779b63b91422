"""What the scene program is given and what it answers.

A *tie* says that the scales of two bodies have a certain ratio, and how much log-odds that is worth. Ties without a
group are independent of each other. Ties of one group repeat each other: where three bodies share a plane, the third
pair says nothing that the other two did not. So of a group no more ties count than there are bodies in any part that
they connect (a pseudoforest; these are the independent sets of the bicircular matroid, so that taking the heaviest
first is best).
"""

from dataclasses import dataclass

import numpy as np

from linecad.arrays import Bool, Float, Int, check_lengths, check_not_negative, freeze
from linecad.line_graph import Status

ROUNDING = 1e-7  # log ratio by which a tie may be missed and still hold


@dataclass(frozen=True, eq=False)
class Ties:
    """T ties between bodies."""

    bodies: Int  # (T, 2) two different bodies
    log_ratio: Float  # (T,) log scale of the first less that of the second
    tolerance: Float  # (T,) half width of the interval about log_ratio, positive
    weight: Float  # (T,) positive: log-odds that are won where the ratio is in the interval
    group: Int  # (T,) -1, or the group whose ties repeat each other
    # (T,) its ratio is known less well than others': it places what they leave free, and moves nothing that they hold.
    yields: Bool | tuple[()] = ()

    def __post_init__(self) -> None:
        freeze(self, "bodies", np.int64, (None, 2))
        for name in ("log_ratio", "tolerance", "weight"):
            freeze(self, name, np.float64, (None,))
        freeze(self, "group", np.int64, (None,))
        if len(self.yields) == 0:
            object.__setattr__(self, "yields", np.zeros(len(self.bodies), bool))
        freeze(self, "yields", np.bool_, (None,))
        check_lengths(self, len(self.bodies), ["log_ratio", "tolerance", "weight", "group", "yields"])
        check_not_negative(self, ["bodies"])
        if len(self) and not (self.tolerance.min() > 0 and self.weight.min() > 0):
            raise ValueError("Ties.tolerance and Ties.weight must be positive")
        if (self.bodies[:, 0] == self.bodies[:, 1]).any():
            raise ValueError("Ties.bodies names one body twice")
        if len(self) and self.group.min() < -1:
            raise ValueError(f"Ties.group holds {self.group.min()}, expected -1 or more")

    def __len__(self) -> int:
        return len(self.bodies)

    def subset(self, keep: Bool | Int) -> "Ties":
        """The ties that a mask or an index array selects."""
        return Ties(
            self.bodies[keep], self.log_ratio[keep], self.tolerance[keep], self.weight[keep], self.group[keep],
            np.asarray(self.yields)[keep],
        )  # fmt: skip

    def joined(self, other: "Ties") -> "Ties":
        """These ties and then the others."""
        return Ties(
            np.concatenate([self.bodies, other.bodies]),
            np.r_[self.log_ratio, other.log_ratio],
            np.r_[self.tolerance, other.tolerance],
            np.r_[self.weight, other.weight],
            np.r_[self.group, other.group],
            np.r_[self.yields, other.yields],
        )

    def parts(self, used: Bool, count: int) -> Int:
        """Number (B,) of the part that each of `count` bodies is in by the used ties (T,), in order of first bodies."""
        # Without SciPy, whose calls take far longer than these few ties.
        root = list(range(count))
        for first, second in self.bodies[used].tolist():
            one, other = _find(root, first), _find(root, second)
            root[max(one, other)] = min(one, other)
        # A root is the first body of its part, and stands before all that lead to it.
        number, parts = [0] * count, 0
        for body in range(count):
            if root[body] == body:
                number[body], parts = parts, parts + 1
            else:
                number[body] = number[root[body]]
        return np.array(number, np.int64)

    def misfit(self, log_scale: Float) -> Float:
        """(T,) by how much log scales (B,) miss the ratios."""
        first, second = self.bodies.T
        misfit: Float = np.abs(log_scale[first] - log_scale[second] - self.log_ratio)
        return misfit

    def holds(self, log_scale: Float) -> Bool:
        """(T,) the ties whose interval log scales (B,) are in."""
        return np.asarray(self.misfit(log_scale) <= self.tolerance + ROUNDING)

    def counted(self, log_scale: Float) -> Bool:
        """(T,) the ties that hold at log scales (B,) and count: of each group the heaviest that may count at once."""
        holds = self.holds(log_scale)
        counted = holds & (self.group < 0)
        own = np.flatnonzero(holds & (self.group >= 0))
        own = own[np.argsort(-self.weight[own], kind="stable")]
        # The bodies of each group are other nodes, so that all groups can be gone through at once.
        nodes = self.bodies[own] + self.group[own, None] * (self.bodies.max(initial=0) + 1)
        counted[own[pseudoforest(nodes)]] = True
        return counted

    def value(self, log_scale: Float) -> float:
        """The weight of all that counts at log scales (B,)."""
        return float(self.weight[self.counted(log_scale)].sum())


def _find(root: list[int], node: int) -> int:
    """The root of the part that a node is in, with shorter ways to it for the next time (union-find)."""
    while root[node] != node:
        root[node] = root[root[node]]
        node = root[node]
    return node


def pseudoforest(edges: Int) -> Bool:
    """Mask (E,) of the edges that are taken, first come first served, while no part has more edges than nodes."""
    count = int(edges.max(initial=-1)) + 1
    root = list(range(count))
    is_full = [False] * count  # the part has as many edges as nodes
    taken = [False] * len(edges)
    for number, (one, other) in enumerate(edges.tolist()):
        # As `_find`, the calls of which would take most of the time of a local search.
        while root[one] != one:
            root[one] = one = root[root[one]]
        while root[other] != other:
            root[other] = other = root[root[other]]
        if is_full[one] and is_full[other]:
            continue
        taken[number] = True
        root[one] = other
        is_full[other] = is_full[one] or is_full[other] or one == other
    return np.array(taken, bool)


@dataclass(frozen=True, eq=False)
class Placement:
    """The scales of B bodies."""

    log_scale: Float  # (B,) 0 for the reference, and for the first of bodies that no counted tie leads to from it
    counted: Bool  # (T,) ties that hold and count
    objective: float  # their weight
    bound: float  # proven: no scales are worth more
    gap: float
    status: Status
    nodes: int
    solver: str
    margin: Float  # (B,) see `solver.bodies.margins`

    def __post_init__(self) -> None:
        freeze(self, "log_scale", np.float64, (None,))
        freeze(self, "counted", np.bool_, (None,))
        freeze(self, "margin", np.float64, (None,))
        check_lengths(self, len(self.log_scale), ["margin"])
