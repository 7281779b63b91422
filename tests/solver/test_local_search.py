from itertools import combinations

import numpy as np
import pytest

from solver.choice import Choice, boundaries, objective_of, planar_pairs
from solver.families import find_families
from solver.local_search import LocalSearch
from solver.options import SolveOptions


def value(graph, families, options, chosen):
    chosen = np.array(chosen, bool)
    flags, planes = boundaries(graph, chosen), planar_pairs(families, chosen)
    return objective_of(graph, options, Choice(chosen, flags, planes, np.zeros(len(graph.segments))))


@pytest.fixture
def search(street):
    options = SolveOptions(mu_boundary=1.0)
    families = find_families(street, frozenset({"cycles"}))
    return LocalSearch(street, families, options), families, options


def states(street, count=6):
    rng = np.random.default_rng(0)
    for share in np.linspace(0, 1, count):
        yield rng.random(len(street.edges)) < share


def test_the_gain_of_an_edge_is_the_change_of_the_objective(street, search):
    local, families, options = search
    none = np.zeros(len(street.edges), bool)
    for chosen in states(street):
        local._begin(chosen, none)
        before = value(street, families, options, chosen)
        changes = []
        for edge in range(len(chosen)):
            toggled = chosen.copy()
            toggled[edge] = not toggled[edge]
            changes.append(value(street, families, options, toggled) - before)
        np.testing.assert_allclose(local._edge_gains(), changes, atol=1e-9)


def test_the_gain_of_a_side_is_the_change_of_the_objective(street, search):
    local, families, options = search
    none = np.zeros(len(street.edges), bool)
    found = 0
    for chosen in states(street):
        local._begin(chosen, none)
        before = value(street, families, options, chosen)
        gains = local._side_gains()
        for side, members in enumerate(local.sides):
            if chosen[members].any() and chosen[local.sides[side ^ 1]].any():
                without = chosen.copy()
                without[members] = False
                assert gains[side] == pytest.approx(value(street, families, options, without) - before)
                found += 1
    assert found > 20


def test_toggling_adds_up_to_the_change_of_the_objective(street, search):
    local, families, options = search
    chosen = next(states(street))
    local._begin(chosen, chosen)
    before = value(street, families, options, chosen)
    rng = np.random.default_rng(1)
    total = sum(local._toggle(int(edge)) for edge in rng.integers(len(chosen), size=300))
    assert total == pytest.approx(value(street, families, options, local.chosen) - before)


def test_no_single_edge_improves_the_result(street, search):
    local, families, options = search
    agrees = np.random.default_rng(2).random(len(street.edges)) < 0.8
    found = local.run(agrees, np.zeros(len(agrees), bool), agrees)
    assert not (found & ~agrees).any()
    best = value(street, families, options, found)
    for edge in np.flatnonzero(agrees):
        toggled = found.copy()
        toggled[edge] = not toggled[edge]
        assert value(street, families, options, toggled) <= best + 1e-9


def test_cycles_of_the_paper_are_kept_open(build_graph):
    lines = [(0, (0, 6, 1), 0.5, 3), (1, (1, 0, 1), 5, 7), (2, (1, 6, 0), 0.5, 3)]
    graph = build_graph(lines, list(combinations(range(3), 2)), weight=[1.0, 2.0, 3.0])
    families = find_families(graph, frozenset({"planarity", "boundary"}))
    assert len(families.three_cycles) == 1
    none, every = np.zeros(3, bool), np.ones(3, bool)
    assert LocalSearch(graph, families, SolveOptions(formulation="paper")).run(every, none, every).tolist() == [
        False,
        True,
        True,
    ]
