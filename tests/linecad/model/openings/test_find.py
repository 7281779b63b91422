"""Windows of painted facades are found where they are, made regular, and nothing is found where there is nothing."""

from dataclasses import replace

import numpy as np
import pytest

from linecad.model.openings import find, regular
from linecad.model.openings.choice import Choice
from linecad.model.openings.find import find_openings, look_at_walls
from linecad.scene import Face, Plane

NEAR = 0.12  # units: a frame is that wide, and a raster's column about a quarter of it


def box_of(opening):
    return np.array([opening.u0, opening.u1, opening.v0, opening.v1])


def found_in(views, facade, pixels):
    """What is found in a photo of walls."""
    return find_openings(look_at_walls(views, facade.camera, pixels), views[0].planes, facade.camera, facade.rotation)


def which(opening, facade):
    """The true window that a found one is."""
    off = np.abs(np.array(facade.boxes) - box_of(opening)).max(axis=1)
    assert off.min() < NEAR, box_of(opening)
    return int(off.argmin())


def test_every_window_is_found_once_and_nothing_else(facade):
    found = facade.openings()
    assert sorted(which(each, facade) for each in found) == list(range(len(facade.boxes)))
    assert {each.kind for each in found} == {"window"}
    assert {each.plane for each in found} == {7}
    assert not any(each.is_completed for each in found)


def test_equal_windows_are_one_shape_in_rows_and_columns(facade):
    found = facade.openings()
    assert len({each.shape for each in found}) == 1
    assert len({each.v0 for each in found}) == 2
    assert len({each.u0 for each in found}) == 4
    assert np.ptp([each.u1 - each.u0 for each in found]) < 1e-12
    assert np.ptp([each.v1 - each.v0 for each in found]) < 1e-12


def test_sides_are_the_coordinates_of_lines(facade):
    for each in facade.openings():
        u0, _, v0, _ = facade.boxes[which(each, facade)]
        assert (each.u0, each.v0) == (u0, v0)


def test_window_without_lines_is_found_in_the_photo(facade_of):
    facade = facade_of(with_lines=2)
    assert sorted(which(each, facade) for each in facade.openings()) == list(range(len(facade.boxes)))


def test_bare_wall_has_no_openings(facade):
    bare = np.full_like(facade.pixels, 180)
    assert facade.openings(bare) == ()


def test_without_a_photo_nothing_is_found(facade):
    assert found_in([facade.view()], facade, None).openings == ()


def test_without_planes_nothing_is_found(facade):
    assert found_in([facade.view(())], facade, facade.pixels).openings == ()


def test_choice_that_ended_at_its_limit_is_told(facade, monkeypatch):
    args = ([facade.view()], facade, facade.pixels)
    assert found_in(*args).notes == ()
    first = find.choose
    monkeypatch.setattr(find, "choose", lambda *each: Choice(first(*each).taken, 0.0123))
    assert found_in(*args).notes == ("windows and doors: another choice of them may be up to 1.2% better; not proven",)


def test_walls_of_two_frames_have_their_windows_in_their_own_axes(facade):
    # The same wall in both frames: each window is found once, in the frame that comes first.
    other = replace(facade.view(), planes=(replace(facade.planes[0], id=9),))
    both = found_in([facade.view(), other], facade, facade.pixels).openings
    assert sorted(which(each, facade) for each in both) == list(range(len(facade.boxes)))
    # No wall in the first: all windows are those of the second, with its coordinates.
    nothing = facade.view(())
    found = found_in([nothing, other], facade, facade.pixels).openings
    assert found == tuple(replace(each, plane=9) for each in facade.openings())


def test_the_same_photo_gives_the_same_openings(facade):
    assert facade.openings() == facade.openings()


@pytest.mark.parametrize("number", [1, 6])
def test_window_behind_a_tree_does_not_move_the_others(facade_of, number):
    facade = facade_of(hidden=(number,))
    found = {
        which(each, facade)
        for each in facade.openings()
        if np.abs(np.array(facade.boxes)[:, :2] - [each.u0, each.u1]).max(axis=1).min() < NEAR
    }
    assert found >= set(range(len(facade.boxes))) - {number}


def with_level(facade, kind, height):
    """The facade's planes and a level one with a face of a kind."""
    face = Face(0, np.array([[-6.0, 9, height], [6, 9, height], [6, 8, height]]), kind=kind)
    return (*facade.planes, Plane(8, 2, height, (), (face,)))


