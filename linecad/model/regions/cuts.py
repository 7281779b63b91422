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
        if not _may_gain(costs, borders, label, number):
            continue
        found = np.where(_takes(costs, borders, label, number), number, label)
        cost = energy(costs, borders, found)
        if cost < best:
            label, best, idle = found, cost, 1
    return label


def _may_gain(costs: Int, borders: Borders, label: Int, number: int) -> bool:
    """Whether any cell would gain by a label if that made all its borders free; else no set of cells does."""
    one, other = borders.cells.T
    was = borders.cost * (label[one] != label[other])
    count = len(label)
    rise = costs[:, number] - costs[np.arange(count), label]
    return bool((rise < _sums(one, was, count) + _sums(other, was, count))[label != number].any())


def _takes(costs: Int, borders: Borders, label: Int, number: int) -> Bool:
    """Which cells (C,) take a label in its best expansion."""
    count = len(label)
    one, other = borders.cells.T
    was = borders.cost * (label[one] != label[other])
    first_stays = borders.cost * (label[one] != number)  # and the second takes it
    second_stays = borders.cost * (label[other] != number)
    gain = costs[:, number] - costs[np.arange(count), label]
    gain = gain + _sums(one, second_stays - was, count) - _sums(other, second_stays, count)
    capacity = first_stays + second_stays - was
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
    taken = np.ones(count + 2, bool)
    taken[breadth_first_order(left, source, return_predecessors=False)] = False
    return taken[:count]


def _sums(cell: Int, values: Int, count: int) -> Int:
    """Sums (count,) of values by cell."""
    # In doubles, which hold these whole numbers exactly.
    return np.bincount(cell, values, count).astype(np.int64)
