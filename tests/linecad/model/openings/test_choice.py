"""The set of rectangles that is taken is the best one, as trying all sets shows."""

from itertools import product

import numpy as np
import pytest
import shapely

from linecad.model.openings.choice import choose, heaviest_set, overlapping


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
    taken = heaviest_set(value, pairs) if len(pairs) else np.ones(count, bool)
    assert not any(taken[a] and taken[b] for a, b in pairs)
    assert value[taken].sum() == pytest.approx(best_by_trying(value, pairs), abs=1e-9)


@pytest.mark.parametrize("seed", range(10))
def test_rectangles_that_overlap_are_never_taken_together_and_no_set_is_better(seed):
    rng = np.random.default_rng(100 + seed)
    corner, size = rng.uniform(0, 6, (11, 2)), rng.uniform(1, 3, (11, 2))
    shapes = [shapely.box(*low, *(low + side)) for low, side in zip(corner, size, strict=True)]
    odds = rng.uniform(-0.5, 3.0, 11)
    pairs = overlapping(np.array(shapes, object))
    taken = choose(shapes, odds)
    value = odds * np.sqrt([shape.area for shape in shapes])
    assert not any(a in taken and b in taken for a, b in pairs)
    assert value[taken].sum() == pytest.approx(best_by_trying(value, pairs), abs=1e-9)


def test_two_that_together_are_likelier_take_the_place_of_one():
    # Greedily the one in the middle is taken, and both others are lost.
    shapes = [shapely.box(0, 0, 2, 2), shapely.box(1.5, 0, 3.5, 2), shapely.box(3, 0, 5, 2)]
    assert choose(shapes, np.array([1.0, 1.5, 1.0])).tolist() == [0, 2]


def test_window_is_taken_and_not_its_panes():
    shapes = [shapely.box(0, 0, 2, 2), shapely.box(0, 0, 1, 1), shapely.box(1, 1, 2, 2)]
    assert choose(shapes, np.array([1.1, 1.0, 1.0])).tolist() == [0]


def test_what_hardly_overlaps_is_taken_together_and_what_is_unlikely_is_not():
    shapes = [shapely.box(0, 0, 2, 2), shapely.box(1.95, 0, 4, 2), shapely.box(9, 9, 10, 10)]
    assert overlapping(np.array(shapes, object)).tolist() == []
    assert choose(shapes, np.array([0.2, 0.3, -0.1])).tolist() == [0, 1]
