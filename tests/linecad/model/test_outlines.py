"""Unions of cells as polygons, and the grids that they are made of."""

import numpy as np
import shapely
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from linecad.model.outlines import Edges, build_cells, outlines, without_slivers

masks = arrays(bool, st.tuples(st.integers(1, 7), st.integers(1, 7)))


def edges(*rows, reach=0.0, goes_on=False):
    """Lines given as (at, from, to)."""
    rows = np.array(rows, float).reshape(-1, 3)
    return Edges(
        rows[:, 0], rows[:, 1:], np.full(len(rows), reach), np.full((len(rows), 2), reach), np.full(len(rows), goes_on)
    )


def no_preference():
    return np.zeros(0), np.zeros(0)


def meet_in_a_corner(kept):
    a, b, c, d = kept[:-1, :-1], kept[1:, :-1], kept[:-1, 1:], kept[1:, 1:]
    return ((a & d & ~b & ~c) | (b & c & ~a & ~d)).any()


@given(masks)
def test_outlines_are_the_union_of_the_cells_where_none_meet_in_a_corner_only(kept):
    polygons = outlines(kept) if kept.any() else []
    i, j = np.indices(kept.shape)
    inside = np.zeros(kept.shape, bool)
    for polygon in polygons:
        assert polygon.is_valid
        inside |= shapely.contains_xy(polygon, i + 0.5, j + 0.5)
    assert (kept | ~inside).all()
    assert meet_in_a_corner(kept) or (inside == kept).all()
    assert sum(polygon.area for polygon in polygons) == inside.sum()


@given(masks)
def test_outlines_have_corners_only_where_they_turn(kept):
    for polygon in outlines(kept) if kept.any() else []:
        for ring in (polygon.exterior, *polygon.interiors):
            points = shapely.get_coordinates(ring)[:-1]
            along = np.roll(points, -1, axis=0) - points
            assert (np.abs(along).min(axis=1) == 0).all()
            assert ((along[:, 0] == 0) != (np.roll(along, 1, axis=0)[:, 0] == 0)).all()


def test_a_frame_has_a_hole():
    kept = np.ones((3, 3), bool)
    kept[1, 1] = False
    (polygon,) = outlines(kept)
    assert len(polygon.interiors) == 1


def test_walls_are_lines_anywhere_on_that_side():
    cells = build_cells(edges((0, 0, 4), (3, 0, 2)), edges((0, 0, 3), (2, 0, 3), (4, 0, 1)), no_preference())
    assert cells.u.tolist() == [0, 2, 4]
    assert cells.v.tolist() == [0, 1, 3]
    below_u, above_u, below_v, above_v = (wall.tolist() for wall in cells.walls)
    assert below_u == [[True, True], [True, True]]
    assert above_u == [[True, True], [True, False]]
    assert below_v == [[True, True], [True, True]]
    assert above_v == [[True, True], [False, False]]


def test_cells_between_lines_that_go_on_above_the_photo_are_framed():
    bar = edges((0, 0, 4))
    between = build_cells(bar, edges((0, 0, 3), (2, 0, 3), goes_on=True), no_preference())
    assert between.u.tolist() == [0, 2, 4]
    assert between.framed.tolist() == [[True], [False]]
    assert not build_cells(bar, edges((0, 0, 3), (2, 0, 3)), no_preference()).framed.any()


def test_coordinates_that_the_photo_does_not_tell_apart_are_one_and_the_preferred():
    along_v = edges((0, 0, 3), (4.0, 0, 3), (4.1, 0, 3), (4.2, 0, 3), reach=0.5)
    along_u = edges((0, 0, 3.9), (3, 0, 4.3), reach=0.5)
    assert build_cells(along_u, along_v, no_preference()).u.tolist() == [0, 4.1]
    assert build_cells(along_u, along_v, (np.array([4.2]), np.zeros(0))).u.tolist() == [0, 4.2]


def test_lines_without_area_have_no_cells():
    assert build_cells(edges((1, 0, 2)), edges((1, 1, 1)), no_preference()) is None


def test_points_are_found_in_their_cells():
    cells = build_cells(edges((0, 0, 2), (5, 0, 2)), edges((0, 0, 5), (2, 0, 5)), no_preference())
    assert cells.find(np.array([[1.0, 2.0], [-1.0, 2.0], [1.0, 6.0], [3.0, 1.0]])).tolist() == [0, -1, -1, -1]


@given(masks, masks, st.floats(0, 3))
def test_slivers_are_narrow(kept, free, least):
    free = np.resize(free, kept.shape)
    size = np.ones(kept.shape)
    changed = without_slivers(kept, free, size, size, least)
    if least <= 1:
        assert (changed == kept).all()
    assert not (changed & ~kept & ~free).any()


def test_a_narrow_gap_is_filled_and_a_narrow_strip_left_out():
    kept = np.array([[1, 1, 0, 1, 1], [1, 1, 0, 1, 1], [0, 0, 1, 0, 0]], bool)
    width, height = np.full(kept.shape, 10.0), np.array([[10.0, 10, 2, 10, 10]] * 3)
    free = np.ones(kept.shape, bool)
    assert without_slivers(kept, free, width, height, 5.0).tolist() == [[True] * 5, [True] * 5, [False] * 5]
    assert not without_slivers(kept, ~free, width, height, 5.0)[:, 2].any()


@given(kept=masks)
def test_no_outline_has_a_corner_twice(kept):
    for polygon in outlines(kept):
        corners = [point for ring in (polygon.exterior, *polygon.interiors) for point in ring.coords[:-1]]
        assert len(set(corners)) == len(corners)


def test_of_two_cells_that_meet_in_a_corner_one_stays():
    assert [part.area for part in outlines(np.array([[True, False], [False, True]]))] == [1.0]
