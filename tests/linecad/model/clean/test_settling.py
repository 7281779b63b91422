"""Ends in the air go on to where they stop, if the photo shows it."""

import numpy as np
import pytest

from linecad.model.clean.settling import at_outlines, outlines_of, settle_ends, settled
from linecad.model.clean.sight import Sight
from linecad.model.clean.strokes import strokes_of
from linecad.scene import Face, Plane

X, Y, Z = range(3)
DEPTH = 10.0
NO_OUTLINES = np.zeros((0, 2, 3))
COURSE = (X, (-2, DEPTH, 0), (0, DEPTH, 0))
START = (Z, (-2, DEPTH, -1), (-2, DEPTH, 1))


def post(x, depth=DEPTH):
    return (Z, (x, depth, -1), (x, depth, 1))


def course(end, start=-2):
    return (X, (start, DEPTH, 0), (end, DEPTH, 0))


def edge(x, depth, low=-1.0, high=1.0):
    """The upright edge of a face that stands `depth` away where the course would be seen at `x`."""
    return np.array([[[x * depth / DEPTH, depth, low], [x * depth / DEPTH, depth, high]]])


@pytest.fixture
def end_of_course(lines, photo, camera, rotation):
    """Where a course from -2 to 0 that meets START ends, with other rows, outlines, and what the photo shows."""

    def find(rows=(), outlines=NO_OUTLINES, shown=(), first=COURSE):
        sight = Sight(camera.matrix, rotation, photo(shown) if len(shown) else None)
        strokes = strokes_of(lines([first, START, *rows]), sight.forward)
        found = settle_ends(strokes, outlines, sight)
        np.testing.assert_array_equal(found.offset, strokes.offset)
        assert found.reach[0, 0] == strokes.reach[0, 0]
        return found.reach[0, 1]

    return find


def test_an_end_goes_on_to_the_next_line_where_the_photo_shows_it(end_of_course):
    rows = [post(3), post(1.5)]
    assert end_of_course(rows, shown=[course(3)]) == 1.5
    assert end_of_course(rows, shown=[course(0)]) == 0
    assert end_of_course(rows, shown=[course(0.7)]) == 0
    assert end_of_course(rows) == 0


def test_an_end_goes_to_no_line_of_another_plane_or_height(end_of_course):
    assert end_of_course([post(1.5, DEPTH + 0.3)], shown=[course(3)]) == 0
    short = (Z, (1.5, DEPTH, 0.2), (1.5, DEPTH, 1))
    assert end_of_course([short], shown=[course(3)]) == 0


def test_a_line_is_not_drawn_on_by_more_than_three_times_its_length(end_of_course):
    for x, expected in ((2.9, 2.9), (3.1, 0)):
        assert end_of_course(
            [post(x), (Z, (-1, DEPTH, -1), (-1, DEPTH, 1))], first=course(0, -1), shown=[course(4)]
        ) == (expected)


@pytest.mark.parametrize("x", [-0.09, 0.09])
def test_an_end_near_an_outline_ends_there(end_of_course, x):
    assert end_of_course(outlines=edge(x, DEPTH)) == pytest.approx(x)
    assert end_of_course(outlines=edge(2 * x, DEPTH)) == 0


def test_closing_ends_brings_no_two_pieces_of_one_line_together(lines, camera, rotation):
    sight = Sight(camera.matrix, rotation, None)
    before = strokes_of(lines([course(0.1), START, course(2, start=0.24), post(0.15)]), sight.forward)
    assert settle_ends(before, NO_OUTLINES, sight).reach[[0, 2]].tolist() == [[-2, 0.1], [0.24, 2]]
    alone = strokes_of(lines([course(0.1), START, post(0.15)]), sight.forward)
    assert settle_ends(alone, NO_OUTLINES, sight).reach[0].tolist() == [-2, 0.15]


def test_both_ends_of_a_short_line_near_one_outline_stay(lines, camera, rotation):
    strokes = strokes_of(lines([course(0.08, start=0), START]), rotation[2])
    found = settle_ends(strokes, edge(0.04, DEPTH), Sight(camera.matrix, rotation, None))
    assert found.reach[0].tolist() == [0, 0.08]


