"""Lines that became one while their ends were drawn on."""

from dataclasses import replace

import numpy as np
import pytest

from linecad.directions import directions_of
from linecad.model.clean.ends import NEAR
from linecad.model.clean.sight import Sight
from linecad.model.frames import FramedLines
from linecad.model.merging import with_merged_lines
from linecad.scene import Plane, Scene, SolveReport

X, Y, Z = range(3)
DEPTH = 10.0
GAP = 0.5 * NEAR * DEPTH
POST = (Z, (0, DEPTH, -1), (0, DEPTH, 1))


def level(low, high, z=0.0):
    return X, (low, DEPTH, z), (high, DEPTH, z)


@pytest.fixture
def merged(lines, crossings, camera, rotation):
    """The scene of rows, and the same with lines that are one merged."""

    def merge(rows, pairs=(), component=None, turns=(), frame=None, by_face=None, **told):
        framed = FramedLines(
            lines(rows, component), np.zeros(len(rows), int) if frame is None else np.array(frame), turns
        )
        framed = replace(framed, lines=replace(framed.lines, by_face=by_face or [False] * len(rows)))
        scene = Scene(
            photo="wall.jpg", camera=camera, rotation=rotation, lines=framed.in_world(), turns=turns,
            intersections=crossings(list(pairs), **told), planes=(Plane(0, Y, DEPTH, tuple(range(len(rows))), ()),),
            solve=SolveReport("SCIP 10.0", "bodies", "optimal", 0, 0, 0),
        )  # fmt: skip
        found, rows_left = with_merged_lines(scene, framed, Sight.of(camera, rotation, None))
        assert rows_left.lines.id.tolist() == found.lines.id.tolist()
        np.testing.assert_array_equal(rows_left.in_world().ends, found.lines.ends)
        return scene, found

    return merge


def test_the_longest_stays_and_reaches_as_far_as_all(merged):
    rows = [level(-1, 0), level(GAP, 2), level(1.9, 2.5), POST]
    found = merged(rows, [(0, 3), (1, 3), (0, 1)])[1]
    assert found.lines.id.tolist() == [1, 3]
    assert np.sort(found.lines.ends[0, :, X]).tolist() == [-1, 2.5]
    assert len(found.lines.pieces[0]) == 3
    assert found.intersections.lines.tolist() == [[1, 3]]
    assert found.planes[0].lines == (1, 3)


@pytest.mark.parametrize(
    "rows",
    [
        [level(-1, 0), level(4 * GAP, 2)],
        [level(-1, 0), level(0, 2, 1e-6)],
        [level(-1, 0), POST],
    ],
    ids=["far", "not to the last digit", "across"],
)
def test_what_is_not_one_line_is_the_scene_as_it_is(merged, rows):
    before, after = merged(rows)
    assert after is before


def test_lines_of_two_components_and_those_a_person_said_are_two_stay(merged):
    rows = [level(-1, 0), level(0, 2)]
    before, after = merged(rows, component=[0, 1])
    assert after is before
    before, after = merged(rows, [(0, 1)], kind="collinear", real=False, reason="annotated")
    assert after is before


def test_what_pieces_tell_is_told_by_the_whole(merged):
    found = merged([level(-1, 0), level(0, 2)], by_face=[False, True])[1]
    assert found.lines.by_face.tolist() == [False]
    both = merged([level(-1, 0), level(0, 2)], by_face=[True, True])[1]
    assert both.lines.by_face.tolist() == [True]


def test_uprights_of_two_frames_that_stand_in_one_place_are_one(merged):
    turns = (0.5,)
    foot = np.array([0.3, DEPTH])
    turned = directions_of(turns)[3:, :2] @ foot
    rows = [(Z, (*foot, -1), (*foot, 0.5)), (Z, (*turned, 0.4), (*turned, 2))]
    found = merged(rows, turns=turns, frame=[0, 1])[1]
    assert found.lines.id.tolist() == [1]
    np.testing.assert_allclose(np.sort(found.lines.ends[0, :, Z]), [-1, 2])
    assert len(merged(rows, turns=turns, frame=[0, 1], component=[0, 1])[1].lines) == 2
    apart = [rows[0], (Z, (*(turned + 1e-4), 0.4), (*(turned + 1e-4), 2))]
    assert len(merged(apart, turns=turns, frame=[0, 1])[1].lines) == 2


def test_what_a_face_placed_along_an_edge_of_another_frame_goes_into_it(merged):
    turns = (0.05,)
    middle = np.array([1.0, DEPTH, 0.0])
    place = directions_of(turns)[[3, 4, 2]] @ middle
    reach = np.array([0.2, 0, 0])
    short = (X, place - reach, place + reach)
    for by_face, left in ((True, [0]), (False, [0, 1])):
        found = merged([level(-2, 2), short], turns=turns, frame=[0, 1], by_face=[False, by_face])[1]
        assert found.lines.id.tolist() == left
        assert np.sort(found.lines.ends[0, :, X]).tolist() == [-2, 2]
