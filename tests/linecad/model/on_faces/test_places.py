"""Stretches of segments on faces, and where they are in space."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from linecad.directions import directions_of, frame_axes
from linecad.geometry import central_camera, project
from linecad.line_graph import Segments
from linecad.lines.details import LEAST_STRETCH
from linecad.model.on_faces.places import GAP, STEP, Samples, can_lie, in_space, stretches
from linecad.model.on_faces.seen import NO_FACE, SeenFaces
from linecad.scene import Camera, Face, Plane

WIDTH, HEIGHT = 1600, 1200
CAMERA = Camera(WIDTH, HEIGHT, central_camera(1200.0, WIDTH, HEIGHT), "file")
AHEAD = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
TURNS = (0.3,)


def test_places_are_spread_evenly_over_each_segment():
    ends = np.array([[[0.0, 0], [100, 0]], [[5, 5], [5, 6]]])
    samples = Samples.of(ends, WIDTH)
    assert np.bincount(samples.row).tolist() == [int(100 / STEP.px(WIDTH)), 2]
    long = samples.pixel[samples.row == 0]
    np.testing.assert_allclose(np.diff(long[:, 0]), 100 / len(long))
    np.testing.assert_allclose(long[[0, -1], 0].sum(), 100)
    np.testing.assert_allclose(samples.pixel[samples.row == 1], [[5, 5.25], [5, 5.75]])


def runs_by_hand(shows):
    """Stretches of one face as (face, first, last), by looking at every place."""
    found = []
    for face in sorted(set(shows) - {NO_FACE}):
        first = last = None
        for place, each in enumerate(shows):
            if each == face:
                if last is not None and place - last > GAP + 1:
                    found.append((face, first, last))
                    first = place
                first = place if first is None else first
                last = place
        found.append((face, first, last))
    return found


@given(shows=st.lists(st.integers(NO_FACE, 2), min_size=40, max_size=40))
def test_stretches_are_the_runs_of_places_that_show_one_face(shows):
    length = 40 * STEP.px(WIDTH) + 0.01
    segments = Segments(np.array([[[0.0, 7], [length, 7]]]), np.array([0]))
    samples = Samples.of(segments.ends, WIDTH)
    found = stretches(samples, np.array(shows), segments, WIDTH)
    step = length / 40
    wanted = [each for each in runs_by_hand(shows) if (each[2] - each[1] + 1) * step >= LEAST_STRETCH.px(WIDTH)]
    assert found.face.tolist() == [face for face, _, _ in wanted]
    placed = found.segments(segments).ends
    np.testing.assert_allclose(placed[:, 0, 0], [first * step for _, first, _ in wanted], atol=1e-9)
    np.testing.assert_allclose(placed[:, 1, 0], [(last + 1) * step for _, _, last in wanted], atol=1e-9)


def test_a_line_lies_in_planes_across_its_axis_only():
    axis, normal = np.array([0, 0, 2, 2, 0, 3]), np.array([1, 0, 1, 2, -1, 4])
    assert can_lie(axis, normal).tolist() == [True, False, True, False, False, True]


@pytest.mark.parametrize(("turns", "frame"), [((), 0), (TURNS, 0), (TURNS, 1)])
@pytest.mark.parametrize("letter", [0, 2])
def test_a_line_comes_back_where_it_was_on_its_wall(turns, frame, letter):
    """A line in a wall is drawn in the photo, and found on the wall again, exactly in its plane and along its axis."""
    vectors, axes = directions_of(turns), frame_axes(frame)
    corner = vectors[axes[1]] * 9.0 + vectors[2] * 0.7 + vectors[axes[0]] * 0.4
    ends = np.stack([corner, corner + vectors[axes[letter]] * 1.5])
    offset = 9.0
    sides = [corner + u * vectors[axes[0]] + v * vectors[2] for u, v in ((-5, -3), (5, -3), (5, 3), (-5, 3))]
    wall = Plane(2, axes[1], offset, (), (Face(0, np.array(sides), kind="wall"),))
    seen = SeenFaces.of((wall,), CAMERA, AHEAD, turns)
    segments = Segments(project(ends, CAMERA.matrix, AHEAD)[None], np.array([axes[letter]]))
    placed, frames = in_space(segments, np.array([0]), seen, AHEAD, turns)
    assert frames.tolist() == [frame]
    local = np.array([vectors[axis] for axis in axes])
    np.testing.assert_allclose(placed[0] @ local, ends, atol=1e-9)
    other = 2 - letter
    assert placed[0, :, 1].tolist() == [offset, offset]
    assert placed[0, 0, other] == placed[0, 1, other]
