"""Which pixels hold depth."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from linecad.depth.validity import valid_depths

RNG = np.random.default_rng(3)


def surfaces(height=100, width=120):
    """Depths of which no two are alike, as a network writes them."""
    return RNG.uniform(2, 30, (height, width)).astype(np.float32)


@given(
    arrays.arrays(
        np.float64, (17, 18), elements=st.floats(width=64) | st.sampled_from([0.0, -1.0, np.inf, np.nan, 5.0])
    )
)
def test_what_is_valid_is_a_positive_number(values):
    depth, valid = valid_depths(values, None)
    assert ((depth > 0) == valid).all()
    assert np.isfinite(depth).all()
    with np.errstate(all="ignore"):
        single = values.astype(np.float32)
    np.testing.assert_array_equal(depth[valid], single[valid])
    refused = single[~valid]
    positive = refused[(refused > 0) & np.isfinite(refused)]
    assert len(np.unique(positive)) <= 1  # at most one plateau


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf, 0.0, -3.0])
def test_the_missing_the_infinite_and_the_negative(bad):
    values = surfaces()
    values[10:20] = bad
    depth, valid = valid_depths(values, None)
    assert valid.sum() == 90 * 120
    assert not valid[10:20].any()
    assert (depth[~valid] == 0).all()


@pytest.mark.parametrize("share", [0.01, 0.3, 0.9])
def test_sky_at_the_largest_value(share):
    values = surfaces()
    rows = int(100 * share)
    values[:rows] = 80
    _, valid = valid_depths(values, None)
    np.testing.assert_array_equal(valid, values < 80)


@pytest.mark.parametrize("share", [0.02, 0.3, 0.6])
def test_sky_at_the_99th_percentile(share):
    values = surfaces()
    rows = int(100 * share)
    values[:rows] = np.percentile(values[rows:], 99)
    _, valid = valid_depths(values, None)
    assert not valid[:rows].any()
    assert valid[rows:].mean() > 0.99


def test_a_map_of_one_value_has_no_plateau():
    assert valid_depths(np.full((20, 20), 4.0), None)[1].all()


@pytest.mark.parametrize("step", [1 / 256, 2.0**-8])
def test_a_far_wall_in_steps_is_no_plateau(step):
    """A wall that stands across the view fills few steps of 16 bits or of half precision, each of them often."""
    values = surfaces()
    values[:40] = 40 + RNG.normal(0, 0.01, (40, 120))
    assert valid_depths(np.round(values / step) * step, None)[1].all()


def test_a_near_plateau_is_depth():
    values = surfaces()
    values[:40] = 1.0
    assert valid_depths(values, None)[1].all()


def test_the_mask_of_the_network():
    mask = np.ones((100, 120), bool)
    mask[:, :7] = False
    np.testing.assert_array_equal(valid_depths(surfaces(), mask)[1], mask)


def test_a_large_map_is_judged_by_a_part_of_it():
    values = RNG.uniform(2, 30, (1500, 1000)).astype(np.float32)
    values[:300] = 55
    np.testing.assert_array_equal(valid_depths(values, None)[1], values < 55)
