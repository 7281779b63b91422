"""Labels by expansions against all labellings of small graphs."""

from itertools import combinations, product

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from linecad.model.regions import cuts as cuts_module
from linecad.model.regions.cuts import Borders, energy, expand

NEVER = 10**7


@st.composite
def problems(draw, labels):
    """Costs (C, labels) and borders of a few cells, and labels to start from."""
    cells = draw(st.integers(1, 5))
    cost = st.one_of(st.integers(0, 12), st.integers(-5, 5), st.just(NEVER))
    costs = np.array(draw(st.lists(st.lists(cost, min_size=labels, max_size=labels), min_size=cells, max_size=cells)))
    pairs = [pair for pair in combinations(range(cells), 2) if draw(st.booleans())]
    border = draw(st.lists(st.integers(0, 9), min_size=len(pairs), max_size=len(pairs)))
    start = draw(st.lists(st.integers(0, labels - 1), min_size=cells, max_size=cells))
    borders = Borders(np.array(pairs, np.int64).reshape(-1, 2), np.array(border, np.int64))
    return costs, borders, np.array(start)


def least(costs, borders, choices):
    """The least energy of all labellings of which each cell has one of its choices."""
    return min(energy(costs, borders, np.array(label)) for label in product(*choices))


def test_energy_is_the_sum_of_cells_and_borders_of_two_labels():
    costs = np.array([[1, 20, 300], [4, 50, 600], [7, 80, 900]])
    borders = Borders(np.array([[0, 1], [1, 2], [0, 2]]), np.array([1000, 2000, 4000]))
    assert energy(costs, borders, np.array([0, 0, 0])) == 1 + 4 + 7
    assert energy(costs, borders, np.array([0, 0, 2])) == 1 + 4 + 900 + 2000 + 4000
    assert energy(costs, borders, np.array([2, 1, 0])) == 300 + 50 + 7 + 1000 + 2000 + 4000


def test_a_cell_yields_to_its_neighbours_where_its_border_costs_more_than_its_label():
    costs = np.array([[0, 9], [3, 0], [0, 9]])
    row = np.array([[0, 1], [1, 2]])
    start = costs.argmin(axis=1)
    assert expand(costs, Borders(row, np.array([1, 1])), start, [0, 1]).tolist() == [0, 1, 0]
    assert expand(costs, Borders(row, np.array([2, 2])), start, [0, 1]).tolist() == [0, 0, 0]


def test_only_labels_that_may_be_taken_are_taken():
    costs = np.array([[5, 0, 1], [5, 0, 1]])
    borders = Borders(np.array([[0, 1]]), np.array([1]))
    assert expand(costs, borders, np.array([0, 0]), [0, 2]).tolist() == [2, 2]
    assert expand(costs, borders, np.array([0, 0]), []).tolist() == [0, 0]


@settings(max_examples=80)
@given(problems(2))
def test_two_labels_are_exact(problem):
    costs, borders, start = problem
    found = expand(costs, borders, start, [0, 1])
    assert energy(costs, borders, found) == least(costs, borders, [range(2)] * len(start))


@settings(max_examples=60)
@given(problems(3))
def test_three_labels_are_no_worse_than_any_expansion(problem):
    costs, borders, start = problem
    found = expand(costs, borders, start, [0, 1, 2])
    best = energy(costs, borders, found)
    assert best <= energy(costs, borders, start)
    for number in range(3):
        assert best <= least(costs, borders, [{own, number} for own in found.tolist()])
    # What Boykov, Veksler and Zabih prove: at most twice the least, where no cost is negative.
    if costs.min() >= 0:
        assert best <= 2 * least(costs, borders, [range(3)] * len(start))


@settings(max_examples=60)
@given(problems(2))
def test_an_expansion_takes_as_many_cells_as_may_be_at_the_least_cost(problem):
    # So that the same costs give the same labels, however much of it is known without a cut.
    costs, borders, start = problem
    choices = [np.where(mask, 1, start) for mask in product([False, True], repeat=len(start))]
    best = min(energy(costs, borders, label) for label in choices)
    most = np.any([label != start for label in choices if energy(costs, borders, label) == best], axis=0)
    found = expand(costs, borders, start, [1])
    wanted = np.where(most, 1, start) if best < energy(costs, borders, start) else start
    assert found.tolist() == wanted.tolist()


def test_a_cut_is_asked_only_where_single_cells_do_not_tell(monkeypatch):
    cuts = []
    cut_off = cuts_module._cut_off
    monkeypatch.setattr(cuts_module, "_cut_off", lambda gain, *rest: cuts.append(len(gain)) or cut_off(gain, *rest))
    costs = np.array([[9, 0], [0, 9], [6, 0], [2, 0], [0, 9]])
    row = Borders(np.array([[0, 1], [1, 2], [2, 3], [3, 4]]), np.array([1, 1, 3, 1]))
    assert expand(costs, row, np.zeros(5, np.int64), [1]).tolist() == [1, 0, 1, 1, 0]
    assert cuts == []
    # Neither gains alone, both together do.
    pair = Borders(np.array([[0, 1]]), np.array([4]))
    assert expand(np.array([[3, 0], [0, 1]]), pair, np.zeros(2, np.int64), [1]).tolist() == [1, 1]
    assert cuts == [2]
