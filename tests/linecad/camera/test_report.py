"""What follows from a camera and its frame: angles with their errors, horizon, vanishing points."""

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from linecad.camera.horizontal_frames import HorizontalFrame, HorizontalFrames
from linecad.camera.intrinsics import Calibration
from linecad.camera.photo import Photo
from linecad.camera.report import CameraReport, find_camera
from linecad.geometry import central_camera, rotation_about
from linecad.line_graph import ManhattanFrame, Segments
from linecad.scene import Camera, Certainty

ROOM = Path(__file__).resolve().parents[3] / "samples" / "room.jpg"
WIDTH, HEIGHT, FOCAL = 1200, 800, 1000.0
LEVEL = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])  # world to camera, looking along y
SURE = (1e-3, 2e-3, 5e-4)  # rad

tilts = st.floats(-1.5, 1.5)
rolls = st.floats(-3.0, 3.0)
yaws = st.floats(-3.0, 3.0)


def held(yaw, tilt, roll):
    """World to camera: turned right by `yaw`, then up by `tilt`, then clockwise by `roll`."""
    right, up, clockwise = (rotation_about(np.array(vector)) for vector in ((0, 0, -yaw), (-tilt, 0, 0), (0, 0, -roll)))
    return clockwise @ up @ LEVEL @ right.T


def report(rotation, errors=SURE, camera=None, segments=None):
    if camera is None:
        camera = Camera(WIDTH, HEIGHT, central_camera(FOCAL, WIDTH, HEIGHT), "vanishing points")
    return CameraReport(
        photo=Photo("made.jpg", np.zeros((1, 1, 3), np.uint8), camera),
        camera=camera,
        taken=Calibration(camera.width, camera.height, camera.matrix),
        frames=HorizontalFrames(
            ManhattanFrame(rotation, 0.001, 0.9), (HorizontalFrame(0.0, 0.005, 0.9, 100.0),), np.full(4, 0.25)
        ),
        certainty=Certainty(np.array(errors), 12.0, None, None, "good", "it is made"),
        segments=Segments(np.zeros((0, 2, 2)), np.zeros(0)) if segments is None else segments,
        notes=(),
    )


@given(yaws, tilts, rolls)
def test_tilt_and_roll_are_those_that_the_camera_was_held_with(yaw, tilt, roll):
    found = report(held(yaw, tilt, roll))
    assert found.tilt.value == pytest.approx(tilt, abs=1e-9)
    assert found.roll.value == pytest.approx(roll, abs=1e-9)


@given(yaws, tilts, st.floats(-2.5, 2.5))
def test_errors_of_tilt_and_roll_are_those_of_small_turns_of_the_camera(yaw, tilt, roll):
    rotation, step = held(yaw, tilt, roll), 1e-6
    changes = []
    for turn in step * np.eye(3):
        turned = [report(rotation_about(sign * turn) @ rotation) for sign in (1, -1)]
        changes.append(
            [(getattr(turned[0], n).value - getattr(turned[1], n).value) / 2 / step for n in ("tilt", "roll")]
        )
    expected = np.linalg.norm(np.array(changes) * np.array(SURE)[:, None], axis=0)
    found = report(rotation)
    assert [found.tilt.error, found.roll.error] == pytest.approx(np.minimum(expected, math.pi), rel=1e-4)


def test_a_camera_that_looks_straight_up_has_no_horizon_and_any_roll():
    found = report(held(0.0, math.pi / 2, 0.0))
    assert found.horizon is None
    assert found.tilt == pytest.approx((math.pi / 2, math.hypot(*SURE[:2])), abs=1e-6)
    assert found.roll.error == math.pi


@given(yaws, st.floats(-1.0, 1.0), rolls, st.floats(-1.0, 1.0))
def test_every_horizontal_direction_vanishes_on_the_horizon(yaw, tilt, roll, heading):
    found = report(held(yaw, tilt, roll))
    direction = rotation_about(np.array([0.0, 0.0, heading])) @ held(yaw, 0, 0)[2]  # level, within a radian of ahead
    ray = found.camera.matrix @ found.frame.rotation @ direction
    (x, y), (u, v) = found.horizon
    area = np.linalg.det([[x, y, 1], [u, v, 1], ray])
    assert abs(area) <= 1e-6 * math.hypot(u - x, v - y) * max(np.linalg.norm(ray), 1.0)


