"""Segments of a facade are along one direction, whatever a short one by itself looks like."""

import numpy as np
from numpy.testing import assert_array_equal

from linecad.camera.frame_labels import label_by_frames
from linecad.camera.horizontal_frames import HorizontalFrame, HorizontalFrames
from linecad.geometry import central_camera, directions_to, rotation_about, vanishing_points
from linecad.line_graph import ManhattanFrame, Segments
from linecad.scene import Camera

WIDTH, HEIGHT = 1200, 800
CAMERA = Camera(WIDTH, HEIGHT, central_camera(1000.0, WIDTH, HEIGHT), "file")
LEVEL = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])  # world to camera, looking along y
ROTATION = rotation_about(np.array([0.1, 0, 0])) @ LEVEL @ rotation_about(np.array([0, 0, 0.3]))
TURN = np.radians(6.0)
FRAMES = HorizontalFrames(
    ManhattanFrame(ROTATION, 0.001, 0.8),
    (HorizontalFrame(0.0, 0.005, 0.4, 90.0), HorizontalFrame(TURN, 0.005, 0.4, 80.0)),
    np.array([0.25, 0.1, 0.2, 0.25, 0.1, 0.1]),
)


SINGLE = HorizontalFrames(
    ManhattanFrame(ROTATION, 0.001, 0.8), (HorizontalFrame(0.0, 0.005, 0.6, 90.0),), np.array([0.3, 0.3, 0.2, 0.2])
)


_POINT = vanishing_points(CAMERA.matrix, ROTATION)[0]
HORIZON = float(_POINT[1] / _POINT[2])  # px, of a camera that is not rolled


def facades(noise, frames=FRAMES, other=3, rows=(0.0, HEIGHT)):
    """Segments along x in the left half of the photo, along the `other` axis in the right half, and their axis."""
    rng = np.random.default_rng(2)
    axis = np.repeat([0, other], 60)
    middle = rng.uniform([0, rows[0]], [WIDTH / 2 - 40, rows[1]], (120, 2))
    middle[axis == other, 0] += WIDTH / 2 + 40
    points = vanishing_points(CAMERA.matrix, frames.sound.frame.axes)[axis]
    reach = 15 * directions_to(middle, points)
    across = reach[:, ::-1] * [1, -1] / 15
    off = rng.normal(0, noise, (2, 120, 1)) * across
    return Segments(np.stack([middle - reach + off[0], middle + reach + off[1]], axis=1), np.full(120, -1)), axis


def test_neighbours_tell_which_of_two_frames_a_segment_is_of():
    segments, axis = facades(0.2)
    alone = FRAMES.labelled(segments, CAMERA)
    assert (alone != axis).sum() > 10
    assert (label_by_frames(segments, CAMERA, FRAMES) != axis).sum() < 3


def test_neighbours_tell_level_directions_apart_near_the_horizon():
    segments, axis = facades(0.6, SINGLE, 1, (HORIZON - 100, HORIZON + 100))
    alone = SINGLE.labelled(segments, CAMERA)
    by_neighbours = label_by_frames(segments, CAMERA, SINGLE)
    assert ((alone != axis) & (alone >= 0)).sum() > 5
    assert ((by_neighbours != axis) & (by_neighbours >= 0)).sum() < 3
    assert (by_neighbours == axis).sum() > 100


def test_labels_of_segments_without_noise_are_right_without_neighbours_too():
    segments, axis = facades(0.0)
    assert_array_equal(label_by_frames(segments, CAMERA, FRAMES)[axis == 0], 0)
    assert_array_equal(label_by_frames(segments, CAMERA, FRAMES)[axis == 3], 3)


def test_what_runs_along_none_has_no_label():
    segments, _ = facades(0.2)
    stray = Segments([[[300.0, 300.0], [330.0, 350.0]]], [-1])
    assert label_by_frames(segments.joined(stray), CAMERA, FRAMES)[-1] == -1


def test_one_segment_alone_has_no_neighbours_to_ask():
    segments, axis = facades(0.0)
    assert label_by_frames(segments.subset(np.array([0])), CAMERA, FRAMES).tolist() == [axis[0]]


def test_no_segment_has_no_label():
    assert len(label_by_frames(Segments(np.zeros((0, 2, 2)), []), CAMERA, FRAMES)) == 0
