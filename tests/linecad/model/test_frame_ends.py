"""Ends at lines of other frames."""

import numpy as np
import pytest

from linecad.directions import directions_of
from linecad.model.clean.ends import NEAR
from linecad.model.clean.sight import Sight
from linecad.model.frame_ends import (
    closed_across,
    ends_that_meet_others,
    ends_that_miss_others,
    missed_pairs,
    strokes_in_frames,
    with_ends_closed,
)
from linecad.model.frames import FramedLines, in_frame

TURNS = (0.5,)
X, Y, Z = range(3)
DEPTH = 10.0
ALONG = np.array([1.0, 0, 0])
CORNER = np.array([0.0, DEPTH, 0.0])  # where the walls y = DEPTH of the world and through it along x2 meet


@pytest.fixture
def sight(camera, rotation):
    return Sight.of(camera, rotation, None)


@pytest.fixture
def corner(lines):
    """Lines of both walls: level ones of the first end `short` of the corner, those of the second begin there."""

    def build(short=0.0, height=0.0, component=None):
        there = in_frame(CORNER, 1, TURNS)
        first = (X, (-2, DEPTH, height), (-short, DEPTH, height))
        second = (X, there, there + 2 * ALONG)
        return FramedLines(lines([first, second], component), np.array([0, 1]), TURNS)

    return build


@pytest.mark.parametrize("short", [0.06, -0.06])
def test_an_end_near_a_line_of_another_frame_goes_there(corner, sight, short):
    before = corner(short)
    after = closed_across(before, sight)
    np.testing.assert_allclose(after.lines.ends[0, 1], CORNER, atol=1e-12)
    np.testing.assert_allclose(after.lines.ends[1], before.lines.ends[1], atol=1e-12)
    assert ends_that_meet_others(before, sight).tolist() == [[False, False], [short < 0, False]]
    assert ends_that_miss_others(before, sight).misses.tolist() == [[False, True], [short > 0, False]]
    assert ends_that_meet_others(after, sight).tolist() == [[False, True], [True, False]]
    assert not ends_that_miss_others(after, sight).misses.any()


@pytest.mark.parametrize(("short", "height"), [(0.3, 0.0), (0.06, 0.01)])
def test_an_end_that_is_far_or_higher_stays(corner, sight, short, height):
    before = corner(short, height)
    np.testing.assert_array_equal(closed_across(before, sight).lines.ends, before.lines.ends)


def test_lines_of_two_components_do_not_meet(corner, sight):
    before = corner(0.06, component=[0, 1])
    np.testing.assert_array_equal(closed_across(before, sight).lines.ends, before.lines.ends)
    assert not ends_that_miss_others(before, sight).misses.any()
    assert len(missed_pairs(before, sight)) == 0


def test_at_a_small_angle_an_end_goes_further_but_not_any_way(lines, sight):
    for turn, closes in ((0.4, True), (0.2, False)):
        turns = (turn,)
        there = in_frame(CORNER, 1, turns)
        off = 0.8 * NEAR * DEPTH  # of the end from the other line
        first = (X, (-4, DEPTH, 0), (off / np.sin(turn), DEPTH, 0))
        framed = FramedLines(lines([first, (X, there - 3 * ALONG, there + 3 * ALONG)]), np.array([0, 1]), turns)
        after = closed_across(framed, sight)
        assert (abs(after.lines.ends[0, 1, X]) < 1e-12) == closes


def test_a_post_and_a_level_line_of_another_frame_meet_both_ways_round(lines, sight):
    foot = CORNER[:2] + 0.7 * directions_of(TURNS)[3, :2]  # in the second wall
    there = in_frame(CORNER, 1, TURNS)
    post = (Z, (*foot, 0.05), (*foot, 2))
    level = (X, there, there + 0.66 * ALONG)
    after = closed_across(FramedLines(lines([post, level]), np.array([0, 1]), TURNS), sight)
    assert after.lines.ends[0, 0].tolist() == [*foot, 0.0]
    np.testing.assert_allclose(after.lines.ends[1, 1], there + 0.7 * ALONG, atol=1e-12)
    away = (Z, (*(foot + 0.01), 0.05), (*(foot + 0.01), 2))  # not in the wall
    apart = FramedLines(lines([away, level]), np.array([0, 1]), TURNS)
    np.testing.assert_array_equal(closed_across(apart, sight).lines.ends, apart.lines.ends)


def test_each_line_has_the_depth_of_its_place_in_the_world(corner, sight):
    framed = corner()
    depth = framed.in_world().ends @ sight.forward
    strokes = strokes_in_frames(framed, sight)
    np.testing.assert_allclose(np.sort(strokes.end_depth), np.sort(depth))
    np.testing.assert_allclose(strokes.of(np.array([False, True])).end_depth, strokes.end_depth[1:])


def test_with_one_frame_ends_close_within_it_alone(lines, sight):
    rows = [(X, (-1, DEPTH, 0), (0.96, DEPTH, 0)), (Z, (1, DEPTH, -1), (1, DEPTH, 1))]
    only = FramedLines(lines(rows), np.zeros(2, int), ())
    assert closed_across(only, sight) is only
    assert with_ends_closed(only, sight).lines.ends[0, 1].tolist() == [1, DEPTH, 0]
    assert not ends_that_meet_others(only, sight).any()
    assert not ends_that_miss_others(only, sight).misses.any()
    assert len(missed_pairs(only, sight)) == 0


def test_pairs_that_miss_are_those_whose_planes_are_apart(corner, sight):
    assert missed_pairs(corner(0.06, 0.04), sight).tolist() == [[0, 1], [1, 0]]
    assert len(missed_pairs(corner(0.0), sight)) == 0
    assert len(missed_pairs(corner(0.0, 0.2), sight)) == 0


@pytest.mark.parametrize(("height", "length", "hugs"), [(0.0, 0.4, True), (0.0, 0.8, False), (0.08, 0.3, False)])
def test_a_line_hugs_one_that_it_stands_on_and_does_not_leave(lines, sight, height, length, hugs):
    turns = (0.2,)
    there = in_frame(CORNER + height * np.array([0, 0, 1.0]), 1, turns)
    rows = [(X, (-2, DEPTH, 0), (2, DEPTH, 0)), (X, there, there + length * ALONG)]
    found = ends_that_miss_others(FramedLines(lines(rows), np.array([0, 1]), turns), sight)
    assert found.hugs.tolist() == [False, hugs]
