"""Each family of the paper on a graph that can be solved by hand."""

import numpy as np
import pytest

from solver.options import SolveOptions
from solver.solve import solve


def options(*off, **others):
    return SolveOptions(formulation="paper", without=frozenset(off), **others)


ONLY_DEPTHS = ("cycles", "planarity", "boundary")
RECTANGLE = [(0, (0, 6, 1), 1, 3), (0, (0, 6, 2), 1, 3), (2, (1, 6, 0), 1, 2), (2, (3, 6, 0), 1, 2)]


def test_connectivity_joins_lines_that_meet_and_parts_those_that_do_not(build_graph):
    """The x-line and the z-line meet in (1, 6, 1); the third, 3 behind, cannot meet both."""
    graph = build_graph([(0, (0, 6, 1), 1, 3), (2, (1, 6, 0), 1, 2), (1, (1.7, 0, 1.2), 5, 7), (1, (1, 0, 1.2), 9, 11)])
    solution = solve(graph, options(*ONLY_DEPTHS))
    i, j = graph.edges[solution.connected].T
    off = solution.log_depth[i] - solution.log_depth[j] - graph.log_ratio[solution.connected]
    assert (np.abs(off) <= graph.tolerance[solution.connected] + 1e-6).all()
    assert not solution.connected.all()


@pytest.mark.parametrize(("tolerance", "taken"), [(0.0202, 3), (0.0198, 2)])
def test_the_slack_of_three_edges_adds_up_around_a_cycle(corner, change, tolerance, taken):
    """The ratios around the cycle are made to miss by 0.06: three times 0.02 covers that, three times less does not."""
    log_ratio = corner.log_ratio.copy()
    log_ratio[0] += 0.06
    graph = change(corner, log_ratio=log_ratio, tolerance=np.full(3, tolerance))
    assert solve(graph, options(*ONLY_DEPTHS)).connected.sum() == taken


def test_edges_of_lines_on_opposite_sides_of_the_camera_are_fake(build_graph):
    graph = build_graph([(0, (0, 6, 1), 1, 3), (1, (1, 0, -1), 5, 7)])
    assert not graph.possible[0]
    assert solve(graph, options(*ONLY_DEPTHS)).connected.tolist() == [False]


def test_an_edge_that_says_nothing_of_depth_is_taken_whatever_the_depths(corner, change):
    wrong = change(corner, log_ratio=corner.log_ratio + np.array([1.0, 0, 0]))
    assert solve(wrong, options("boundary")).connected.sum() == 2
    silent = change(wrong, informative=[False, True, True])
    assert solve(silent, options("boundary")).connected.all()


def test_near_ends_of_connected_lines_stay_within_the_depth_range(build_graph):
    """Two x-lines at depths of about 4 and 12, joined by a y-line."""
    graph = build_graph([(0, (0, 4, 1), 0, 1), (0, (0, 12, 1), 0, 1), (1, (1, 0, 1), 3.9, 12.1)], yaw=0.0, pitch=0.05)
    assert solve(graph, options(*ONLY_DEPTHS, depth_range=3.3)).connected.sum() == 2
    assert solve(graph, options(*ONLY_DEPTHS, depth_range=2.7)).connected.sum() == 1


def test_a_line_that_runs_far_into_depth_fits_any_depth_range(build_graph):
    graph = build_graph([(1, (1, 0, -1), 2, 200)])
    assert solve(graph, options(depth_range=1.5)).status == "optimal"


def test_a_corner_of_three_lines_is_refused_with_cycles_on_and_taken_with_cycles_off(corner):
    assert solve(corner, options("boundary")).connected.sum() == 2
    assert solve(corner, options("boundary", "cycles")).connected.sum() == 3


def test_an_xyzy_cycle_keeps_one_edge_open_although_the_depths_agree(build_graph):
    """Two y-lines 2 cm apart, an x-line and a z-line that touch both within the tolerance."""
    lines = [(0, (0, 6, 1.01), 0.5, 3), (1, (1, 0, 1), 5, 7), (1, (1.02, 0, 1.02), 5, 7), (2, (1.01, 6.5, 0), 0.5, 3)]
    graph = build_graph(lines, [(0, 1), (0, 2), (1, 3), (2, 3)], tolerance=0.05)
    assert solve(graph, options("boundary", "planarity")).connected.sum() == 3
    assert solve(graph, options("boundary", "planarity", "cycles")).connected.sum() == 4


