import subprocess
import sys
import threading

import numpy as np
import pytest

from linecad.errors import SolverError
from solver.options import Progress, SolveOptions, relative_gap
from solver.solve import solve


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("formulation", "other"),
        ("without", frozenset({"corners"})),
        ("mu_planarity", -0.1),
        ("mu_boundary", float("nan")),
        ("time_limit_s", 0.0),
        ("time_limit_s", float("inf")),
        ("gap", -1e-3),
        ("seed", -1),
        ("seed", 2**31),
        ("depth_range", 1.0),
        ("memory_limit_mb", 0.0),
        ("node_limit", 0),
    ],
)
def test_an_option_that_cannot_be_used_is_named_in_one_line(name, value):
    with pytest.raises(SolverError, match=r"expected|unknown") as caught:
        SolveOptions(**{name: value})
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(("formulation", "reward"), [("gain", 1.0), ("paper", 10.0)])
def test_each_formulation_has_its_own_reward_of_a_line_off_the_boundary(formulation, reward):
    assert SolveOptions(formulation=formulation).boundary_reward == reward
    assert SolveOptions(formulation=formulation, mu_boundary=0.0).boundary_reward == 0.0


def test_the_gap_of_a_bound_below_the_objective_is_zero():
    assert relative_gap(10.0, 10.0 - 1e-9) == 0.0
    assert relative_gap(10.0, 11.0) == pytest.approx(0.1)


def test_a_segment_without_an_axis_is_refused(corner, change):
    unlabelled = change(corner, segments=change(corner.segments, axis=np.array([0, -1, 2])))
    with pytest.raises(ValueError, match="segment 1"):
        solve(unlabelled, SolveOptions())


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("coordinate", [2, 1, 1], "edge 2"),
        ("kind", ["X", "collinear", "X"], "edge 1"),
        ("edges", [[0, 1], [0, 2], [0, 2]], "edge 2"),
        ("weight", [1.0, 0.0, 1.0], "edge 1"),
        ("tolerance", [0.1, 0.1, -0.1], "edge 2"),
    ],
)
def test_an_edge_that_does_not_fit_is_refused(corner, change, name, value, message):
    with pytest.raises(ValueError, match=message):
        solve(change(corner, **{name: np.array(value)}), SolveOptions())


def test_two_edges_between_the_same_lines_are_refused(build_graph):
    graph = build_graph([(0, (0, 5, 2), 1, 3), (1, (1, 0, 2), 5, 7)], [(0, 1), (0, 1)])
    with pytest.raises(ValueError, match="two edges"):
        solve(graph, SolveOptions())


def test_no_lines_at_all(build_graph):
    solution = solve(build_graph([]), SolveOptions())
    assert (solution.status, solution.objective, solution.gap) == ("optimal", 0.0, 0.0)
    assert len(solution.log_depth) == len(solution.connected) == 0


def test_one_line(build_graph):
    solution = solve(build_graph([(0, (0, 5, 2), 1, 3)]), SolveOptions(mu_boundary=10.0))
    assert solution.objective == 10.0
    assert solution.log_depth.shape == (1,)


def test_an_isolated_line_beside_two_that_meet(build_graph):
    graph = build_graph([(0, (0, 5, 2), 1, 3), (2, (-3, 9, 0), -1, 2), (1, (1, 0, 2), 5, 7)], [(0, 2)])
    solution = solve(graph, SolveOptions())
    assert solution.connected.tolist() == [True]
    assert np.isfinite(solution.log_depth).all()


def test_lines_without_edges(build_graph):
    graph = build_graph([(0, (0, 5, 2), 1, 3), (2, (-3, 9, 0), -1, 2)], [])
    assert solve(graph, SolveOptions()).connected.shape == (0,)


def test_solves_in_a_thread_of_the_callers(corner):
    found = []
    worker = threading.Thread(target=lambda: found.append(solve(corner, SolveOptions())))
    worker.start()
    worker.join()
    assert found[0].status == "optimal"


def test_progress_comes_in_the_callers_thread_and_ends_with_the_solution(corner):
    reports = []
    threads = set()

    def on_progress(progress):
        reports.append(progress)
        threads.add(threading.current_thread())

    solution = solve(corner, SolveOptions(), on_progress)
    assert threads == {threading.current_thread()}
    assert isinstance(reports[-1], Progress)
    assert (reports[-1].objective, reports[-1].bound) == (solution.objective, solution.bound)


def test_scip_is_not_loaded_before_something_is_solved():
    code = "import sys, solver.options, solver.start, solver.choice; sys.exit('pyscipopt' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
