"""Labels that are proven against all labellings of small graphs."""

from itertools import combinations, product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from linecad.model.regions import proof
from linecad.model.regions.cuts import Borders
from linecad.model.regions.proof import Program, Proof, prove

LABELS = 3
NEVER = 10**7


@st.composite
def programs(draw):
    """A few cells with three labels of which up to two are surfaces, and labels to start from."""
    cells = draw(st.integers(1, 5))
    cost = st.one_of(st.integers(0, 12), st.integers(-5, 5), st.just(NEVER))
    costs = draw(st.lists(st.lists(cost, min_size=LABELS, max_size=LABELS), min_size=cells, max_size=cells))
    pairs = [pair for pair in combinations(range(cells), 2) if draw(st.booleans())]
    border = draw(st.lists(st.integers(0, 9), min_size=len(pairs), max_size=len(pairs)))
    borders = Borders(np.array(pairs, np.int64).reshape(-1, 2), np.array(border, np.int64))
    start = draw(st.lists(st.integers(0, LABELS - 1), min_size=cells, max_size=cells))
    price = np.array(draw(st.lists(st.integers(0, 15), max_size=2)), np.int64)
    return Program(np.array(costs), borders, price), np.array(start)


@settings(max_examples=200)
@given(programs())
def test_nothing_is_cheaper_than_proven_labels_and_they_cost_what_they_say(case):
    program, start = case
    found = prove(program, start)
    costs = [program.cost(np.array(label)) for label in product(range(LABELS), repeat=len(start))]
    assert program.cost(found.label) == found.cost == min(costs)
    assert found.bound == found.cost
    assert found.gap == 0


@settings(max_examples=50)
@given(programs())
def test_labels_that_are_the_best_stay_as_they_are(case):
    program, start = case
    best = prove(program, start).label
    assert prove(program, best).label is best


def test_the_cost_is_that_of_cells_above_their_cheapest_of_borders_and_of_each_surface_once():
    costs = np.array([[5, 15, 105], [0, 20, 200]])
    program = Program(costs, Borders(np.array([[0, 1]]), np.array([1000])), np.array([5000, 7000]))
    assert program.cost(np.array([1, 1])) == 10 + 20 + 7000
    assert program.cost(np.array([0, 1])) == 20 + 1000 + 5000 + 7000
    assert program.cost(np.array([2, 2])) == 100 + 200


# Three cells around a corner, each of which may be two of three labels: half of each is cheaper than any whole answer.
TRIANGLE = Program(
    np.array([[0, 0, 30], [30, 0, 0], [0, 30, 0]]),
    Borders(np.array([[0, 1], [1, 2], [0, 2]]), np.full(3, 8)),
    np.zeros(3, np.int64),
)


def test_a_bound_below_the_cost_is_told_where_the_search_may_not_begin(monkeypatch):
    monkeypatch.setattr(proof, "NODES", 0)
    start = np.array([2, 0, 1])
    found = prove(TRIANGLE, start)
    assert found.bound <= 16 <= found.cost
    assert found.gap == (found.cost - found.bound) / found.cost


def test_the_gap_is_a_share_of_the_cost():
    assert Proof(np.zeros(1, np.int64), 200, 150).gap == pytest.approx(0.25)
    assert Proof(np.zeros(1, np.int64), 0, 0).gap == 0
