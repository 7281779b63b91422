"""How the eave and the ridge of a house run, by their segments in the photo."""

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from linecad.geometry import central_camera, project
from linecad.model.regions.bearings import UNKNOWN, Bearing, bearing_of
from linecad.model.regions.profiles import Shown, Wall, about_upright
from linecad.model.regions.segments import View
from linecad.scene import Camera

CAMERA = Camera(1280, 960, central_camera(900.0, 1280, 960), "file")
DISTANCE, EAVE, RIDGE, REACH = 20.0, 4.0, 7.0, 6.0  # m
WALL = Wall(1, DISTANCE, np.array([0.0, 1, 0]), (0,), np.zeros((1, 1), bool))


def looking(turn):
    cos, sin = np.cos(turn), np.sin(turn)
    return np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]) @ [[cos, -sin, 0], [sin, cos, 0], [0, 0, 1]]


def seen(house, camera, back=4.0):
    """A profile whose lines run as the wall, the segments of a house turned by `house`, rad, and what is shown."""
    middle, along = np.array([0.0, DISTANCE, 0.0]), np.array([[-REACH, 0, 0], [REACH, 0, 0]])
    places = [np.array([0, 0, EAVE]), np.array([0, back, RIDGE])]
    rotation = looking(camera)
    lines = [middle + (along + at) @ about_upright(house).T for at in places]
    segments = np.stack([project(line, CAMERA.matrix, rotation) for line in lines])
    shown = Shown(None, View(CAMERA, rotation, None), None, None)
    drawn = [
        np.linspace(*project(middle + about_upright(house) @ at + along, CAMERA.matrix, rotation), 9) for at in places
    ]
    profile = SimpleNamespace(wall=WALL, eave=drawn[0], ridge=drawn[1], ends=(0, 8))
    return profile, segments, shown


@given(st.floats(-0.14, 0.14), st.floats(-0.5, 0.5))
def test_eave_and_ridge_tell_how_the_house_is_turned(house, camera):
    found = bearing_of(*seen(house, camera))
    assert abs(found.turn - house) < max(found.error, 1e-9)
    assert found.turn == 0 or found.turn == pytest.approx(house, abs=1e-9)
    assert found.error < UNKNOWN / 3


def test_segments_elsewhere_tell_nothing():
    profile, segments, shown = seen(0.05, 0.1)
    found = bearing_of(profile, segments + np.array([0.0, 9.0]), shown)
    assert (found.turn, found.error) == (0.0, UNKNOWN)
    found = bearing_of(profile, segments[:0], shown)
    assert (found.turn, found.error) == (0.0, UNKNOWN)


def test_segments_that_scatter_tell_nothing():
    profile, _, shown = seen(0.0, 0.0)
    found = bearing_of(profile, np.concatenate([seen(house, 0.0)[1] for house in (-0.16, -0.1, 0.0, 0.1, 0.16)]), shown)
    assert (found.turn, found.error) == (0.0, UNKNOWN)


def test_a_single_stray_segment_does_not_turn_it():
    profile, segments, shown = seen(0.06, 0.0)
    short = segments[0, 0] + np.outer([0.3, 0.4], segments[0, 1] - segments[0, 0]) + np.array([[0.0, 1.0], [0.0, -1.0]])
    assert bearing_of(profile, np.concatenate([segments, short[None]]), shown).turn == pytest.approx(0.06, abs=1e-3)


@given(st.floats(-1, 1), st.floats(-1, 1), st.floats(-0.4, 0.4), st.floats(-0.4, 0.4))
def test_a_turned_wall_keeps_the_point_about_which_it_is_turned(turn, more, across, up):
    _, _, shown = seen(0.0, 0.0)
    pixel = np.array([640 * (1 + across), 480 * (1 + up)])
    point = WALL.point(shown.rays(pixel))
    turned = WALL.turned(turn, pixel, shown)
    assert turned.point(shown.rays(pixel)) == pytest.approx(point)
    assert turned.normal @ turned.direction == pytest.approx(0, abs=1e-12)
    assert turned.direction == pytest.approx(Bearing(turn, 0.0).turned(WALL.direction))
    assert Bearing(turn, 0.0).turned(WALL.normal, more) == pytest.approx(about_upright(turn + more) @ WALL.normal)
