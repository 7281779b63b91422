"""The line graph against brute force and against the true depths of the made scene."""

from dataclasses import replace
from itertools import pairwise

import networkx as nx
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from shapely import LineString

from linecad.graph import build as graph_module
from linecad.graph.build import MAX_TOLERANCE, build_line_graph
from linecad.graph.connectivity import components, in_no_block, spanning_tree
from linecad.line_graph import ManhattanFrame, Segments
from linecad.options import SHORT_REACH
from linecad.scene import Camera

WIDE = Camera(3840, 2880, np.array([[3000.0, 0, 1919.5], [0, 3000, 1439.5], [0, 0, 1]]), "file")
FRONTAL = ManhattanFrame(np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]), 0.0, 1.0)  # x right, y away, z up
MARGIN = 1e-6  # px; crossings that hang on less are not asked for


def row_of(u, v, angle, length, axis):
    return (u, v, u + length * np.cos(angle), v + length * np.sin(angle), axis)


place = st.floats(0, 300)
segment = st.builds(row_of, place, place, st.floats(0, 6.28), st.floats(26, 200), st.integers(0, 2))


def graph_of(rows, extension=30.0):
    """The graph of rows (u0, v0, u1, v1, axis) in a photo at the reference width."""
    rows = np.array(rows, float)
    return build_line_graph(
        Segments(rows[:, :4].reshape(-1, 2, 2), rows[:, 4].astype(int)),
        WIDE,
        FRONTAL,
        replace(SHORT_REACH, extension=extension),
    )


def extended(row, by):
    ends = np.array(row[:4]).reshape(2, 2)
    along = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
    return LineString([ends[0] - by * along, ends[1] + by * along])


def sine_between(first, second):
    angles = [np.arctan2(row[3] - row[1], row[2] - row[0]) for row in (first, second)]
    return np.sin(angles[1] - angles[0])


@given(st.lists(segment, min_size=2, max_size=8), st.floats(6, 80))
def test_edges_are_the_crossings_that_brute_force_finds(rows, extension):
    expected, unsure = set(), set()
    for i in range(len(rows)):
        for j in range(i + 1, len(rows)):
            if rows[i][4] == rows[j][4]:
                continue
            if abs(sine_between(rows[i], rows[j])) < 1e-3:
                unsure.add((i, j))
            sure = extended(rows[i], extension - MARGIN).intersects(extended(rows[j], extension - MARGIN))
            maybe = extended(rows[i], extension + MARGIN).intersects(extended(rows[j], extension + MARGIN))
            assume(sure == maybe)
            if sure:
                expected.add((i, j))
    assert set(map(tuple, graph_of(rows, extension).edges.tolist())) ^ expected <= unsure


@given(segment, segment)
def test_a_crossing_lies_on_both_extended_segments(first, second):
    assume(abs(sine_between(first, second)) > 1e-2)
    graph = graph_of([first, second])
    for point, gap in zip(graph.crossing, graph.gap, strict=True):
        for k, own in enumerate((first, second)):
            assert extended(own, gap[k] + 1e-5).distance(LineString([point, point])) < 1e-5


CROSSINGS = [
    # the second segment against the first, which runs level from (100, 100) to (200, 100); kind; gaps
    ((150, 50, 150, 150), "X", (0, 0)),
    ((150, 100, 150, 200), "T", (0, 0)),
    ((150, 120, 150, 200), "T", (0, 20)),
    ((150, 95, 150, 200), "T", (0, 0)),
    ((100, 100, 100, 200), "L", (0, 0)),
    ((80, 115, 80, 200), "L", (20, 15)),
    ((205, 50, 205, 150), "T", (5, 0)),
]


@pytest.mark.parametrize(("other", "kind", "gap"), CROSSINGS)
def test_kinds_and_gaps_of_crossings(other, kind, gap):
    graph = graph_of([(100, 100, 200, 100, 0), (*other, 2)])
    assert graph.kind.tolist() == [kind]
    np.testing.assert_allclose(graph.gap[0], gap, atol=1e-9)
    assert graph.crossing[0].tolist() == [other[0], 100]


@pytest.mark.parametrize(("gap", "edges"), [(29, 1), (31, 0)])
def test_extension_is_the_longest_gap(gap, edges):
    assert len(graph_of([(100, 100, 200, 100, 0), (150, 100 + gap, 150, 200, 2)]).edges) == edges


