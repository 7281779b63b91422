"""Windows of painted facades are found where they are, made regular, and nothing is found where there is nothing."""

import numpy as np
import pytest

from linecad.model.openings.find import find_openings

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
    assert find_openings(facade.planes, facade.lines, facade.camera, facade.rotation, None) == ()


def test_without_planes_nothing_is_found(facade):
    assert find_openings((), facade.lines, facade.camera, facade.rotation, facade.pixels) == ()


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
