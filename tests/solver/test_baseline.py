"""The baseline's linear program on graphs whose optimum is known."""

import numpy as np
import pytest

from linecad.errors import SolverError
from solver.baseline import solve_baseline
from solver.depths import end_ratios


def test_lines_that_meet_cost_nothing(corner):
    found = solve_baseline(corner, 10)
    assert found.objective == pytest.approx(0, abs=1e-9)
    i, j = corner.edges.T
    assert np.log(found.depth[i] / found.depth[j]) == pytest.approx(corner.log_ratio)


def test_no_end_is_nearer_than_one_and_some_end_is_there(street):
    found = solve_baseline(street, 10)
    near = found.depth * end_ratios(street).min(axis=1)
    assert near.min() == pytest.approx(1)


def test_of_two_contradicting_crossings_the_heavier_one_holds(build_graph):
    # A vertical line before a wall: it meets the course in front of it (y = 5), or the one behind (y = 8).
    lines = [(2, (1, 5, 0), 0, 3), (0, (0, 5, 1), 0.5, 2), (0, (0, 8, 3.5), 0.5, 3)]
    # Both courses are tied to one line along y, so that they cannot simply move.
    lines.append((1, (2, 0, 1), 4.5, 9))
    edges = [(0, 1), (0, 2), (1, 3), (2, 3)]
    weights = np.array([5.0, 1.0, 9.0, 9.0])
    graph = build_graph(lines, edges, weight=weights)
    found = solve_baseline(graph, 10)
    assert found.slack[0] == pytest.approx(0, abs=1e-9)
    assert found.slack[1] > 0.01
    assert found.objective == pytest.approx(weights @ found.slack)
    swapped = solve_baseline(build_graph(lines, edges, weight=weights[[1, 0, 2, 3]]), 10)
    assert swapped.slack[1] == pytest.approx(0, abs=1e-9)


def test_the_slack_of_lines_on_opposite_sides_is_what_they_must_miss_by(build_graph):
    # A line above the horizon and one below can agree in height nowhere; at depth 1 they are as near as they get.
    graph = build_graph([(0, (0, 5, 1), -1, 1), (1, (0, 0, -1), 4, 6)], yaw=0.0, pitch=0.0)
    assert not graph.possible.any()
    found = solve_baseline(graph, 10)
    ratios = end_ratios(graph)
    least = 1 / ratios.min(axis=1)
    assert found.depth == pytest.approx(least)
    assert found.objective == pytest.approx(np.abs(least[0] * graph.rays[0, 2] - least[1] * graph.rays[1, 2]))


def test_no_choice_of_depths_is_better(alley):
    found = solve_baseline(alley, 10)
    i, j = alley.edges.T
    near = 1 / end_ratios(alley).min(axis=1)
    rng = np.random.default_rng(2)
    for step in (1e-3, 1e-1, 1.0):
        for _ in range(50):
            depth = np.maximum(found.depth + step * rng.normal(size=len(found.depth)), near)
            slack = np.abs(depth[i] * alley.rays[i, alley.coordinate] - depth[j] * alley.rays[j, alley.coordinate])
            assert alley.weight @ slack >= found.objective - 1e-9


def test_no_time_is_an_error_that_says_so(street):
    with pytest.raises(SolverError, match="time"):
        solve_baseline(street, 1e-9)