def test_lengths_scale_with_the_width_of_the_photo():
    half = Camera(1920, 1440, WIDE.matrix, "file")
    segments = Segments([[[100, 100], [200, 100]], [[150, 120], [150, 200]]], [0, 2])
    assert len(build_line_graph(segments, WIDE, FRONTAL).edges) == 1
    assert len(build_line_graph(segments, half, FRONTAL).edges) == 0


def test_segments_of_one_axis_never_meet():
    assert len(graph_of([(100, 100, 200, 100, 0), (150, 50, 150, 150, 0)]).edges) == 0


def test_short_segments_are_no_nodes():
    assert len(graph_of([(100, 100, 200, 100, 0), (150, 100, 150, 120, 2)]).segments) == 1


def test_segments_without_crossings_have_no_edges():
    graph = graph_of([(100, 100, 200, 100, 0), (900, 100, 900, 200, 2)])
    assert (len(graph.segments), len(graph.edges)) == (2, 0)


def test_a_point_where_three_axes_meet_is_a_corner():
    rows = [(100, 100, 200, 100, 0), (100, 100, 100, 200, 2), (100, 100, 170, 170, 1)]
    assert graph_of(rows).corner.tolist() == [True] * 3
    assert graph_of(rows[:2]).corner.tolist() == [False]
    away = [*rows[:2], (180, 100, 230, 150, 1)]
    assert not graph_of(away).corner.any()


def test_weights_of_one_are_one():
    segments = Segments([[[100, 100], [200, 100]], [[150, 100], [150, 200]]], [0, 2])
    assert build_line_graph(segments, WIDE, FRONTAL, weights="ones").weight.tolist() == [1.0]


def test_log_ratios_of_real_crossings_are_those_of_the_true_depths(made):
    graph = made.graph()
    real = made.truly_real(graph)
    depth = np.array([made.depth_at(i, graph.segments.ends[i].mean(axis=0)) for i in range(len(graph.segments))])
    i, j = graph.edges[real].T
    assert len(i) > 60
    np.testing.assert_allclose(np.log(depth[i] / depth[j]), graph.log_ratio[real], atol=1e-9)


def test_log_ratio_of_a_fake_crossing_is_not_that_of_the_depths(made, depth_on):
    # A vertical of the near box moved before the front of the far one: it crosses its courses without meeting them.
    course = int(np.flatnonzero((made.axis == 0) & (made.box == 0))[1])
    middle = made.pixels[course].mean(axis=0)
    near = 0.5 * made.ends[course].mean(axis=0)
    ends = np.array([near - [0, 0, 0.5], near + np.array([0, 0, 0.5])]) @ (made.camera.matrix @ made.frame.rotation).T
    segments = Segments([made.pixels[course], ends[:, :2] / ends[:, 2:]], [0, 2])
    graph = build_line_graph(segments, made.camera, made.frame)
    assert len(graph.edges) == 1
    true = [
        made.depth_at(course, middle),
        depth_on(made.camera, made.frame.rotation, 2, near, segments.ends[1].mean(axis=0)),
    ]
    assert abs(np.log(true[0] / true[1]) - graph.log_ratio[0]) == pytest.approx(np.log(2), abs=1e-6)


def test_tolerance_is_three_standard_deviations_of_pixel_noise(made):
    graph = made.graph()
    sigma = graph_module.NOISE.px(made.camera.width)
    rng = np.random.default_rng(0)
    along = graph.segments.ends[:, 1] - graph.segments.ends[:, 0]
    normal = np.stack([-along[:, 1], along[:, 0]], axis=1) / np.linalg.norm(along, axis=1)[:, None]
    # Each draw turns the segments about their vanishing points: what matters here is how their middles move.
    draws = []
    inverse = np.linalg.inv(made.camera.matrix @ made.frame.rotation)
    middle = graph.segments.ends.mean(axis=1)
    i, j = graph.edges.T
    for _ in range(600):
        moved = middle + normal * rng.normal(0, sigma, len(middle))[:, None]
        rays = np.column_stack([moved, np.ones(len(moved))]) @ inverse.T
        draws.append(np.log(rays[j, graph.coordinate] / rays[i, graph.coordinate]))
    spread = 3 * np.std(draws, axis=0)
    loose = graph.tolerance > 2 * SHORT_REACH.least_tolerance
    assert loose.sum() > 20
    np.testing.assert_allclose(graph.tolerance[loose], spread[loose], rtol=0.2)
    assert graph.tolerance.min() >= SHORT_REACH.least_tolerance


