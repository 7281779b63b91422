"""Paths without a common line, against networkx on random graphs."""

import networkx as nx
from hypothesis import given, settings
from hypothesis import strategies as st

from linecad.decide.disjoint import disjoint_paths

pairs = st.sets(st.tuples(st.integers(0, 8), st.integers(0, 8)).filter(lambda pair: pair[0] < pair[1]), max_size=24)


def network(edges):
    net = nx.Graph()
    net.add_nodes_from(range(9))
    net.add_edges_from(edges)
    return net


@settings(max_examples=200)
@given(pairs, st.sets(st.integers(1, 8), min_size=1, max_size=5))
def test_paths_to_several_goals_end_apart(edges, goals):
    net = network(edges)
    # One node behind all goals, and no way from a goal to anything else: each goal then carries one path.
    behind = net.to_directed()
    behind.remove_edges_from([(goal, other) for goal in goals for other in net[goal]])
    behind.add_edges_from((goal, "sink") for goal in goals)
    expected = nx.node_connectivity(behind, 0, "sink")
    assert disjoint_paths(dict(net.adj), 0, goals, 20) == expected


@settings(max_examples=200)
@given(pairs)
def test_paths_to_one_joint_goal(edges):
    net = network(edges)
    direct = int(net.has_edge(0, 8))
    net.remove_edges_from([(0, 8)] * direct)
    expected = direct + nx.node_connectivity(net, 0, 8)
    net.add_edges_from([(0, 8)] * direct)
    assert disjoint_paths(dict(net.adj), 0, {8}, 20, joint=True) == expected


def test_no_more_paths_are_counted_than_asked():
    net = nx.complete_graph(6)
    assert disjoint_paths(dict(net.adj), 0, {1, 2, 3, 4, 5}, 2) == 2
