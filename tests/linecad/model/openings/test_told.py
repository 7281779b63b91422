"""Windows that a person draws: rectangles of their wall with exactly the corners that were drawn."""

from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from linecad.corrections.edits import Anchor, NoWindow, WallAnchor, Window
from linecad.directions import directions_of, partner
from linecad.geometry import project
from linecad.model.openings.corners import on_wall, rectangle_in_space
from linecad.model.openings.cutting import with_openings
from linecad.model.openings.told import ToldOpenings
from linecad.scene import Camera, Face, Lines, Opening, Plane

CAMERA = Camera(1200, 900, np.array([[900.0, 0, 599.5], [0, 900, 449.5], [0, 0, 1]]), "file")
AHEAD = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
OFFSET, TURNS = 10.0, (0.3,)


def wall_of(axis=1, turns=(), number=7, offset=OFFSET):
    outline = on_wall(np.array([[-6.0, -2], [6, -2], [6, 4], [-6, 4]]), axis, offset, turns)
    return Plane(number, axis, offset, (), (Face(5 + number, outline, kind="wall"),))


def no_lines():
    none = np.zeros(0)
    return Lines(none, none, none.reshape(0, 2, 2), none.reshape(0, 2, 3), none, none, none.astype(str))


WALL = wall_of()


def told(*edits, planes=(WALL,), rotation=AHEAD, turns=(), lines=None):
    return ToldOpenings(edits, planes, lines or no_lines(), CAMERA, rotation, turns)


def pixels_of(u, v, axis=1, turns=(), rotation=AHEAD, offset=OFFSET):
    points = on_wall(np.column_stack([u, v]), axis, offset, turns)
    return tuple(map(tuple, project(points, CAMERA.matrix, rotation).tolist()))


def turned(yaw, pitch):
    """A camera that looks a little aside and up."""
    aside = [[np.cos(yaw), -np.sin(yaw), 0], [np.sin(yaw), np.cos(yaw), 0], [0, 0, 1]]
    up = [[1, 0, 0], [0, np.cos(pitch), -np.sin(pitch)], [0, np.sin(pitch), np.cos(pitch)]]
    return np.array(up) @ AHEAD @ np.array(aside)


sides = st.floats(-5.0, 3.0), st.floats(0.2, 2.5), st.floats(-1.5, 2.0), st.floats(0.2, 1.8)


@given(*sides, st.sampled_from([1, 4]), st.floats(-0.25, 0.25), st.floats(-0.15, 0.15), st.integers(0, 1))
def test_a_rectangle_has_the_corners_that_were_drawn_in_any_perspective(u, wide, v, tall, axis, yaw, pitch, flip):
    turns, rotation = (TURNS if axis > 2 else ()), turned(yaw, pitch)
    drawn = pixels_of([u, u + wide], [v, v + tall] if flip else [v + tall, v], axis, turns, rotation)
    given_ = told(Window(WallAnchor(axis, None), drawn), planes=(wall_of(axis, turns),), rotation=rotation, turns=turns)
    (opening,), notes = given_.among(())
    assert notes == ()
    assert (opening.u0, opening.u1, opening.v0, opening.v1) == pytest.approx((u, u + wide, v, v + tall), abs=1e-9)
    corners = project(rectangle_in_space(opening, wall_of(axis, turns), turns), CAMERA.matrix, rotation)
    off = np.linalg.norm(corners[:, None] - np.array(drawn)[None], axis=2).min(axis=0)
    assert off.max() < 1e-6
    # It lies in the wall, with sides along its two axes.
    sides_of = np.diff(rectangle_in_space(opening, wall_of(axis, turns), turns), axis=0)
    assert np.abs(sides_of @ directions_of(turns)[axis]).max() < 1e-9
    assert abs(sides_of[0] @ directions_of(turns)[partner(axis)]) == pytest.approx(wide)


@given(st.integers(1, 4), st.integers(1, 3), st.booleans())
def test_rows_and_columns_are_equal_windows_up_to_the_last(columns, rows, leftwards):
    way = -1 if leftwards else 1
    first = pixels_of([way * -4.0, way * -3.5], [2.5, 1.9])
    reach = (way * (-3.5 + 1.5 * (columns - 1)), 1.9 - 1.1 * (rows - 1))
    last = pixels_of([reach[0]], [reach[1]])[0]
    found, notes = told(Window(WallAnchor(1, None), first, "window", columns, rows, last)).among(())
    assert notes == ()
    assert len(found) == columns * rows
    assert {opening.shape for opening in found} == {0}
    assert sorted({round(opening.u0, 6) for opening in found}) == pytest.approx(
        sorted(min(way * (-4 + 1.5 * n), way * (-3.5 + 1.5 * n)) for n in range(columns))
    )
    assert sorted({round(opening.v0, 6) for opening in found}) == pytest.approx(
        sorted(1.9 - 1.1 * n for n in range(rows))
    )
    (plane,), _ = with_openings((wall_of(),), found)
    assert len(plane.faces[0].holes) == len(found)


def found_at(number, u, v, recess=None):
    panel = None if recess is None else OFFSET + recess
    return Opening(number, 7, u, u + 1, v, v + 1, "window", recess, panel, shape=number)


