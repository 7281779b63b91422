"""What a drawn or stretched line becomes: snapping moves an end, and a line far off every axis is asked about."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from linecad.corrections.drawing import Drawing
from linecad.corrections.lookup import LineTable
from linecad.corrections.snapping import find_snap, propose, stretch
from linecad.errors import CorrectionError
from linecad.geometry import angles_to, segment_coordinates, vanishing_points

NONE = LineTable(np.zeros(0, np.int64), np.zeros((0, 2, 2)), np.zeros(0, np.int64))
REACH = 12.0


@pytest.fixture(scope="module")
def drawing(made):
    return Drawing(made.camera, made.frame)


@pytest.fixture(scope="module")
def table(made):
    return LineTable(np.arange(len(made.axis)), made.pixels.copy(), made.axis)


def lines(*ends):
    return LineTable(np.arange(len(ends)), np.array(ends, float), np.zeros(len(ends), np.int64))


def off_axis(made, ends, axis):
    """Sine of the angle of a segment to the vanishing point of an axis."""
    return angles_to(np.asarray(ends)[None], vanishing_points(made.camera.matrix, made.frame.rotation))[axis, 0]


def towards(made, start, axis, length, degrees=0.0):
    """A segment from a point that runs that much off the vanishing point of an axis, seen from its middle at last."""
    ends = Drawing(made.camera, made.frame).turned(start + np.array([[0.0, 0.0], [1.0, 1.0]]) * length, axis)
    middle, turn = ends.mean(axis=0), np.radians(degrees)
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    return middle + (ends - middle) @ rotation.T


class TestAxis:
    def test_it_is_that_of_the_nearest_vanishing_point(self, made, drawing):
        for line in range(0, len(made.axis), 5):
            drawn = made.pixels[line] + np.array([0.6, -0.4])
            assert propose(drawing, NONE, drawn, None, 0.0).axis == made.axis[line]

    def test_a_line_a_few_degrees_off_is_turned_and_one_farther_off_is_asked_about(self, made, drawing):
        """What lay 15 degrees off every axis was bent to the nearest without a word."""
        for degrees, is_bent in ((2.0, False), (-3.5, False), (6.0, True), (-15.0, True)):
            found = propose(drawing, NONE, towards(made, np.array([700.0, 500.0]), 2, 300, degrees), 2, 0.0)
            assert np.degrees(found.off) == pytest.approx(abs(degrees), abs=1e-6)
            assert found.is_bent == is_bent
            assert off_axis(made, found.ends, 2) < 1e-9

    def test_a_level_line_of_a_further_frame_is_no_bent_one(self, made):
        turned = Drawing(made.camera, replace(made.frame, turns=(0.3,)))
        ends = turned.turned(np.array([[400.0, 500.0], [700.0, 520.0]]), 3)
        found = propose(turned, NONE, ends, None, 0.0)
        assert (found.axis, found.is_bent) == (3, False)
        assert found.ends == pytest.approx(ends)


class TestSnapping:
    def test_a_point_snaps_to_the_nearest_end_then_to_the_nearest_line(self):
        there = lines([[0, 0], [100, 0]], [[104, 6], [104, 90]])
        snap = find_snap(np.array([98.0, 3.0]), there, REACH)
        assert (snap.line, snap.is_end, snap.point.tolist()) == (0, True, [100, 0])
        snap = find_snap(np.array([50.0, 7.0]), there, REACH)
        assert (snap.line, snap.is_end, snap.point.tolist()) == (0, False, [50, 0])
        assert find_snap(np.array([50.0, 13.0]), there, REACH) is None
        assert find_snap(np.array([0.0, 0.0]), NONE, REACH) is None

    def test_an_end_near_that_of_another_line_takes_its_place(self, made, drawing, table):
        start = made.pixels[0, 0]
        found = propose(drawing, table, start + np.array([[6, 5], [3, 160]]), 2, REACH)
        assert found.snaps[0].is_end
        assert found.ends[0] == pytest.approx(found.snaps[0].point)
        assert np.linalg.norm(found.ends[0] - start) <= REACH * 1.5
        assert off_axis(made, found.ends, 2) < 1e-9

    def test_an_end_near_a_line_slides_to_where_the_drawn_line_crosses_it(self, made, drawing):
        drawn = towards(made, np.array([700.0, 400.0]), 2, 200)
        bottom = drawn[1]
        across = lines([np.add(bottom, [-80.0, 7.0]), np.add(bottom, [90.0, 7.0])])
        alone, found = (propose(drawing, there, drawn, 2, REACH) for there in (NONE, across))
        assert found.snaps[0] is None
        assert (found.snaps[1].line, found.snaps[1].is_end) == (0, False)
        assert found.ends[1][1] == pytest.approx(bottom[1] + 7)
        assert np.abs(segment_coordinates(found.ends, alone.ends)[1]).max() < 1e-9  # the line is the same one

    def test_a_line_that_ends_far_before_the_crossing_is_not_crossed(self, made, drawing):
        """It was where it is slanted: beside the drawn line its end is near, along it far away."""
        drawn = towards(made, np.array([700.0, 400.0]), 2, 200)
        there = np.add(drawn[1], [0.0, 4.0])
        slanted = lines([np.add(there, [9.0, 90.0]), np.add(there, [30.0, 300.0])])
        assert propose(drawing, slanted, drawn, 2, 15.0).snaps[1] is None
        near = lines([np.add(there, [1.2, 9.0]), np.add(there, [30.0, 300.0])])
        assert propose(drawing, near, drawn, 2, 15.0).snaps[1] is not None

    @given(st.integers(0, 10**6), st.floats(1, 15))
    def test_whatever_it_snaps_to_the_free_end_stays_near_where_it_was_drawn(self, made, drawing, table, seed, reach):
        """Two ends that snapped put the line between both, 24 px from where it was drawn, and neither end was there."""
        random = np.random.default_rng(seed)
        start = random.uniform([200, 200], [1300, 900])
        drawn = towards(made, start, int(random.integers(3)), 150)
        alone, found = (propose(drawing, there, drawn, None, reach) for there in (NONE, table))
        for end in range(2):
            assert np.linalg.norm(found.ends[end] - alone.ends[end]) <= 2.2 * reach
            snap = found.snaps[end]
            if snap is not None and not snap.is_end:
                assert segment_distance(found.ends[end], table.ends[snap.line]) < 2 * reach
            if snap is not None and snap.is_end:
                assert np.linalg.norm(table.ends[snap.line] - found.ends[end], axis=1).min() <= 2.0 + 1e-9
        assert off_axis(made, found.ends, found.axis) < 1e-9

    def test_of_two_ends_that_no_line_along_the_axis_joins_the_nearer_one_is_kept(self, made, drawing):
        drawn = towards(made, np.array([700.0, 400.0]), 2, 200)
        near, far = drawn[0] + [2.0, 0.0], drawn[1] + [-11.0, 0.0]
        there = lines([near, np.add(near, [0.0, -90.0])], [far, np.add(far, [-90.0, 0.0])])
        found = propose(drawing, there, drawn, 2, REACH)
        assert found.snaps[0].is_end
        assert found.ends[0] == pytest.approx(near)
        assert found.snaps[1] is None or not found.snaps[1].is_end


def segment_distance(point, ends):
    place, beside = segment_coordinates(point, ends)
    over = max(-place, place - np.linalg.norm(ends[1] - ends[0]), 0)
    return float(np.hypot(over, beside))


class TestStretching:
    ENDS = ((100.0, 100.0), (200.0, 100.0))

    def test_an_end_moves_along_the_line_and_the_other_stays(self, drawing):
        found = stretch(drawing, lines(self.ENDS), 0, 1, np.array([260.0, 117.0]), REACH)
        assert found.ends.tolist() == [[100, 100], [260, 100]]
        assert found.snaps == (None, None)

    def test_it_snaps_to_where_another_line_crosses(self, drawing):
        there = lines(self.ENDS, ([250, 60], [254, 140]))
        found = stretch(drawing, there, 0, 1, np.array([246.0, 104.0]), REACH)
        assert found.ends[1] == pytest.approx([252, 100])
        assert (found.snaps[1].line, found.snaps[1].is_end) == (1, False)

    def test_a_line_that_stops_short_of_it_is_met_too(self, drawing):
        there = lines(self.ENDS, ([250, 20], [250, 93]))
        assert stretch(drawing, there, 0, 1, np.array([246.0, 100.0]), REACH).ends[1] == pytest.approx([250, 100])
        there = lines(self.ENDS, ([250, 20], [250, 80]))
        assert stretch(drawing, there, 0, 1, np.array([246.0, 100.0]), REACH).ends[1] == pytest.approx([246, 100])

    @pytest.mark.parametrize("at", [(105.0, 100.0), (40.0, 100.0)])
    def test_an_end_does_not_pass_the_other(self, drawing, at):
        with pytest.raises(CorrectionError, match="the line would be shorter than 10 px"):
            stretch(drawing, lines(self.ENDS), 0, 1, np.array(at), REACH)
