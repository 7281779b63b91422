"""Planes that crossings left apart become one where the noise cannot tell them apart, and only there."""

import numpy as np
import pytest
from scipy.sparse import eye_array

from linecad.geometry import project
from linecad.graph.build import build_line_graph
from linecad.line_graph import ManhattanFrame, Segments
from linecad.model.lifting import lift
from linecad.model.plane_merging import find_merges
from linecad.scene import Camera

CAMERA = Camera(3840, 2880, np.array([[2500.0, 0, 1919.5], [0, 2500, 1439.5], [0, 0, 1]]), "file")
FRAME = ManhattanFrame(np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]), 0.0, 1.0)


def window(left, right, place):
    """Edges of a rectangle that faces the camera, as (axis, start, end)."""
    low, high = -1.5, 1.5
    across = [(0, (left, place, z), (right, place, z)) for z in (low, high)]
    return across + [(2, (x, place, low), (x, place, high)) for x in (left, right)]


def two_windows(first, second):
    """The windows stand in planes `first` and `second`; a bay before them ties the two."""
    bay = [
        (1, (-1, 7, -1.5), (-1, first, -1.5)),
        (0, (-1, 7, -1.5), (1, 7, -1.5)),
        (1, (1, 7, -1.5), (1, second, -1.5)),
    ]
    rows = window(-4, -1, first) + window(1, 4, second) + bay
    axis = np.array([row[0] for row in rows])
    ends = np.array([row[1:] for row in rows], float)
    return axis, ends


def lifted_windows(first, second):
    axis, ends = two_windows(first, second)
    pixels = project(ends, CAMERA.matrix, FRAME.rotation)
    graph = build_line_graph(Segments(pixels, axis), CAMERA, FRAME)
    assert len(graph.segments) == len(axis)
    i, j = graph.edges.T
    chosen = np.abs(ends[i, 0, graph.coordinate] - ends[j, 0, graph.coordinate]) < 1e-9
    rays = graph.rays * (np.arange(3) != axis[:, None])
    depth = np.log((rays * ends[:, 0]).sum(axis=1) / (rays**2).sum(axis=1))
    return graph, chosen, depth, lift(graph, chosen, depth)


FIRST, SECOND = slice(0, 4), slice(4, 8)


@pytest.mark.parametrize("apart", [0.0, 0.02])
def test_planes_within_the_noise_become_one_offset_bit_for_bit(apart):
    *_, lifted = lifted_windows(10.0, 10.0 + apart)
    assert len(np.unique(lifted.offset[:8, 1])) == 1
    assert len(np.unique(lifted.shared[:8, 1])) == 1


def test_merged_lines_stay_where_they_are_seen():
    graph, *_, lifted = lifted_windows(10.0, 10.02)
    back = project(lifted.ends, CAMERA.matrix, FRAME.rotation)
    assert np.abs(back - graph.segments.ends).max() < 1.0


@pytest.mark.parametrize("apart", [0.5, 1.0])
def test_planes_further_apart_than_the_noise_stay_two(apart):
    *_, lifted = lifted_windows(10.0, 10.0 + apart)
    ratio = lifted.offset[SECOND, 1].mean() / lifted.offset[FIRST, 1].mean()
    assert ratio == pytest.approx(1 + apart / 10, rel=1e-6)


def merges(first, second, component=None, loose=1e-9):
    graph, chosen, depth, _ = lifted_windows(first, second)
    shared = np.arange(3 * len(graph.segments)).reshape(-1, 3)
    shared[FIRST, 1], shared[SECOND, 1] = 1000, 1001
    shared[np.arange(len(shared)), graph.axis] = -1
    count = len(graph.segments)
    group = np.zeros(count, np.int64) if component is None else component
    normal = loose * eye_array(count, format="csr")
    return find_merges(graph, chosen, group, shared, depth, normal)


def test_what_little_ties_is_merged_up_to_a_limit_only():
    assert len(merges(10.0, 10.1).axis) == 1
    assert len(merges(10.0, 10.2).axis) == 0
    assert len(merges(10.0, 10.1, loose=1e9).axis) == 0


def test_groups_of_lines_with_scales_of_their_own_are_not_merged():
    component = np.array([0] * 4 + [1] * 4 + [0] * 3)
    assert len(merges(10.0, 10.0, component).axis) == 0


def test_a_line_from_one_plane_to_the_other_keeps_them_two():
    graph, chosen, depth, _ = lifted_windows(10.0, 10.0)
    shared = np.arange(3 * len(graph.segments)).reshape(-1, 3)
    shared[FIRST, 1], shared[SECOND, 1] = 1000, 1001
    shared[np.arange(len(shared)), graph.axis] = -1
    # The line along the normal that starts at the first window, as if it ended at the second.
    shared[10, 1] = 1001
    normal = 1e-9 * eye_array(len(shared), format="csr")
    component = np.zeros(len(shared), np.int64)
    assert len(find_merges(graph, chosen, component, shared, depth, normal).axis) == 0
