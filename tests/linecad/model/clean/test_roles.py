"""Outline, opening or detail."""

import numpy as np
import pytest

from linecad.model.clean.roles import with_roles
from linecad.scene import Face, Plane

X, Y, Z = range(3)
FORWARD = np.array([0.0, 1, 0])
DEPTH = 10.0


def frame(low, high, depth=DEPTH):
    """The four lines of a rectangle that faces the camera, from (x, z) to (x, z)."""
    (left, bottom), (right, top) = low, high
    return [
        *[(X, (left, depth, z), (right, depth, z)) for z in (bottom, top)],
        *[(Z, (x, depth, bottom), (x, depth, top)) for x in (left, right)],
    ]


def ring(low, high, depth=DEPTH):
    return [(low[0], depth, low[1]), (high[0], depth, low[1]), (high[0], depth, high[1]), (low[0], depth, high[1])]


def wall(lines, holes=()):
    """The plane of a wall from (-4, -3) to (4, 3)."""
    face = Face(0, ring((-4, -3), (4, 3)), tuple(ring(*hole) for hole in holes))
    return (Plane(0, Y, DEPTH, tuple(range(len(lines))), (face,)),)


WALL = frame((-4, -3), (4, 3))


def roles(lines, rows, holes=(), openings=None):
    return with_roles(lines(rows), wall(rows, holes), FORWARD, openings).role.tolist()


def test_edges_of_faces_are_outline_and_what_lies_within_is_detail(lines):
    rows = [*WALL, (X, (-4, DEPTH, 0), (0, DEPTH, 0)), (Z, (0, DEPTH, -3), (0, DEPTH, 0))]
    assert roles(lines, rows) == ["outline"] * 4 + ["detail"] * 2


def test_a_line_across_a_face_is_outline_unless_it_is_a_rung(lines):
    rows = [*WALL, (X, (-4, DEPTH, 0), (4, DEPTH, 0))]
    assert roles(lines, rows) == ["outline"] * 5
    rows = [*WALL, *[(X, (-4, DEPTH, z), (4, DEPTH, z)) for z in np.linspace(0, 0.8, 9)]]
    assert roles(lines, rows) == ["outline"] * 5 + ["detail"] * 7 + ["outline"]


def test_edges_of_holes_are_openings(lines):
    rows = [*WALL, *frame((-1, -1), (1, 1))]
    assert roles(lines, rows, holes=[((-1, -1), (1, 1))]) == ["outline"] * 4 + ["opening"] * 4


def test_openings_that_are_known_are_openings(lines):
    rows = [*WALL, *frame((-1, -1), (1, 1)), *frame((2, -1), (3, 1))]
    found = roles(lines, rows, openings=np.array([[Y, DEPTH, -1, 1, -1, 1]]))
    assert found == ["outline"] * 4 + ["opening"] * 4 + ["detail"] * 4


def test_without_known_openings_closed_rectangles_are_openings_and_their_bars_are_detail(lines):
    bars = [(X, (-1, DEPTH, 0), (1, DEPTH, 0))]
    rows = [*WALL, *frame((-1, -1), (1, 1)), *bars]
    assert roles(lines, rows) == ["outline"] * 4 + ["opening"] * 4 + ["detail"]
    openings = np.zeros((0, 6))
    assert roles(lines, rows, openings=openings) == ["outline"] * 4 + ["detail"] * 5


@pytest.mark.parametrize("gone", range(4))
def test_three_sides_are_no_opening(lines, gone):
    window = frame((-1, -1), (1, 1))
    del window[gone]
    courses = [(X, (-4, DEPTH, z), (4, DEPTH, z)) for z in (-2.5, 2.5)]
    assert roles(lines, [*WALL, *window, *courses])[4:7] == ["detail"] * 3


def test_rungs_of_a_ladder_are_detail_but_for_the_last(lines):
    """Courses that a face with steps has for edges."""
    rows = [*WALL, *[(X, (-4, DEPTH, z), (4, DEPTH, z)) for z in np.linspace(2.1, 2.9, 9)]]
    low = Face(0, ring((-4, -3), (4, 3)))
    steps = [Face(n + 1, ring((-4, a), (4, b))) for n, (a, b) in enumerate(zip((2.1, 2.3), (2.2, 2.4), strict=True))]
    planes = (Plane(0, Y, DEPTH, tuple(range(len(rows))), (low, *steps)),)
    found = with_roles(lines(rows), planes, FORWARD).role.tolist()
    assert found[:4] == ["outline"] * 4
    assert found[4] == "outline"  # the lowest course has no neighbour below
    assert set(found[5:]) == {"detail"}


def test_few_or_uneven_lines_are_no_ladder(lines):
    heights = [-0.9, -0.78, 0.5, 1.2]
    rows = [*WALL, *[(X, (-4, DEPTH, z), (4, DEPTH, z)) for z in heights]]
    bands = tuple(Face(n, ring((-4, -3), (4, z))) for n, z in enumerate([3, *heights]))
    planes = (Plane(0, Y, DEPTH, tuple(range(len(rows))), bands),)
    assert set(with_roles(lines(rows), planes, FORWARD).role.tolist()) == {"outline"}


def test_the_double_of_a_line_is_detail(lines):
    rows = [*WALL, (X, (-4, DEPTH, 2.98), (3.5, DEPTH, 2.98))]
    assert roles(lines, rows) == ["outline"] * 4 + ["detail"]


def test_lines_that_end_in_the_air_are_detail_unless_they_are_long(lines):
    rows = [
        *WALL[:1],
        (Z, (-4, DEPTH, -3), (-4, DEPTH, -1.5)),
        (Z, (4, DEPTH, -3), (4, DEPTH, 2)),
        (X, (0, DEPTH, 3), (1, DEPTH, 3)),
    ]
    assert roles(lines, rows) == ["outline", "detail", "outline", "detail"]


def test_an_outline_is_drawn_on_to_the_corner_of_its_face(lines):
    rows = [
        (X, (-4, DEPTH, -3), (4, DEPTH, -3)),
        (Z, (-4, DEPTH, -3), (-4, DEPTH, 1)),
        (X, (-2, DEPTH, 3), (4, DEPTH, 3)),
    ]
    found = with_roles(lines(rows), wall(rows), FORWARD)
    assert found.ends[1].tolist() == [[-4, DEPTH, -3], [-4, DEPTH, 3]]
    assert found.ends[2].tolist() == [[-4, DEPTH, 3], [4, DEPTH, 3]]
    assert found.role.tolist() == ["outline"] * 3


def test_a_line_is_not_drawn_on_by_more_than_was_seen_of_it(lines):
    rows = [(X, (-4, DEPTH, -3), (4, DEPTH, -3)), (Z, (-4, DEPTH, -3), (-4, DEPTH, -0.5))]
    assert with_roles(lines(rows), wall(rows), FORWARD).ends[1, 1].tolist() == [-4, DEPTH, -0.5]


def test_no_lines_have_no_roles(lines):
    assert len(with_roles(lines([]), (), FORWARD).role) == 0
