"""Which face the photo shows: against the rays of pixels, one by one."""

import numpy as np
import pytest

from linecad.geometry import central_camera, world_rays
from linecad.model.on_faces.seen import BESIDE, NO_FACE, SeenFaces
from linecad.scene import Camera, Face, Plane

CAMERA = Camera(400, 300, central_camera(300.0, 400, 300), "file")
AHEAD = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])


def ring(u0, u1, v0, v1, offset=10.0):
    return np.array([[u0, offset, v0], [u1, offset, v0], [u1, offset, v1], [u0, offset, v1]], float)


HOLE, HIDDEN = ring(-1, 1, -1, 1), ring(2, 3, -3, 0)
WALL = Plane(4, 1, 10.0, (), (Face(0, ring(-4, 4, -3, 3), (HOLE,), "wall", (HIDDEN,)),))
PANE = Plane(5, 1, 10.5, (), (Face(1, ring(-1.05, 1.05, -1.05, 1.05, 10.5), kind="window", opening=0),))
SEEN = SeenFaces.of((WALL, PANE), CAMERA, AHEAD)


def pixels_of(points):
    points = np.array(points, float) @ AHEAD.T @ CAMERA.matrix.T
    return points[:, :2] / points[:, 2:]


@pytest.mark.parametrize(
    ("x", "z", "face"),
    [(-2, 2, 0), (0, 0, 1), (2.5, -1, NO_FACE), (2.5, 1, 0), (5, 0, NO_FACE), (0.99, 0.99, 1), (1.01, 1.01, 0)],
)
def test_a_place_shows_the_face_there_but_not_what_something_hides(x, z, face):
    assert SEEN.at(pixels_of([[x, 10, z]])).tolist() == [face]
    assert SEEN.hidden_at(pixels_of([[x, 10, z]])).tolist() == [0 if (x, z) == (2.5, -1) else NO_FACE]


def test_a_window_in_what_a_tree_hides_is_not_hidden():
    tree = Plane(4, 1, 10.0, (), (Face(0, ring(-4, 4, -3, 3), (HOLE,), "wall", (ring(-2, 2, -2, 2),)),))
    seen = SeenFaces.of((tree, PANE), CAMERA, AHEAD)
    pixels = pixels_of([[0, 10, 0], [1.5, 10, 0], [3, 10, 0]])
    assert seen.hidden_at(pixels).tolist() == [NO_FACE, 0, NO_FACE]
    assert seen.at(pixels).tolist() == [1, NO_FACE, 0]


def test_depths_are_those_of_the_planes_on_the_rays():
    pixels = pixels_of([[-2, 10, 2], [0, 10, 0]])
    depth = SEEN.depths(np.array([0, 1]), pixels)
    rays = world_rays(pixels, CAMERA.matrix, AHEAD)
    np.testing.assert_allclose(depth, np.array([10.0, 10.5]) / rays[:, 1])
    assert SEEN.depths(np.array([NO_FACE]), pixels[:1]).tolist() == [np.inf]


def test_a_plane_behind_the_camera_has_no_depth():
    behind = SeenFaces.of((Plane(0, 2, -1.0, (), (Face(0, ring(-4, 4, -3, -2)),)),), CAMERA, AHEAD)
    above = pixels_of([[0, 10, 3]])
    assert behind.depths(np.array([0]), above).tolist() == [np.inf]


def test_both_sides_of_a_line_are_looked_at():
    edge = pixels_of([[1.0, 10, 0]])
    right, left = SEEN.beside(edge, np.array([[0.0, -7.0]]))
    assert (right.tolist(), left.tolist()) == ([0], [1])
    assert BESIDE.px(CAMERA.width) < edge[0, 0] - pixels_of([[0.5, 10, 0]])[0, 0]


def test_a_scene_without_faces_shows_none():
    nothing = SeenFaces.of((), CAMERA, AHEAD)
    assert nothing.at(np.array([[10.0, 10.0]])).tolist() == [NO_FACE]