def test_from_inside_what_is_darker_than_the_wall_is_no_window(facade):
    planes = with_level(facade, "ceiling", 4.0)
    dark = found_in([facade.view(planes)], facade, facade.pixels).openings
    bright = found_in([facade.view(planes)], facade, 255 - facade.pixels).openings
    assert dark == ()
    assert len(bright) == len(facade.boxes)


def test_what_stands_on_the_ground_is_a_door(facade, monkeypatch):
    monkeypatch.setattr(regular, "TALL", 1.3)  # these are 1.5 times as tall as wide
    planes = with_level(facade, "ground", min(box[2] for box in facade.boxes))
    found = found_in([facade.view(planes)], facade, facade.pixels).openings
    assert {(each.kind, each.v0 < 0) for each in found} == {("door", True), ("window", False)}


def test_doors_stand_on_the_pavement_not_on_the_road_below(facade, monkeypatch):
    monkeypatch.setattr(regular, "TALL", 1.3)
    foot = min(box[2] for box in facade.boxes)
    road = with_level(facade, "ground", foot - 1.0)[-1]
    planes = (*with_level(facade, "ground", foot), replace(road, id=9))
    found = found_in([facade.view(planes)], facade, facade.pixels).openings
    assert {(each.kind, each.v0 < 0) for each in found} == {("door", True), ("window", False)}


def test_what_the_panes_tell_is_put_behind_the_plane_of_the_wall(facade, monkeypatch):
    monkeypatch.setattr(find, "depth_ratios", lambda _, box: np.where(box[:, 2] < 0, 0.02, np.nan))
    low = [each for each in facade.openings() if each.v0 < 0]
    high = [each for each in facade.openings() if each.v0 > 0]
    assert {(each.recess, each.panel) for each in high} == {(None, None)}
    assert [each.recess for each in low] == pytest.approx([0.2] * 4)
    assert [each.panel for each in low] == pytest.approx([10.2] * 4)


def test_where_another_wall_is_shown_there_are_none(facade):
    # The side of a house before the left half of the facade.
    ring = np.array([[-0.2, 4.0, -9], [-0.2, 4, 9], [-6, 9.9, 9], [-6, 9.9, -9]])
    planes = (*facade.planes, Plane(8, 0, -1.0, (), (Face(0, ring, kind="wall"),)))
    found = {which(each, facade) for each in found_in([facade.view(planes)], facade, facade.pixels).openings}
    assert found == {number for number, box in enumerate(facade.boxes) if box[0] > 0}


def test_what_is_seen_of_the_walls_tells_where_they_are(facade):
    seen = look_at_walls([facade.view()], facade.camera, facade.pixels).shown
    assert {each.axis for each in seen} == {1}
    windows = [each.shape for each in seen if each.is_opening]
    assert len(windows) == len(facade.boxes)
    between = [each.shape.centroid for each in seen if not each.is_opening]
    assert len(between) == 3 * 2 + 4  # of two rows of four
    assert not any(shape.contains(point) for shape in windows for point in between)


def test_walls_of_further_frames_face_along_their_own_axes(facade):
    view = replace(facade.view(), frame=1)
    assert {each.axis for each in look_at_walls([view], facade.camera, facade.pixels).shown} == {4}


def test_without_a_photo_no_wall_is_shown(facade):
    assert look_at_walls([facade.view()], facade.camera, None).shown == ()


def test_planes_are_looked_at_once(facade, monkeypatch):
    seen = look_at_walls([facade.view()], facade.camera, facade.pixels)
    again = (facade.camera, facade.pixels, seen)
    assert look_at_walls([facade.view()], *again) is seen
    late = replace(facade.planes[0], id=9, offset=20.0, lines=())
    monkeypatch.setattr(find, "find_walls", lambda *_: [replace(seen.likely[0].wall, planes=(late,))])
    assert look_at_walls([facade.view()], *again).looked_at == {7, 9}


def test_a_note_about_the_first_choice_is_told(facade, monkeypatch):
    view = facade.view()
    first = find.choose
    monkeypatch.setattr(find, "choose", lambda *each: Choice(first(*each).taken, 0.0123))
    seen = look_at_walls([view], facade.camera, facade.pixels)
    monkeypatch.setattr(find, "choose", first)
    assert len(find_openings(seen, view.planes, facade.camera, facade.rotation).notes) == 1
