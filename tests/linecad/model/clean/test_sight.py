"""Whether a photo shows that a line goes on."""

import numpy as np
import pytest

from linecad.model.clean.sight import Sight
from linecad.scene import Camera

LINE = np.array([[[20.0, 50], [60, 50]]])
WAY = np.array([[[60.0, 50], [100, 50]]])


@pytest.fixture
def sight(rotation):
    """A sight of a photo with a step along y = 50 from x = 0 on: its heights on x below 60, below 80 and from there."""

    def build(*heights, row=50):
        grey = np.full((100, 120), 100.0, np.float32)
        for (low, high), height in zip(((0, 60), (60, 80), (80, 120)), heights, strict=True):
            grey[row:, low:high] += height
        return Sight(np.eye(3), rotation, grey)

    return build


@pytest.mark.parametrize(
    ("heights", "shown"),
    [
        ((40, 40, 40), True),
        ((40, 20, 20), True),
        ((40, 10, 10), False),
        ((2, 2, 2), True),
        ((40, -40, -40), False),
        ((-40, -40, -40), True),
        ((40, 40, 0), False),
        ((40, 0, 40), False),
        ((0, 40, 40), False),
    ],
)
def test_a_line_goes_on_where_its_step_does_over_the_whole_way(sight, heights, shown):
    assert sight(*heights).shows(LINE, WAY).tolist() == [shown]


@pytest.mark.parametrize(("row", "shown"), [(48, True), (52, True), (58, False)])
def test_an_edge_may_lie_a_little_beside_its_line(sight, row, shown):
    assert sight(40, 40, 40, row=row).shows(LINE, WAY).tolist() == [shown]


def test_what_is_not_in_the_photo_is_not_shown(sight, rotation):
    assert Sight(np.eye(3), rotation, None).shows(LINE, WAY).tolist() == [False]
    beyond = np.concatenate([WAY, WAY * np.nan])
    assert sight(40, 40, 40).shows(np.concatenate([LINE, LINE]), beyond).tolist() == [True, False]
    assert sight(40, 40, 40).shows(np.zeros((0, 2, 2)), np.zeros((0, 2, 2))).tolist() == []


def test_points_behind_the_camera_have_no_pixel(rotation, camera):
    sight = Sight.of(camera, rotation, None)
    found = sight.pixels(np.array([[0.0, 10, 0], [0, -10, 0]]))
    assert found[0].tolist() == [1499.5, 999.5]
    assert np.isnan(found[1]).all()


def test_a_photo_is_seen_in_grey(rotation):
    camera = Camera(8, 6, np.array([[5.0, 0, 4], [0, 5, 3], [0, 0, 1]]), "file")
    assert Sight.of(camera, rotation, None).grey is None
    grey = Sight.of(camera, rotation, np.full((6, 8, 3), 77, np.uint8)).grey
    assert grey.shape == (6, 8)
    assert (grey == 77).all()
