"""Pieces of one line between which the photo shows the edge."""

import pytest

from linecad.model.clean.gaps import continued
from linecad.model.clean.sight import Sight
from linecad.model.clean.strokes import strokes_of

X = 0
DEPTH = 10.0


def row(start, end, height=1.0):
    return (X, (start, DEPTH, height), (end, DEPTH, height))


@pytest.fixture
def pairs(lines, photo, camera, rotation):
    """The pairs among rows that go on to each other in a photo of other rows."""

    def find(rows, shown):
        sight = Sight(camera.matrix, rotation, photo(shown))
        return continued(strokes_of(lines(rows), sight.forward), sight).tolist()

    return find


def test_pieces_go_on_to_each_other_where_the_photo_shows_it(pairs):
    rows = [row(-3, -1), row(0.5, 3)]
    assert pairs(rows, [row(-3, 3)]) == [[0, 1]]
    assert pairs(rows[::-1], [row(-3, 3)]) == [[0, 1]]
    assert pairs(rows, rows) == []
    assert pairs(rows, [row(-3, 3, 1.1)]) == []


@pytest.mark.parametrize("shown", [(-3, 0), (-0.5, 3)])
def test_an_edge_over_half_of_the_gap_does_not_join(pairs, shown):
    assert pairs([row(-3, -1), row(0.5, 3)], [row(-3, -1), row(0.5, 3), row(*shown)]) == []


def test_a_gap_is_no_wider_than_the_shorter_piece(pairs):
    for start, expected in ((-2.6, [[0, 1]]), (-2.4, [])):
        assert pairs([row(start, -1), row(0.5, 3)], [row(-3, 3)]) == expected


def test_pieces_that_nearly_touch_are_left_to_others(pairs):
    assert pairs([row(-3, -1), row(-0.95, 3)], [row(-3, 3)]) == []


def test_parallel_lines_are_no_pieces_of_one(pairs):
    assert pairs([row(-3, -1), row(0.5, 3, 1.02)], [row(-3, 3)]) == []