def test_the_horizon_ends_at_the_borders_across_which_it_runs():
    assert report(held(0.3, 0.1, 0.2)).horizon[:, 0].tolist() == [0, WIDTH - 1]
    assert report(held(0.3, 0.1, 1.4)).horizon[:, 1].tolist() == [0, HEIGHT - 1]


def test_vanishing_points_are_where_lines_meet_before_the_camera():
    found = report(held(0.4, 0.2, 0.0))
    assert [point.axis for point in found.vanishing_points] == [0, 1, 2]
    for point in found.vanishing_points:
        ahead = found.frame.rotation[:, point.axis] * np.sign(found.frame.rotation[2, point.axis])
        far = found.camera.matrix @ (np.array([0.3, -0.2, 2.0]) + 1e9 * ahead)
        assert point.pixel == pytest.approx((far[:2] / far[2]).tolist(), abs=1e-3)
        from_centre = np.array(point.pixel) - found.camera.matrix[:2, 2]
        assert point.direction == pytest.approx((from_centre / np.linalg.norm(from_centre)).tolist())


def test_lines_in_the_image_plane_vanish_at_infinity():
    x, y, z = report(held(0.0, 0.0, 0.1)).vanishing_points
    assert x.pixel is None
    assert z.pixel is None
    assert y.pixel == pytest.approx(((WIDTH - 1) / 2, (HEIGHT - 1) / 2))
    assert abs(x.direction[1] / x.direction[0]) == pytest.approx(math.tan(0.1))


def test_a_point_that_the_errors_cannot_tell_from_infinity_is_there():
    slope = 0.03
    assert report(held(0.0, slope, 0.0), (0.014, 0, 0)).vanishing_points[2].pixel is not None
    assert report(held(0.0, slope, 0.0), (0.016, 0, 0)).vanishing_points[2].pixel is None


def test_field_of_view_and_equivalent_of_the_film_that_names_them():
    """A frame of 36 x 24 mm with a lens of 50 mm: 39.6 degrees across, 27.0 from top to bottom."""
    camera = Camera(3600, 2400, central_camera(5000.0, 3600, 2400), "file")
    found = report(LEVEL, camera=camera)
    assert np.degrees(found.field_of_view) == pytest.approx([39.6, 27.0], abs=0.02)
    assert found.equivalent == pytest.approx(50.0, abs=0.01)


def test_the_field_of_view_of_a_crop_is_the_angle_between_its_borders():
    matrix = np.array([[1000.0, 0, -0.5], [0, 1000.0, 399.5], [0, 0, 1]])
    found = report(LEVEL, camera=Camera(1000, 800, matrix, "file"))
    assert np.degrees(found.field_of_view[0]) == pytest.approx(45.0)


def test_shares_are_of_the_length():
    ends = np.array([[[0, 0], [30, 0]], [[0, 0], [0, 50]], [[0, 0], [20, 0]]], float)
    found = report(LEVEL, segments=Segments(ends, np.array([0, 2, -1])))
    assert [point.share for point in found.vanishing_points] == pytest.approx([0.3, 0.0, 0.5])
    assert found.unexplained == pytest.approx(0.2)


@pytest.fixture(scope="module")
def room():
    return find_camera(ROOM)


def test_the_shares_of_a_photo_are_what_its_frame_explains(room):
    assert sum(point.share for point in room.vanishing_points) == pytest.approx(room.frame.explained, abs=1e-3)


def test_stages_are_reported():
    stages = []
    find_camera(ROOM, focal=1067.0, on_stage=stages.append)
    assert [stage.split()[0] for stage in stages] == ["reading", "finding", "finding"]


def test_the_camera_as_taken_is_that_of_the_file(tmp_path):
    """Pixels that are not square are made so for measuring; what is written again is the photo's own."""
    path = tmp_path / "camera.json"
    path.write_text('{"width": 1600, "height": 1067, "K": [[1067, 0, 799.5], [0, 1080, 533], [0, 0, 1]]}')
    found = find_camera(ROOM, path)
    assert np.diag(found.taken.matrix).tolist() == [1067, 1080, 1]
    assert np.diag(found.camera.matrix).tolist() == [1067, 1067, 1]
