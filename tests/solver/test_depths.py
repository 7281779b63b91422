import numpy as np
import pytest

from solver.depths import end_ratios, near_log_ratio

LINES = [(0, (0, 5, 2), 1, 3), (1, (1, 0, 2), 5, 17), (2, (1, 5, 0), -1, 2)]


def test_inverse_depths_of_the_ends_average_to_that_of_the_middle(build_graph):
    """Inverse depth is linear along an image line, whatever the line in space."""
    ratios = end_ratios(build_graph(LINES))
    assert (1 / ratios).mean(axis=1) == pytest.approx(1.0, rel=1e-12)


def test_the_ends_differ_in_nothing_but_the_lines_own_coordinate(build_graph):
    graph = build_graph(LINES)
    points = end_ratios(graph)[:, :, None] * graph.end_rays
    for i, (axis, point, low, high) in enumerate(LINES):
        one, other = points[i]
        assert np.delete(one - other, axis) == pytest.approx(0.0, abs=1e-12)
        scale = np.linalg.norm(np.delete(np.array(point, float), axis)) / np.linalg.norm(np.delete(one, axis))
        assert points[i, :, axis] * scale == pytest.approx([low, high], rel=1e-9)


def test_a_segment_beside_its_vanishing_point_is_refused(corner, change):
    bent = corner.end_rays.copy()
    bent[1, 0, 0] += 1e-3
    with pytest.raises(ValueError, match=r"segment 1 .* misses the vanishing point"):
        end_ratios(change(corner, end_rays=bent))


def test_a_segment_that_ends_in_its_vanishing_point_is_refused(corner, change):
    ends = corner.end_rays.copy()
    ends[2, 1] = [0.0, 0.0, 1.0]
    with pytest.raises(ValueError, match=r"segment 2 .* ends in the vanishing point"):
        end_ratios(change(corner, end_rays=ends))


def test_lines_that_meet_have_near_ends_at_their_true_depths(build_graph):
    graph = build_graph(LINES)
    true = []  # depth of the nearer end, by the camera's view axis
    view = np.linalg.lstsq(graph.end_rays.reshape(-1, 3), np.ones(6), rcond=None)[0]
    for axis, point, low, high in LINES:
        ends = np.array([point, point], float)
        ends[:, axis] = low, high
        true.append((ends @ view).min())
    true = np.log(true)
    step = near_log_ratio(graph, end_ratios(graph))
    assert step == pytest.approx([true[i] - true[j] for i, j in graph.edges], abs=1e-12)
