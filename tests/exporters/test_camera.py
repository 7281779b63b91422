from dataclasses import replace

import numpy as np
import pytest

from exporters.camera import camera_to_world, clipping_range, padded_frame, principal_point, vanishing_points
from exporters.model import ORIGINS, build_model
from linecad.scene import Camera


def camera(width, height, cx, cy):
    return Camera(width, height, [[500, 0, cx], [0, 500, cy], [0, 0, 1]], "file")


def test_pixels_count_from_the_corner():
    assert principal_point(camera(640, 480, 319.5, 239.5)) == (320.0, 240.0)


def test_the_vanishing_points_are_where_the_axes_run_to(scene):
    far = 1e9 * np.where(scene.rotation[2] >= 0, 1, -1)[:, None] * np.eye(3)
    rays = far @ scene.rotation.T @ scene.camera.matrix.T
    expected = rays[:, :2] / rays[:, 2:] + 0.5
    np.testing.assert_allclose(vanishing_points(scene.camera, scene.rotation), expected)


def test_an_axis_in_the_image_plane_vanishes_far_off_but_not_at_infinity(scene):
    assert np.isfinite(vanishing_points(scene.camera, np.eye(3))).all()


@pytest.mark.parametrize(
    ("cx", "cy", "size", "left", "top"),
    [(319.5, 239.5, (640, 480), 0, 0), (199.7, 299.5, (880, 600), 239.8, 0), (-20.5, 239.5, (1320, 480), 680, 0)],
)
def test_the_padded_frame_is_even_and_holds_the_photo_about_the_principal_point(cx, cy, size, left, top):
    frame = padded_frame(camera(640, 480, cx, cy))
    assert (frame.width, frame.height) == size
    assert frame.left == pytest.approx(left)
    assert frame.top == pytest.approx(top)
    assert frame.left + cx + 0.5 == pytest.approx(frame.width / 2)
    assert frame.width % 2 == frame.height % 2 == 0


def test_the_pose_turns_what_is_seen_before_a_camera_that_looks_along_minus_z(scene, line_ends):
    eye = np.array([1.0, 2.0, 3.0])
    pose = camera_to_world(scene.rotation, eye)
    assert np.linalg.det(pose[:3, :3]) == pytest.approx(1)
    points = np.concatenate(list(line_ends.values()))
    seen = np.c_[points + eye, np.ones(len(points))] @ np.linalg.inv(pose)[:3].T
    np.testing.assert_allclose(seen, points @ scene.rotation.T * (1, -1, -1), atol=1e-9)
    assert (seen[:, 2] < 0).all()


@pytest.mark.parametrize("factor", [1e-3, 1.0, 1e4])
@pytest.mark.parametrize("origin", ORIGINS)
def test_the_clipping_planes_enclose_the_model(grounded, factor, origin):
    small = build_model(replace(grounded, metres_per_unit=factor), origin=origin)
    near, far = clipping_range(small)
    points = grounded.lines.ends.reshape(-1, 3) * factor
    depth = points @ grounded.rotation[2]
    distance = np.linalg.norm(points, axis=1)
    assert 0 < near < depth.min()
    assert far > distance.max()


def test_a_model_behind_the_camera_still_has_clipping_planes(scene, model):
    near, far = clipping_range(replace(model, scene=replace(scene, rotation=-scene.rotation)))
    assert 0 < near < far