def test_it_takes_the_place_of_those_that_it_overlaps_with_their_recess_and_leaves_others():
    others = (found_at(0, -4, 0), found_at(1, 0, 0, 0.25), found_at(2, 3, 0))
    window = Window(WallAnchor(1, None), pixels_of([-0.1, 1.2], [-0.1, 1.3]))
    found, _ = told(window).among(others)
    assert [opening.u0 for opening in found] == pytest.approx([-4, 3, -0.1])
    assert [opening.id for opening in found] == [0, 1, 2]
    assert (found[2].recess, found[2].panel) == pytest.approx((0.25, OFFSET + 0.25))


def test_openings_are_cut_out_of_faces_that_go_on_unseen():
    low = Face(12, on_wall(np.array([[-6.0, 0], [6, 0], [6, 4], [-6, 4]]), 1, OFFSET, ()), kind="wall")
    seen = replace(WALL, faces=(low,))
    window = Window(WallAnchor(1, None), pixels_of([-1, 1], [-0.6, 1]))
    opened = [replace(told(window, planes=(seen,)), cut=cut).opened(()) for cut in ((), (WALL,))]
    assert [len(planes[0].faces[0].holes) for planes, _, _ in opened] == [0, 1]
    assert [len(notes) for *_, notes in opened] == [1, 0]
    (plane,) = opened[1][0]
    assert plane.faces[0].outline[:, 2].min() == -2


def test_one_that_was_missed_has_the_recess_of_the_nearest_equal_one_in_its_wall():
    bare = Plane(8, 1, 15.0, ())
    elsewhere = Opening(2, 8, 6, 7, 0, 1, "window", 0.5, 15.5, shape=2)
    others = (found_at(0, -4, 0, 0.25), found_at(1, -2, 0, 0.3), elsewhere)
    for (wide, tall), recess in (((1.0, 1.0), 0.3), ((1.05, 0.97), 0.3), ((1.0, 1.6), None)):
        window = Window(WallAnchor(1, None), pixels_of([1, 1 + wide], [0, tall]))
        found, _ = told(window, planes=(WALL, bare)).among(others)
        assert found[-1].recess == (None if recess is None else pytest.approx(recess))
    door = Window(WallAnchor(1, None), pixels_of([1, 2], [0, 1]), "door")
    assert told(door, planes=(WALL, bare)).among(others)[0][-1].recess is None


def test_no_window_takes_away_what_is_there_until_one_is_drawn():
    at = pixels_of([0.5], [0.5])[0]
    window = Window(WallAnchor(1, None), pixels_of([0.1, 0.9], [0.1, 0.9]))
    others = (found_at(0, -4, 0), found_at(1, 0, 0))
    assert [opening.u0 for opening in told(NoWindow(at)).among(others)[0]] == [-4]
    assert len(told(NoWindow(at), window).among(others)[0]) == 2
    assert len(told(window, NoWindow(at)).among(others)[0]) == 1
    assert told(NoWindow((1190.0, 5.0))).among(others)[0] == others


def test_of_parallel_walls_the_one_that_the_photo_shows_there_is_meant():
    behind = wall_of(number=8, offset=15.0)
    face = replace(behind.faces[0], outline=on_wall(np.array([[20.0, -2], [22, -2], [22, 4], [20, 4]]), 1, 15.0, ()))
    planes = (replace(behind, faces=(face,)), wall_of())
    window = Window(WallAnchor(1, None), pixels_of([0, 1], [0, 1]))
    (opening,), _ = told(window, planes=planes).among(())
    assert opening.plane == 7


def line_at(offset):
    ends = np.array([[[0.0, offset, 1.0], [2.0, offset, 1.0]]])
    segment = project(ends, CAMERA.matrix, AHEAD)
    one = np.zeros(1, np.int64)
    return Lines(one + 3, one, segment, ends, one.astype(bool), one, np.array(["proven"]))


def test_where_no_face_is_the_plane_of_its_line_is_meant_and_a_note_says_that_it_is_no_hole():
    lines = line_at(12.0)
    bare = Plane(9, 1, 12.0, (3,))
    (a, b), (c, d) = lines.segment[0].tolist()
    window = Window(WallAnchor(1, Anchor(((a, b), (c, d)), 0)), pixels_of([-9, -8], [0, 1], offset=12.0))
    (opening,), notes = told(window, planes=(bare,), lines=lines).among(())
    assert opening.plane == 9
    assert (opening.u0, opening.v1) == pytest.approx((-9, 1))
    assert notes == ("1 of the windows and doors that you drew reach beyond the face of their wall: no holes",)


@pytest.mark.parametrize(
    ("edit", "note"),
    [
        (Window(WallAnchor(0, None), pixels_of([0, 1], [0, 1])), "no wall across x is there"),
        (Window(WallAnchor(1, None), pixels_of([0, 1], [0, 0])), "it has no area"),
        (
            Window(WallAnchor(1, None), pixels_of([0, 1], [0, 1]), "window", 2, 1, pixels_of([1.5], [1])[0]),
            "its rows and columns overlap",
        ),
    ],
)
def test_what_cannot_be_is_left_out_and_told(edit, note):
    found, notes = told(edit).among((found_at(0, -4, 0),))
    assert [opening.u0 for opening in found] == [-4]
    assert note in notes[0]


def test_a_window_is_in_the_photo_where_it_was_drawn():
    drawn = pixels_of([0, 1], [0, 1])
    (opening,), _ = told(Window(WallAnchor(1, None), drawn)).among(())
    (plane,), _ = with_openings((wall_of(),), (opening,))
    (hole,) = plane.faces[0].holes
    seen = shapely.Polygon(project(hole, CAMERA.matrix, AHEAD))
    assert seen.symmetric_difference(shapely.box(*drawn[0], *drawn[1])).area < 1e-6
