"""Biconnected blocks: a near edge before a far wall joins nothing, a true corner is kept."""

from itertools import combinations

import networkx as nx
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from linecad.decide.blocks import biconnected_blocks, find_blocks
from linecad.decide.bodies import agreeing as all_agreeing
from linecad.geometry import project
from linecad.graph.build import build_line_graph
from linecad.graph.connectivity import in_no_block
from linecad.line_graph import ManhattanFrame, Segments
from linecad.scene import Camera

X, Y, Z = 0, 1, 2
COURSES = [-1.6, -0.5, 0.7, 1.9, 3.1]  # z of the horizontal lines of a wall


def wall(normal, place, across, up=COURSES, until=None):
    """A grid of verticals and courses in one plane; the courses go on `until` there, where there is no vertical."""
    other = 1 - normal

    def point(along, height):
        found = np.empty(3)
        found[[normal, other, Z]] = place, along, height
        return found

    verticals = [(Z, point(at, up[0]), point(at, up[-1])) for at in across]
    ends = across[0], (across[-1] if until is None else until)
    return verticals + [(other, point(ends[0], height), point(ends[1], height)) for height in up]


def graph_of(lines):
    camera = Camera(3840, 2880, np.array([[2000.0, 0, 1919.5], [0, 2000, 1439.5], [0, 0, 1]]), "file")
    turn = np.array([[np.cos(0.3), -np.sin(0.3), 0], [np.sin(0.3), np.cos(0.3), 0], [0, 0, 1]])
    frame = ManhattanFrame(np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]) @ turn, 0.0, 1.0)
    ends = np.array([line[1:] for line in lines])
    segments = Segments(project(ends, camera.matrix, frame.rotation), [line[0] for line in lines])
    graph = build_line_graph(segments, camera, frame, collinear=True)
    assert len(graph.segments) == len(lines)
    return graph


def agreeing(graph, depth):
    """The crossings that say what these depths (N,) say."""
    i, j = graph.edges.T
    return graph.informative & (np.abs(np.log(depth[i] / depth[j]) - graph.log_ratio) < 1e-6)


def depths(graph, lines):
    rays = graph.rays.copy()
    rays[np.arange(len(lines)), graph.axis] = 0
    there = np.array([line[1] for line in lines])
    return (rays * there).sum(axis=1) / (rays**2).sum(axis=1)


@pytest.fixture
def near_and_far():
    """A near wall whose left edge hides the courses of a far one: in the photo they end on that edge."""
    near = wall(Y, 8.0, [1.0, 2.0, 3.0, 4.0])
    far = wall(Y, 16.0, [-6.0, -4.0, -2.0, -0.5], up=[-3.0, -1.5, 0.5, 2.5, 5.0], until=2.0)
    return near, far


def test_a_near_edge_before_a_far_wall_is_refused(near_and_far):
    near, far = near_and_far
    lines = near + far
    graph = graph_of(lines)
    depth = depths(graph, lines)
    depth[len(near) :] /= 2  # the far wall in the plane of the near one, as its five crossings with the edge say
    chosen = agreeing(graph, depth)
    edge, courses = 0, np.arange(len(lines)) >= len(near) + 4
    fakes = chosen & (graph.edges[:, 0] == edge) & courses[graph.edges[:, 1]]
    assert fakes.sum() == 5
    found = find_blocks(graph, chosen)
    assert found.count == 2
    assert not found.joins(graph)[fakes].any()
    assert len(set(found.body[: len(near)])) == len(set(found.body[len(near) :])) == 1


def test_a_true_corner_is_kept():
    front, side = wall(Y, 8.0, [-4.0, -3.0, -2.0, -1.0]), wall(X, -1.0, [8.0, 9.0, 10.5, 12.5])
    lines = front + side[1:]  # the corner stands once
    graph = graph_of(lines)
    found = find_blocks(graph, agreeing(graph, depths(graph, lines)))
    assert found.count == 1
    assert (found.body == 0).all()


