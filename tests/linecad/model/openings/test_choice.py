"""The set of rectangles that is taken is the best one, as trying all sets shows."""

from itertools import product

import numpy as np
import pytest
import shapely

from linecad.model.openings import choice
from linecad.model.openings.choice import choose, heaviest_set, not_overlapping, overlapping


def best_by_trying(value, pairs):
    """The most value in sum of a set without pairs."""
    best = 0.0
    for taken in product((0, 1), repeat=len(value)):
        if not any(taken[a] and taken[b] for a, b in pairs):
            best = max(best, float(np.dot(value, taken)))
    return best


@pytest.mark.parametrize("seed", range(25))
def test_no_set_is_better(seed):
    rng = np.random.default_rng(seed)
    count = int(rng.integers(2, 13))
    value = rng.uniform(0.1, 4.0, count)
    every = np.column_stack(np.triu_indices(count, 1))
    pairs = every[rng.random(len(every)) < rng.uniform(0.1, 0.9)]
    taken, more = heaviest_set(value, pairs) if len(pairs) else (np.ones(count, bool), 0.0)
    assert more == 0
    assert not any(taken[a] and taken[b] for a, b in pairs)
    assert value[taken].sum() == pytest.approx(best_by_trying(value, pairs), abs=1e-9)


@pytest.mark.parametrize("seed", range(10))
def test_rectangles_that_overlap_are_never_taken_together_and_no_set_is_better(seed):
    rng = np.random.default_rng(100 + seed)
    corner, size = rng.uniform(0, 6, (11, 2)), rng.uniform(1, 3, (11, 2))
    shapes = [shapely.box(*low, *(low + side)) for low, side in zip(corner, size, strict=True)]
    log_odds = rng.uniform(-0.5, 3.0, 11)
    pairs = overlapping(np.array(shapes, object))
    taken = choose(shapes, log_odds).taken
    value = log_odds * np.sqrt([shape.area for shape in shapes])
    assert not any(a in taken and b in taken for a, b in pairs)
    assert value[taken].sum() == pytest.approx(best_by_trying(value, pairs), abs=1e-9)


def test_two_that_together_are_likelier_take_the_place_of_one():
    # Greedily the one in the middle is taken, and both others are lost.
    shapes = [shapely.box(0, 0, 2, 2), shapely.box(1.5, 0, 3.5, 2), shapely.box(3, 0, 5, 2)]
    assert choose(shapes, np.array([1.0, 1.5, 1.0])).taken.tolist() == [0, 2]


def test_window_is_taken_and_not_its_panes():
    shapes = [shapely.box(0, 0, 2, 2), shapely.box(0, 0, 1, 1), shapely.box(1, 1, 2, 2)]
    assert choose(shapes, np.array([1.1, 1.0, 1.0])).taken.tolist() == [0]


def test_what_hardly_overlaps_is_taken_together_and_what_is_unlikely_is_not():
    shapes = [shapely.box(0, 0, 2, 2), shapely.box(1.95, 0, 4, 2), shapely.box(9, 9, 10, 10)]
    assert overlapping(np.array(shapes, object)).tolist() == []
    assert choose(shapes, np.array([0.2, 0.3, -0.1])).taken.tolist() == [0, 1]


def test_search_that_ends_at_its_limit_tells_how_much_better_another_set_may_be(monkeypatch):
    rng = np.random.default_rng(3)
    value = rng.uniform(0.5, 1.5, 70)
    every = np.column_stack(np.triu_indices(70, 1))
    pairs = every[rng.random(len(every)) < 0.1]
    best, none = heaviest_set(value, pairs)
    monkeypatch.setattr(choice, "MOST_NODES", 1)
    taken, more = heaviest_set(value, pairs)
    assert none == 0
    assert not any(taken[a] and taken[b] for a, b in pairs)
    assert 0 < value[best].sum() - value[taken].sum() <= more < value[taken].sum()


def test_gap_is_a_share_of_what_is_taken(monkeypatch):
    shapes = [shapely.box(0, 0, 2, 2), shapely.box(1.5, 0, 3.5, 2), shapely.box(3, 0, 5, 2), shapely.box(9, 0, 11, 2)]
    monkeypatch.setattr(choice, "heaviest_set", lambda _value, _pairs: (np.array([True, False, True]), 0.6))
    found = choose(shapes, np.ones(4))
    assert found.taken.tolist() == [0, 2, 3]
    assert found.gap == pytest.approx(0.1)
    assert found.notes == ("windows and doors: another choice of them may be up to 10.0% better; not proven",)


def test_nothing_is_told_of_a_choice_that_is_proven():
    assert choose([shapely.box(0, 0, 2, 2)], np.ones(1)).notes == ()


def test_what_overlaps_nothing_taken_is_free():
    taken = [shapely.box(0, 0, 2, 2)]
    shapes = [shapely.box(1, 1, 3, 3), shapely.box(1.9, 0, 4, 2), shapely.box(5, 5, 6, 6)]
    assert not_overlapping(shapes, taken).tolist() == [False, True, True]
    assert not_overlapping([], taken).tolist() == []
    assert not_overlapping(shapes, []).all()
