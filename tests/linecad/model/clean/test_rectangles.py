"""Rectangles that lines close."""

import numpy as np
import pytest

from linecad.model.clean.rectangles import closed_rectangles
from linecad.model.clean.strokes import strokes_of

X, Y, Z = range(3)
DEPTH = 10.0
FORWARD = np.array([0.0, 1, 0])
# The axes before the camera: windows in a wall ahead, in a side wall, in a floor.
TURNS = {Y: (0, 1, 2), X: (1, 0, 2), Z: (0, 2, 1)}


def frame(low, high):
    (left, bottom), (right, top) = low, high
    return [
        *[(X, (left, DEPTH, z), (right, DEPTH, z)) for z in (bottom, top)],
        *[(Z, (x, DEPTH, bottom), (x, DEPTH, top)) for x in (left, right)],
    ]


WALL = frame((-4, -3), (4, 3))
WINDOWS = [frame((-3, -1), (-1, 1)), frame((1, -1), (3, 1))]


def found(lines, rows):
    return closed_rectangles(strokes_of(lines(rows), FORWARD)).tolist()


def test_windows_of_a_wall_are_found_and_the_wall_is_none(lines):
    assert sorted(found(lines, [*WALL, *WINDOWS[0], *WINDOWS[1]])) == [
        [Y, DEPTH, -3, -1, -1, 1],
        [Y, DEPTH, 1, 3, -1, 1],
    ]


@pytest.mark.parametrize("normal", TURNS)
def test_they_are_found_in_planes_of_all_directions(lines, normal):
    order = np.array(TURNS[normal])
    rows = [
        (int(np.flatnonzero(order == axis)[0]), np.array(a)[order] + [0, 20, 0], np.array(b)[order] + [0, 20, 0])
        for axis, a, b in [*WALL, *WINDOWS[0]]
    ]
    (window,) = closed_rectangles(strokes_of(lines(rows), FORWARD)).tolist()
    assert window[0] == normal


def test_bars_and_panes_are_parts_of_their_window(lines):
    bar = (X, (-3, DEPTH, 0), (-1, DEPTH, 0))
    assert found(lines, [*WALL, *WINDOWS[0], bar]) == [[Y, DEPTH, -3, -1, -1, 1]]
    pane = frame((-2.5, 0.2), (-1.5, 0.8))
    assert found(lines, [*WALL, *WINDOWS[0], *pane]) == [[Y, DEPTH, -3, -1, -1, 1]]


def test_windows_above_each_other_are_two(lines):
    rows = [*WALL, *frame((-1, -2), (1, -0.5)), *frame((-1, 0.5), (1, 2))]
    assert sorted(found(lines, rows)) == [[Y, DEPTH, -1, 1, -2, -0.5], [Y, DEPTH, -1, 1, 0.5, 2]]


@pytest.mark.parametrize("side", range(4))
def test_an_open_side_closes_nothing(lines, side):
    window = list(WINDOWS[0])
    del window[side]
    assert found(lines, [*WALL, *window, (X, (-4, DEPTH, 2), (4, DEPTH, 2))]) == []


def test_small_planes_hold_no_openings(lines):
    assert found(lines, WINDOWS[0]) == []
    assert found(lines, []) == []
