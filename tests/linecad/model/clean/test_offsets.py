"""Offsets that become one, and what goes with them."""

import numpy as np
import pytest

from linecad.model.clean.offsets import join_offsets, offsets_of, with_offsets
from linecad.model.clean.strokes import strokes_of

X, Y, Z = range(3)
FORWARD = np.array([0.0, 1, 0])
DEPTH = 10.0
# Two beams of nearly one height, the lower one four times as long in the photo, and a post that ends at the upper one.
ROWS = [
    (X, (-2, DEPTH, 1), (2, DEPTH, 1)),
    (X, (-2, DEPTH, 1.01), (-1, DEPTH, 1.01)),
    (Z, (0, DEPTH, -1), (0, DEPTH, 1.01)),
]


def joined(lines, rows, most=0.002):
    """The strokes with the heights of the first two lines as one, if it may be, and the offsets."""
    strokes = strokes_of(lines(rows), FORWARD)
    before = offsets_of(strokes)
    after = join_offsets(before, strokes, strokes.number[:2, Z][None], most)
    return with_offsets(strokes, before, after), after


def test_the_mean_is_by_length_and_ends_go_with_it(lines):
    strokes, offsets = joined(lines, ROWS)
    height = strokes.offset[0, Z]
    assert height == pytest.approx(1.002)
    assert strokes.offset[1, Z] == strokes.reach[2, 1] == height
    assert strokes.number[0, Z] == strokes.number[1, Z]
    assert offsets.moved.max() == pytest.approx(0.0008)


def test_no_offset_moves_further_than_it_may(lines):
    strokes, offsets = joined(lines, ROWS, most=0.0007)
    assert strokes.offset[:2, Z].tolist() == [1, 1.01]
    assert offsets.moved.max() == 0


def test_a_line_between_them_keeps_them_apart(lines):
    strokes, _ = joined(lines, [*ROWS, (Z, (1, DEPTH, 1), (1, DEPTH, 1.01))])
    assert strokes.offset[:2, Z].tolist() == [1, 1.01]
