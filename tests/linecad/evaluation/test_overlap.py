"""Stretches along which segments run together, against cases made by hand and against dense sampling."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from linecad.evaluation.overlap import find_overlaps, union_length

LEVEL = np.array([[0.0, 0], [100, 0]])


def overlap(segment, *pieces, reach=2.0, degrees=5.0):
    return find_overlaps(np.array(segment, float), np.array(pieces, float), reach, np.radians(degrees))


def test_parallel_pieces_overlap_where_they_face_each_other():
    found = overlap(LEVEL, [[20, 1], [50, 1]], [[120, 1], [150, 1]], [[90, -2], [70, -2]], [[0, 2.1], [100, 2.1]])
    assert found.piece.tolist() == [0, 2]
    assert found.start.tolist() == [20, 70]
    assert found.end.tolist() == [50, 90]
    assert found.distance.tolist() == [1, 2]


def test_a_slanted_piece_counts_until_it_is_out_of_reach():
    slope = np.tan(np.radians(4))
    found = overlap(LEVEL, [[0, 0], [100, 100 * slope]])
    assert found.start == pytest.approx([0])
    assert found.end == pytest.approx([2 / np.sin(np.radians(4))])


def test_a_piece_at_too_wide_an_angle_does_not_count():
    assert len(overlap(LEVEL, [[0, 0], [100, 100 * np.tan(np.radians(6))]]).piece) == 0


def test_a_piece_without_length_does_not_count():
    assert len(overlap(LEVEL, [[5, 0], [5, 0]]).piece) == 0


corner = st.tuples(st.floats(-50, 50), st.floats(-50, 50))


@given(first=corner, second=corner, third=corner, fourth=corner)
def test_intervals_are_those_of_dense_sampling(first, second, third, fourth):
    segment, piece = np.array([first, second]), np.array([third, fourth])
    length, other = (np.linalg.norm(ends[1] - ends[0]) for ends in (segment, piece))
    if min(length, other) < 1:
        return
    found = find_overlaps(segment, piece[None], 10.0, np.radians(20))
    along, unit = (segment[1] - segment[0]) / length, (piece[1] - piece[0]) / other
    at = np.linspace(0, length, 4001)
    to = segment[0] + at[:, None] * along - piece[0]
    near = np.abs(unit[0] * to[:, 1] - unit[1] * to[:, 0]) <= 10
    near &= (to @ unit >= 0) & (to @ unit <= other)
    near &= abs(unit[0] * along[1] - unit[1] * along[0]) <= np.sin(np.radians(20))
    assert (found.end - found.start).sum() == pytest.approx(near.mean() * length, abs=length / 1000)


def test_a_union_counts_what_is_covered_twice_once():
    start, end = np.array([0.0, 5, 20, 6]), np.array([10.0, 12, 30, 7])
    assert union_length(start, end) == 22
    assert union_length(start, end, np.array([True, False, False, True])) == 10
    assert union_length(np.zeros(0), np.zeros(0)) == 0
