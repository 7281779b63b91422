"""Where the cameras of the pictures stand, and that each holds what it looks at."""

from dataclasses import replace

import numpy as np
import pytest

from linecad.evaluation.turned.glb import read_glb
from linecad.evaluation.turned.panels import COLUMNS, GAP, TITLE, WIDTH, draw_panels, draw_view
from linecad.evaluation.turned.raster import NOTHING, draw_triangles
from linecad.evaluation.turned.views import seen_points, views_of
from linecad.outputs import write_outputs

UP = np.array([0.0, 1.0, 0.0])


@pytest.fixture(scope="module")
def views(model):
    return views_of(model, 320)


def azimuth(view):
    return np.degrees(np.arctan2(view.rotation[2, 0], -view.rotation[2, 2]))  # to the right of glTF's -z


def test_the_views_are_turned_as_they_say(views):
    photo, left, right, above, front = views
    # From the left one looks to the right.
    assert azimuth(left) - azimuth(photo) == pytest.approx(30)
    assert azimuth(right) - azimuth(photo) == pytest.approx(-30)
    assert np.degrees(np.arcsin(above.rotation[2] @ UP)) == pytest.approx(-45)
    assert azimuth(above) == pytest.approx(azimuth(photo))
    assert front.rotation[2] == pytest.approx([0, 0, -1])  # the front wall, which faces the camera along -y
    to_the_right = photo.rotation[0]
    assert (left.position - photo.position) @ to_the_right < 0 < (right.position - photo.position) @ to_the_right
    assert above.position @ UP > photo.position @ UP


def test_every_view_is_that_of_a_camera(views):
    for view in views:
        assert view.rotation @ view.rotation.T == pytest.approx(np.eye(3), abs=1e-9)
        assert np.linalg.det(view.rotation) == pytest.approx(1)


def test_every_view_holds_the_model(model, views):
    for view in views:
        drawn = draw_triangles(model, view)
        assert (drawn.triangle != NOTHING).mean() > 0.2
        y, x = np.nonzero(drawn.triangle != NOTHING)
        assert max(np.ptp(x) / view.width, np.ptp(y) / view.height) > 0.8


def test_the_facade_is_seen_without_perspective(model, views):
    camera = views[4].to_camera(model.triangles[np.ptp(model.triangles[:, :, 2], axis=1) < 1e-6])
    assert np.ptp(camera[..., 2]) / camera[..., 2].mean() < 1e-6


def test_seen_points_lie_on_the_faces(model, views):
    points = seen_points(views[0], draw_triangles(model, views[0]))
    on = [np.abs(points[:, 2] + 10), np.abs(points[:, 0] - 3), np.abs(points[:, 1] + 1.5)]
    assert np.min(on, axis=0).max() < 1e-5


def test_the_panels_have_the_photo_and_five_pictures(model, photo):
    picture = np.asarray(draw_panels(model, photo, "a"))
    height = WIDTH * 240 // 320
    assert picture.shape == (2 * (height + TITLE + GAP) + GAP, COLUMNS * (WIDTH + GAP) + GAP, 3)
    first = picture[GAP + TITLE : GAP + TITLE + height, GAP : GAP + WIDTH]
    middle = first[height // 2, WIDTH // 2]
    assert np.abs(middle.astype(int) - photo[120, 160]).max() <= 3


def test_lines_are_left_out_on_demand(model, views):
    with_lines, without = (draw_view(model, views[0], lines) for lines in (True, False))
    assert (with_lines != without).any(axis=2).mean() > 0.005


def test_a_model_of_nothing_but_lines_is_drawn(scene, tmp_path):
    write_outputs(replace(scene, planes=()), None, [tmp_path / "a.glb"], {})
    bare = read_glb(tmp_path / "a.glb")
    assert len(bare.triangles) == 0
    pictures = [draw_view(bare, view) for view in views_of(bare, 320)]
    assert all((picture != picture[0, 0]).any() for picture in pictures)
