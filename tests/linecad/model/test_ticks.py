"""Stubs that end nowhere are not drawn."""

from dataclasses import replace

import numpy as np
import pytest

from linecad.directions import directions_of, frame_axes
from linecad.model.clean.sight import Sight
from linecad.model.frames import FramedLines, in_frame
from linecad.model.ticks import without_ticks
from linecad.scene import Face, Opening, Plane, Scene, SolveReport

X, Y, Z = range(3)
DEPTH = 10.0
SILL = (X, (-2, DEPTH, 0), (2, DEPTH, 0))
LEFT = (Z, (-2, DEPTH, -1), (-2, DEPTH, 0))


def tick(height, x=0.0):
    """An upright line of that height on the sill."""
    return (Z, (x, DEPTH, 0), (x, DEPTH, height))


def one_frame(scene):
    """The lines of a scene that has one frame."""
    return FramedLines(scene.lines, np.zeros(len(scene.lines), np.int64), ())


@pytest.fixture
def drawn(lines, crossings, camera, rotation):
    """The scene, without ticks, of rows of detail behind SILL and LEFT, in one wall."""

    def draw(rows, planes=None, roles=None, reason="", by_face=False):
        rows = [SILL, LEFT, *rows]
        on_face = np.arange(len(rows)) >= (2 if by_face else len(rows))
        found = replace(lines(rows), by_face=on_face, role=roles or ["outline"] * 2 + ["detail"] * (len(rows) - 2))
        scene = Scene(
            photo="wall.jpg", camera=camera, rotation=rotation, lines=found,
            intersections=crossings([(0, row) for row in range(1, len(rows))], reason=reason),
            planes=planes or (Plane(0, Y, DEPTH, tuple(range(len(rows))), ()),),
            solve=SolveReport("SCIP 10.0", "bodies", "optimal", 0, 0, 0), notes=("before",),
        )  # fmt: skip
        return scene, without_ticks(scene, one_frame(scene), Sight.of(camera, rotation, None))[0]

    return draw


def test_a_tick_goes_with_its_crossing(drawn):
    _, found = drawn([tick(0.07), tick(0.3, 1)])
    assert found.lines.id.tolist() == [0, 1, 3]
    assert found.intersections.lines.tolist() == [[0, 1], [0, 3]]
    assert found.planes[0].lines == (0, 1, 3)


def test_a_scene_without_ticks_is_the_scene_as_it_is(drawn):
    before, found = drawn([tick(0.3)])
    assert found is before


def test_a_short_line_between_two_lines_is_none(drawn):
    before, found = drawn([tick(0.07), (X, (-1, DEPTH, 0.07), (1, DEPTH, 0.07))])
    assert found is before


@pytest.mark.parametrize(
    ("behind", "height", "ids"), [(0.05, 0.3, [0, 1]), (0.05, 0.8, [0, 1, 2]), (0.5, 0.3, [0, 1, 2])]
)
def test_a_short_detail_just_before_or_behind_a_line_goes(drawn, behind, height, ids):
    for off in (behind, -behind):
        _, found = drawn([(Z, (0, DEPTH + off, 0), (0, DEPTH + off, height))])
        assert found.lines.id.tolist() == ids


def test_a_short_edge_that_only_a_face_placed_goes_whatever_it_is_for(drawn):
    for by_face, ids in ((True, [0, 1]), (False, [0, 1, 2])):
        _, found = drawn([tick(0.07)], roles=["outline"] * 3, by_face=by_face)
        assert found.lines.id.tolist() == ids


@pytest.mark.parametrize(("length", "left"), [(0.4, [0, 1]), (0.9, [0, 1, 2])])
def test_a_line_that_stands_on_one_of_another_frame_and_stays_near_it_goes(drawn, camera, rotation, length, left):
    scene, _ = drawn([SILL])
    turns, ends = (0.2,), scene.lines.ends.copy()
    start = in_frame(np.array([0, DEPTH, 0]), 1, turns)
    ends[2] = [start, start + length * np.array([1.0, 0, 0])]
    framed = FramedLines(replace(scene.lines, ends=ends), np.array([0, 0, 1]), turns)
    scene = replace(scene, lines=framed.in_world(), planes=(), turns=turns)
    found, _ = without_ticks(scene, framed, Sight.of(camera, rotation, None))
    assert found.lines.id.tolist() == left


