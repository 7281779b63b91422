"""The re-check sees each way in which an answer can be wrong."""

from dataclasses import replace

import numpy as np
import pytest

from linecad.errors import SolverError
from solver.choice import Choice, boundaries, objective_of, recheck, trivial_bound
from solver.families import find_families
from solver.options import SolveOptions
from solver.solve import solve

RECTANGLE = [(0, (0, 6, 1), 1, 3), (0, (0, 6, 2), 1, 3), (2, (1, 6, 0), 1, 2), (2, (3, 6, 0), 1, 2)]


def answer(graph, options):
    found = solve(graph, options)
    return Choice(found.connected, found.is_boundary, found.planar_pairs, found.log_depth)


def check(graph, options, choice):
    recheck(graph, find_families(graph, options.without), options, choice)


@pytest.fixture(scope="module")
def rectangle(build_graph):
    return build_graph(RECTANGLE)


def test_a_right_answer_passes(rectangle):
    check(rectangle, SolveOptions(formulation="paper"), answer(rectangle, SolveOptions(formulation="paper")))


def test_its_value_is_that_of_the_papers_objective(rectangle):
    choice = answer(rectangle, SolveOptions(formulation="paper"))
    assert objective_of(rectangle, SolveOptions(formulation="paper"), choice) == 4 + 0.5 * 2 + 10.0 * 4
    assert objective_of(rectangle, SolveOptions(formulation="paper", without=frozenset({"boundary"})), choice) == 5.0
    assert objective_of(rectangle, SolveOptions(formulation="paper", without=frozenset({"planarity"})), choice) == 44.0
    families = find_families(rectangle, frozenset())
    assert trivial_bound(rectangle, families, SolveOptions(formulation="paper")) == 45.0


def test_a_line_at_a_wrong_depth_is_seen(rectangle):
    right = answer(rectangle, SolveOptions(formulation="paper"))
    moved = right.log_depth + np.array([0, 0, 0, 0.03])
    with pytest.raises(SolverError, match="outside its tolerance"):
        check(rectangle, SolveOptions(formulation="paper"), replace(right, log_depth=moved))


def test_a_depth_out_of_range_is_seen(rectangle):
    right = answer(rectangle, SolveOptions(formulation="paper"))
    for shift in (-1.0, 5.0):
        with pytest.raises(SolverError, match="outside the depths"):
            check(rectangle, SolveOptions(formulation="paper"), replace(right, log_depth=right.log_depth + shift))


def test_an_impossible_crossing_is_seen(rectangle, change):
    right = answer(rectangle, SolveOptions(formulation="paper"))
    with pytest.raises(SolverError, match="edge 2, whose lines cannot meet"):
        check(change(rectangle, possible=[True, True, False, True]), SolveOptions(formulation="paper"), right)


def test_a_closed_cycle_is_seen(corner):
    closed = answer(corner, SolveOptions(formulation="paper", without=frozenset({"cycles"}), mu_boundary=0.1))
    assert closed.connected.all()
    with pytest.raises(SolverError, match="cycle"):
        check(corner, SolveOptions(formulation="paper"), closed)


def test_a_missing_boundary_flag_is_seen(corner):
    options = SolveOptions(formulation="paper", without=frozenset({"cycles"}), mu_boundary=0.1)
    right = answer(corner, options)
    with pytest.raises(SolverError, match="boundary"):
        check(corner, options, replace(right, is_boundary=np.array([True, False, True])))


@pytest.mark.parametrize(
    ("pairs", "message"),
    [
        ([[0, 1, 1]], "breaks the plane"),
        ([[0, 1, 0]], "cannot be or are already"),
        ([[0, 2, 1]], "cannot be or are already"),
        ([[0, 1, 2], [0, 1, 2]], "cannot be or are already"),
    ],
)
def test_a_wrong_planar_pair_is_seen(rectangle, pairs, message):
    right = answer(rectangle, SolveOptions(formulation="paper"))
    with pytest.raises(SolverError, match=message):
        check(rectangle, SolveOptions(formulation="paper"), replace(right, planar_pairs=np.array(pairs)))


def test_a_planar_pair_that_meets_a_line_once_is_seen(rectangle):
    right = answer(rectangle, SolveOptions(formulation="paper"))
    connected = np.array([False, True, True, True])
    with pytest.raises(SolverError, match="breaks the plane"):
        check(rectangle, SolveOptions(formulation="paper"), replace(right, connected=connected))


def test_boundaries_are_the_lines_that_meet_two_axes(corner):
    assert boundaries(corner, np.array([True, True, True])).tolist() == [True, True, True]
    assert boundaries(corner, np.array([True, True, False])).tolist() == [True, False, False]
    assert not boundaries(corner, np.array([True, False, False])).any()
