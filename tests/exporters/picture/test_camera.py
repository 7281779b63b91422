"""The picture of a camera: everything stands where the photo's pixels say, in any size of photo."""

from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from exporters.camera import vanishing_points
from exporters.colours import line_colour
from exporters.picture import camera as camera_picture
from exporters.picture.camera import CameraPicture, write
from linecad.line_graph import Segments
from linecad.scene import Camera, Certainty

WIDTH, HEIGHT = 1600, 1200
LEFT, TOP, SHOWN = 190, 306, 1460  # px: where the photo stands in a picture of a 4 : 3 photo, and its width
GREY = 128


def turned(yaw, tilt):
    """World to camera, turned right and then up, rad."""
    c, s, e, f = np.cos(yaw), np.sin(yaw), np.cos(tilt), np.sin(tilt)
    level = np.array([[c, -s, 0], [0, 0, -1], [s, c, 0]])
    return np.array([[1, 0, 0], [0, e, f], [0, -f, e]]) @ level


def made(yaw=0.7, tilt=0.1, focal=1000.0, **changes):
    camera = Camera(WIDTH, HEIGHT, np.array([[focal, 0, 799.5], [0, focal, 599.5], [0, 0, 1]]), "exif")
    rotation = turned(yaw, tilt)
    a, b, c = np.linalg.solve(camera.matrix.T, rotation[:, 2])
    picture = CameraPicture(
        camera=camera,
        rotation=rotation,
        segments=Segments(np.zeros((0, 2, 2)), np.zeros(0)),
        certainty=Certainty(np.zeros(3), None, None, None, "good", "it is made"),
        horizon=np.array([[x, -(a * x + c) / b] for x in (0.0, WIDTH - 1.0)]),
        places=("here", "there", "far away"),
        shares=(0.1, 0.2, 0.3, 0.4),
        title="made.jpg: focal length 1000 px",
        facts=("tilt 5 degrees",),
    )
    return replace(picture, **changes)


@pytest.fixture
def drawn(tmp_path):
    """A function that draws and gives the picture's pixels, 0 to 1."""

    def draw(picture):
        photo = np.full((picture.camera.height, picture.camera.width, 3), GREY, np.uint8)
        write(picture, tmp_path / "a.png", photo)
        with Image.open(tmp_path / "a.png") as image:
            return np.asarray(image, float) / 255

    return draw


def shown(pixel):
    """Column and row of the picture that show a pixel of the photo."""
    x, y = np.round((np.asarray(pixel) + 0.5) * SHOWN / WIDTH - 0.5 + (LEFT, TOP)).astype(int)
    return x, y


def at(picture, pixel):
    x, y = shown(pixel)
    return picture[y, x]


def test_segments_have_the_colour_of_their_axis_and_outliers_are_grey(drawn):
    ends = np.array([[[100, y], [400, y]] for y in (100, 200, 300, 400)], float)
    picture = drawn(made(segments=Segments(ends, np.array([0, 1, 2, -1]))))
    for axis, y in enumerate((100, 200, 300)):
        assert at(picture, (250, y)) == pytest.approx(line_colour(axis, True), abs=0.02)
    red, green, blue = at(picture, (250, 400))
    assert max(red, green, blue) - min(red, green, blue) < 0.05
    assert max(red, green, blue) < 0.6 * at(picture, (250, 500)).min()


def test_the_horizon_runs_through_photo_and_margin(drawn):
    content = made()
    picture = drawn(content)
    for x in (-20.0, 300.0, 1300.0, 1620.0):
        y = np.interp(x, content.horizon[:, 0], content.horizon[:, 1])
        assert at(picture, (x, y)) == pytest.approx(camera_picture._HORIZON, abs=0.05)


def test_a_vanishing_point_in_the_photo_has_a_ring_of_its_colour(drawn):
    content = made(yaw=0.3, horizon=None)
    point = vanishing_points(content.camera, content.rotation)[1] - 0.5
    assert (point > 0).all()
    assert (point < (WIDTH, HEIGHT)).all()
    picture = drawn(content)
    x, y = shown(point)
    radius = round(camera_picture._POINT)
    for ring in (picture[y, x], picture[y - radius, x], picture[y + radius, x], picture[y, x - radius]):
        assert ring == pytest.approx(line_colour(1, True), abs=0.05)


@pytest.mark.parametrize(("tilt", "side"), [(0.2, "top"), (-0.2, "bottom")])
def test_an_arrow_points_to_a_vanishing_point_far_off(drawn, tilt, side):
    picture = drawn(made(tilt=tilt, horizon=None))
    margin = picture[160 : TOP - 20] if side == "top" else picture[TOP + 1100 : TOP + 1230]
    other = picture[TOP + 1100 : TOP + 1230] if side == "top" else picture[160 : TOP - 20]
    blue = np.array(line_colour(2, True))
    assert (np.abs(margin - blue).max(axis=2) < 0.02).sum() > 200
    assert not (np.abs(other - blue).max(axis=2) < 0.02).any()


def purple(picture):
    """Offsets (N, 2) px from the middle of the photo of the pixels in the colour of the principal point."""
    part = picture[TOP : TOP + 1095, LEFT : LEFT + SHOWN]
    rows, columns = np.nonzero(np.abs(part - camera_picture._CENTRE).max(axis=2) < 0.02)
    return np.column_stack([columns - (SHOWN - 1) / 2, rows - 1094 / 2])


def test_the_principal_point_has_the_ellipse_of_its_errors(drawn):
    certainty = Certainty(np.zeros(3), 10.0, (120.0, 40.0), None, "doubtful", "it is made")
    reach = np.abs(purple(drawn(made(certainty=certainty)))).max(axis=0)
    assert reach == pytest.approx(np.array([120, 40]) * SHOWN / WIDTH, abs=2.5)


def test_a_principal_point_that_was_not_estimated_has_none(drawn):
    assert np.abs(purple(drawn(made()))).max() < 16


@pytest.mark.parametrize("size", [(60, 45), (6000, 200), (300, 4000), (8000, 1)])
def test_every_photo_gives_a_picture_of_a_size_for_screens(drawn, size):
    width, height = size
    camera = Camera(width, height, np.array([[width, 0, width / 2], [0, width, height / 2], [0, 0, 1]]), "exif")
    picture = drawn(made(camera=camera))
    assert 1000 <= picture.shape[1] <= 2000
    assert 400 <= picture.shape[0] <= 2400


@pytest.mark.parametrize(("yaw", "tilt"), [(0.0, 0.0), (0.7, 1.5), (0.7, -1.5), (1.57, 0.0)])
def test_any_way_to_hold_the_camera_can_be_drawn(drawn, yaw, tilt):
    assert drawn(made(yaw=yaw, tilt=tilt)).size


def test_words_that_are_too_long_or_in_other_scripts_stay_in_the_picture(drawn):
    certainty = Certainty(np.zeros(3), None, None, None, "poor", "because " * 60)
    picture = drawn(made(title="写真 " * 100, facts=("a fact " * 60, "another " * 60), certainty=certainty))
    assert (picture[:, -20:] == picture[0, -1]).all()


@pytest.mark.parametrize("quality", ["good", "doubtful", "poor"])
def test_the_word_for_the_quality_has_its_colour(drawn, quality):
    picture = drawn(made(certainty=Certainty(np.zeros(3), None, None, None, quality, "it is made")))
    title = picture[90:150, 30:200]
    assert (np.abs(title - camera_picture._QUALITY[quality]).max(axis=2) < 0.05).sum() > 20