@pytest.mark.parametrize(("roles", "reason"), [(["outline"] * 3, ""), (None, "annotated")])
def test_outlines_and_what_a_person_spoke_of_stay(drawn, roles, reason):
    before, found = drawn([tick(0.07)], roles=roles, reason=reason)
    assert found is before


@pytest.mark.parametrize(("height", "ids"), [(0.15, [0, 1, 2]), (0.07, [0, 1])])
def test_a_stub_may_end_at_an_outline_unless_it_misses_the_line_that_it_stands_on(drawn, height, ids):
    ring = [(-2, DEPTH, 0), (2, DEPTH, 0), (2, DEPTH, height), (-2, DEPTH, height)]
    _, found = drawn([tick(height)], (Plane(0, Y, DEPTH, (0, 1, 2), (Face(0, ring, (), "wall"),)),))
    assert found.lines.id.tolist() == ids


def test_a_stub_that_crosses_a_line_close_to_an_outline_goes(drawn):
    ring = [(-2, DEPTH, -0.08), (2, DEPTH, -0.08), (2, DEPTH, 0.09), (-2, DEPTH, 0.09)]
    stub = (Z, (0, DEPTH, -0.08), (0, DEPTH, 0.09))
    _, found = drawn([stub], (Plane(0, Y, DEPTH, (0, 1, 2), (Face(0, ring, (), "wall"),)),))
    assert found.lines.id.tolist() == [0, 1]


def test_a_line_that_ended_on_a_tick_ends_on_what_the_tick_stood_on(drawn):
    ends_on_tick = (X, (0.0, DEPTH, 0.07), (1, DEPTH, 0.07))
    beam = (Z, (1, DEPTH, 0.07), (1, DEPTH, 2))
    post = (Z, (-0.05, DEPTH, -1), (-0.05, DEPTH, 1))
    _, found = drawn([(Z, (0, DEPTH, 0.03), (0, DEPTH, 0.12)), ends_on_tick, beam, post])
    assert found.lines.id.tolist() == [0, 1, 3, 4, 5]
    np.testing.assert_array_equal(found.lines.ends[2], [[-0.05, DEPTH, 0.07], [1, DEPTH, 0.07]])


def test_a_plane_that_only_ticks_showed_goes_and_one_without_lines_stays(drawn):
    planes = (Plane(0, Y, DEPTH, (0, 1, 2), ()), Plane(1, X, 0.0, (2,), ()), Plane(2, Z, -3.0, (), ()))
    _, found = drawn([tick(0.07)], planes)
    assert [plane.id for plane in found.planes] == [0, 2]


def test_a_plane_that_an_opening_is_in_stays_though_only_ticks_showed_it(drawn, camera, rotation):
    planes = (Plane(0, Y, DEPTH, (0, 1, 2), ()), Plane(1, X, 0.0, (2,), ()))
    scene = replace(drawn([tick(0.07)], planes)[0], openings=(Opening(0, 1, 8.0, 9.0, 1.0, 2.0, "window"),))
    found = without_ticks(scene, one_frame(scene), Sight.of(camera, rotation, None))[0]
    assert [plane.id for plane in found.planes] == [0, 1]
    assert found.planes[1].lines == ()


def test_a_tick_that_alone_connects_another_line_stays(drawn, crossings, camera, rotation):
    scene, _ = drawn([tick(0.07), (X, (0, DEPTH, 0.03), (1, DEPTH, 0.03))])
    hangs = replace(scene, intersections=crossings([(0, 1), (0, 2), (2, 3)]))
    sight = Sight.of(camera, rotation, None)
    assert without_ticks(hangs, one_frame(hangs), sight)[0] is hangs
    stands = replace(scene, intersections=crossings([(0, 1), (0, 2), (2, 3), (0, 3)]))
    found, framed = without_ticks(stands, one_frame(stands), sight)
    assert framed.lines.id.tolist() == found.lines.id.tolist()
    assert found.lines.id.tolist() == [0, 1, 3]
    assert found.intersections.in_tree.tolist() == [True, True]
    assert found.intersections.lines.tolist() == [[0, 1], [0, 3]]


