"""An end that nearly meets a line meets it, and moves along its own line alone."""

import numpy as np
import pytest

from linecad.model.clean.ends import (
    close_ends,
    ends_that_meet,
    ends_that_miss,
    missed_offsets,
    without_new_twins,
)
from linecad.model.clean.strokes import strokes_of

X, Y, Z = range(3)
FORWARD = np.array([0.0, 1, 0])
DEPTH = 10.0


@pytest.fixture
def strokes(lines):
    """Strokes of rows (axis, start, end)."""

    def build(rows, **more):
        return strokes_of(lines(rows, **more), FORWARD)

    return build


def closed(strokes):
    return close_ends(strokes)[0].reach.tolist()


BEAM = (X, (-2, DEPTH, 1), (2, DEPTH, 1))


@pytest.mark.parametrize(("top", "new"), [(0.95, 1), (1.05, 1), (1, 1), (0.85, 0.85), (1.15, 1.15)])
def test_an_end_goes_to_the_line_that_it_nearly_meets(strokes, top, new):
    assert closed(strokes([BEAM, (Z, (0, DEPTH, -1), (0, DEPTH, top))])) == [[-2, 2], [-1, new]]


def test_two_ends_that_nearly_meet_form_a_corner(strokes):
    assert closed(strokes([BEAM, (Z, (2.06, DEPTH, -1), (2.06, DEPTH, 0.95))])) == [[-2, 2.06], [-1, 1]]


def test_a_line_that_ends_elsewhere_is_drawn_on_to_form_a_corner(strokes):
    post, hanging = ((Z, (x, DEPTH, -1), (x, DEPTH, top)) for x, top in ((2, 1), (2.06, 0.95)))
    assert closed(strokes([BEAM, post, hanging])) == [[-2, 2.06], [-1, 1], [-1, 1]]
    post, hanging = ((Z, (x, DEPTH, -1), (x, DEPTH, top)) for x, top in ((-2, 1), (-2.06, 0.95)))
    assert closed(strokes([BEAM, post, hanging])) == [[-2.06, 2], [-1, 1], [-1, 1]]


def test_an_end_goes_to_the_nearest_of_several(strokes):
    rows = [BEAM, (X, (-2, DEPTH, 1.06), (2, DEPTH, 1.06)), (Z, (0, DEPTH, -1), (0, DEPTH, 1.04))]
    assert closed(strokes(rows))[2] == [-1, 1.06]


def test_an_end_that_meets_a_line_stays(strokes):
    rows = [BEAM, (X, (-2, DEPTH, 1.06), (2, DEPTH, 1.06)), (Z, (0, DEPTH, -1), (0, DEPTH, 1))]
    assert closed(strokes(rows))[2] == [-1, 1]


def test_a_line_that_would_shrink_to_nothing_stays(strokes):
    """Of a stub both ends are near to the beam; the nearer one goes there."""
    rows = [BEAM, (Z, (0, DEPTH, 1.01), (0, DEPTH, 1.08))]
    assert closed(strokes(rows))[1] == [1, 1.08]
    rows = [BEAM, (Z, (0, DEPTH, 0.96), (0, DEPTH, 1.05))]  # it crosses: the longer side stays
    assert closed(strokes(rows))[1] == [1, 1.05]


def test_lines_in_different_planes_or_components_do_not_meet(strokes):
    behind = (Z, (0, DEPTH + 0.01, -1), (0, DEPTH + 0.01, 0.95))
    assert closed(strokes([BEAM, behind]))[1] == [-1, 0.95]
    apart = (Z, (0, DEPTH, -1), (0, DEPTH, 0.95))
    assert closed(strokes([BEAM, apart], component=[0, 1]))[1] == [-1, 0.95]


def test_planes_that_keep_an_end_from_its_line_are_named_nearest_first(strokes):
    far, near = ((Z, (x, DEPTH + off, -1), (x, DEPTH + off, 1)) for x, off in ((0, 0.05), (1, 0.01)))
    found = strokes([BEAM, far, near])
    after, meets = close_ends(found)
    assert meets.tolist() == [[False, False]] * 3
    depths = [found.number[row, Y] for row in range(3)]
    assert missed_offsets(after, meets).tolist() == [[depths[2], depths[0]], [depths[1], depths[0]]]
    assert ends_that_miss(after, meets).tolist() == [[False, False], [False, True], [False, True]]


def test_which_ends_meet(strokes):
    post = (Z, (2, DEPTH, -1), (2, DEPTH, 1))
    assert ends_that_meet(strokes([BEAM, post])).tolist() == [[False, True], [False, True]]
    assert ends_that_meet(strokes([])).shape == (0, 2)


def test_an_end_is_not_drawn_on_to_another_piece_of_its_line(strokes):
    rows = [(X, (-2, DEPTH, 1), (-1, DEPTH, 1)), (X, (0, DEPTH, 1), (1, DEPTH, 1)), (X, (0, DEPTH, 0), (1, DEPTH, 0))]
    before = strokes(rows)
    for end, drawn in ((-0.05, False), (-0.5, True)):
        after = strokes([(X, (-2, DEPTH, 1), (end, DEPTH, 1)), *rows[1:]])
        assert (without_new_twins(before, after).reach[0, 1] == end) == drawn
