"""Uprights on a ground before a wall, each at several times its distance, where it looks the same."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from linecad.geometry import central_camera, project
from linecad.model.on_faces.posts import BURIED, FURTHEST, standing
from linecad.model.on_faces.seen import NO_FACE, SeenFaces
from linecad.scene import Camera, Face, Lines, Plane

CAMERA = Camera(800, 600, central_camera(600.0, 800, 600), "file")
AHEAD = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
GROUND, WALL = -1.6, 20.0
LEVEL = np.array([[-30, 3, GROUND], [30, 3, GROUND], [30, WALL, GROUND], [-30, WALL, GROUND]], float)
UPRIGHT = np.array([[-30, WALL, GROUND], [30, WALL, GROUND], [30, WALL, 9], [-30, WALL, 9]], float)
PLANES = (
    Plane(0, 2, GROUND, (), (Face(0, LEVEL, kind="ground"),)),
    Plane(1, 1, WALL, (), (Face(1, UPRIGHT, kind="wall"),)),
)
SEEN = SeenFaces.of(PLANES, CAMERA, AHEAD)


def line(foot, height, factor, axis=2, swapped=False):
    """An upright on a foot (3,), at so many times its distance."""
    ends = np.array([foot, [*foot[:2], foot[2] + height]], float)[None]
    ends = ends[:, ::-1] if swapped else ends
    return Lines([0], [axis], project(ends, CAMERA.matrix, AHEAD), ends * factor, [False], [0], ["weak"])


@given(st.floats(-2, 2), st.floats(6, 12), st.floats(1.5, 4), st.floats(BURIED + 0.01, FURTHEST - 0.1), st.booleans())
def test_what_would_be_buried_stands_where_the_photo_shows_its_foot(x, y, height, factor, swapped):
    nearer, ground = standing(line((x, y, GROUND), height, factor, swapped=swapped), SEEN)
    assert ground.tolist() == [0]
    assert nearer[0] * factor == pytest.approx(1.0)


@pytest.mark.parametrize(
    "lines",
    [
        line((0, 10, GROUND), 3, 1.02),  # a trifle
        line((0, 10, GROUND), 3, 0.8),  # in the air: a sign that hangs
        line((0, 10, GROUND), 3, 5.0),
        line((1, WALL, GROUND + 1), 3, 1.2),  # its lower end is seen on the wall
        line((0, 10, GROUND), 3, 1.5, axis=0),
    ],
    ids=["trifle", "before", "far off", "on the wall", "level"],
)
def test_others_stay(lines):
    nearer, ground = standing(lines, SEEN)
    assert (nearer.tolist(), ground.tolist()) == ([1.0], [NO_FACE])


def test_without_faces_nothing_is_told():
    nearer, ground = standing(line((0, 10, GROUND), 3, 1.5), SeenFaces.of((), CAMERA, AHEAD))
    assert (nearer.tolist(), ground.tolist()) == ([1.0], [NO_FACE])