def test_courses_at_a_corner_connect_it_though_not_chosen():
    front, side = wall(Y, 8.0, [-4.0, -3.0, -2.0, -1.0]), wall(X, -1.0, [8.0, 9.0, 10.5, 12.5])
    lines = front + side[1:]
    graph = graph_of(lines)
    depth = depths(graph, lines)
    chosen = agreeing(graph, depth) & (graph.coordinate != Z)  # no crossing of two courses
    assert find_blocks(graph, chosen).count == 2
    assert find_blocks(graph, all_agreeing(graph, chosen, np.log(depth))).count == 1


def test_a_corner_without_matching_courses_is_two_bodies():
    front = wall(Y, 8.0, [-4.0, -3.0, -2.0, -1.0])
    side = wall(X, -1.0, [8.0, 9.0, 10.5, 12.5], up=[-1.1, 0.1, 1.3, 2.5])
    lines = front + side[1:]
    graph = graph_of(lines)
    assert find_blocks(graph, agreeing(graph, depths(graph, lines))).count == 2


def test_pieces_of_one_line_make_one_body_of_two():
    left, right = wall(Y, 8.0, [-4.0, -3.2, -2.4, -1.6]), wall(Y, 8.0, [-1.4, -0.6, 0.2, 1.0])
    lines = left + right
    graph = graph_of(lines)
    within = (graph.edges < len(left)).sum(axis=1) != 1
    pieces = (graph.kind == "collinear") & ~within
    one = np.zeros(len(graph.edges), bool)
    one[np.flatnonzero(pieces)[0]] = True
    chosen = graph.informative & (graph.kind != "collinear") & within
    assert find_blocks(graph, chosen).count == 2
    assert find_blocks(graph, chosen | one).count == 1


def test_a_few_lines_may_hang_on_a_body():
    grid = wall(Y, 8.0, [-4.0, -3.0, -2.0, -1.0])
    lines = [*grid, (Y, np.array([-1.0, 8.0, 1.3]), np.array([-1.0, 11.0, 1.3]))]
    graph = graph_of(lines)
    found = find_blocks(graph, agreeing(graph, depths(graph, lines)))
    assert (found.body == 0).all()
    assert found.rigid.tolist() == [True] * len(grid) + [False]


def test_a_graph_without_a_body_stays_together():
    lines = wall(Y, 8.0, [-4.0, -2.5, -1.0], up=[-1.6, 1.9])[:4]  # three uprights on one course
    graph = graph_of(lines)
    found = find_blocks(graph, graph.informative)
    assert found.count == 0
    assert found.joins(graph).all()
    assert not found.rigid.any()


edges_of_a_graph = st.sets(
    st.tuples(st.integers(0, 9), st.integers(0, 9)).filter(lambda pair: pair[0] < pair[1]), max_size=30
)


@settings(max_examples=settings.default.max_examples * 3 // 2)
@given(edges_of_a_graph)
def test_no_single_line_parts_two_lines_of_a_block(edges):
    net = nx.Graph(sorted(edges))
    for block in biconnected_blocks(np.array(sorted(edges), np.int64).reshape(-1, 2)):
        for one, other in combinations(sorted(block), 2):
            for gone in sorted(set(net) - {one, other}):
                assert nx.has_path(net.subgraph(set(net) - {gone}), one, other)


@given(edges_of_a_graph)
def test_what_no_block_holds_depends_on_one_edge(edges):
    net = nx.Graph(sorted(edges))
    blocks = biconnected_blocks(np.array(sorted(edges), np.int64).reshape(-1, 2))
    bridges = set(nx.bridges(net)) if len(net) else set()
    for line in net:
        if not any(line in block for block in blocks):
            assert all((line, other) in bridges or (other, line) in bridges for other in net[line])


@given(edges_of_a_graph)
def test_lines_in_no_block_are_found_without_the_blocks(edges):
    pairs = np.array(sorted(edges), np.int64).reshape(-1, 2)
    inside = set().union(*biconnected_blocks(pairs))
    assert in_no_block(10, pairs).tolist() == [line not in inside for line in range(10)]
