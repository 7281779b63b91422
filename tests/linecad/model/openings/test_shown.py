"""What openings tell of the wall they are in: in each of a row or column, and between two of them."""

import numpy as np
import pytest
import shapely

from linecad.model.openings.raster import Raster
from linecad.model.openings.shown import WIDEST, walls_shown

COLUMNS, ROWS = np.arange(201) * 0.1, np.arange(151) * 0.1
AXIS = 4
WINDOW = (20, 30, 40, 60)  # columns, then rows


@pytest.fixture(scope="module")
def raster():
    shape = (len(ROWS), len(COLUMNS))
    nothing = np.zeros(shape, bool)
    return Raster(COLUMNS, ROWS, np.zeros((*shape, 3), np.uint8), ~nothing, nothing, nothing)


def shapes_of(raster, box):
    """Rectangles of the wall as the photo would show it from straight before."""
    return [
        shapely.box(*raster.u[box[[0]]], *raster.v[box[[2]]], *raster.u[box[[1]]], *raster.v[box[[3]]]) for box in box
    ]


def shown(raster, *boxes):
    return walls_shown(AXIS, raster, np.array(boxes, np.int64).reshape(-1, 4), shapes_of)


def moved(columns=0, rows=0):
    u0, u1, v0, v1 = WINDOW
    return (u0 + columns, u1 + columns, v0 + rows, v1 + rows)


def test_one_alone_says_nothing(raster):
    assert shown(raster, WINDOW) == []
    assert shown(raster, WINDOW, (60, 90, 100, 110)) == []
    assert shown(raster) == []


@pytest.mark.parametrize(("columns", "rows", "gap"), [(22, 0, (3.0, 4.0, 4.2, 6.0)), (0, 35, (2.0, 6.0, 3.0, 7.5))])
def test_two_of_a_row_or_column_show_the_wall_between_them(raster, columns, rows, gap):
    found = shown(raster, WINDOW, moved(columns, rows))
    assert {each.axis for each in found} == {AXIS}
    assert [each.is_opening for each in found] == [True, True, False]
    assert found[2].shape.equals(shapely.box(*gap)), found[2].shape


def test_between_two_that_are_far_apart_may_be_anything(raster):
    wide = WINDOW[1] - WINDOW[0]
    for columns, count in ((wide + round(WIDEST * wide) - 1, 3), (wide + round(WIDEST * wide), 2)):
        assert len(shown(raster, WINDOW, moved(columns))) == count


def test_nothing_lies_between_two_that_touch(raster):
    assert len(shown(raster, WINDOW, moved(WINDOW[1] - WINDOW[0]))) == 2
