"""Openings go to the walls whose faces show them, where they look the same in the photo."""

from dataclasses import replace

import numpy as np
import pytest

from linecad.depth.normals import UNTOLD
from linecad.directions import directions_of, frame_axes
from linecad.geometry import project
from linecad.model.openings.corners import panel_in_space, rectangle_in_space
from linecad.model.openings.homes import at_home, axes_shown
from linecad.scene import Camera, Face, Opening, Plane

CAMERA = Camera(1200, 900, np.array([[900.0, 0, 599.5], [0, 900, 449.5], [0, 0, 1]]), "file")
AHEAD = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
WINDOW = Opening(4, 7, 0.5, 1.5, -0.2, 1.3, "window", 0.2, 8.2, shape=4)
NEAR = Plane(7, 1, 8.0, ())


def wall(number, offset, u0=-5.0, u1=5.0):
    ring = np.array([[u0, offset, -3], [u1, offset, -3], [u1, offset, 4], [u0, offset, 4]], float)
    return Plane(number, 1, offset, (), (Face(number, ring, kind="wall"),))


def homes(openings, *planes):
    return at_home(openings, planes, CAMERA, AHEAD)


def test_an_opening_stays_in_the_plane_that_shows_it():
    (found,) = homes((WINDOW,), wall(7, 8.0))
    assert found == replace(WINDOW, id=0, shape=0)


@pytest.mark.parametrize("offset", [6.4, 9.1, 12.0])
def test_an_opening_moves_along_its_rays_to_the_wall_behind_or_before(offset):
    home = wall(3, offset)
    (found,) = homes((WINDOW,), NEAR, home)
    assert found.plane == 3
    assert found.panel == pytest.approx(offset + found.recess)
    for corners in (rectangle_in_space, panel_in_space):
        before, after = (project(corners(*each), CAMERA.matrix, AHEAD) for each in ((WINDOW, NEAR), (found, home)))
        np.testing.assert_allclose(after, before, atol=1e-9)


def test_an_opening_that_no_face_shows_stays_where_it_is():
    found = homes((WINDOW,), NEAR, wall(3, 9.0, u0=1.3))
    assert found == (replace(WINDOW, id=0, shape=0),)


def test_an_opening_on_another_kind_of_face_is_none():
    ring = np.array([[-5.0, 6, -1], [5, 6, -1], [5, 60, -1], [-5, 60, -1]])
    below = replace(WINDOW, v0=-0.9, v1=-0.2)
    assert homes((below,), NEAR, Plane(3, 2, -1.0, (), (Face(0, ring, kind="ground"),))) == ()


def test_equal_openings_stay_equal_and_those_of_two_walls_part():
    others = [replace(WINDOW, id=5, u0=-2.5, u1=-1.5), replace(WINDOW, id=6, u0=-1.0, u1=0.0), WINDOW]
    found = homes(tuple(others), NEAR, wall(3, 9.0, u1=0.2), replace(wall(8, 10.0, u0=0.3), id=8))
    assert [each.id for each in found] == [0, 1, 2]
    assert [each.plane for each in found] == [3, 3, 8]
    assert [each.shape for each in found] == [0, 0, 2]
    assert found[0].u1 - found[0].u0 == pytest.approx(9 / 8, rel=1e-12)


def test_an_opening_of_a_turned_wall_goes_to_a_parallel_one_of_its_frame():
    turns, axes = (0.3,), frame_axes(1)
    vectors = directions_of(turns)[axes]

    def turned(plane):
        faces = tuple(replace(face, outline=face.outline @ vectors) for face in plane.faces)
        return replace(plane, axis=axes[plane.axis], faces=faces)

    planes = [turned(plane) for plane in (NEAR, wall(3, 9.0))]
    found = at_home((WINDOW,), tuple(planes), CAMERA, AHEAD @ vectors, turns)
    assert found == homes((WINDOW,), NEAR, wall(3, 9.0))
    # A wall of the main frame shows it: it is none of the turned wall.
    assert at_home((WINDOW,), (planes[0], wall(3, 9.0)), CAMERA, AHEAD @ vectors, turns) == ()


def test_without_faces_all_stay():
    assert homes((WINDOW,), NEAR) == (replace(WINDOW, id=0, shape=0),)


def test_what_stands_before_the_wall_has_no_opening_of_it():
    home = wall(7, 8.0)
    u0, u1, v0 = WINDOW.u0, WINDOW.u1, WINDOW.v0

    def found(v1, **change):
        tree = np.array([[u0 - 1, 8.0, v0 - 1], [u1 + 1, 8, v0 - 1], [u1 + 1, 8, v1], [u0 - 1, 8, v1]])
        face = replace(home.faces[0], hidden=(tree,))
        return homes((replace(WINDOW, **change),), replace(home, faces=(face,)))

    assert len(found(v0 + 0.4 * 1.5)) == 1
    assert found(v0 + 0.6 * 1.5) == ()
    assert len(found(v0 + 0.6 * 1.5, is_completed=True)) == 1


def test_what_is_hidden_stays_where_an_equal_one_is_seen():
    home = wall(7, 8.0)
    tree = np.array([[0, 8.0, -3], [2, 8, -3], [2, 8, 4], [0, 8, 4]])
    hidden = replace(home, faces=(replace(home.faces[0], hidden=(tree,)),))
    other = replace(WINDOW, id=5, u0=-2.5, u1=-1.5)
    assert len(homes((WINDOW, other), hidden)) == 2
    assert [each.u0 for each in homes((WINDOW, replace(other, shape=5)), hidden)] == [-2.5]
    behind = replace(WINDOW, id=5, u0=0.1, u1=1.1)  # the tree hides both
    assert homes((WINDOW, behind), hidden) == ()
    assert len(homes((WINDOW, replace(other, is_completed=True)), hidden)) == 1  # which was not seen either


def test_the_axes_that_faces_show():
    ring = np.array([[-5.0, 9, -1], [5, 9, -1], [5, 60, -1], [-5, 60, -1]])
    planes = (wall(7, 8.0, u0=0.0), NEAR, Plane(3, 2, -1.0, (), (Face(0, ring, kind="ground"),)))
    points = np.array([[1.0, 8, 0], [-1, 8, 0], [-1, 20, -1], [0, 1, 9]])
    axes_at = axes_shown(planes, CAMERA, AHEAD)
    assert axes_at(project(points, CAMERA.matrix, AHEAD)).tolist() == [1, UNTOLD, 2, UNTOLD]
    assert axes_at(np.zeros((0, 2))).tolist() == []
    assert axes_shown((NEAR,), CAMERA, AHEAD)(np.zeros((2, 2))).tolist() == [UNTOLD, UNTOLD]
