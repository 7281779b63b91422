"""Lengths that a person knows: of a line, of a piece that was joined to another, between points of lines and faces."""

import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from linecad.corrections.corrected import FoundPlace
from linecad.geometry import project
from linecad.line_graph import Segments
from linecad.model.known_lengths import measured
from linecad.model.scale import measurable, seen_plane
from linecad.scene import Camera, Face, Intersections, Lines, Plane, Scene, SolveReport

CAMERA = Camera(3000, 2000, np.array([[2500.0, 0, 1499.5], [0, 2500, 999.5], [0, 0, 1]]), "file")
AHEAD = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
WHOLE = np.array([[-2.0, 10, 1], [2, 10, 1]])
PIECES = np.array([[[-2.0, 10, 1], [-1, 10, 1]], [[-0.5, 10, 1], [2, 10, 1]]])


def seen(ends):
    return project(ends, CAMERA.matrix, AHEAD)


@pytest.fixture(scope="module")
def scene():
    lines = Lines([7], [0], [seen(WHOLE)], [WHOLE], [False], [0], ["supported"], pieces=(seen(PIECES),))
    report = SolveReport("SCIP 10.0", "bodies", "optimal", 0, 0, 0)
    return Scene("a.jpg", CAMERA, AHEAD, lines, Intersections([], [], [], [], [], []), (), report)


def corrected(segment, metres):
    return SimpleNamespace(lengths={3: metres}, distances=(), ids=np.array([3]), segments=Segments(segment[None], [0]))


@pytest.mark.parametrize(("piece", "units"), [(0, 1.0), (1, 2.5)])
def test_the_length_of_a_piece_is_its_own(scene, piece, units):
    assert measured(scene, corrected(seen(PIECES[piece]), 3.0)).metres_per_unit == pytest.approx(3.0 / units)


def test_the_length_of_a_line_in_one_piece_is_from_end_to_end(scene):
    alone = replace(scene, lines=replace(scene.lines, pieces=()))
    assert measured(alone, corrected(seen(WHOLE), 3.0)).metres_per_unit == pytest.approx(3.0 / 4.0)


# A wall at y = 10 before another one at y = 14, and the ground 2 below the camera; a line stands free before them.
FRONT, BACK, GROUND = np.array([[-3.0, 10, -2], [1, 10, -2], [1, 10, 2], [-3, 10, 2]]), 14.0, -2.0
POLE = np.array([[2.0, 8, -2], [2, 8, 1]])


@pytest.fixture(scope="module")
def town(scene):
    """Lines 7 (in the front wall), 8 (a pole), 9 (in the back wall, of component 1)."""
    far = np.array([[-6.0, BACK, 1], [6, BACK, 1]])
    ends = [WHOLE, POLE, far]
    lines = Lines(
        [7, 8, 9], [0, 2, 0], [seen(each) for each in ends], ends, [False] * 3, [0, 0, 1], ["supported"] * 2 + ["weak"]
    )
    back = np.array([[-6.0, BACK, -2], [6, BACK, -2], [6, BACK, 4], [-6, BACK, 4]])
    ground = np.array([[-6.0, 4, GROUND], [6, 4, GROUND], [6, BACK, GROUND], [-6, BACK, GROUND]])
    planes = (
        Plane(0, 1, 10.0, (7,), (Face(0, FRONT, kind="wall"),)),
        Plane(1, 1, BACK, (9,), (Face(1, back, kind="wall"),)),
        Plane(2, 2, GROUND, (), (Face(2, ground, kind="ground"),)),
    )
    return replace(scene, lines=lines, planes=planes)


def known(scene, *distances):
    axes, segments = scene.lines.axis, scene.lines.segment
    return SimpleNamespace(lengths={}, distances=distances, ids=np.arange(3), segments=Segments(segments, axes))


def pixel_of(point):
    u, v = seen(np.array(point)).tolist()
    return u, v


def on_face(point, at, normal=1):
    return FoundPlace(pixel_of(point), face=pixel_of(at), normal=normal)


inside = st.tuples(st.floats(-2.9, 0.9), st.floats(-1.9, 1.9))
heights = st.floats(-1.9, 0.9)


@given(inside, heights, st.floats(0.01, 1000))
@settings(max_examples=50)
def test_a_distance_between_a_line_and_a_face_sets_the_scale(town, place, height, metres):
    wall, pole = np.array([place[0], 10, place[1]]), np.array([2, 8, height])
    distance = (on_face(wall, wall), FoundPlace(pixel_of(pole), line=1), metres)
    found = measured(town, known(town, distance))
    assert found.metres_per_unit * np.linalg.norm(wall - pole) == pytest.approx(metres)
    assert f"1 known length, so a unit is {found.metres_per_unit:.6g} m" in found.scale_source


def test_a_corner_of_a_face_is_a_point_of_its_plane_as_another_place_shows_it(town):
    """Rounding puts a corner beside its face: the plane is told by a place inside."""
    distance = (on_face(FRONT[0], (0, 10, 0)), on_face(FRONT[1], (0, 10, 0)), 8.0)
    assert measured(town, known(town, distance)).metres_per_unit == pytest.approx(2.0)


def test_the_normal_tells_faces_at_one_place_apart(town):
    distance = (on_face((0, 9, GROUND), (0, 9, GROUND), normal=2), on_face((0, 10, 0), (0, 10, 0)), 1.0)
    assert measured(town, known(town, distance)).metres_per_unit == pytest.approx(1 / np.sqrt(5))


@pytest.mark.parametrize(
    ("places", "words"),
    [
        ((on_face((0, 10, 0), (0, 10, 0)), on_face((0, 10, 0), (0, 10, 0))), "two points are one"),
        (
            (on_face((0, 10, 0), (0, 10, 0)), on_face((4, BACK, 0), (4, BACK, 0))),
            "plane 1 stands at a depth that is a guess",
        ),
        ((on_face((0, 10, 0), (0, 10, 0)), on_face((0, 10, 0), (0, 10, 3.9), 0)), "no face .* any more"),
        ((on_face((0, 10, 0), (0, 10, 0)), FoundPlace(pixel_of((0, BACK, 1)), line=2)), "depth that is a guess"),
        ((on_face((0, 10, 0), (0, 10, 0)), FoundPlace((0, 0), face=pixel_of((0, 9, GROUND)), normal=2)), "not meet"),
    ],
)
def test_a_distance_that_the_scene_does_not_hold_sets_nothing_and_a_note_says_why(town, places, words):
    found = measured(town, known(town, (*places, 2.0)))
    assert found.metres_per_unit is None
    assert re.search(rf"a known distance \(2 m\) says nothing: .*{words}", found.notes[-1])


def test_lengths_and_distances_that_disagree_give_their_mean_and_a_note(town):
    distance = (FoundPlace(pixel_of(POLE[0]), line=1), FoundPlace(pixel_of(POLE[1]), line=1), 6.0)
    both = known(town, distance)
    both.lengths = {0: 4.0}
    found = measured(town, both)
    assert found.metres_per_unit == pytest.approx(np.sqrt(2))
    assert "disagree by up to 100%" in found.notes[-1]


def test_of_two_faces_the_nearer_one_is_seen(town):
    assert seen_plane(town, pixel_of((0, 10, 0)), 1).id == 0
    assert seen_plane(town, pixel_of((4, BACK, 0)), 1).id == 1
    assert seen_plane(town, pixel_of((0, 10, 0)), None).id == 0
    assert seen_plane(town, pixel_of((0, 9, GROUND)), None).id == 2


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
