"""A window that a bush half hides is found by those in its row and its column; nothing is where the wall is bare."""

from dataclasses import replace

import numpy as np
import pytest

from linecad.model.openings import gaps
from linecad.model.openings.evidence import NAMES, Sums, measure
from linecad.model.openings.gaps import are_between, are_odd, find_gaps, may_be
from linecad.model.openings.pool import Pool
from linecad.model.openings.raster import build_raster, look
from linecad.model.openings.rectangles import count_edges
from linecad.model.openings.walls import find_walls

HALF_HIDDEN = 2  # of the lower row
NEAR = 4  # columns or rows


@pytest.fixture(scope="module")
def facade(facade_of):
    """The lower half of a window is painted over in the wall's own colour, so that its sides end in nothing."""
    return facade_of(half_hidden=(HALF_HIDDEN,))


@pytest.fixture(scope="module")
def pool(facade):
    wall = find_walls(facade.planes, facade.lines, facade.camera, facade.rotation)[0]
    raster = build_raster(wall, look(facade.pixels))
    edges, sums = count_edges(raster), Sums(raster)
    none = np.zeros((0, 4), np.int64)
    return Pool(raster, edges, sums, none, measure(none, edges, sums, raster), none, np.zeros(0), False)


@pytest.fixture(scope="module")
def boxes(facade, pool):
    """All windows in columns and rows of the raster."""
    flat = np.array(facade.boxes)
    columns = np.interp(flat[:, :2], pool.raster.u, np.arange(len(pool.raster.u)))
    rows = np.interp(flat[:, 2:], pool.raster.v, np.arange(len(pool.raster.v)))
    return np.rint(np.column_stack([columns, rows])).astype(np.int64)


def others(boxes):
    return np.delete(boxes, HALF_HIDDEN, axis=0)


def test_half_hidden_window_is_asked_for(pool, boxes):
    found, odds = find_gaps(pool, others(boxes), np.full(7, 3.0))
    assert len(odds) == len(found)
    assert np.abs(found - boxes[HALF_HIDDEN]).max(axis=1).min() <= NEAR


def test_wall_between_windows_is_not_asked_for(pool, boxes):
    found, _ = find_gaps(pool, others(boxes), np.full(7, 3.0))
    for box in found:
        shared = np.minimum(boxes[:, [1, 3]], box[[1, 3]]) - np.maximum(boxes[:, [0, 2]], box[[0, 2]])
        assert (shared.clip(min=0).prod(axis=1) > 0).any(), box


def test_one_window_asks_for_nothing(pool, boxes):
    found, odds = find_gaps(pool, boxes[:1], np.array([3.0]))
    assert found.shape == (0, 4)
    assert odds.shape == (0,)


def test_two_windows_of_a_row_ask_for_a_third_and_one_does_not_reach(pool, boxes):
    assert len(find_gaps(pool, boxes[:2], np.full(2, 3.0))[0]) > 0
    far = np.array([boxes[0], boxes[5]])  # neither in the row nor in the column of the other
    assert len(find_gaps(pool, far, np.full(2, 3.0))[0]) == 0


def test_bare_wall_between_the_sides_of_windows_is_not_asked_for(pool, boxes, monkeypatch):
    between = np.array([[boxes[0][1], boxes[1][0], *boxes[0][2:]]])
    between = np.column_stack([between[:, :1], between[:, :1] + np.diff(boxes[0][:2]), between[:, 2:]])
    evidence = measure(between, pool.edges, pool.sums, pool.raster)
    judged = replace(pool, box=between, evidence=evidence)
    monkeypatch.setattr(gaps, "LEAST_ODDS", -100.0)
    assert between[0].tolist() not in find_gaps(judged, others(boxes), np.full(7, 3.0))[0].tolist()
    monkeypatch.setattr(gaps, "ALIKE", -100.0)
    monkeypatch.setattr(gaps, "LEAST_COVER", 0.0)
    assert between[0].tolist() in find_gaps(judged, others(boxes), np.full(7, 3.0))[0].tolist()


def test_wall_between_two_windows_is_none(pool, boxes):
    """Its sides are their jambs, and at its head and sill nothing changes."""
    assert not are_between(pool, boxes).any()
    left, right = boxes[0][1], boxes[1][0]
    assert are_between(pool, np.vstack([boxes, [left, right, *boxes[0][2:]]])).tolist() == [False] * 8 + [True]


def test_tiny_one_alone_is_odd(pool, boxes):
    left, _, low, _ = boxes[0]
    tiny = np.array([left + 13, left + 21, low + 15, low + 26])
    assert are_odd(pool.raster, np.vstack([boxes, tiny])).tolist() == [False] * 8 + [True]


def test_tiny_ones_in_a_row_are_not_odd(pool, boxes):
    left, _, low, _ = boxes[0]
    tiny = np.array([[left + way, left + way + 8, low + 15, low + 26] for way in (13, 30)])
    assert not are_odd(pool.raster, np.vstack([boxes, tiny])).any()


def test_nothing_is_odd_among_few(pool, boxes):
    left, _, low, _ = boxes[0]
    tiny = np.array([left + 13, left + 21, low + 15, low + 26])
    assert not are_odd(pool.raster, np.vstack([boxes[:2], tiny])).any()


def test_window_whose_edges_are_hidden_is_not_asked_for(pool, boxes, monkeypatch):
    monkeypatch.setattr(gaps, "LEAST_COVER", 4.0)
    assert len(find_gaps(pool, others(boxes), np.full(7, 3.0))[0]) == 0


def test_from_inside_only_what_is_bright_may_be_a_window():
    evidence = np.zeros((3, len(NAMES)))
    evidence[:, NAMES.index("darker")] = [1.5, -0.5, -1.5]
    odds = np.array([0.0, 0.0, 0.0])
    assert may_be(odds, -0.5, evidence, True).tolist() == [False, False, True]
    assert may_be(odds - [1, 0, 0], -0.5, evidence, False).tolist() == [False, True, True]
