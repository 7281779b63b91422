"""A length that a person knows, of a line and of a piece that was joined to another."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from linecad.corrections.lengths import measurable, measured
from linecad.geometry import project
from linecad.line_graph import Segments
from linecad.scene import Camera, Intersections, Lines, Scene, SolveReport

CAMERA = Camera(3000, 2000, np.array([[2500.0, 0, 1499.5], [0, 2500, 999.5], [0, 0, 1]]), "file")
AHEAD = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
WHOLE = np.array([[-2.0, 10, 1], [2, 10, 1]])
PIECES = np.array([[[-2.0, 10, 1], [-1, 10, 1]], [[-0.5, 10, 1], [2, 10, 1]]])


def seen(ends):
    return project(ends, CAMERA.matrix, AHEAD)


@pytest.fixture
def scene():
    lines = Lines([7], [0], [seen(WHOLE)], [WHOLE], [False], [0], ["supported"], pieces=(seen(PIECES),))
    report = SolveReport("SCIP 10.0", "bodies", "optimal", 0, 0, 0)
    return Scene("a.jpg", CAMERA, AHEAD, lines, Intersections([], [], [], [], [], []), (), report)


def corrected(segment, metres):
    return SimpleNamespace(lengths={3: metres}, ids=np.array([3]), segments=Segments(segment[None], [0]))


@pytest.mark.parametrize(("piece", "units"), [(0, 1.0), (1, 2.5)])
def test_the_length_of_a_piece_is_its_own(scene, piece, units):
    assert measured(scene, corrected(seen(PIECES[piece]), 3.0)).metres_per_unit == pytest.approx(3.0 / units)


def test_the_length_of_a_line_in_one_piece_is_from_end_to_end(scene):
    alone = replace(scene, lines=replace(scene.lines, pieces=()))
    assert measured(alone, corrected(seen(WHOLE), 3.0)).metres_per_unit == pytest.approx(3.0 / 4.0)


@pytest.mark.parametrize(("component", "probability", "scale"), [(3, 0.6, 0.75), (3, 0.4, None), (0, 0.4, None)])
def test_where_probabilities_are_told_all_but_guesses_set_the_scale(scene, component, probability, scale):
    """A length on a weak group once promised a scale and did nothing, also where all groups have one scale."""
    lines = replace(scene.lines, pieces=(), component=[component], probability=[probability])
    told = measured(replace(scene, lines=lines), corrected(seen(WHOLE), 3.0))
    assert told.metres_per_unit == (None if scale is None else pytest.approx(scale))
    assert len(told.notes) == (scale is None)


def test_where_none_are_told_component_0_alone_sets_it(scene):
    for component, tells in ((0, True), (1, False)):
        lines = replace(scene.lines, component=[component])
        assert measurable(replace(scene, lines=lines)).tolist() == [tells]
