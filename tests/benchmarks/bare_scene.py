"""A scene of lines alone, without crossings, planes and a solve; used by exports.py and ties_truth.py."""

import numpy as np

from linecad.arrays import Float
from linecad.directions import Turns
from linecad.scene import Camera, Intersections, Lines, Scene, SolveReport


def scene_of_lines(camera: Camera, rotation: Float, lines: Lines, turns: Turns = ()) -> Scene:
    """The scene; `rotation` (3, 3) takes world to camera."""
    no_crossings = Intersections(
        lines=np.zeros((0, 2), np.int64),
        kind=np.zeros(0, np.str_),
        pixel=np.zeros((0, 2)),
        real=np.zeros(0, np.bool_),
        in_tree=np.zeros(0, np.bool_),
        weight=np.zeros(0),
    )
    report = SolveReport("none", "gain", "optimal", 0, 0, 0)
    return Scene("made.jpg", camera, rotation, lines, no_crossings, (), report, turns=turns)
