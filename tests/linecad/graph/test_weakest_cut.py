"""The weakest cut: its conductance is what it says, bridges are found, heavy edges stay, no side is too small."""

import networkx as nx
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from linecad.graph import weakest_cut as module
from linecad.graph.weakest_cut import weakest_cut


def conductance(count, edges, weight, side):
    graph = nx.Graph()
    graph.add_nodes_from(range(count))
    for (one, other), own in zip(edges.tolist(), weight.tolist(), strict=True):
        before = graph.get_edge_data(one, other, {"weight": 0.0})["weight"]
        graph.add_edge(one, other, weight=before + own)
    return nx.conductance(graph, np.flatnonzero(side).tolist(), weight="weight")


def cliques(*sizes, bridges=1, seed=0):
    """Cliques in a row, each joined to the next by so many edges, their nodes in random order."""
    edges, start = [], 0
    for number, size in enumerate(sizes):
        edges += [(start + i, start + j) for i in range(size) for j in range(i)]
        if number:
            edges += [(start + k, start - 1 - k) for k in range(bridges)]
        start += size
    new = np.random.default_rng(seed).permutation(start)
    return (
        start,
        new[np.array(edges)],
        [set(new[sum(sizes[:k]) : sum(sizes[: k + 1])].tolist()) for k in range(len(sizes))],
    )


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("sizes", [(6, 9), (12, 12), (70, 80)])
def test_two_cliques_part_at_their_bridge(sizes, seed):
    count, edges, groups = cliques(*sizes, bridges=2, seed=seed)
    side, found = weakest_cut(count, edges, np.ones(len(edges)), 3)
    assert set(np.flatnonzero(side).tolist()) in groups
    assert found == pytest.approx(2 / (min(sizes) * (min(sizes) - 1) + 2))


def test_heavy_edges_are_not_cut():
    count, edges, groups = cliques(8, 8, 8, seed=1)
    between = [
        len({number for number, own in enumerate(groups) for node in edge if node in own}) > 1
        for edge in edges.tolist()
    ]
    weight = np.ones(len(edges))
    heavy, light = np.flatnonzero(between)
    weight[heavy] = 30.0
    side, found = weakest_cut(count, edges, weight, 3)
    assert len({bool(side[node]) for node in edges[heavy].tolist()}) == 1
    assert len({bool(side[node]) for node in edges[light].tolist()}) == 2
    assert found == pytest.approx(conductance(count, edges, weight, side))


@given(st.integers(8, 40), st.integers(0, 60), st.integers(0, 1000))
def test_conductance_is_that_of_the_cut_and_no_side_is_too_small(count, more, seed):
    random = np.random.default_rng(seed)
    tree = np.column_stack([np.arange(1, count), [random.integers(0, node) for node in range(1, count)]])
    extra = random.integers(0, count, (more, 2))
    edges = np.concatenate([tree, extra[extra[:, 0] != extra[:, 1]]])
    weight = random.uniform(0.5, 5.0, len(edges))
    side, found = weakest_cut(count, edges, weight, 4)
    assert min(side.sum(), (~side).sum()) >= 4
    assert found == pytest.approx(conductance(count, edges, weight, side))
    again, _ = weakest_cut(count, edges, weight, 4)
    assert (side == again).all()


@pytest.mark.parametrize("seed", range(3))
def test_the_sparse_way_finds_what_the_dense_one_does(monkeypatch, seed):
    count, edges, _ = cliques(30, 40, 20, bridges=3, seed=seed)
    weight = np.random.default_rng(seed).uniform(1.0, 4.0, len(edges))
    dense, one = weakest_cut(count, edges, weight, 5)
    monkeypatch.setattr(module, "DENSE", 10)
    sparse, other = weakest_cut(count, edges, weight, 5)
    assert one == pytest.approx(other)
    assert (dense == sparse).all() or (dense == ~sparse).all()


def test_few_nodes_are_not_parted():
    count, edges, _ = cliques(4, 3)
    assert weakest_cut(count, edges, np.ones(len(edges)), 4) is None
    assert weakest_cut(count, edges, np.ones(len(edges)), 3) is not None
