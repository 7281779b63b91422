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
HOLDS = 1e-9  # of the depth; a linear program's rounding
ROUNDS = 3  # of reweighting
LEAST_MISS = 5e-5  # of the depth, from which on what is missed costs less the larger it is
FIRM = 1000.0  # as much as so many others counts a condition that goes last
UNEVEN = 1e-3  # the last condition counts more than the first, so that not each of several misses a part
MOVE = 1e-6  # of a miss costs a move as large of a plane with 1 px of segments


@dataclass(frozen=True, eq=False)
class PlaneOffsets:
    """Offsets of C planes."""

    value: Float  # (C,)
    nearest: Float  # (C,) depth of the nearest line
    weight: Float  # (C,) px of segments

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
    best, most = np.zeros(len(planes.value)), (0, 0)
    for moves in _with_few_missed(conditions, planes, firm):
        holds = _hold(conditions, planes, moves)
        count = (int((holds & firm).sum()), int(holds.sum()))
        if count > most:
            best, most = moves, count
    return best


def _shortest(conditions: Float, planes: PlaneOffsets) -> Float:
    """The moves (C,) that meet the conditions best, and of these the least, of planes of long lines above all."""
    if not len(conditions):
        return np.zeros(len(planes.value))
    scale = planes.nearest / np.sqrt(np.maximum(planes.weight, 1.0))
    return scale * shortest_solution(conditions * scale, -conditions @ planes.value)


def _is_far(moves: Float, planes: PlaneOffsets) -> Bool:
    return np.asarray(np.abs(moves) > FARTHEST * planes.nearest)


def _hold(conditions: Float, planes: PlaneOffsets, moves: Float) -> Bool:
    """Which conditions (R,) hold after the moves (C,)."""
    missed = np.abs(conditions @ (planes.value + moves))
    return np.asarray(missed <= EXACT * (np.abs(conditions) @ planes.nearest))


def _with_few_missed(conditions: Float, planes: PlaneOffsets, firm: Bool) -> Iterator[Float]:
    """Moves (C,) up to FARTHEST that leave ever fewer conditions missed, by more.

    A linear program that fails ends the sets.
    """
    distinct, which = np.unique(conditions, axis=0, return_inverse=True)  # each of a wall's level lines asks the same
    which = which.reshape(-1)
    says = np.bincount(which, np.where(firm, FIRM, 1.0)) * np.linspace(1.0, 1.0 + UNEVEN, len(distinct))
    reach = np.abs(distinct) @ planes.nearest
    # Unknowns: moves of planes there and back, of their depth, and what is missed on either side.
    rows = csr_array(distinct * planes.nearest / reach[:, None])
    unit = eye_array(len(distinct), format="csr")
    system = hstack([rows, -rows, unit, -unit], format="csr")
    price = np.tile(MOVE * np.sqrt(planes.weight), 2)
    bounds = np.zeros((system.shape[1], 2))
    bounds[:, 1] = np.where(np.arange(len(bounds)) < len(price), FARTHEST, np.inf)
    missed = np.zeros(len(distinct))
    for _ in range(ROUNDS):
        cost = np.tile(says * LEAST_MISS / (LEAST_MISS + missed), 2)
        found = linprog(
            np.concatenate([price, cost]), A_eq=system, b_eq=-(distinct @ planes.value) / reach, bounds=bounds,
            method="highs",
        )  # fmt: skip
        if not found.success:
            return
        missed = found.x[len(price) :].reshape(2, -1).sum(axis=0)
        own = distinct[missed <= HOLDS]
        moves = _shortest(own, planes)
        if _is_far(moves, planes).any():  # then those of the program, whose rounding goes
            there, back = found.x[: len(price)].reshape(2, -1) * planes.nearest
            moves = there - back
            moves += _shortest(own, replace(planes, value=planes.value + moves))
        yield moves
