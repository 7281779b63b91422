"""The algebra of directions, against vectors."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from linecad.directions import (
    UP,
    across,
    axis_in_frame,
    axis_name,
    axis_of,
    common_frame,
    components,
    count_of,
    directions_of,
    frame_of,
    in_world,
    letter_of,
    lies_across,
    partner,
    third,
)

TURNS = (0.3, -0.7)
AXES = np.arange(count_of(TURNS))
VECTORS = directions_of(TURNS)
PAIRS = [(first, second) for first in AXES.tolist() for second in AXES.tolist() if first != second]


def test_every_frame_is_right_handed_and_its_third_axis_is_the_upright():
    for first in (0, 3, 5):
        x, y = VECTORS[first], VECTORS[first + 1]
        np.testing.assert_allclose(np.cross(x, y), VECTORS[UP], atol=1e-15)
    np.testing.assert_allclose(VECTORS[3], [np.cos(0.3), np.sin(0.3), 0])


@pytest.mark.parametrize(("first", "second"), PAIRS)
def test_two_lines_that_meet_agree_along_the_normal_of_their_plane(first, second):
    normal = int(third(np.array(first), np.array(second)))
    turned = np.cross(VECTORS[first], VECTORS[second])
    np.testing.assert_allclose(np.abs(turned @ VECTORS[normal]), np.linalg.norm(turned), atol=1e-15)
    assert lies_across(np.array([first, second]), normal).all()


@pytest.mark.parametrize("axis", AXES.tolist())
def test_the_components_across_place_a_line(axis):
    one, other = across(np.array(axis)).tolist()
    assert abs(VECTORS[one] @ VECTORS[axis]) < 1e-15
    np.testing.assert_allclose(np.cross(VECTORS[one], VECTORS[other]), VECTORS[axis], atol=1e-15)


@pytest.mark.parametrize("axis", AXES.tolist())
def test_a_line_lies_in_planes_whose_normals_are_at_right_angles_to_it(axis):
    normals = lies_across(np.array(axis), AXES)
    assert (np.abs(VECTORS[normals] @ VECTORS[axis]) < 1e-15).all()
    assert normals.sum() == (len(AXES) - 1 if axis == UP else 2)


def test_partners_are_at_right_angles_in_one_frame():
    assert partner(AXES).tolist() == [1, 0, 2, 4, 3, 6, 5]


def test_the_upright_is_of_every_frame():
    frame = common_frame(np.array([0, 0, 2, 5, 0, 4]), np.array([1, 2, 3, 2, 3, 6]))
    assert frame.tolist() == [0, 0, 1, 2, -1, -1]


@given(st.integers(0, 500))
def test_names_are_read_as_they_are_written(axis):
    assert axis_of(axis_name(axis)) == axis


@pytest.mark.parametrize("name", ["", "z2", "x1", "x0", "x02", "w", "xy", "x²", "X"])
def test_what_is_no_name_of_a_direction_is_none(name):
    assert axis_of(name) is None


@given(st.integers(0, 500))
def test_a_letter_and_a_frame_tell_the_axis(axis):
    assert axis_in_frame(letter_of(axis), int(frame_of(np.array(axis)))) == axis


@given(st.integers(0, 200))
def test_the_upright_is_the_same_axis_in_all_frames(frame):
    assert axis_in_frame("z", frame) == 2


def test_names_count_the_frames():
    assert [axis_name(axis) for axis in AXES.tolist()] == ["x", "y", "z", "x2", "y2", "x3", "y3"]


def test_components_of_the_main_frame_are_the_coordinates_to_the_last_bit():
    points = np.random.default_rng(3).normal(size=(4, 2, 3))
    assert components(points, ()) is points
    found = components(points, TURNS)
    assert (found[..., :3] == points).all()
    np.testing.assert_allclose(found, points @ VECTORS.T)


def test_points_of_lines_come_back_from_their_components():
    points = np.random.default_rng(4).normal(size=(len(AXES), 1, 3))
    told = components(points, TURNS)[:, 0]
    along = np.take_along_axis(told, AXES[:, None], axis=1)
    fixed = np.take_along_axis(told, across(AXES), axis=1)
    np.testing.assert_allclose(in_world(along, AXES, fixed, TURNS), points, atol=1e-14)
