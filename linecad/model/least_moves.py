"""The least moves of planes with which linear conditions on their offsets hold, as many of them as may be.

Which conditions hold together, where not all do, is told by the least sum of what is missed, each reweighted by what
the last sum left of it (Candes, Wakin and Boyd, Enhancing sparsity by reweighted l1 minimization, 2008): few are missed
then and the others hold. To drop the worst one by one keeps fewer and took minutes of a photo with two thousand.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import linprog
from scipy.sparse import csr_array, eye_array, hstack

from linecad.arrays import Bool, Float, Int
from solver.least_squares import shortest_solution

# Of the depth, by which a plane may move to meet others. Two nearly parallel walls ask uprights to move far along both.
FARTHEST = 0.004
EXACT = 1e-12  # of the depth; rounding
MET = 1e-9  # of the depth; what a linear program leaves of a condition that holds
PROGRAM = 1e-10  # of the depth; the tolerance of that program, the least that HiGHS has
FAR = FARTHEST * (1 + 1e-9)  # the same with rounding
ROUNDS = 3  # of reweighting
LEAST_MISS = 5e-5  # of the depth, from which on what is missed costs less the larger it is
FIRM = 1000.0  # as much as so many others counts a condition that goes last
UNEVEN = 1e-3  # the last condition counts more than the first, so that not each of several misses a part
MOVE = 1e-6  # of a miss costs a move as large of a plane with 1 px of segments or less


@dataclass(frozen=True, eq=False)
class PlaneOffsets:
    """Offsets of C planes."""

    value: Float  # (C,)
    nearest: Float  # (C,) depth of the nearest line
    weight: Float  # (C,) px of segments

    def moved(self, moves: Float) -> "PlaneOffsets":
        """The same after moves (C,)."""
        return replace(self, value=self.value + moves)

    def subset(self, planes: Int) -> "PlaneOffsets":
        """Some of them, by number."""
        return PlaneOffsets(self.value[planes], self.nearest[planes], self.weight[planes])


def least_moves(conditions: Float, planes: PlaneOffsets, firm: Bool) -> Float:
    """The least moves (C,) of planes, none of more than FARTHEST, with which `conditions` (R, C) @ offsets are 0.

    Conditions that cannot hold beside others go, those that are `firm` (R,) last.
    """
    moves = _shortest(conditions, planes)
    if not _is_far(moves, planes).any() and _hold(conditions, planes, moves).all():
        return moves

    def worth(moves: Float) -> tuple[int, int]:
        holds = _hold(conditions, planes, moves)
        return int((holds & firm).sum()), int(holds.sum())

    return max([np.zeros(len(planes.value)), *_with_few_missed(conditions, planes, firm)], key=worth)


def missed_share(conditions: Float | csr_array, planes: PlaneOffsets) -> Float:
    """What each condition (R,) misses, over what is gained if each plane of it moves by its whole depth."""
    reach = np.maximum(abs(conditions) @ planes.nearest, np.finfo(float).tiny)
    missed: Float = np.abs(conditions @ planes.value) / reach
    return missed


def _shortest(conditions: Float, planes: PlaneOffsets) -> Float:
    """The moves (C,) that meet the conditions best, and of these the least, of planes of long lines above all."""
    if not len(conditions):
        return np.zeros(len(planes.value))
    scale = planes.nearest / np.sqrt(np.maximum(planes.weight, 1.0))
    return scale * shortest_solution(conditions * scale, -conditions @ planes.value)


def _is_far(moves: Float, planes: PlaneOffsets) -> Bool:
    return np.asarray(np.abs(moves) > FAR * planes.nearest)


def _hold(conditions: Float, planes: PlaneOffsets, moves: Float) -> Bool:
    """Which conditions (R,) hold after the moves (C,)."""
    return np.asarray(missed_share(conditions, planes.moved(moves)) <= EXACT)


def _with_few_missed(conditions: Float, planes: PlaneOffsets, firm: Bool) -> Iterator[Float]:
    """Moves (C,) up to FARTHEST that leave few conditions missed, of each round of the linear program.

    A program that fails ends them.
    """
    distinct, which = np.unique(conditions, axis=0, return_inverse=True)  # many level lines of a wall ask the same
    says = np.bincount(which.reshape(-1), np.where(firm, FIRM, 1.0)) * np.linspace(1.0, 1.0 + UNEVEN, len(distinct))
    reach = np.abs(distinct) @ planes.nearest
    # Unknowns: moves of planes there and back, of their depth, and what is missed on either side.
    rows = csr_array(distinct * planes.nearest / reach[:, None])
    unit = eye_array(len(distinct), format="csr")
    system = hstack([rows, -rows, unit, -unit], format="csr")
    price = np.tile(MOVE * np.sqrt(np.maximum(planes.weight, 1.0)), 2)
    bounds = np.zeros((system.shape[1], 2))
    bounds[:, 1] = np.where(np.arange(len(bounds)) < len(price), FARTHEST, np.inf)
    missed = np.zeros(len(distinct))
    for _ in range(ROUNDS):
        cost = np.tile(says * LEAST_MISS / (LEAST_MISS + missed), 2)
        found = linprog(
            np.concatenate([price, cost]), A_eq=system, b_eq=-(distinct @ planes.value) / reach, bounds=bounds,
            method="highs", options={"primal_feasibility_tolerance": PROGRAM},
        )  # fmt: skip
        if not found.success:
            return
        unknowns = np.maximum(found.x, 0.0)
        missed = unknowns[len(price) :].reshape(2, -1).sum(axis=0)
        own = distinct[missed <= MET]
        moves = _shortest(own, planes)
        if _is_far(moves, planes).any():
            there, back = unknowns[: len(price)].reshape(2, -1) * planes.nearest
            moves = _without_rounding(there - back, own, planes)
        yield moves


def _without_rounding(moves: Float, conditions: Float, planes: PlaneOffsets) -> Float:
    """Moves (C,) that conditions (R, C) hold after but for rounding, and after these to the last digit.

    Nearly parallel frames make much of rounding: what would move a plane too far for it goes.
    """
    missed = missed_share(conditions, planes.moved(moves))
    while len(conditions):
        exact = moves + _shortest(conditions, planes.moved(moves))
        far = np.abs(exact) / planes.nearest
        if far.max() <= FAR:
            return exact
        gone = int((missed * np.abs(conditions[:, far.argmax()])).argmax())
        conditions, missed = np.delete(conditions, gone, axis=0), np.delete(missed, gone)
    return np.zeros(len(moves))
