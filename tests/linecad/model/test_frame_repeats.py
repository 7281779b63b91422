"""Pieces of an edge that have the direction of another frame."""

import numpy as np
import pytest

from linecad.directions import directions_of
from linecad.geometry import project, world_rays
from linecad.model.frame_repeats import edges_repeated

TURNS = (0.1,)
DEPTH = 10.0
EDGE = (0, (-3, DEPTH, 1), (3, DEPTH, 1))


@pytest.fixture
def piece(camera, rotation):
    """A piece from `low` to `high` of the edge in the photo, `off` px above it, along the turned direction.

    Its end is lower by `tilt` px.
    """

    def build(low, high, off=0.0, farther=1.0, tilt=0.0):
        height = 1 + off * DEPTH / camera.focal
        pixels = project(np.array([[low, DEPTH, height], [high, DEPTH, height]]), camera.matrix, rotation)
        pixels[1, 1] += tilt
        middle = farther * np.array([(low + high) / 2, DEPTH, height])
        along = directions_of(TURNS)[3]
        normal = directions_of(TURNS)[4]
        rays = world_rays(pixels, camera.matrix, rotation)
        ends = rays * ((middle @ normal) / (rays @ normal))[:, None]
        return 3, *(middle + ((each - middle) @ along) * along for each in ends)

    return build


def homes(lines, rows, camera, rotation, frame=(0, 1), spare=None, component=None):
    found = lines(rows, component)
    return edges_repeated(found, np.array(frame), rotation[2], camera.width, spare).tolist()


@pytest.mark.parametrize(
    ("where", "home"),
    [
        ({"low": 1.0, "high": 1.8}, [0, 0]),
        ({"low": 1.0, "high": 1.8, "off": 15.0}, [0, 1]),
        ({"low": 1.0, "high": 1.8, "farther": 1.05}, [0, 1]),
        ({"low": 2.4, "high": 3.5}, [0, 0]),
        ({"low": 2.8, "high": 3.5}, [0, 1]),
        ({"low": 3.1, "high": 3.9}, [0, 1]),
        ({"low": 1.0, "high": 1.8, "off": 2.6, "tilt": 6.5}, [0, 0]),
        ({"low": 1.0, "high": 1.8, "off": 6.0, "tilt": 5.0}, [0, 1]),
        ({"low": 1.0, "high": 1.8, "off": 5.0, "tilt": 14.0}, [0, 1]),
    ],
    ids=[
        "on it",
        "beside it",
        "far behind it",
        "half of it beyond its end",
        "most of it beyond its end",
        "behind its end",
        "turned by noise",
        "turned and beside it",
        "turned by more",
    ],
)
def test_a_piece_on_an_edge_in_the_photo_and_near_it_in_space_is_of_it(lines, piece, camera, rotation, where, home):
    assert homes(lines, [EDGE, piece(**where)], camera, rotation) == home


def test_only_lines_of_another_frame_that_are_level_and_of_one_component(lines, piece, camera, rotation):
    short = piece(1.0, 1.8)
    assert homes(lines, [EDGE, short], camera, rotation, frame=(1, 1)) == [0, 1]
    assert homes(lines, [EDGE, short], camera, rotation, frame=(0, 0)) == [0, 1]
    assert homes(lines, [EDGE, short], camera, rotation, component=[0, 1]) == [0, 1]
    post = (2, (0, DEPTH, -1), (0, DEPTH, 3))
    assert homes(lines, [post, (2, (0, DEPTH, 0), (0, DEPTH, 1))], camera, rotation) == [0, 1]


def test_the_longer_is_the_edge_and_what_is_not_spare_stays(lines, piece, camera, rotation):
    short = piece(1.0, 1.8)
    assert homes(lines, [short, EDGE], camera, rotation, frame=(1, 0)) == [1, 1]
    assert homes(lines, [EDGE, short], camera, rotation, spare=np.array([True, False])) == [0, 1]


def test_near_the_horizon_pieces_that_part_in_depth_are_of_one_edge(lines, camera, rotation):
    """Both run through (-2, DEPTH): in the photo they are one, in space the far end of the turned one is 6 % away."""
    rows = []
    for axis, reach in ((0, 6.0), (3, 5.0)):
        start = np.array([-2, DEPTH, 1e-3])
        rows.append((axis, start, start + reach * directions_of(TURNS)[axis]))
    assert homes(lines, rows, camera, rotation) == [0, 0]
