"""How rectangles lie to others, against a count one by one, and windows of which only the panes have edges."""

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from linecad.model.openings.neighbours import (
    ACROSS,
    CLOSE,
    COVERED,
    LARGER,
    LIKELY_PANE,
    MORE,
    MOST_MATES,
    NAMES,
    PANES,
    SURE,
    TIGHT,
    WITHIN,
    compare,
    windows_of_panes,
)

EVEN = SimpleNamespace(u=np.arange(200.0), v=np.arange(200.0))
SAME = 2.0  # columns or rows by which those of one row or column differ here, all of them being small


def is_mate(box, other, along):
    """Whether another of the same size stands beside a box along columns (0) or rows (1)."""
    own, its = box.reshape(2, 2), other.reshape(2, 2)
    across = 1 - along
    is_apart = own[along, 0] >= its[along, 1] or its[along, 0] >= own[along, 1]
    in_line = abs(own[across] - its[across]).max() <= SAME
    return is_apart and in_line and abs(np.diff(own[along]) - np.diff(its[along]))[0] <= SAME


def gap(box, other, along):
    own, its = box.reshape(2, 2)[along], other.reshape(2, 2)[along]
    return max(its[0] - own[1], own[0] - its[1])


def is_near(box, other, along, share):
    return gap(box, other, along) < share * np.diff(box.reshape(2, 2)[along])[0] + MORE


def area(box):
    return np.diff(box.reshape(2, 2), axis=1).prod()


def shared(box, other):
    own, its = box.reshape(2, 2), other.reshape(2, 2)
    return int(np.prod(np.maximum(np.minimum(own[:, 1], its[:, 1]) - np.maximum(own[:, 0], its[:, 0]), 0)))


def one_by_one(box, others, log_odds):
    """The numbers of one box."""
    sure = 1 / (1 + np.exp(-log_odds))
    standing = np.zeros((2, 3))
    for other, share in zip(others, sure, strict=True):
        for along in range(2):
            if is_mate(box, other, along):
                place = 2 if is_near(box, other, along, TIGHT) else 1 if is_near(box, other, along, CLOSE) else 0
                standing[along, place] += share
    panes = [
        sum(is_mate(one, two, along) and is_near(one, two, along, CLOSE) for two in others for along in range(2))
        >= PANES
        for one in others
    ]
    around, inside = -SURE, -SURE
    sums = np.zeros(4)
    covered = np.zeros(2)
    for other, value, share, is_pane in zip(others, log_odds, sure, panes, strict=True):
        both = shared(box, other)
        if both > WITHIN * area(box) and area(other) > LARGER * area(box):
            around = max(around, min(value, SURE))
            sums[2] += share
        if both > WITHIN * area(other) and area(box) > LARGER * area(other):
            inside = max(inside, min(value, SURE))
            sums[0 if is_pane else 1] += share
            covered[0 if is_pane else 1] += both * ((share > LIKELY_PANE) if is_pane else share)
        smaller = min(area(box), area(other))
        if ACROSS * smaller < both < WITHIN * smaller:
            sums[3] += share
    mates = np.log1p(np.minimum(standing, MOST_MATES)).ravel()
    return np.concatenate([mates, [around, inside], np.log1p(sums), np.minimum(covered / area(box), COVERED)])


SIDES = st.tuples(st.integers(0, 60), st.integers(5, 24)).map(lambda side: (side[0], side[0] + side[1]))
BOXES = st.lists(st.tuples(SIDES, SIDES), min_size=1, max_size=7).map(
    lambda boxes: np.array(boxes, np.int64).reshape(-1, 4)
)


@given(box=BOXES, others=BOXES, data=st.data())
def test_numbers_are_those_counted_one_by_one(box, others, data):
    values = st.lists(st.floats(-9, 9), min_size=len(others), max_size=len(others))
    log_odds = np.array(data.draw(values))
    expected = np.array([one_by_one(each, others, log_odds) for each in box])
    np.testing.assert_allclose(compare(box, EVEN, others, log_odds), expected, atol=1e-9)


def test_without_others_there_is_nothing_to_compare_with():
    box, none = np.array([[0, 9, 0, 9], [0, 9, 9, 20]]), np.zeros((0, 4), np.int64)
    far = np.array([[100, 150, 100, 190]])
    np.testing.assert_array_equal(compare(box, EVEN, none, np.zeros(0)), compare(box, EVEN, far, np.zeros(1)))


def grid(columns, rows, bar, left=20, low=30):
    """Panes of 10 by 12, a bar apart."""
    across = [left + (10 + bar) * column for column in range(columns)]
    up = [low + (12 + bar) * row for row in range(rows)]
    return np.array([[u, u + 10, v, v + 12] for u in across for v in up], np.int64)


def test_panes_are_a_window_with_and_without_its_frame():
    panes = grid(2, 3, bar=2)
    assert windows_of_panes(panes, np.zeros(6), EVEN).tolist() == [[18, 44, 28, 72], [20, 42, 30, 70]]


def test_each_group_of_panes_is_a_window_and_what_stands_apart_is_none():
    panes = np.concatenate([grid(2, 1, bar=0), grid(2, 1, bar=0, left=100), grid(1, 1, bar=0, left=160)])
    assert windows_of_panes(panes, np.zeros(5), EVEN).tolist() == [[20, 40, 30, 42], [100, 120, 30, 42]]


def test_unlikely_panes_are_no_window():
    log_odds = np.array([0.0, -9.0])
    assert len(windows_of_panes(grid(2, 1, bar=1), log_odds, EVEN)) == 0


def test_a_window_with_its_frame_stays_on_the_wall():
    assert windows_of_panes(grid(2, 1, bar=3, left=1, low=1), np.zeros(2), EVEN).tolist() == [
        [0, 27, 0, 16],
        [1, 24, 1, 13],
    ]


@pytest.mark.parametrize(("name", "bar"), [("row, tight", 2), ("row, close", 5), ("row, apart", 14)])
def test_mates_count_by_how_far_they_stand(name, bar):
    pair = grid(2, 1, bar=bar)
    found = compare(pair[:1], EVEN, pair, np.zeros(2))[0]
    counted = {each: round(float(value), 6) for each, value in zip(NAMES[:6], found, strict=False) if value}
    assert counted == {name: round(float(np.log(1.5)), 6)}
