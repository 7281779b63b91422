"""Labels of low cost for cells beside each other: expansions by minimal cuts.

Each cell has a cost for each label, and two neighbours with different labels cost as their border says. An expansion
lets any cells at once change to one label; the best one is a minimal cut (Boykov, Veksler, Zabih 2001). Whole numbers
throughout, so that the same costs give the same labels everywhere.
"""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import breadth_first_order, maximum_flow

from linecad.arrays import Bool, Int

ROUNDS = 6
MOST = 2**30  # that SciPy's flow takes


@dataclass(frozen=True, eq=False)
class Borders:
    """M pairs of neighbouring cells."""

    cells: Int  # (M, 2)
    cost: Int  # (M,) not negative, of two different labels there


def energy(costs: Int, borders: Borders, label: Int) -> int:
    """Cost of labels (C,), by costs (C, L)."""
    one, other = label[borders.cells].T
    return int(costs[np.arange(len(label)), label].sum() + borders.cost[one != other].sum())


def expand(costs: Int, borders: Borders, label: Int, labels: list[int]) -> Int:
    """Labels (C,) that no expansion of one of `labels` makes cheaper, from `label` (C,) on; costs (C, L)."""
    best = energy(costs, borders, label)
    idle = 0
    for number in labels * ROUNDS:
        if idle == len(labels):
            break
        idle += 1
        taken = _takes(costs, borders, label, number)
        if not taken.any():
            continue
        found = np.where(taken, number, label)
        cost = energy(costs, borders, found)
        if cost < best:
            label, best, idle = found, cost, 1
    return label


def _takes(costs: Int, borders: Borders, label: Int, number: int) -> Bool:
    """Which cells (C,) that have another label take this one in its best expansion, as many as may."""
    count, cost = len(label), borders.cost
    one, other = borders.cells.T
    was = cost * (label[one] != label[other])
    rise = costs[:, number] - costs[np.arange(count), label]
    # What either cell of a border saves there by taking the label while the other stays as it is; all if both take it.
    here, there = np.concatenate([one, other]), np.concatenate([other, one])
    both_take = np.concatenate([cost, cost])
    takes_alone = np.concatenate([was, was]) - both_take * (label[there] != number)

    def saved(takes: Bool) -> Int:
        """By each cell (C,) where others take the label."""
        return _sums(here, np.where(takes[there], both_take, takes_alone), count)

    takes, is_open = np.zeros(count, bool), label != number
    if not (is_open & (rise < saved(is_open))).any():
        return takes  # no set of cells gains
    while is_open.any():
        # A cell whose rise is more than it can save stays; one that saves as much in any case takes the label. They are
        # nearly all, so that a network is seldom needed, and small.
        stays, gains = is_open & (rise > saved(takes | is_open)), is_open & (rise <= saved(takes))
        if not (stays | gains).any():
            break
        takes |= gains
        is_open &= ~(stays | gains)
    if is_open.any():
        gain, place = rise - saved(takes), np.cumsum(is_open) - 1
        both = is_open[one] & is_open[other]
        one, other, capacity = one[both], other[both], (2 * cost - was)[both]
        gain -= _sums(other, capacity, count)
        takes[is_open] = _cut_off(gain[is_open], place[one], place[other], capacity)
    return takes


def _cut_off(gain: Int, one: Int, other: Int, capacity: Int) -> Bool:
    """Which cells (N,) a minimal cut leaves on the sink's side, as many as may be.

    A `gain` (N,) above 0 is what a cell there costs, one below 0 what it saves; a cell `one` (M,) that is not there
    while the `other` is costs `capacity`.
    """
    count = len(gain)
    cell = np.arange(count)
    source, sink = count, count + 1
    tail = np.concatenate([np.full(count, source), cell, one])
    head = np.concatenate([cell, np.full(count, sink), other])
    room = np.concatenate([np.maximum(gain, 0), np.maximum(-gain, 0), capacity])
    used = room > 0
    network = csr_matrix(
        (np.minimum(room[used], MOST).astype(np.int32), (tail[used], head[used])), (count + 2, count + 2)
    )
    left = network - maximum_flow(network, source, sink).flow
    left.data[left.data < 0] = 0
    left.eliminate_zeros()
    cut = np.ones(count + 2, bool)
    cut[breadth_first_order(left, source, return_predecessors=False)] = False
    return cut[:count]


def _sums(cell: Int, values: Int, count: int) -> Int:
    """Sums (count,) of values by cell."""
    # In doubles, which hold these whole numbers exactly.
    return np.bincount(cell, values, count).astype(np.int64)
