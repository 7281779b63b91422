"""A window that a bush half hides is found by those in its row and its column; nothing is where the wall is bare."""

from dataclasses import replace

import numpy as np
import pytest

from linecad.model.openings import gaps
from linecad.model.openings.evidence import NAMES, Sums, measure
from linecad.model.openings.gaps import are_beside_clearer, are_odd, find_gaps, may_be
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
    return Pool(raster, edges, sums, none, measure(none, edges, sums, raster), none, np.zeros(0))


@pytest.fixture(scope="module")
def boxes(facade, pool):
    """All windows in columns and rows of the raster."""
    flat = np.array(facade.boxes)
    columns = np.interp(flat[:, :2], pool.raster.u, np.arange(len(pool.raster.u)))
    rows = np.interp(flat[:, 2:], pool.raster.v, np.arange(len(pool.raster.v)))
    return np.rint(np.column_stack([columns, rows])).astype(np.int64)


def others(boxes):
    return np.delete(boxes, HALF_HIDDEN, axis=0)


def asked_by(pool, taken):
    """What is asked for by those taken, each of log-odds 3."""
    evidence = measure(taken, pool.edges, pool.sums, pool.raster)
    return find_gaps(pool, taken, np.full(len(taken), 3.0), evidence, is_inside=False)


def told_by(*steps):
    """Evidence of rectangles of which nothing but the steps at their sides is known."""
    evidence = np.zeros((len(steps), len(NAMES)))
    evidence[:, NAMES.index("steps")] = steps
    return evidence


def test_half_hidden_window_is_asked_for(pool, boxes):
    found, log_odds, evidence = asked_by(pool, others(boxes))
    assert len(log_odds) == len(found)
    np.testing.assert_array_equal(evidence, measure(found, pool.edges, pool.sums, pool.raster))
    assert np.abs(found - boxes[HALF_HIDDEN]).max(axis=1).min() <= NEAR


def test_wall_between_windows_is_not_asked_for(pool, boxes):
    found, _, _ = asked_by(pool, others(boxes))
    for box in found:
        shared = np.minimum(boxes[:, [1, 3]], box[[1, 3]]) - np.maximum(boxes[:, [0, 2]], box[[0, 2]])
        assert (shared.clip(min=0).prod(axis=1) > 0).any(), box


def test_one_window_asks_for_nothing(pool, boxes):
    found, log_odds, evidence = asked_by(pool, boxes[:1])
    assert evidence.shape == (0, len(NAMES))
    assert found.shape == (0, 4)
    assert log_odds.shape == (0,)


def test_two_windows_of_a_row_ask_for_a_third(pool, boxes):
    assert len(asked_by(pool, boxes[:2])[0]) > 0


def test_one_mate_does_not_reach(pool, boxes, monkeypatch):
    """The fourth of the upper row beside the third alone, and the first of the lower one, which is no mate of it."""
    fourth = boxes[7:8]
    judged = replace(pool, box=fourth, evidence=measure(fourth, pool.edges, pool.sums, pool.raster))
    taken = boxes[[0, 6]]
    assert fourth[0].tolist() not in asked_by(judged, taken)[0].tolist()
    assert fourth[0].tolist() in asked_by(judged, boxes[[0, 5, 6]])[0].tolist()
    monkeypatch.setattr(gaps, "LEAST_MATES", 0.5)
    assert fourth[0].tolist() in asked_by(judged, taken)[0].tolist()


def test_bare_wall_between_the_sides_of_windows_is_not_asked_for(pool, boxes, monkeypatch):
    between = np.array([[boxes[0][1], boxes[1][0], *boxes[0][2:]]])
    between = np.column_stack([between[:, :1], between[:, :1] + np.diff(boxes[0][:2]), between[:, 2:]])
    evidence = measure(between, pool.edges, pool.sums, pool.raster)
    judged = replace(pool, box=between, evidence=evidence)
    monkeypatch.setattr(gaps, "LEAST_LOG_ODDS", -100.0)
    assert between[0].tolist() not in asked_by(judged, others(boxes))[0].tolist()
    monkeypatch.setattr(gaps, "ALIKE", -100.0)
    monkeypatch.setattr(gaps, "LEAST_COVER", 0.0)
    assert between[0].tolist() in asked_by(judged, others(boxes))[0].tolist()


def test_wall_between_two_windows_is_none(pool, boxes):
    """Its sides are their jambs, and at its head and sill nothing changes."""
    evidence = measure(boxes, pool.edges, pool.sums, pool.raster)
    assert not are_beside_clearer(boxes, evidence).any()
    between = np.array([[boxes[0][1], boxes[1][0], *boxes[0][2:]]])
    evidence = np.vstack([evidence, measure(between, pool.edges, pool.sums, pool.raster)])
    assert are_beside_clearer(np.vstack([boxes, between]), evidence).tolist() == [False] * 8 + [True]


@pytest.mark.parametrize(
    ("other", "is_wall"),
    [
        ([62, 92, 20, 120], True),  # beside all of it
        ([62, 92, 55, 85], False),  # beside a part of it in its middle
        ([62, 92, 90, 119], False),  # beside its end
        ([62, 92, 55, 120], True),  # beside more than half of it
        ([62, 92, 130, 230], False),  # a storey higher
        ([58, 92, 20, 120], True),  # with the side of one where the other begins
        ([57, 92, 20, 120], False),  # before it
        ([67, 92, 20, 120], False),  # far from it
    ],
)
def test_pale_one_is_wall_where_a_clear_one_has_its_side(other, is_wall):
    pale = [40, 60, 20, 120]
    assert are_beside_clearer(np.array([pale, other]), told_by(0.7, 2.0)).tolist() == [is_wall, False]
    assert not are_beside_clearer(np.array([pale, other]), told_by(1.1, 2.0)).any()


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
    assert len(asked_by(pool, others(boxes))[0]) == 0


def test_from_inside_only_what_is_bright_may_be_a_window():
    evidence = np.zeros((3, len(NAMES)))
    evidence[:, NAMES.index("darker")] = [1.5, -0.5, -1.5]
    log_odds = np.array([0.0, 0.0, 0.0])
    assert may_be(log_odds, evidence, True).tolist() == [False, False, True]
    assert may_be(log_odds - [1, 0, 0], evidence, False).tolist() == [False, True, True]
