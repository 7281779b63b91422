"""Window grids that continue: storeys of one facade get the true scale, another facade does not."""

import numpy as np
import pytest

from linecad.geometry import project
from linecad.graph.build import build_line_graph
from linecad.line_graph import ManhattanFrame, Segments
from linecad.model.body_scales import ENOUGH, join_bodies
from linecad.model.window_grids import find_window_grid_cues
from linecad.scene import Camera

X, Y, Z = 0, 1, 2
GROWN = 0.4  # what the second body's free scale is, beside the true one
CAMERA = Camera(3840, 2880, np.array([[2000.0, 0, 1919.5], [0, 2000, 1439.5], [0, 0, 1]]), "file")
TURN = np.array([[np.cos(0.3), -np.sin(0.3), 0], [np.sin(0.3), np.cos(0.3), 0], [0, 0, 1]])
FRAME = ManhattanFrame(np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]) @ TURN, 0.0, 1.0)


def storey(wall, lefts, sill, head, width=1.1):
    """Four lines for each window of a storey in the plane y = wall."""
    lines = []
    for left in lefts:
        for at in (left, left + width):
            lines.append((Z, (at, wall, sill), (at, wall, head)))
        for at in (sill, head):
            lines.append((X, (left, wall, at), (left + width, wall, at)))
    return lines


def cues_between(first, second, noise=0.0):
    """The scale cues between two bodies, the second GROWN, its lines moved by `noise` px."""
    lines = first + second
    ends = project(np.array([line[1:] for line in lines], float), CAMERA.matrix, FRAME.rotation)
    ends = ends + noise * np.random.default_rng(1).normal(size=(len(lines), 1, 2))
    graph = build_line_graph(Segments(ends, [line[0] for line in lines]), CAMERA, FRAME)
    assert len(graph.segments) == len(lines)
    offset = np.array([line[1] for line in lines], float)
    offset[len(first) :] *= GROWN
    offset[np.arange(len(lines)), graph.axis] = np.nan
    bodies = [np.arange(len(first)), np.arange(len(first), len(lines))]
    return find_window_grid_cues(graph, CAMERA, FRAME.rotation, bodies, offset)


LEFTS = [-4.0, -1.3, 1.0, 3.9]
BELOW = storey(14.0, LEFTS, -0.5, 1.2)


@pytest.mark.parametrize("noise", [0.0, 0.7])
def test_storeys_of_one_facade_have_one_scale(noise):
    joined = join_bodies(cues_between(BELOW, storey(14.0, LEFTS, 4.0, 6.1), noise), 2)
    assert joined.group.tolist() == [0, 0]
    assert joined.log_scale[1] == pytest.approx(-np.log(GROWN), abs=1e-6)


def test_windows_of_one_row_have_one_scale():
    left, right = storey(14.0, LEFTS[:2], -0.5, 1.2), storey(14.0, LEFTS[2:], -0.5, 1.2)
    cues = cues_between(left, right)
    assert cues.seen.tolist() == [2]
    assert cues.log_ratio == pytest.approx(-np.log(GROWN), abs=1e-6)


def test_each_image_line_counts_once():
    assert cues_between(BELOW, storey(14.0, LEFTS, 4.0, 6.1)).seen.tolist() == [2 * len(LEFTS)]


def test_a_facade_behind_with_windows_of_its_own_has_another_scale():
    behind = storey(23.0, [-8.3, -4.9, -0.7, 2.9], 6.3, 9.0, 1.4)
    assert all(cues_between(BELOW, behind).evidence < ENOUGH)


def test_bodies_without_a_common_normal_have_scales_of_their_own():
    side = [(Z, (9.0, at, 3.0), (9.0, at, 6.0)) for at in (11.0, 12.0, 13.0)]
    side += [(Y, (9.0, 11.0, at), (9.0, 13.0, at)) for at in (3.0, 6.0)]
    assert len(cues_between(BELOW, side).bodies) == 0