def test_a_crossing_near_the_horizon_says_nothing_about_depth():
    # In coordinate z, both lines at nearly the height of the eye: half a pixel turns their ratio round.
    horizon = WIDE.matrix[1, 2]
    graph = graph_of([(1000, horizon + 1, 1500, horizon + 1, 0), (1000, horizon + 1.2, 1300, horizon + 0.8, 1)])
    assert graph.possible.tolist() == [True]
    assert graph.tolerance[0] > MAX_TOLERANCE
    assert graph.informative.tolist() == [False]


def test_a_crossing_beyond_the_horizon_is_impossible():
    # A line away from the camera below the eye, stretched past its vanishing point to a level line above the eye.
    u, v = WIDE.matrix[:2, 2]
    graph = graph_of([(u - 200, v - 5, u + 200, v - 5, 0), (u, v + 300, u, v + 4, 1)])
    assert graph.kind.tolist() == ["T"]
    assert graph.possible.tolist() == [False]
    assert graph.informative.tolist() == [False]
    assert graph.log_ratio.tolist() == [0.0]


def test_rays_belong_to_middles_and_ends(made):
    graph = made.graph()
    back = graph.end_rays @ (made.camera.matrix @ made.frame.rotation).T
    np.testing.assert_allclose(back[..., :2], made.pixels, atol=1e-9)
    np.testing.assert_allclose(graph.rays, graph.end_rays.mean(axis=1), atol=1e-12)


def test_components_are_those_of_the_two_boxes(made):
    parts = components(made.graph())
    assert [part.tolist() for part in parts] == [np.flatnonzero(made.box == box).tolist() for box in (0, 1)]


def test_components_over_chosen_edges_come_in_order_of_size_then_of_index(made):
    graph = made.graph()
    none = components(graph, np.zeros(len(graph.edges), bool))
    assert [part.tolist() for part in none] == [[i] for i in range(len(graph.segments))]
    first = np.zeros(len(graph.edges), bool)
    first[-1] = True
    parts = components(graph, first)
    assert parts[0].tolist() == sorted(graph.edges[-1].tolist())
    assert [part[0] for part in parts[1:]] == sorted(part[0] for part in parts[1:])


def test_it_does_not_matter_how_many_segments_are_compared_at_a_time(made, monkeypatch):
    at_once = build_line_graph(made.segments, made.camera, made.frame, collinear=True)
    monkeypatch.setattr(graph_module, "PAIRS", 1)
    row_by_row = build_line_graph(made.segments, made.camera, made.frame, collinear=True)
    assert len(at_once.edges)
    assert row_by_row.edges.tolist() == at_once.edges.tolist()
    assert row_by_row.crossing.tolist() == at_once.crossing.tolist()


@pytest.mark.parametrize("seed", range(5))
def test_spanning_tree_spans_with_the_least_residual(made, seed):
    graph = made.graph()
    rng = np.random.default_rng(seed)
    chosen = rng.random(len(graph.edges)) < 0.7
    residual = rng.random(len(graph.edges))
    tree = spanning_tree(graph, chosen, residual)
    assert not (tree & ~chosen).any()
    assert [part.tolist() for part in components(graph, tree)] == [part.tolist() for part in components(graph, chosen)]
    assert tree.sum() == len(graph.segments) - len(components(graph, chosen))
    for edge in np.flatnonzero(chosen & ~tree):  # the cycle property: no tree edge of its cycle is worse
        net = nx.Graph()
        for number in np.flatnonzero(tree):
            net.add_edge(*graph.edges[number].tolist(), number=number)
        path = nx.shortest_path(net, *graph.edges[edge].tolist())
        around = [net.edges[pair]["number"] for pair in pairwise(path)]
        assert residual[around].max() <= residual[edge]


def test_lines_on_one_crossing_are_hinged():
    # A rectangle of four lines, and a fifth that touches one of them.
    rows = [
        (100, 100, 200, 100, 0), (100, 200, 200, 200, 0), (100, 100, 100, 200, 2), (200, 100, 200, 200, 2),
        (150, 100, 190, 60, 1),
    ]  # fmt: skip
    graph = graph_of(rows)
    assert len(graph.edges) == 5
    assert in_no_block(5, graph.edges).tolist() == [False] * 4 + [True]
    assert in_no_block(5, graph.edges[:0]).all()
    assert in_no_block(5, graph.edges[1:]).all()
