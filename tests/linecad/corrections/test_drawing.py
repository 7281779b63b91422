"""Lines that a person draws or turns: they pass through vanishing points, and their ends snap to other lines."""

from dataclasses import replace

import numpy as np
import pytest

from linecad.corrections.drawing import Drawing
from linecad.corrections.edits import Anchor, Draw, SetAxis
from linecad.errors import CorrectionError
from linecad.geometry import angles_to, vanishing_points


def off_axis(made, ends, axis):
    """Sine of the angle of a segment to the vanishing point of an axis."""
    return angles_to(np.asarray(ends)[None], vanishing_points(made.camera.matrix, made.frame.rotation))[axis, 0]


def test_another_axis_turns_the_line_about_its_middle(made, applied, anchor):
    lines = applied(SetAxis(anchor(3), 1 if made.axis[3] != 1 else 0))
    axis = lines.segments.axis[3]
    assert axis != made.axis[3]
    assert off_axis(made, lines.segments.ends[3], axis) < 1e-9
    assert lines.segments.ends[3].mean(axis=0) == pytest.approx(made.pixels[3].mean(axis=0))
    assert np.delete(lines.segments.ends, 3, axis=0) == pytest.approx(np.delete(made.pixels, 3, axis=0))


def test_a_drawn_line_passes_through_its_vanishing_point(made, applied):
    lines = applied(Draw(Anchor(((700.0, 300.0), (900.0, 320.0)), 0)))
    assert off_axis(made, lines.segments.ends[-1], 0) < 1e-9
    assert lines.segments.ends[-1] == pytest.approx(np.array([[700, 300], [900, 320]]), abs=20)


class TestReaching:
    def test_ends_become_their_feet_on_the_line_itself(self, made):
        ends = np.array([[100.0, 100.0], [200.0, 100.0]])
        drawing = Drawing(made.camera, made.frame)
        assert drawing.reaching(ends, np.array([[80.0, 107.0], [260.0, 91.0]])).tolist() == [[80, 100], [260, 100]]

    def test_they_keep_the_direction_of_a_line_that_was_found_the_other_way_round(self, made):
        ends = np.array([[200.0, 100.0], [100.0, 100.0]])
        wanted = np.array([[80.0, 100.0], [260.0, 100.0]])
        assert Drawing(made.camera, made.frame).reaching(ends, wanted).tolist() == [[260, 100], [80, 100]]


def test_a_line_that_takes_no_part_in_the_graph_is_refused(made):
    ends = np.array([[100.0, 100.0], [110.0, 100.0]])
    with pytest.raises(CorrectionError, match="a line of 10 px is too short; at least 10 px are needed"):
        Drawing(made.camera, made.frame).long_enough(ends)


def test_pieces_of_a_split_line_meet_at_the_foot_of_the_point(made):
    one, other = Drawing(made.camera, made.frame).split(np.array([[0.0, 0.0], [100.0, 0.0]]), (40.0, 3.0))
    assert one.tolist() == [[0, 0], [40, 0]]
    assert other.tolist() == [[40, 0], [100, 0]]


def test_a_direction_that_the_photo_has_not_is_refused(made):
    drawing = Drawing(made.camera, made.frame)
    with pytest.raises(CorrectionError, match="the photo has no direction x2; choose another axis"):
        drawing.turned(np.array([[700.0, 300.0], [900.0, 320.0]]), 3)
    turned = Drawing(made.camera, replace(made.frame, turns=(0.2,)))
    assert len(turned.turned(np.array([[700.0, 300.0], [900.0, 320.0]]), 3)) == 2
