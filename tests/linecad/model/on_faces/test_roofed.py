"""Lines that the photo shows on a roof stand on it, whatever wall their crossings put them into."""

import numpy as np
import pytest
import shapely

from linecad.geometry import central_camera, project
from linecad.model.on_faces.roofed import on_roofs
from linecad.model.on_faces.seen import NO_FACE, SeenFaces
from linecad.model.regions.roofs import Roof
from linecad.scene import Camera, Face, Lines, Plane

CAMERA = Camera(960, 720, central_camera(700.0, 960, 720), "file")
ROTATION = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
WALL, EAVE = 20.0, 3.0  # m


def in_photo(points):
    return project(np.array(points, float), CAMERA.matrix, ROTATION)


def roof():
    """It rises at 45 degrees from the eave of the wall, 4 m up."""
    outline = in_photo([[-5, WALL, EAVE], [-5, WALL + 4, EAVE + 4], [5, WALL + 4, EAVE + 4], [5, WALL, EAVE]])
    polygon = shapely.Polygon(outline)
    return Roof(1, np.pi / 4, np.array([0, WALL, EAVE]), polygon, polygon, (0,), True)


def wall(kind="wall"):
    corners = np.array([[-5, WALL, -2], [-5, WALL, EAVE], [5, WALL, EAVE], [5, WALL, -2]], float)
    return Plane(0, 1, WALL, (), (Face(0, corners, kind=kind),))


def lines(*ends):
    """Lines with such ends, as the photo shows them."""
    ends = np.array(ends, float)
    axis = np.abs(ends[:, 1] - ends[:, 0]).argmax(axis=1)
    count = len(ends)
    return Lines(
        id=np.arange(count), axis=axis, segment=in_photo(ends), ends=ends, is_boundary=np.zeros(count, bool),
        component=np.zeros(count, int), confidence=np.full(count, "supported"),
    )  # fmt: skip


def moved(found, plane=None, *, carried=True):
    """The lines where the roof puts them, and what carries each."""
    seen = SeenFaces.of((plane or wall(),), CAMERA, ROTATION)
    factor, below = on_roofs(found, (roof(),), seen, ROTATION)
    assert (below != NO_FACE).all() == carried
    return found.ends * factor[:, None, None]


def above_roof(points):
    """How far points (..., 3) lie above the plane of the roof, upright."""
    return points[..., 2] - EAVE - (points[..., 1] - WALL)


def test_a_level_line_along_the_eave_lies_on_the_roof():
    put = moved(lines([[-2, WALL, EAVE + 1], [2, WALL, EAVE + 1]]))
    assert above_roof(put) == pytest.approx(np.zeros((1, 2)), abs=1e-9)


def test_an_upright_stands_on_the_roof():
    (put,) = moved(lines([[1, WALL, EAVE + 1.5], [1, WALL, EAVE + 0.5]]))
    assert above_roof(put) == pytest.approx([above_roof(put)[0], 0], abs=1e-9)
    assert above_roof(put)[0] > 0.5
    assert put[0, 0] == pytest.approx(put[1, 0])


def test_a_line_across_the_eave_ends_on_the_roof():
    (put,) = moved(lines([[1, WALL, EAVE + 1.5], [1, WALL + 1, EAVE + 1.5]]))
    assert above_roof(put)[1] == pytest.approx(0, abs=1e-9)
    assert above_roof(put)[0] > 0


@pytest.mark.parametrize(
    "ends",
    [
        [[-4, WALL, EAVE + 0.05], [4, WALL, EAVE + 0.05]],  # the eave itself
        [[1, WALL / 2, EAVE / 2 + 0.5], [1, WALL / 2, EAVE / 2 + 1]],  # a lamp before the house
        [[-4, WALL, 0], [4, WALL, 0]],  # on the wall
        [[4, WALL, EAVE + 1], [7, WALL, EAVE + 1]],  # beyond the roof's end
    ],
)
def test_what_is_not_on_the_roof_stays(ends):
    found = lines(ends)
    assert moved(found, carried=False) == pytest.approx(found.ends)


def test_without_a_wall_below_nothing_moves():
    found = lines([[-2, WALL, EAVE + 1], [2, WALL, EAVE + 1]])
    assert moved(found, wall("other"), carried=False) == pytest.approx(found.ends)
