"""The page's lines in the scene of a model: which row each is, and how sure that is."""

import numpy as np

from exporters.bands import GUESS, bands_of
from linecad.arrays import Bool, Float, Int
from linecad.line_graph import LineGraph
from linecad.scene import Scene


def rows_in_scene(graph: LineGraph, scene: Scene) -> Int:
    """(N,) the row of the scene that each line of a graph is in, -1 where it is in none."""
    rows = scene.lines.row_by_look
    looks = zip(graph.axis.tolist(), graph.segments.ends, strict=True)
    return np.array([rows.get((axis, ends.tobytes()), -1) for axis, ends in looks], np.int64)


def is_guess(scene: Scene) -> Bool:
    """(N,) whether the depth of each line is more likely wrong than right; where the scene does not tell, is weak."""
    bands = bands_of(scene.lines)
    guess: Bool = scene.lines.confidence == "weak" if bands is None else bands == GUESS
    return guess


def sureness(scene: Scene) -> Float:
    """(N,) the probability that the depth of each line is right; where the scene does not tell, 0 for what is weak."""
    if len(scene.lines.probability):
        return np.asarray(scene.lines.probability, float)
    return np.asarray(~is_guess(scene), float)
