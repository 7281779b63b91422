"""Lines that a person draws or turns: they pass through vanishing points, and their ends snap to other lines."""

from dataclasses import replace

import numpy as np
import pytest

from linecad.corrections.apply import Correcting
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


class TestSnap:
    def test_an_end_near_another_line_ends_there(self, made):
        lines = Correcting(made.segments, made.camera, made.frame)
        start = made.pixels[0, 0]
        ends, axis, snapped = lines.snapped(start + np.array([[3, 2], [3, 160]]), 2)
        assert snapped == (True, False)
        assert ends[0] == pytest.approx(start, abs=3)
        along, to = ends[1] - ends[0], start - ends[0]
        assert abs(along[0] * to[1] - along[1] * to[0]) < 1e-6 * np.linalg.norm(along)
        assert off_axis(made, ends, axis) < 1e-9

    def test_the_axis_is_that_of_the_nearest_vanishing_point(self, made):
        lines = Correcting(made.segments, made.camera, made.frame)
        for line in range(0, len(made.axis), 5):
            assert lines.snapped(made.pixels[line] + np.array([0.6, -0.4]), None)[1] == made.axis[line]


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
