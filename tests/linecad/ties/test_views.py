"""Views of photos: what they show is where the camera of the view sees it, and so are the points of known depth."""

import numpy as np
import pytest
from views import CLOSER, VIEWS, changed

from linecad.camera.photo import Photo
from linecad.evaluation.references import Points, Reference
from linecad.geometry import central_camera, homogeneous
from linecad.scene import Camera

WIDTH, HEIGHT, FOCAL = 403, 301, 350.0
POINTS = np.array([[180.0, 140.0], [215.0, 130.0], [190.0, 170.0], [230.0, 165.0]])
DEPTH = np.array([5.0, 8.0, 11.0, 20.0])


@pytest.fixture
def photo():
    """Black, with a bright spot at each of POINTS."""
    pixels = np.zeros((HEIGHT, WIDTH, 3), np.uint8)
    for across, down in POINTS.astype(int).tolist():
        pixels[down - 3 : down + 4, across - 3 : across + 4] = 255
    return Photo("photo.jpg", pixels, Camera(WIDTH, HEIGHT, central_camera(FOCAL, WIDTH, HEIGHT), "file"))


def space(photo, points):
    rays = homogeneous(points.pixels) @ np.linalg.inv(photo.camera.matrix).T
    return rays * points.depth[:, None]


@pytest.mark.parametrize("name", VIEWS)
def test_points_keep_their_distances_from_the_camera_and_each_other(photo, name):
    reference = Reference(edges=Points(POINTS, DEPTH), dense=Points(POINTS[:2], DEPTH[:2]))
    view, known = changed(photo, reference, name)
    before, after = space(photo, reference.edges), space(view, known.edges)
    error = 40 * 0.6 / FOCAL  # of points up to 20 away, as pixels of a smaller photo are not square to the last bit
    assert after @ after.T == pytest.approx(before @ before.T, abs=error * 20)
    assert known.dense.depth == pytest.approx(known.edges.depth[:2])
    turned = np.linalg.det(after[:3].T) * np.linalg.det(before[:3].T)
    assert (turned < 0) == VIEWS[name].is_mirrored


@pytest.mark.parametrize("name", VIEWS)
def test_what_is_seen_is_where_its_point_is(photo, name):
    view, known = changed(photo, Reference(edges=Points(POINTS, DEPTH)), name)
    bright = view.pixels.min(axis=2) > 100
    for across, down in known.edges.pixels:
        rows, columns = np.nonzero(bright[int(down) - 9 : int(down) + 10, int(across) - 9 : int(across) + 10])
        middle = columns.mean() + int(across) - 9, rows.mean() + int(down) - 9
        assert middle == pytest.approx((across, down), abs=1.0)


def test_a_camera_turned_to_the_right_sees_things_further_left(photo):
    ways = (("turned right", 0, -1), ("turned left", 0, 1), ("turned up", 1, 1), ("turned down", 1, -1))
    for name, axis, sign in ways:
        view, known = changed(photo, Reference(edges=Points(POINTS, DEPTH)), name)
        middle = np.array([WIDTH - 1, HEIGHT - 1]) / 2
        moved = known.edges.pixels - view.camera.matrix[:2, 2] - CLOSER * (POINTS - middle)
        assert (sign * moved[:, axis] > 20).all()


def test_points_outside_a_view_are_left_out(photo):
    at_border = Points(np.array([[2.0, 150.0], [400.0, 150.0]]), np.ones(2))
    _, known = changed(photo, Reference(edges=at_border), "turned right")
    assert known.edges.pixels[:, 0].tolist() == pytest.approx([known.edges.pixels[0, 0]])
    assert known.dense is None


@pytest.mark.parametrize("name", [name for name, view in VIEWS.items() if view.right or view.up])
def test_a_turned_view_ends_where_the_photo_ends(photo, name):
    rng = np.random.default_rng(3)
    noisy = Photo("noise.jpg", rng.integers(60, 200, (HEIGHT, WIDTH, 3), np.uint8), photo.camera)
    view, _ = changed(noisy, Reference(), name)
    assert view.pixels.shape[:2] == (view.camera.height, view.camera.width)
    assert view.pixels.size > 0.7 * noisy.pixels.size
    spread = view.pixels.astype(float)
    for border in (spread[0], spread[-1], spread[:, 0], spread[:, -1]):
        assert border.mean() == pytest.approx(130, abs=12)
    # Streaks would be even along their own way.
    assert np.abs(np.diff(spread, axis=1)).mean(axis=(1, 2)).min() > 5
    assert np.abs(np.diff(spread, axis=1)).mean(axis=(0, 2)).min() > 5


def test_a_dim_view_is_darker_and_noisy(photo):
    grey = Photo("grey.jpg", np.full((HEIGHT, WIDTH, 3), 128, np.uint8), photo.camera)
    view, _ = changed(grey, Reference(), "dim")
    assert 60 < view.pixels.mean() < 100
    assert view.pixels.std() > 1
