"""Control lines as a person would draw them."""

from dataclasses import replace

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from exporters.camera import vanishing_points
from exporters.fspy.control_lines import find_control_lines
from linecad.line_graph import Segments


@given(st.floats(-3, 3), st.floats(-1.5, 1.5), st.floats(-3, 3))
def test_control_lines_run_to_the_vanishing_point_however_the_camera_is_turned(scene, yaw, pitch, roll):
    turns = [(yaw, 0, 2), (pitch, 1, 2), (roll, 0, 1)]
    rotation = np.eye(3)
    for angle, i, j in turns:
        turn = np.eye(3)
        turn[[i, j], [i, j]] = np.cos(angle)
        turn[i, j], turn[j, i] = -np.sin(angle), np.sin(angle)
        rotation = rotation @ turn
    turned = replace(scene, rotation=rotation)
    segments = Segments(turned.lines.segment, turned.lines.axis)
    goals = vanishing_points(turned.camera, turned.rotation)
    assert np.isfinite(goals).all()
    for axis in range(3):
        for start, end in find_control_lines(turned.camera, turned.rotation, segments, axis):
            along, towards = end - start, goals[axis] - start
            off = along[0] * towards[1] - along[1] * towards[0]
            assert abs(off) <= 1e-6 * np.linalg.norm(along) * np.linalg.norm(towards)
            assert np.linalg.norm(along) > 1
