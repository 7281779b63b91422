"""Lines that run across a face."""

import numpy as np
import pytest

from linecad.model.clean.bands import run_across
from linecad.model.clean.strokes import strokes_of
from linecad.scene import Face, Plane

X, Y, Z = range(3)
FORWARD = np.array([0.0, 1, 0])
DEPTH = 10.0
WALL = [(-4, DEPTH, -3), (4, DEPTH, -3), (4, DEPTH, 3), (0, DEPTH, 6), (-4, DEPTH, 3)]  # with a gable
PLANES = (Plane(0, Y, DEPTH, (), (Face(0, WALL),)),)


@pytest.mark.parametrize(
    ("row", "across"),
    [
        ((X, (-4, DEPTH, 2), (4, DEPTH, 2)), True),
        ((X, (-2, DEPTH, 2), (2.9, DEPTH, 2)), True),
        ((X, (-2, DEPTH, 2), (2.7, DEPTH, 2)), False),
        ((X, (-4, DEPTH, -4), (4, DEPTH, -4)), False),  # below the wall
        ((X, (-1.9, DEPTH, 4.5), (1.9, DEPTH, 4.5)), True),  # from side to side of the gable
        ((X, (-1, DEPTH, 5.2), (1, DEPTH, 5.2)), False),  # in its tip
        ((Z, (2, DEPTH, -3), (2, DEPTH, 3)), True),
        ((Y, (2, DEPTH - 4, 0), (2, DEPTH + 4, 0)), False),
        ((X, (-4, DEPTH - 0.4, 2), (4, DEPTH - 0.4, 2)), True),  # a cornice
        ((X, (-4, DEPTH - 0.6, 2), (4, DEPTH - 0.6, 2)), False),  # a cable
    ],
)
def test_lines_from_side_to_side_run_across(lines, row, across):
    assert run_across(strokes_of(lines([row]), FORWARD), PLANES).tolist() == [across]


def test_what_stands_before_a_face_counts_where_it_is_seen_on_it(lines):
    """A line at 2.88 before the wall is seen at 3 on it; where the wall ends lower it is seen above."""
    row = (X, (-3.9, DEPTH - 0.4, 2.95), (3.9, DEPTH - 0.4, 2.95))
    low = (Plane(0, Y, DEPTH, (), (Face(0, [(-4, DEPTH, -3), (4, DEPTH, -3), (4, DEPTH, 3), (-4, DEPTH, 3)]),)),)
    assert run_across(strokes_of(lines([row]), FORWARD), low).tolist() == [False]


def test_without_lines_or_faces_nothing_runs_across(lines):
    assert run_across(strokes_of(lines([]), FORWARD), PLANES).tolist() == []
    assert run_across(strokes_of(lines([(X, (-4, DEPTH, 2), (4, DEPTH, 2))]), FORWARD), ()).tolist() == [False]