def test_a_rectangle_is_taken_whole_and_its_sides_are_planar_pairs(build_graph):
    solution = solve(build_graph(RECTANGLE), options())
    assert solution.connected.all()
    assert solution.planar_pairs.tolist() == [[0, 1, 2], [2, 3, 0]]
    assert not solution.is_boundary.any()
    assert solution.objective == pytest.approx(4 + 2 * 0.5 + 4 * 10.0)


def test_a_planar_pair_gives_up_the_line_that_crosses_its_plane(build_graph):
    """Both x-lines touch the z-line; a y-line touches both too, within its tolerance, but runs out of their plane."""
    lines = [(0, (0, 6, 1), 1, 3), (0, (0, 6, 1.02), 1, 3), (2, (1.5, 6, 0), 0.5, 2), (1, (2.5, 0, 1.01), 5, 7)]
    graph = build_graph(lines, [(0, 2), (1, 2), (0, 3), (1, 3)], tolerance=0.05)
    dear = solve(graph, options("boundary", "cycles", mu_planarity=1.5))
    assert len(dear.planar_pairs) == 1
    assert dear.connected.sum() == 3
    cheap = solve(graph, options("boundary", "cycles", mu_planarity=0.5))
    assert len(cheap.planar_pairs) == 0
    assert cheap.connected.all()


def test_a_planar_pair_meets_a_line_along_its_plane_with_both_or_none(build_graph, change):
    """z-line 2 and y-line 3 can meet x-line 0 only, z-line 4 both x-lines: a plane along z costs edge (0, 2)."""
    lines = [RECTANGLE[0], RECTANGLE[1], RECTANGLE[2], (1, (2, 0, 1), 5, 7), RECTANGLE[3]]
    edges = [(0, 2), (1, 2), (0, 3), (1, 3), (0, 4), (1, 4)]
    graph = change(build_graph(lines, edges), possible=[True, False, True, False, True, True])
    cheap = solve(graph, options("boundary", "cycles", mu_planarity=0.4))
    assert cheap.connected.tolist() == [True, False, True, False, True, True]
    assert len(cheap.planar_pairs) == 0
    dear = solve(graph, options("boundary", "cycles", mu_planarity=0.6))
    assert dear.connected.tolist() == [False, False, True, False, True, True]
    assert dear.planar_pairs.tolist() == [[0, 1, 2], [2, 4, 1]]


@pytest.mark.parametrize(("mu", "crossings", "boundaries"), [(0.4, 3, 3), (0.6, 2, 1), (1.1, 1, 0)])
def test_crossings_are_given_up_for_lines_off_the_boundary_if_that_pays(corner, mu, crossings, boundaries):
    solution = solve(corner, options("cycles", "planarity", mu_boundary=mu))
    assert (solution.connected.sum(), solution.is_boundary.sum()) == (crossings, boundaries)


def test_boundary_flags_follow_the_crossings_with_the_family_off(corner):
    solution = solve(corner, options("cycles", "boundary"))
    assert solution.is_boundary.all()
    assert solution.objective == pytest.approx(3.0)


def test_collinear_edges_join_lines_of_one_axis_that_agree(build_graph):
    lines = [(0, (0, 6, 1), 1, 2), (0, (0, 6, 1), 2.5, 3), (2, (2.2, 6, 0), 0.5, 2)]
    graph = build_graph(lines, [(0, 1), (0, 2), (1, 2)])
    assert graph.kind.tolist() == ["collinear", "X", "X"]
    assert solve(graph, options()).connected.all()


def test_collinear_edges_are_fake_where_the_lines_lie_apart(build_graph, change):
    lines = [(0, (0, 6, 1), 1, 2), (0, (0, 6, 1), 2.5, 3), (2, (2.2, 6, 0), 0.5, 2)]
    graph = build_graph(lines, [(0, 1), (0, 2), (1, 2)])
    apart = change(graph, log_ratio=graph.log_ratio + np.array([0.1, 0, 0]))
    assert solve(apart, options()).connected.sum() == 2
