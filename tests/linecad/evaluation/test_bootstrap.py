"""Figures over photos and their intervals."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from linecad.evaluation.bootstrap import mean, ratio_of_sums

photos = st.lists(st.tuples(st.integers(0, 50), st.integers(0, 50)), min_size=1, max_size=12)


@given(photos)
def test_a_share_lies_in_its_interval_and_the_interval_between_the_photos(counted):
    right, total = [a for a, _ in counted], [a + b for a, b in counted]
    found = ratio_of_sums(right, total)
    said = [a / n for a, n in zip(right, total, strict=True) if n]
    if not said:
        assert found is None
        return
    assert found.photos == len(said)
    assert found.value == pytest.approx(sum(right) / sum(total))
    assert min(said) - 1e-12 <= found.low <= found.high <= max(said) + 1e-12


def test_one_photo_leaves_no_room():
    found = ratio_of_sums([3], [4])
    assert (found.value, found.low, found.high) == (0.75, 0.75, 0.75)


def test_the_same_photos_give_the_same_interval():
    assert mean([0.1, 0.5, 0.9, 0.2]) == mean([0.1, 0.5, 0.9, 0.2])


def test_photos_without_a_say_change_nothing():
    assert mean([0.1, None, 0.5]) == mean([0.1, 0.5])
    assert ratio_of_sums([1, 0, 2], [2, 0, 2]) == ratio_of_sums([1, 2], [2, 2])


def test_the_interval_is_that_of_a_mean_of_many():
    values = np.random.default_rng(1).normal(5, 2, 400)
    found = mean(values.tolist())
    assert found.high - found.low == pytest.approx(2 * 1.96 * 2 / np.sqrt(400), rel=0.12)


def test_large_photos_count_more_in_a_share_and_not_in_a_mean():
    assert ratio_of_sums([90, 1], [100, 10]).value == pytest.approx(91 / 110)
    assert mean([0.9, 0.1]).value == pytest.approx(0.5)
