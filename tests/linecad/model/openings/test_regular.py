"""Openings are put at lines, in the plane of the wall around them, and doors are told from windows."""

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest

from linecad.geometry import project
from linecad.model.openings.regular import Seen, make_regular
from linecad.model.openings.walls import find_walls
from linecad.scene import Plane

STEP = np.full((2, 2), 0.02)
BOXES = np.array([[-2.0, -1.0, 0.0, 1.5], [1.0, 2.03, 0.01, 1.5]])


def regular(facade, lines, planes, box=BOXES, ground=None):
    wall = find_walls(planes, lines, facade.camera, facade.rotation)[0]
    return make_regular(wall, lines, Seen(box, STEP[: len(box)], np.zeros(len(box), bool)), 5, ground)


def plane_of(lines, rows, offset, number=0):
    return Plane(number, 1, offset, tuple(lines.id[rows].tolist()))


def test_nearly_equal_openings_become_equal(facade, sides):
    edges_of, lines_of = sides
    lines = lines_of(edges_of(-6, 6, -2, 4) + edges_of(-5, 5, -1.5, 3) + edges_of(-4, -3, -1.4, 3))
    found = regular(facade, lines, (plane_of(lines, slice(None), 10.0),))
    assert [each.id for each in found] == [5, 6]
    assert found[0].shape == found[1].shape
    assert found[0].v0 == found[1].v0
    assert found[0].v1 == found[1].v1
    assert found[0].u1 - found[0].u0 == pytest.approx(found[1].u1 - found[1].u0, abs=1e-12)


@pytest.mark.parametrize(
    ("box", "step"),
    [
        # Of one size, the narrow one would touch the next; to equal left sides the upper one would move into it.
        ([[0, 0.6, 0, 1.5], [0.8, 1.6, 0, 1.5]], 0.1),
        ([[0, 1, 0, 1.5], [1.03, 2.075, 0, 1.5]], 0.012),
        ([[0, 1, 0, 1.5], [1.02, 2.0, 1.4, 3.0], [-0.5, 0.5, 1.52, 3.0]], 0.05),
        ([[0, 1.5, 0, 0.6], [0, 1.5, 0.8, 1.6]], 0.1),
    ],
)
def test_what_is_apart_stays_apart(facade, sides, box, step):
    edges_of, lines_of = sides
    lines = lines_of(edges_of(-6, 6, -2, 4) + edges_of(-5, 5, -1.5, 3.5) + edges_of(-4, -3, -1.4, 3.5))
    box = np.array(box, float)
    wall = find_walls((plane_of(lines, slice(None), 10.0),), lines, facade.camera, facade.rotation)[0]
    seen = Seen(box, np.full((len(box), 2), step), np.zeros(len(box), bool))
    found = np.array([[each.u0, each.u1, each.v0, each.v1] for each in make_regular(wall, lines, seen, 0, None)])
    for (one, before), (other, then) in combinations(zip(found, box, strict=True), 2):
        was_apart, is_apart = (
            a[0] > b[1] or b[0] > a[1] or a[2] > b[3] or b[2] > a[3] for a, b in ((before, then), (one, other))
        )
        assert was_apart == is_apart


def test_lines_behind_the_wall_do_not_move_its_holes(facade, sides):
    edges_of, lines_of = sides
    wall = edges_of(-6, 6, -2, 4) + edges_of(-5, 5, -1.5, 3) + edges_of(-4, -3, -1.4, 3)
    frame = edges_of(-2.05, -1.02, 0.01, 1.52, distance=10.2)
    lines = lines_of(wall + frame)
    seen = np.array([[-2.05, -1.02, 0.01, 1.52]]) * 10 / 10.2  # where the photo shows the frame on the wall
    planes = (plane_of(lines, slice(0, 12), 10.0), plane_of(lines, slice(12, 16), 10.2, 1))
    [found] = regular(facade, lines, planes, seen)
    assert found.plane == 0
    assert [found.u0, found.u1, found.v0, found.v1] == pytest.approx(seen[0].tolist())


def test_opening_is_in_the_plane_of_the_wall_around_it(facade, sides):
    edges_of, lines_of = sides
    main = edges_of(-6, -1, -2, 4) + edges_of(-5, -2, -1.5, 3) + edges_of(-4, -3, -1.4, 3) + edges_of(-5, -4, -1, 2)
    beside = edges_of(0.5, 4, -0.5, 2.2, distance=10.3) + edges_of(0.6, 3, -0.4, 2, distance=10.3)
    lines = lines_of(main + beside)
    planes = (plane_of(lines, slice(0, 16), 10.0), plane_of(lines, slice(16, 24), 10.3, 1))
    true = np.array([[1.0, 2.0, 0.0, 1.5]])
    [found] = regular(facade, lines, planes, true * 10 / 10.3)
    assert found.plane == 1
    assert [found.u0, found.u1, found.v0, found.v1] == pytest.approx(true[0].tolist())


@pytest.mark.parametrize(
    ("ground", "kinds"),
    [
        (-1.95, ["door", "window"]),
        (-1.1, ["window", "door"]),
        (-4.0, ["window", "window"]),
        (None, ["door", "window"]),  # the wall's lowest line, at -2, stands for it
    ],
)
def test_door_stands_on_the_ground(facade, sides, ground, kinds):
    edges_of, lines_of = sides
    lines = lines_of(edges_of(-6, 6, -2, 4) + edges_of(-5, 5, -1.8, 3) + edges_of(-4, -3, -1.7, 3))
    boxes = np.array([[-2.0, -1.0, -1.95, 0.4], [1.0, 2.0, -1.1, 0.4]])
    found = regular(facade, lines, (plane_of(lines, slice(None), 10.0),), boxes, ground)
    assert [each.kind for each in found] == kinds


def test_what_is_as_wide_as_tall_is_no_door(facade, sides):
    edges_of, lines_of = sides
    lines = lines_of(edges_of(-6, 6, -2, 4) + edges_of(-5, 5, -1.8, 3) + edges_of(-4, -3, -1.7, 3))
    [found] = regular(facade, lines, (plane_of(lines, slice(None), 10.0),), np.array([[-2.0, 0.0, -1.95, 0.4]]), -1.95)
    assert found.kind == "window"


def test_photo_and_coordinates_agree(facade):
    # Of a wall, the points of the plane are those that the rays of their pixels meet.
    wall = find_walls(facade.planes, facade.lines, facade.camera, facade.rotation)[0]
    flat = np.array([[-1.0, 0.5], [2.0, 1.0]])
    pixels = project(wall.points(flat), facade.camera.matrix, facade.rotation)
    np.testing.assert_allclose(wall.pixels(flat), pixels)
    image = np.column_stack([flat, np.ones(2)]) @ wall.homography().T
    np.testing.assert_allclose(image[:, :2] / image[:, 2:], pixels)


def test_walls_need_lines_of_both_directions(facade):
    lines = replace(facade.lines, axis=np.zeros(len(facade.lines), int))
    assert find_walls(facade.planes, lines, facade.camera, facade.rotation) == []
