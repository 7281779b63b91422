"""Cameras from matrices, angles and points."""

import math

import numpy as np
import pytest
from depth_files import points_of
from hypothesis import given
from hypothesis import strategies as st

from linecad.depth.depth_map import DepthMap
from linecad.depth.intrinsics import camera_matrix, matrix_of_angles, matrix_of_points, note_on_intrinsics
from linecad.geometry import central_camera
from linecad.scene import Camera


@given(st.floats(20, 500), st.floats(-10, 70), st.floats(-10, 50), st.integers(0, 2**32 - 1))
def test_points_tell_the_camera_that_sees_them(focal, x, y, seed):
    depth = np.random.default_rng(seed).uniform(1, 50, (40, 60))
    found = matrix_of_points(points_of(depth, focal, (x, y)).astype(np.float32))
    np.testing.assert_allclose(found, [[focal, 0, x], [0, focal, y], [0, 0, 1]], rtol=1e-3, atol=1e-2)


@pytest.mark.parametrize(
    "points",
    [
        np.random.default_rng(0).random((40, 60, 3)),
        np.ones((40, 60, 3)),
        np.zeros((40, 60, 3)),
        np.full((40, 60, 3), np.nan),
        -points_of(np.full((40, 60), 3.0), 50.0, (30, 20)),
        points_of(np.full((40, 60), 3.0), 50.0, (30, 20))[::-1],
    ],
    ids=["colours", "ones", "zeros", "nothing", "behind", "bottom up"],
)
def test_what_is_seen_by_no_pinhole(points):
    assert matrix_of_points(points) is None


def test_shares_of_the_sides_become_pixels():
    shares = np.array([[0.5, 0, 0.5], [0, 0.75, 0.5], [0, 0, 1]])
    np.testing.assert_array_equal(camera_matrix(shares, 300, 200), [[150, 0, 150], [0, 150, 100], [0, 0, 1]])
    pixels = np.array([[150.0, 0, 150], [0, 150, 100], [0, 0, 1]])
    np.testing.assert_array_equal(camera_matrix(pixels, 300, 200), pixels)


def test_angles():
    matrix = matrix_of_angles(math.pi / 2, math.pi / 3, 300, 200)
    np.testing.assert_allclose(matrix, [[150, 0, 149.5], [0, 100 * math.sqrt(3), 99.5], [0, 0, 1]])


def note(matrix, focal=1000.0):
    depth = DepthMap("map.npz", np.ones((20, 30)), np.ones((20, 30), bool), "z", matrix)
    return note_on_intrinsics(depth, Camera(30, 20, central_camera(focal, 30, 20), "exif"))


def test_a_map_of_another_focal_length_is_noted_with_both():
    assert note(central_camera(1040.0, 30, 20)) == note(central_camera(960.0, 30, 20)) == note(None) == ()
    [more] = note(central_camera(1100.0, 30, 20))
    assert "a focal length of 1100 px, 10% more than the camera's 1000 px" in more
    [less] = note(central_camera(800.0, 30, 20))
    assert "a focal length of 800 px, 20% less than the camera's 1000 px" in less


def test_a_map_that_was_stretched_to_the_photo_has_one_focal_length():
    stretched = central_camera(1000.0, 30, 20)
    stretched[0, 0], stretched[1, 1] = 1060.0, 945.0  # rounded to multiples of 14 px
    assert note(stretched) == ()
