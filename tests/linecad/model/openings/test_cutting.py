"""Holes, panes and reveals: the wall and its panes cover what the wall covered, and recesses are closed boxes."""

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from linecad.directions import directions_of, frame_axes
from linecad.model.openings.cutting import with_openings
from linecad.scene import Face, Opening, Plane

OFFSET = 10.0
RING = np.array([[-6.0, OFFSET, -2], [6, OFFSET, -2], [6, OFFSET, 4], [-6, OFFSET, 4]])
WINDOW = Opening(0, 7, 1.0, 2.0, 0.5, 2.0, "window")
DOOR = Opening(0, 7, -1.0, 0.0, -1.9, 0.3, "door")


def wall_of(ring=RING, holes=(), hidden=(), axis=1):
    swap = [1, 0, 2] if axis == 0 else [0, 1, 2]
    face = Face(
        5, ring[:, swap], tuple(hole[:, swap] for hole in holes), "wall", tuple(part[:, swap] for part in hidden)
    )
    return Plane(7, axis, OFFSET, (), (face,))


def recessed(opening, recess=0.4):
    return replace(opening, recess=recess, panel=OFFSET + recess)


def faces_of(planes):
    return {face.id: (plane, face) for plane in planes for face in plane.faces}


def rectangle(u0, u1, v0, v1):
    return np.array([[u0, OFFSET, v0], [u1, OFFSET, v0], [u1, OFFSET, v1], [u0, OFFSET, v1]])


def flat(plane, ring):
    return shapely.Polygon(ring[:, [axis for axis in range(3) if axis != plane.axis]])


def area(plane, face):
    return flat(plane, face.outline).area - sum(flat(plane, hole).area for hole in face.holes)


@pytest.mark.parametrize("axis", [0, 1])
def test_a_flush_window_is_a_hole_with_a_pane_of_the_same_corners(axis):
    (plane,), (opening,) = with_openings((wall_of(axis=axis),), (WINDOW,))
    wall, pane = plane.faces
    assert opening == WINDOW
    assert (pane.id, pane.kind, pane.opening, pane.hidden) == (6, "window", 0, ())
    assert wall.id == 5
    np.testing.assert_array_equal(wall.holes[0], pane.outline)
    assert set(pane.outline[:, 1 - axis].tolist()) == {1.0, 2.0}
    assert set(pane.outline[:, 2].tolist()) == {0.5, 2.0}
    assert area(plane, wall) + area(plane, pane) == pytest.approx(72.0)


def test_a_recess_is_a_box_without_a_lid():
    planes, _ = with_openings((wall_of(),), (recessed(WINDOW),))
    found = faces_of(planes)
    assert [face.kind for _, face in found.values()] == ["wall", "window", "reveal", "reveal", "reveal", "reveal"]
    wall, pane, *reveals = found.values()
    assert pane[0].offset == 10.4
    edges = Counter(
        frozenset([tuple(start), tuple(end)])
        for ring in (pane[1].outline, *(face.outline for _, face in reveals), wall[1].holes[0])
        for start, end in zip(ring.tolist(), np.roll(ring, -1, axis=0).tolist(), strict=True)
    )
    assert set(edges.values()) == {2}
    assert all(face.opening == 0 for _, face in (pane, *reveals))
    assert len({plane.id for plane in planes}) == len(planes)


def test_the_photo_shows_the_far_reveals_and_hides_the_near_ones():
    above_right = recessed(WINDOW)  # u and v from 0.5 on: its right side and its head look at the camera
    planes, _ = with_openings((wall_of(),), (above_right,))
    hidden = {(plane.axis, plane.offset): face.hidden for plane, face in faces_of(planes).values()}
    assert hidden[0, 2.0] == hidden[2, 2.0] == ()
    for place in ((0, 1.0), (2, 0.5)):
        assert len(hidden[place]) == 1
    # At 10.4 the rays through the near sides of the hole, at 1 and 0.5, are at 1.04 and 0.52.
    (part,) = hidden[1, 10.4]
    seen = shapely.Polygon([(1.04, 0.52), (2, 0.52), (2, 2), (1.04, 2)])
    pane = shapely.Polygon([(1, 0.5), (2, 0.5), (2, 2), (1, 2)])
    assert flat(Plane(0, 1, 10.4, ()), part).symmetric_difference(pane.difference(seen)).area < 1e-9


def test_openings_of_one_row_share_the_planes_of_sill_and_head():
    other = replace(recessed(WINDOW), id=1, u0=-3.0, u1=-2.0)
    planes, _ = with_openings((wall_of(),), (recessed(WINDOW), other))
    assert len(planes) == 1 + 1 + 2 + 4
    assert len(next(plane for plane in planes if plane.axis == 1 and plane.offset == 10.4).faces) == 2


def test_a_pane_goes_to_the_plane_that_is_there():
    behind = Plane(9, 1, 10.4, ())
    planes, _ = with_openings((wall_of(), behind), (recessed(WINDOW),))
    assert [face.kind for face in planes[1].faces] == ["window"]
    assert planes[1].id == 9


@pytest.mark.parametrize("v0", [-1.9, -2.0, -2.2])
def test_a_door_stands_on_the_foot_of_its_wall(v0):
    (plane,), (door,) = with_openings((wall_of(),), (replace(DOOR, v0=v0),))
    wall, pane = plane.faces
    assert door.v0 == -2.0
    assert wall.holes == ()
    assert {tuple(corner) for corner in pane.outline.tolist()} < {tuple(corner) for corner in wall.outline.tolist()}
    assert area(plane, wall) + area(plane, pane) == pytest.approx(72.0)


