"""Corners have the numbers of their opening and its plane."""

import numpy as np
import pytest

from linecad.directions import directions_of, frame_axes
from linecad.model.openings.corners import flat_on_wall, panel_in_space, rectangle_in_space
from linecad.scene import Opening, Plane


@pytest.mark.parametrize("axis", [0, 1])
def test_hole_and_panel_have_exact_coordinates(axis):
    opening = Opening(3, 5, 0.1, 0.3, -0.7, 1.1, "window", 0.2, 4.2)
    plane = Plane(5, axis, 4.0, ())
    hole, panel = rectangle_in_space(opening, plane), panel_in_space(opening, plane)
    across = 1 - axis
    assert hole[:, axis].tolist() == [4.0] * 4
    assert panel[:, axis].tolist() == [4.2] * 4
    for ring in (hole, panel):
        assert ring[:, across].tolist() == [0.1, 0.3, 0.3, 0.1]
        assert ring[:, 2].tolist() == [-0.7, -0.7, 1.1, 1.1]


@pytest.mark.parametrize("axis", [0, 1])
def test_corners_in_a_turned_wall_are_those_of_its_frame(axis):
    turns = (0.3, -0.4)
    opening = Opening(3, 5, 0.1, 0.3, -0.7, 1.1, "window", 0.2, 4.2)
    own, turned = Plane(5, axis, 4.0, ()), Plane(5, frame_axes(2)[axis], 4.0, ())
    vectors = directions_of(turns)[frame_axes(2)]
    for corners in (rectangle_in_space, panel_in_space):
        there = corners(opening, turned, turns)
        np.testing.assert_allclose(there, corners(opening, own) @ vectors, atol=1e-14)
        assert there[:, 2].tolist() == [-0.7, -0.7, 1.1, 1.1]
    flat = flat_on_wall(there, turned.axis, turns)
    np.testing.assert_allclose(flat, [[0.1, -0.7], [0.3, -0.7], [0.3, 1.1], [0.1, 1.1]], atol=1e-14)


def test_flush_opening_has_no_panel():
    assert panel_in_space(Opening(0, 0, 0.0, 1.0, 0.0, 1.0, "door"), Plane(0, 1, 4.0, ())) is None


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"u1": 0.0}, "has no area"),
        ({"v0": 2.0}, "has no area"),
        ({"kind": "gate"}, "expected window or door"),
        ({"recess": 0.1}, "has recess 0.1 and panel None"),
        ({"recess": -0.1, "panel": 3.9}, "has recess -0.1"),
        ({"u0": np.inf}, "finite numbers"),
    ],
)
def test_opening_that_cannot_be_is_refused(change, message):
    values = {"id": 0, "plane": 0, "u0": 0.0, "u1": 1.0, "v0": 0.0, "v1": 1.0, "kind": "window"}
    with pytest.raises(ValueError, match=message):
        Opening(**(values | change))
