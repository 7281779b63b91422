"""The robust fit: true depths in spite of fakes, groups, and the answer that is made of it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from linecad.errors import SolverError
from linecad.line_graph import LineGraph, Segments
from solver.options import SolveOptions
from solver.robust import SLACK, RobustFit, agreeing_with
from solver.solve import solve


def random_graph(lines, edges, fakes, seed):
    """A connected graph of lines of random depths; the last `fakes` of its edges are off by 0.1 to 1 in log depth."""
    random = np.random.default_rng(seed)
    axis = np.arange(lines) % 3
    tree = [(int(random.integers(k)), k) for k in range(1, lines)]
    tree = [(i, j) if axis[i] != axis[j] else (j - 1, j) for i, j in tree]
    every = [(i, j) for i in range(lines) for j in range(i + 1, lines) if axis[i] != axis[j]]
    others = [every[k] for k in random.permutation(len(every)) if every[k] not in tree][: edges - len(tree) + fakes]
    pairs = np.array(tree + others)
    depth = random.uniform(-0.5, 0.5, lines)
    off = np.zeros(len(pairs))
    if fakes:
        off[-fakes:] = random.uniform(0.1, 1.0, fakes) * random.choice([-1, 1], fakes)
    count = len(pairs)
    yes = np.ones(count, bool)
    graph = LineGraph(
        segments=Segments(np.tile([[0.0, 0.0], [9.0, 0.0]], (lines, 1, 1)), axis),
        rays=np.ones((lines, 3)),
        end_rays=np.ones((lines, 2, 3)),
        edges=pairs,
        crossing=np.zeros((count, 2)),
        gap=np.zeros((count, 2)),
        kind=np.full(count, "X"),
        corner=~yes,
        weight=np.ones(count),
        coordinate=3 - axis[pairs].sum(axis=1),
        log_ratio=depth[pairs[:, 0]] - depth[pairs[:, 1]] + off,
        tolerance=np.full(count, 0.003),
        possible=yes,
        informative=yes,
    )
    return graph, depth, off == 0


def spread(found, true):
    """How far found log depths are from true ones after one scale."""
    return float(np.abs(found - true - np.median(found - true)).max())


@given(st.integers(0, 10**6))
def test_without_fakes_the_depths_are_exact(seed):
    graph, depth, _ = random_graph(12, 24, 0, seed)
    assert spread(RobustFit(graph).depths(), depth) < 1e-6


@pytest.mark.parametrize("seed", range(8))
def test_scattered_fakes_do_not_pull(seed):
    graph, depth, real = random_graph(40, 240, 30, seed)
    found = RobustFit(graph).depths()
    assert spread(found, depth) < 1e-3
    assert (agreeing_with(graph, found) == real).all()


def test_least_squares_would_have_been_pulled():
    graph, depth, _ = random_graph(40, 240, 30, 0)
    incidence = np.zeros((len(graph.edges), 40))
    incidence[np.arange(len(graph.edges)), graph.edges[:, 0]] = 1
    incidence[np.arange(len(graph.edges)), graph.edges[:, 1]] = -1
    assert spread(np.linalg.lstsq(incidence, graph.log_ratio)[0], depth) > 0.02


def test_an_edge_without_weight_has_no_say():
    graph, depth, real = random_graph(12, 24, 20, 3)
    assert spread(RobustFit(graph).depths(np.where(real, 1.0, 0.0)), depth) < 1e-6


def test_groups_that_nothing_ties_are_both_fitted():
    graph, _, _ = random_graph(20, 60, 0, 5)
    inside = (graph.edges < 10).all(axis=1) | (graph.edges >= 10).all(axis=1)
    weight = inside.astype(float)
    found = RobustFit(graph).depths(weight)
    agrees = np.abs(found[graph.edges[:, 0]] - found[graph.edges[:, 1]] - graph.log_ratio) < 1e-6
    assert agrees[inside].all()
    assert np.isfinite(found).all()


def test_a_graph_without_crossings_has_depths():
    graph, _, _ = random_graph(6, 5, 0, 0)
    assert RobustFit(graph).depths(np.zeros(len(graph.edges))).tolist() == [0.0] * 6


def test_the_fit_is_the_same_every_time():
    graph, _, _ = random_graph(40, 240, 30, 2)
    assert (RobustFit(graph).depths() == RobustFit(graph).depths()).all()


def test_a_fast_answer_says_what_it_is(alley):
    graph = alley
    found = solve(graph, SolveOptions(fast=True))
    assert found.status == "robust fit"
    assert found.gap == found.bound == np.inf
    assert found.objective == pytest.approx(graph.weight[found.connected].sum())
    i, j = graph.edges.T
    off = np.abs(found.log_depth[i] - found.log_depth[j] - graph.log_ratio)
    told = found.connected & graph.informative
    assert told.any()
    assert (off[told] <= np.maximum(graph.tolerance[told], SLACK)).all()


def test_a_fast_answer_takes_no_word_about_crossings(alley):
    with pytest.raises(SolverError, match="fast"):
        solve(alley, SolveOptions(fast=True, real=(0,)))


def test_the_paper_has_no_fast_answer():
    with pytest.raises(SolverError, match="paper"):
        SolveOptions(fast=True, formulation="paper")
