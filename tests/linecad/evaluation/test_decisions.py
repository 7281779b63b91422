"""The paper's spanning-tree accuracy and the counts of crossings, by hand."""

import numpy as np
import pytest

from linecad.evaluation.decisions import GraphStatistics, compare, count
from linecad.evaluation.labels import FAKE, REAL, UNDECIDED
from linecad.line_graph import LineGraph, Segments


def graph_of(edges, lengths):
    """A graph of level segments of these lengths, axes in turn; only its topology means anything."""
    nodes, edges = len(lengths), np.array(edges)
    ends = [[[0.0, 10 * i], [length, 10 * i]] for i, length in enumerate(lengths)]
    none = np.zeros(len(edges))
    return LineGraph(
        segments=Segments(ends, np.arange(nodes) % 3), rays=np.ones((nodes, 3)), end_rays=np.ones((nodes, 2, 3)),
        edges=edges, crossing=np.zeros((len(edges), 2)), gap=np.zeros((len(edges), 2)), kind=["X"] * len(edges),
        corner=none, weight=none + 1, coordinate=none, log_ratio=none, tolerance=none + 0.01, possible=none == 0,
        informative=none == 0,
    )  # fmt: skip


# A triangle 0 1 2, a line 3 that hangs on it by two crossings, and a pair 4 5 apart.
EDGES = [(0, 1), (1, 2), (0, 2), (2, 3), (0, 3), (4, 5)]
LENGTHS = [10.0, 20, 30, 40, 500, 600]
RESIDUAL = np.array([0.1, 0.2, 0.3, 0.5, 0.4, 0.0])
LABEL = np.array([REAL, FAKE, REAL, REAL, UNDECIDED, FAKE])


def test_the_tree_takes_the_least_residuals_and_leaves_out_what_is_undecided():
    found = compare(graph_of(EDGES, LENGTHS), np.ones(6, bool), RESIDUAL, LABEL, 2400.0)
    # Kruskal takes 4-5 (fake), 0-1 (real), 1-2 (fake), then 0-3 (undecided); 0-2 and 2-3 would close cycles.
    assert (found.tree_real, found.tree_fake) == (1, 2)
    assert found.tree_share == pytest.approx(1 / 3)


def test_another_order_gives_another_tree():
    found = compare(graph_of(EDGES, LENGTHS), np.ones(6, bool), 1 - RESIDUAL, LABEL, 2400.0)
    # 2-3 (real), 0-3 (undecided), then 1-2 (fake): 0-2 would close a cycle; last 4-5.
    assert (found.tree_real, found.tree_fake) == (1, 2)
    chosen = np.array([True, False, True, True, False, False])
    found = compare(graph_of(EDGES, LENGTHS), chosen, RESIDUAL, LABEL, 2400.0)
    assert (found.tree_real, found.tree_fake) == (3, 0)


def test_crossings_are_counted_by_what_was_chosen():
    chosen = np.array([True, True, False, False, True, False])
    found = compare(graph_of(EDGES, LENGTHS), chosen, RESIDUAL, LABEL, 2400.0)
    assert (found.chosen_real, found.chosen_fake, found.missed_real) == (1, 1, 2)


def test_length_is_that_of_the_largest_tree():
    found = compare(graph_of(EDGES, LENGTHS), np.ones(6, bool), RESIDUAL, LABEL, 2400.0)
    assert (found.tied_length, found.total_length) == (100.0, 2400.0)


def test_nothing_chosen_is_no_tree():
    found = compare(graph_of(EDGES, LENGTHS), np.zeros(6, bool), RESIDUAL, LABEL, 2400.0)
    assert found.tree_share is None
    assert found.tied_length == 0
    assert found.missed_real == 3


def test_statistics_of_a_graph():
    assert count(graph_of(EDGES, LENGTHS), LABEL) == GraphStatistics(6, 6, 3, 2, 1)