@pytest.mark.parametrize("opening", [WINDOW, recessed(WINDOW), DOOR])
@pytest.mark.parametrize("axis", [0, 1])
def test_a_turned_wall_is_opened_like_one_of_the_main_frame(axis, opening):
    turns, axes = (0.3,), frame_axes(1)
    vectors = directions_of(turns)[axes]
    wall = wall_of(axis=axis)
    turned = replace(wall, axis=axes[axis], faces=(replace(wall.faces[0], outline=wall.faces[0].outline @ vectors),))
    planes, found = with_openings((turned,), (opening,), turns)
    expected, _ = with_openings((wall,), (opening,))
    assert found[0].v0 == (-2.0 if opening.kind == "door" else opening.v0)
    assert [(plane.axis, plane.offset) for plane in planes] == [(axes[each.axis], each.offset) for each in expected]
    for (_, face), (_, like) in zip(faces_of(planes).values(), faces_of(expected).values(), strict=True):
        assert (face.kind, face.opening, len(face.hidden)) == (like.kind, like.opening, len(like.hidden))
        for ring, own in zip((face.outline, *face.holes), (like.outline, *like.holes), strict=True):
            np.testing.assert_allclose(ring, own @ vectors, atol=1e-13)
    # What stays of the outline is the same to the last digit.
    corners = {tuple(corner) for corner in planes[0].faces[0].outline.tolist()}
    assert {tuple(corner) for corner in turned.faces[0].outline.tolist()} <= corners


def test_a_door_above_the_foot_is_a_hole():
    (plane,), (door,) = with_openings((wall_of(),), (replace(DOOR, v0=-1.0, v1=1.5),))
    assert door.v0 == -1.0
    assert len(plane.faces[0].holes) == 1


def test_a_window_never_moves_to_the_foot():
    planes, (opening,) = with_openings((wall_of(),), (replace(DOOR, kind="window"),))
    assert opening.v0 == -1.9
    assert len(planes[0].faces[0].holes) == 1


def test_doors_of_one_size_that_move_apart_have_shapes_of_their_own():
    doors = (DOOR, replace(DOOR, id=1, u0=3.0, u1=4.0), replace(DOOR, id=2, u0=-5.0, u1=-4.0, v0=-1.0, v1=1.2))
    _, found = with_openings((wall_of(),), doors)
    assert [door.shape for door in found] == [0, 0, 2]


@pytest.mark.parametrize(
    "opening",
    [
        replace(WINDOW, u0=5.5, u1=6.5),  # across the corner
        replace(WINDOW, u0=5.0, u1=6.0),  # at it
        replace(WINDOW, v1=5.0),  # across the eaves
        replace(WINDOW, u0=-4.5, u1=-3.5),  # across a hole that is there
        replace(DOOR, v0=-2.5, v1=0.3, u0=5.5, u1=6.5),
        replace(DOOR, v0=-3.0),  # too far below the foot
    ],
)
def test_an_opening_that_is_not_inside_a_face_is_not_cut(opening):
    wall = wall_of(holes=[rectangle(-4, -3, 0, 3)])
    planes, found = with_openings((wall,), (opening,))
    assert len(planes) == 1
    assert len(planes[0].faces) == 1
    assert planes[0].faces[0] is wall.faces[0]
    assert found == (replace(opening, shape=0),)


def test_of_two_that_overlap_the_first_is_cut():
    planes, found = with_openings((wall_of(),), (WINDOW, replace(WINDOW, id=1, u0=1.9, u1=2.9)))
    assert [face.opening for face in planes[0].faces] == [None, 0]
    assert len(found) == 2


def test_what_is_hidden_of_the_wall_is_hidden_of_the_pane():
    tree = rectangle(1.5, 3.0, -1.0, 1.0)
    (plane,), _ = with_openings((wall_of(hidden=[tree]),), (WINDOW,))
    wall, pane = plane.faces
    (of_pane,), (of_wall,) = pane.hidden, wall.hidden
    assert flat(plane, of_pane).equals(shapely.box(1.5, 0.5, 2.0, 1.0))
    assert flat(plane, of_wall).area == pytest.approx(1.5 * 2 - 0.25)


def test_what_is_hidden_of_the_pane_alone_is_not_hidden_of_the_wall():
    bird = rectangle(1.4, 1.6, 1.0, 1.2)
    (plane,), _ = with_openings((wall_of(hidden=[bird]),), (WINDOW,))
    wall, pane = plane.faces
    assert wall.hidden == ()
    (of_pane,) = pane.hidden
    assert flat(plane, of_pane).equals(shapely.box(1.4, 1.0, 1.6, 1.2))


@given(st.data())
def test_walls_and_panes_cover_what_the_wall_covered(data):
    number = st.floats(-7, 7)
    openings = []
    for place in range(data.draw(st.integers(1, 6))):
        u0, v0 = data.draw(number), data.draw(st.floats(-3, 4))
        wide, tall = data.draw(st.floats(0.1, 3)), data.draw(st.floats(0.1, 3))
        kind = data.draw(st.sampled_from(["window", "door"]))
        openings.append(Opening(place, 7, u0, u0 + wide, v0, v0 + tall, kind))
    (plane,), _ = with_openings((wall_of(),), tuple(openings))
    parts = [shapely.Polygon(face.outline[:, [0, 2]], [hole[:, [0, 2]] for hole in face.holes]) for face in plane.faces]
    assert all(part.is_valid for part in parts)
    assert sum(part.area for part in parts) == pytest.approx(72.0)
    assert shapely.union_all(parts).area == pytest.approx(72.0)