@pytest.mark.parametrize(("component", "left"), [((0, 0, 1, 1), [0, 1]), ((1, 1, 0, 0), [0, 1, 2, 3])])
def test_a_component_that_is_nothing_but_ticks_goes_unless_it_is_the_first(drawn, camera, rotation, component, left):
    """A comb of stubs that only cross each other: without one the rest would be fewer than a group has."""
    scene, _ = drawn([(Z, (1, DEPTH, 5), (1, DEPTH, 5.1)), (X, (1, DEPTH, 5.04), (1.1, DEPTH, 5.04))])
    scene = replace(scene, lines=replace(scene.lines, component=component))
    assert without_ticks(scene, one_frame(scene), Sight.of(camera, rotation, None))[0].lines.id.tolist() == left


@pytest.mark.parametrize(("away", "left"), [(0.0, [0, 1, 2]), (0.05, [0, 1]), (0.5, [0, 1])])
def test_a_detail_by_a_face_may_end_at_a_line_of_another_frame(drawn, camera, rotation, away, left):
    scene, _ = drawn([(X, (0, DEPTH, 0), (1, DEPTH, 0))], by_face=True)
    turns, ends, along = (0.5,), scene.lines.ends.copy(), np.array([1.0, 0, 0])
    start = in_frame(np.array([2, DEPTH, 0]), 1, turns) + away * along  # from the end of the sill
    ends[2] = [start, start + 0.6 * along]
    framed = FramedLines(replace(scene.lines, ends=ends), np.array([0, 0, 1]), turns)
    scene = replace(scene, lines=framed.in_world(), planes=(), turns=turns)
    found, _ = without_ticks(scene, framed, Sight.of(camera, rotation, None))
    assert found.lines.id.tolist() == left


@pytest.mark.parametrize(
    ("row", "stays"),
    [
        ((Z, (0, DEPTH, 0), (0, DEPTH, 1)), True),
        ((Z, (0, DEPTH, 0.5), (0, DEPTH, 1.5)), False),
        ((Z, (0, DEPTH, 0.5), (0, DEPTH, 3.5)), True),
        ((Z, (0, DEPTH + 0.05, 0), (0, DEPTH + 0.05, 1.5)), False),
        ((Z, (0, DEPTH + 0.05, 0.5), (0, DEPTH + 0.05, 3.5)), True),
    ],
    ids=["on the sill", "short in the air", "long in the air", "just behind the sill", "long behind the sill"],
)
def test_details_that_a_face_placed_hang_nowhere(drawn, row, stays):
    _, found = drawn([row], by_face=True)
    assert (2 in found.lines.id) == stays
    before, after = drawn([row])
    assert len(after.lines) == len(before.lines)


def test_a_tick_of_a_turned_wall_goes_as_it_would_in_the_first(drawn, camera, rotation):
    scene, straight = drawn([tick(0.07), tick(0.6, 1), (X, (0, DEPTH, 0.6), (0.995, DEPTH, 0.6))])
    turns = (0.4,)
    frame = np.ones(len(scene.lines), np.int64)
    framed = FramedLines(scene.lines, frame, turns)
    turned = replace(scene, lines=framed.in_world(), planes=(), turns=turns)
    sight = Sight.of(camera, rotation @ directions_of(turns)[frame_axes(1)], None)
    found, _ = without_ticks(turned, framed, sight)
    assert found.lines.id.tolist() == straight.lines.id.tolist() == [0, 1, 3, 4]
    back = found.lines.ends @ directions_of(turns)[frame_axes(1)].T
    np.testing.assert_allclose(back, straight.lines.ends, atol=1e-9)
