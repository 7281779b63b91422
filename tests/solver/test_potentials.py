import numpy as np
import pytest

from solver.depths import end_ratios, near_log_ratio
from solver.potentials import fit_near_depths


def fit(graph, connected, depth_range=100.0):
    step = near_log_ratio(graph, end_ratios(graph))
    guess = np.zeros(len(graph.segments))
    return fit_near_depths(graph, step, np.asarray(connected, bool), np.log(depth_range), guess), step


def test_depths_fit_every_connected_edge_and_the_range(street):
    """A spanning tree of the street fits whatever its ratios, but for the range."""
    tree, met = [], {0}
    for i, j in street.edges.tolist():
        tree.append((i in met) != (j in met))
        met |= {i, j} if tree[-1] else set()
    tree = np.array(tree) & street.possible
    found, step = fit(street, tree, depth_range=1e6)
    i, j = street.edges[tree].T
    off = np.abs(found.near[i] - found.near[j] - step[tree])
    assert tree.sum() > 20
    assert len(found.contradiction) == 0
    assert (off <= street.tolerance[tree] + 1e-6).all()
    assert found.near.min() >= -1e-6
    assert found.near.max() <= np.log(1e6) + 1e-6


def test_a_contradiction_is_the_cycle_and_nothing_besides(build_graph):
    """A corner of which one ratio is off by 1, and two lines more that hang on it."""
    lines = [
        (0, (0, 5, 2), 1, 3),
        (1, (1, 0, 2), 5, 7),
        (2, (1, 5, 0), -1, 2),
        (1, (3, 0, 2), 5, 7),
        (2, (3, 5, 0), 1, 2),
    ]
    edges = [(0, 3), (0, 1), (0, 2), (1, 2), (3, 4)]
    graph = build_graph(lines, edges)
    assert len(fit(graph, [True] * 5)[0].contradiction) == 0
    wrong = build_graph([*lines[:2], (2, (1, 8, 0), -1, 2), *lines[3:]], edges)
    assert fit(wrong, [True] * 5)[0].contradiction.tolist() == [1, 2, 3]
    assert len(fit(wrong, [True, True, False, True, True])[0].contradiction) == 0


def test_a_path_too_long_for_the_depth_range_is_a_contradiction(build_graph):
    """From depth 4 by a y-line to 7 and by another to 12; a z-line hangs on the first."""
    lines = [
        (1, (1, 0, 1), 4, 7.2),
        (0, (0, 7, 1), 0, 1),
        (1, (0.5, 0, 1), 6.9, 12.1),
        (0, (0, 12, 1), 0, 1),
        (2, (1, 5, 0), 1, 2),
    ]
    graph = build_graph(lines, [(0, 1), (1, 2), (2, 3), (0, 4)], yaw=0.0, pitch=0.05)
    assert len(fit(graph, [True] * 4, depth_range=3.2)[0].contradiction) == 0
    assert fit(graph, [True] * 4, depth_range=2.7)[0].contradiction.tolist() == [0, 1, 2]


@pytest.mark.parametrize("silent", [0, 1, 2])
def test_an_edge_that_says_nothing_contradicts_nothing(build_graph, silent):
    lines = [(0, (0, 5, 2), 1, 3), (1, (1, 0, 2), 5, 7), (2, (1, 8, 0), -1, 2)]
    informative = [e != silent for e in range(3)]
    assert len(fit(build_graph(lines), [True] * 3)[0].contradiction) == 3
    assert len(fit(build_graph(lines, informative=informative), [True] * 3)[0].contradiction) == 0
