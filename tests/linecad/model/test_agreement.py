"""Differences between what the solver decided and what the planes and faces show."""

import numpy as np
import pytest

from linecad.model.agreement import bounding, disagreements
from linecad.scene import Face, Lines, Plane

# A front at y = 4 and a side at x = 2 that meet in line 1, with a sill (line 3) in the front.
AXIS = [2, 2, 0, 0, 1]
ENDS = np.array(
    [
        [[0, 4, 0], [0, 4, 3]],
        [[2, 4, 0], [2, 4, 3]],
        [[0, 4, 3], [2, 4, 3]],
        [[0.5, 4, 1], [1.5, 4, 1]],
        [[2, 4, 3], [2, 6, 3]],
    ],
    float,
)
FRONT = Face(0, [[0, 4, 0], [2, 4, 0], [2, 4, 3], [0, 4, 3]])
SIDE = Face(1, [[2, 4, 0], [2, 6, 0], [2, 6, 3], [2, 4, 3]])
PLANES = (Plane(0, 1, 4.0, (10, 11, 12, 13), (FRONT,)), Plane(1, 0, 2.0, (11, 14), (SIDE,)))
EDGE_ONLY = [False, True, False, False, False]


def lines(is_boundary, ends=ENDS):
    count = len(AXIS)
    return Lines(
        id=10 + np.arange(count), axis=AXIS, segment=np.zeros((count, 2, 2)), ends=ends, is_boundary=is_boundary,
        component=np.zeros(count), confidence=np.full(count, "proven"),
    )  # fmt: skip


def test_a_ground_without_lines_bounds_nothing():
    ground = Plane(2, 2, 0.0, (), (Face(2, [[-9, 1, 0], [9, 1, 0], [9, 4, 0], [-9, 4, 0]], kind="ground"),))
    for found, without in zip(
        bounding((*PLANES, ground), lines(EDGE_ONLY)), bounding(PLANES, lines(EDGE_ONLY)), strict=True
    ):
        assert found.tolist() == without.tolist()


def test_the_edge_of_two_faces_bounds_and_a_line_within_one_does_not():
    bounds, shown = bounding(PLANES, lines(EDGE_ONLY))
    assert bounds.tolist() == EDGE_ONLY
    assert shown.all()


def test_nothing_to_say_where_all_agree():
    assert disagreements(PLANES, lines(EDGE_ONLY), np.array([[0, 1, 0], [2, 3, 2]])) == []
    assert disagreements((), lines(EDGE_ONLY), np.zeros((0, 3), np.int64)) == []


@pytest.mark.parametrize("wrong", [[True, True, False, False, False], [False] * 5])
def test_boundaries_that_differ_are_counted(wrong):
    (note,) = disagreements(PLANES, lines(wrong), np.zeros((0, 3), np.int64))
    assert note.startswith("1 of 5 lines")


def test_planar_pairs_in_two_planes_are_counted():
    ends = ENDS.copy()
    ends[3, :, 1] = 4.1
    planes = (Plane(0, 1, 4.0, (10, 11, 12), (FRONT,)), PLANES[1])
    (note,) = disagreements(planes, lines(EDGE_ONLY, ends), np.array([[0, 1, 0], [2, 3, 2]]))
    assert note.startswith("1 of 2 pairs")


def test_a_face_that_a_line_touches_at_its_end_only_bounds_nothing():
    # The side stops above the line's upper end, so that they share one point only.
    above = Face(1, [[2, 4, 3], [2, 6, 3], [2, 6, 5], [2, 4, 5]])
    planes = (PLANES[0], Plane(1, 0, 2.0, (11, 14), (above,)))
    assert not bounding(planes, lines(EDGE_ONLY))[0].any()
