"""Windows of painted facades are found where they are, made regular, and nothing is found where there is nothing."""

from dataclasses import replace

import numpy as np
import pytest

from linecad.model.openings import find, regular
from linecad.model.openings.choice import Choice
from linecad.model.openings.find import find_openings
from linecad.scene import Face, Plane

NEAR = 0.12  # units: a frame is that wide, and a raster's column about a quarter of it


def box_of(opening):
    return np.array([opening.u0, opening.u1, opening.v0, opening.v1])


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
    assert find_openings([facade.view()], facade.camera, None).openings == ()


def test_without_planes_nothing_is_found(facade):
    assert find_openings([facade.view(())], facade.camera, facade.pixels).openings == ()


def test_choice_that_ended_at_its_limit_is_told(facade, monkeypatch):
    args = ([facade.view()], facade.camera, facade.pixels)
    assert find_openings(*args).notes == ()
    first = find.choose
    monkeypatch.setattr(find, "choose", lambda *each: Choice(first(*each).taken, 0.0123))
    assert find_openings(*args).notes == (
        "windows and doors: another choice of them may be up to 1.2% better; not proven",
    )


def test_walls_of_two_frames_have_their_windows_in_their_own_axes(facade):
    # The same wall in both frames: each window is found once, in the frame that comes first.
    other = replace(facade.view(), planes=(replace(facade.planes[0], id=9),))
    both = find_openings([facade.view(), other], facade.camera, facade.pixels).openings
    assert sorted(which(each, facade) for each in both) == list(range(len(facade.boxes)))
    # No wall in the first: all windows are those of the second, with its coordinates.
    nothing = facade.view(())
    found = find_openings([nothing, other], facade.camera, facade.pixels).openings
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
    dark = find_openings([facade.view(planes)], facade.camera, facade.pixels).openings
    bright = find_openings([facade.view(planes)], facade.camera, 255 - facade.pixels).openings
    assert dark == ()
    assert len(bright) == len(facade.boxes)


def test_what_stands_on_the_ground_is_a_door(facade, monkeypatch):
    monkeypatch.setattr(regular, "TALL", 1.3)  # these are 1.5 times as tall as wide
    planes = with_level(facade, "ground", min(box[2] for box in facade.boxes))
    found = find_openings([facade.view(planes)], facade.camera, facade.pixels).openings
    assert {(each.kind, each.v0 < 0) for each in found} == {("door", True), ("window", False)}


def test_doors_stand_on_the_pavement_not_on_the_road_below(facade, monkeypatch):
    monkeypatch.setattr(regular, "TALL", 1.3)
    foot = min(box[2] for box in facade.boxes)
    road = with_level(facade, "ground", foot - 1.0)[-1]
    planes = (*with_level(facade, "ground", foot), replace(road, id=9))
    found = find_openings([facade.view(planes)], facade.camera, facade.pixels).openings
    assert {(each.kind, each.v0 < 0) for each in found} == {("door", True), ("window", False)}


def test_what_the_panes_tell_is_put_behind_the_plane_of_the_wall(facade, monkeypatch):
    monkeypatch.setattr(find, "depth_ratios", lambda _, box: np.where(box[:, 2] < 0, 0.02, np.nan))
    low = [each for each in facade.openings() if each.v0 < 0]
    high = [each for each in facade.openings() if each.v0 > 0]
    assert {(each.recess, each.panel) for each in high} == {(None, None)}
    assert [each.recess for each in low] == pytest.approx([0.2] * 4)
    assert [each.panel for each in low] == pytest.approx([10.2] * 4)
