"""Walls outdoors of which nothing shows but their foot."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from linecad.geometry import central_camera
from linecad.model.regions.blank_walls import LEAST_LENGTH, SAME_WALL, with_blank_walls
from linecad.model.regions.heaven import look_up
from linecad.model.regions.raster import take_raster
from linecad.model.regions.roofs import Sketch
from linecad.model.regions.segments import View
from linecad.model.regions.surfaces import Surface
from linecad.scene import Camera, Lines

CAMERA = Camera(960, 720, central_camera(700.0, 960, 720), "file")
ROTATION = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
NONE = np.zeros(0, np.int64)
LOW = 1.6
GROUND = Surface("ground", 2, -LOW, NONE, None)
SKY, HAZE, GREY, BRICK = (150, 185, 235), (138, 172, 222), (120, 120, 118), (150, 70, 55)


def seen_at(points):
    """Pixels of world points."""
    rays = np.asarray(points, float) @ ROTATION.T @ CAMERA.matrix.T
    return rays[:, :2] / rays[:, 2:]


def paint(colour=BRICK, ground=GREY, wall=(9.0, -2.0, 3.0, 4.0), edge=None):
    """The sky, a ground, on it a wall (distance, from, to, how high), and beyond an `edge` a ground of its colour."""
    rows, columns = np.mgrid[: CAMERA.height, : CAMERA.width]
    pixels = np.stack([columns, rows, np.ones_like(rows)], axis=-1).astype(float)
    rays = pixels @ np.linalg.inv(CAMERA.matrix).T @ ROTATION
    photo = np.where(rays[..., 2:] < 0, np.array(ground), np.array(SKY)).astype(np.uint8)
    if edge is not None:
        with np.errstate(divide="ignore"):
            photo[(rays[..., 2] < 0) & (-LOW * rays[..., 1] / rays[..., 2] > edge)] = colour
    away, low, high, top = wall
    at, up = away * rays[..., 0] / rays[..., 1], away * rays[..., 2] / rays[..., 1]
    photo[(at > low) & (at < high) & (up > -LOW) & (up < top)] = colour
    return photo


def no_lines():
    empty = np.zeros((0, 2, 3))
    return Lines(id=NONE, axis=NONE, segment=empty[:, :, :2], ends=empty, is_boundary=np.zeros(0, bool),
                 component=NONE, confidence=np.zeros(0, "U8"))  # fmt: skip


def added(photo, *feet, before=(GROUND,), axis=0, lines=None):
    """The walls that are added by feet, each (distance, from, to), along x."""
    view = View(CAMERA, ROTATION, photo)
    lines = no_lines() if lines is None else lines
    raster = take_raster(lines, CAMERA, ROTATION, photo)
    whole = np.array([seen_at([(low, away, -LOW), (high, away, -LOW)]) for away, low, high in feet]).reshape(-1, 2, 2)
    sketch = Sketch(whole, whole, np.full(len(whole), axis))
    found = with_blank_walls(list(before), sketch, lines, raster, look_up(raster), view)
    assert found[: len(before)] == list(before)
    return found[len(before) :]


@settings(max_examples=15, deadline=None)
@given(st.floats(5.0, 14.0), st.floats(-4.0, -1.0), st.floats(1.0, 4.0), st.floats(3.0, 6.0))
def test_a_wall_stands_on_its_foot_up_to_where_it_ends(away, low, high, top):
    (found,) = added(paint(wall=(away, low, high, top)), (away, low, high))
    assert (found.kind, found.axis, found.plane, len(found.lines)) == ("wall", 1, None, 0)
    assert found.offset == pytest.approx(away)
    assert found.box[:, 0] == pytest.approx([low, high])
    assert found.box[0, 2] == -LOW
    seen = min(top, away * (CAMERA.height / 2) / CAMERA.matrix[1, 1])  # the photo ends there
    assert seen / 1.1 <= found.box[1, 2] <= 1.25 * seen


def test_pieces_of_one_foot_are_one_wall():
    (found,) = added(paint(), (9.0, -2.0, 0.0), (9.02, 1.0, 3.0))
    assert found.box[:, 0] == pytest.approx([-2.0, 3.0], abs=0.02)


@pytest.mark.parametrize("axis", [1, 2])
def test_what_runs_along_another_axis_is_no_foot_of_it(axis):
    assert added(paint(), (9.0, -2.0, 3.0), axis=axis) == []


def test_a_short_line_is_no_foot():
    short = 0.9 * LEAST_LENGTH * CAMERA.width * 9.0 / CAMERA.matrix[0, 0]
    assert added(paint(), (9.0, 0.0, short)) == []


@pytest.mark.parametrize("away", [4.0, 6.0, 7.0, 8.0])
def test_a_kerb_or_shadow_before_the_wall_is_no_foot(away):
    """Right above it is ground."""
    assert added(paint(), (away, -2.0 * away / 9, 3.0 * away / 9)) == []


@pytest.mark.parametrize("height", [-LOW, -1.2])
def test_a_line_that_the_scene_has_above_the_ground_is_no_foot(height):
    """A sill would be the foot of a wall behind its own."""
    away = -9.0 * height / LOW
    ends = np.array([[[-2.0, away, height], [3.0 * away / 9, away, height]]])
    one = np.zeros(1, np.int64)
    lines = Lines(id=one, axis=one, segment=seen_at(ends[0])[None], ends=ends, is_boundary=np.zeros(1, bool),
                  component=one, confidence=np.full(1, "proven"))  # fmt: skip
    assert len(added(paint(), (9.0, -2.0, 3.0), lines=lines)) == (height == -LOW)


def test_a_line_on_the_ground_below_the_sky_is_no_foot():
    """The ground beyond it looks as the wall would, and above is what looks the same, the sky."""
    assert added(paint(colour=HAZE, wall=(9.0, 0.0, 0.0, 0.0), edge=9.0), (9.0, -2.0, 3.0)) == []
    assert len(added(paint(colour=HAZE), (9.0, -2.0, 3.0))) == 1


def test_what_looks_like_the_ground_before_it_is_no_wall():
    assert added(paint(colour=GREY), (9.0, -2.0, 3.0)) == []


def test_a_wall_of_lines_keeps_its_place():
    near, far = (Surface("wall", 1, 9.0 * np.exp(by), NONE, 4) for by in (0.9 * SAME_WALL, 1.1 * SAME_WALL))
    assert added(paint(), (9.0, -2.0, 3.0), before=(near, GROUND)) == []
    assert len(added(paint(), (9.0, -2.0, 3.0), before=(far, GROUND))) == 1


def test_without_a_ground_or_lines_nothing_is_added():
    assert added(paint(), (9.0, -2.0, 3.0), before=(Surface("wall", 1, 20.0, NONE, 0),)) == []
    assert added(paint()) == []
