"""Labels of least cost, or how far from them the labels found are: a whole-number program of cells and labels.

A cell has a label or not, a border separates a label or not, a surface is shown or not: the relaxation of this program
is nearly always whole, so that HiGHS proves most answers without a search. Labels that lose to another one whatever
the neighbours show are left out before.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import Bounds, LinearConstraint, milp
from scipy.sparse import coo_array

from linecad.arrays import Bool, Float, Int
from linecad.model.regions.cuts import Borders, energy

NODES = 100  # of the search; a limit in seconds would give other labels on another computer
WHOLE = 1e-3  # by which a bound may be off; costs are whole


@dataclass(frozen=True, eq=False)
class Proof:
    """Labels with what no other labels of the same cells can cost less than."""

    label: Int  # (C,)
    cost: int  # above what each cell's cheapest label costs, with borders and surfaces
    bound: int  # the same of the best labels, at least

    @property
    def gap(self) -> float:
        """How much cheaper other labels may be, as a share of the cost; 0 where these are the best."""
        return (self.cost - self.bound) / self.cost if self.cost else 0.0


@dataclass(frozen=True, eq=False)
class Program:
    """Costs (C, L) of labels, their borders, and what each of the first K labels costs if any cell has it."""

    costs: Int
    borders: Borders
    price: Int  # (K,)

    def cost(self, label: Int) -> int:
        """What labels (C,) cost above the cheapest one of each cell."""
        shown = np.unique(label)
        above = energy(self.costs - self.costs.min(axis=1, keepdims=True), self.borders, label)
        return above + int(self.price[shown[shown < len(self.price)]].sum())


def prove(program: Program, label: Int) -> Proof:
    """The labels (C,), or cheaper ones, with a bound on all."""
    cost = program.cost(label)
    possible = _possible(program)
    costs, constraint = _rows(program, possible)
    cells = len(np.flatnonzero(possible))
    found = milp(
        costs,
        integrality=(np.arange(len(costs)) < cells).astype(np.int64),  # with whole cells the others are whole
        bounds=Bounds(0, 1),
        constraints=constraint,
        options={"node_limit": NODES, "mip_rel_gap": 0.0},
    )
    if found.x is None:  # at the limit before there was any answer, and then HiGHS tells no bound either
        return Proof(label, cost, 0)
    chosen = np.zeros(possible.shape)
    chosen[possible] = found.x[:cells]
    better = chosen.argmax(axis=1)
    if program.cost(better) < cost:
        label, cost = better, program.cost(better)
    return Proof(label, cost, min(int(np.ceil(max(found.mip_dual_bound, 0.0) - WHOLE)), cost))


def _possible(program: Program) -> Bool:
    """Which labels (C, L) a cell may have in the best labels: not those that cost more than another one and all its
    borders.
    """
    costs, (one, other) = program.costs, program.borders.cells.T
    count = len(costs)
    around = sum(np.bincount(side, program.borders.cost, count) for side in (one, other))
    price = np.pad(program.price, (0, costs.shape[1] - len(program.price)))
    most = (costs + price).min(axis=1) + around
    return np.asarray(costs <= most[:, None])


def _rows(program: Program, possible: Bool) -> tuple[Float, LinearConstraint]:
    """Costs of the variables and what holds them together: cells' labels, then borders' labels, then surfaces."""
    count = len(possible)
    number = np.where(possible, np.cumsum(possible).reshape(possible.shape) - 1, -1)
    cell, own = np.nonzero(possible)
    pair, label = np.nonzero(possible[program.borders.cells[:, 0]])
    start, end = number[program.borders.cells[pair].T, label]
    row_of_pair = np.arange(len(pair)) + count
    shown = np.flatnonzero(own < len(program.price))
    row_of_shown = np.arange(len(shown)) + count + len(pair)
    first_pair, first_surface = len(cell), len(cell) + len(pair)
    both = end >= 0
    entries = [
        (cell, np.arange(len(cell)), 1.0),
        (row_of_pair, start, 1.0),
        (row_of_pair[both], end[both], -1.0),
        (row_of_pair, np.arange(len(pair)) + first_pair, -1.0),
        (row_of_shown, shown, 1.0),
        (row_of_shown, own[shown] + first_surface, -1.0),
    ]
    rows, columns = (np.concatenate([entry[each] for entry in entries]) for each in (0, 1))
    values = np.concatenate([np.full(len(entry[0]), entry[2]) for entry in entries])
    size = (count + len(pair) + len(shown), first_surface + len(program.price))
    above = program.costs - program.costs.min(axis=1, keepdims=True)
    costs = np.concatenate([above[possible], program.borders.cost[pair], program.price]).astype(np.float64)
    low = np.where(np.arange(size[0]) < count, 1.0, -np.inf)
    high = np.where(np.arange(size[0]) < count, 1.0, 0.0)
    return costs, LinearConstraint(coo_array((values, (rows, columns)), size).tocsr(), low, high)
