"""Rectangles, rows and columns on small rasters."""

import numpy as np

from linecad.model.openings import rectangles
from linecad.model.openings.lattice import distinct, propose, support
from linecad.model.openings.raster import Raster
from linecad.model.openings.rectangles import count_edges, find_rectangles

WINDOW = np.array([20, 40, 30, 60])


def moved(by):
    """The window elsewhere."""
    return WINDOW + np.array(by)


def raster_of(boxes, missing=()):
    """Edges of boxes by columns and rows, without the named sides of the first."""
    shape = (120, 160)
    upright, level = np.zeros(shape, bool), np.zeros(shape, bool)
    for number, (left, right, low, high) in enumerate(boxes):
        gone = missing if number == 0 else ()
        for name, column in (("left", left), ("right", right)):
            upright[low : high + 1, column] |= name not in gone
        for name, row in (("low", low), ("high", high)):
            level[row, left : right + 1] |= name not in gone
    colours = np.full((*shape, 3), 128, np.uint8)
    return Raster(np.arange(160) * 0.1, np.arange(120) * 0.1, colours, np.ones(shape, bool), upright, level)


def find(raster):
    return find_rectangles(raster, count_edges(raster))


def nearest(found, box):
    return np.abs(found - box).max(axis=1).min() if len(found) else np.inf


def test_closed_rectangle_is_found():
    assert nearest(find(raster_of([WINDOW])), WINDOW) <= 1


def test_window_seen_obliquely_may_be_five_columns_wide_and_no_less():
    wide = find(raster_of([(20, 25, 30, 55)]))
    assert (wide[:, 1] - wide[:, 0]).min() == 5
    narrower = find(raster_of([(20, 24, 30, 54)]))
    assert len(narrower) == 0 or (narrower[:, 1] - narrower[:, 0]).min() >= 5


def test_nothing_is_found_where_two_sides_are_missing():
    assert len(find(raster_of([WINDOW], missing=("left", "low")))) == 0


def test_nested_rectangles_are_both_found():
    inner = moved([4, -4, 5, -5])
    found = find(raster_of([WINDOW, inner]))
    assert nearest(found, WINDOW) <= 1
    assert nearest(found, inner) <= 1


def test_cover_and_what_goes_on_beyond_are_shares():
    raster = raster_of([WINDOW])
    raster.level[60, :] = True
    edges = count_edges(raster)
    np.testing.assert_allclose(edges.cover(WINDOW[None]), 1.0)
    beyond = edges.beyond(WINDOW[None])[0]
    np.testing.assert_allclose(beyond, [0, 0, 0, 1])


def test_one_of_rectangles_that_mean_the_same_stays():
    box = np.array([WINDOW, WINDOW + 1, moved([60, 60, 0, 0])])
    assert distinct(box, np.array([1.0, 2.0, 0.5])).tolist() == [1, 2]


def test_row_and_column_support_and_others_do_not():
    others = np.array([WINDOW, moved([40, 40, 0, 0]), moved([0, 0, 40, 40]), moved([80, 90, 7, 20])])
    found = support(WINDOW[None], raster_of([WINDOW]), others, np.zeros(4))
    np.testing.assert_allclose(found, np.log1p([[0.5, 0.5]]))


def test_row_and_column_propose_the_fourth():
    others = np.array([WINDOW, moved([40, 40, 0, 0]), moved([0, 0, 40, 40])])
    fourth = moved([40, 40, 40, 40])
    assert nearest(propose(others, raster_of([WINDOW])), fourth) == 0


def test_one_rectangle_proposes_nothing():
    assert len(propose(WINDOW[None], raster_of([WINDOW]))) == 0


def test_only_the_best_closed_rectangles_stay(monkeypatch):
    raster = raster_of([WINDOW, moved([60, 60, 0, 0])])
    raster.level[30, :20] = True  # the head of the first goes on to the left
    monkeypatch.setattr(rectangles, "MOST", 1)
    [found] = find(raster)
    assert nearest(found[None], moved([60, 60, 0, 0])) <= 1