def test_an_end_goes_on_to_an_outline_where_the_photo_shows_it(end_of_course):
    assert end_of_course(outlines=edge(1.0, DEPTH), shown=[course(3)]) == pytest.approx(1)
    assert end_of_course(outlines=edge(1.0, DEPTH)) == 0
    assert end_of_course([post(0.8)], outlines=edge(1.0, DEPTH), shown=[course(3)]) == 0.8


def test_what_stands_before_a_line_hides_its_end_and_what_stands_behind_does_not(end_of_course):
    assert end_of_course(outlines=edge(1.0, 5.0), shown=[course(3)]) == pytest.approx(1)
    assert end_of_course(outlines=edge(1.0, 20.0), shown=[course(3)]) == 0
    assert end_of_course(outlines=edge(1.0, 5.0, 0.2, 1.0), shown=[course(3)]) == 0


def test_an_end_goes_on_to_a_slanted_outline(end_of_course):
    slanted = np.array([[[0.5, DEPTH, -1], [1.5, DEPTH, 1]]])
    assert end_of_course(outlines=slanted, shown=[course(3)]) == pytest.approx(1)


def test_a_small_overshoot_is_cut_off(end_of_course):
    for x, expected in ((-0.2, -0.2), (-0.3, 0)):
        assert end_of_course([post(x)]) == expected


def test_no_more_than_a_quarter_of_a_line_is_cut_off(end_of_course):
    assert end_of_course([post(-0.2), (Z, (-0.7, DEPTH, -1), (-0.7, DEPTH, 1))], first=course(0, -0.7)) == 0


def test_an_overshoot_that_ends_at_an_outline_stays(end_of_course):
    assert end_of_course([post(-0.2)], outlines=edge(0.0, 5.0)) == 0


def test_a_line_that_was_drawn_on_stops_others(lines, photo, camera, rotation):
    rows = [course(0), START, post(3), (Z, (1, DEPTH, -2), (1, DEPTH, -1)), (X, (0, DEPTH, -2), (2, DEPTH, -2))]
    sight = Sight(camera.matrix, rotation, photo([course(3), (Z, (1, DEPTH, -2), (1, DEPTH, 0))]))
    found = settle_ends(strokes_of(lines(rows), sight.forward), NO_OUTLINES, sight)
    assert found.reach[[0, 3]].tolist() == [[-2, 3], [-2, 0]]


def test_which_ends_lie_on_outlines(lines, camera, rotation):
    sight = Sight(camera.matrix, rotation, None)
    strokes = strokes_of(lines([course(0), course(1)]), sight.forward)
    assert at_outlines(strokes, edge(0, 5.0), sight).tolist() == [[False, True], [False, False]]
    assert at_outlines(strokes, NO_OUTLINES, sight).tolist() == [[False, False]] * 2


def test_edges_behind_the_camera_stop_nothing(lines, camera, rotation):
    sight = Sight(camera.matrix, rotation, None)
    behind = np.array([[[0.0, -5, -1], [0, -5, 1]], [[0, 5, -1], [0, -5, 1]]])
    assert not at_outlines(strokes_of(lines([course(0)]), sight.forward), behind, sight).any()


def test_outlines_holes_and_what_is_hidden_are_edges_of_faces(lines, camera, rotation):
    def ring(half):
        return [(-half, DEPTH, -half), (half, DEPTH, -half), (half, DEPTH, half), (-half, DEPTH, half)]

    plane = Plane(0, Y, DEPTH, (0,), (Face(0, ring(3), (ring(2),), "wall", (ring(1),)),))
    edges = outlines_of((plane,))
    assert edges.shape == (12, 2, 3)
    assert outlines_of(()).shape == (0, 2, 3)
    before = lines([(X, (2.05, DEPTH, 0), (2.95, DEPTH, 0))])
    after = settled(before, outlines_of((plane,)), Sight(camera.matrix, rotation, None))
    np.testing.assert_allclose(after.ends[0], [[2, DEPTH, 0], [3, DEPTH, 0]])
