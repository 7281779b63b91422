"""Where the nearer of two parallel walls ends, by points on lines that are drawn at random."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from linecad.model.regions.raster import take_raster
from linecad.model.regions.steps import Pair, find_step

NEAR, FAR = 5.0, 5.5
ROWS = 20
SAMPLE = 0.005  # x of a sample
TRUE = 2.0  # the place of the end
INNER, OUTER = TRUE / FAR, TRUE / NEAR


@pytest.fixture(scope="module")
def raster(house):
    """One without a change of colour anywhere."""
    return take_raster(house.lines, house.camera, house.rotation, None)


def pair_of(raster, inner=INNER, outer=OUTER, each=1):
    """Walls whose lines end at places of the photo, in every sample or fewer, where all rows show the same."""
    column = np.arange(raster.size) % raster.shape[1]
    at = 0.1 + SAMPLE * (column + 0.5)
    seen = np.arange(raster.size) < ROWS * raster.shape[1]
    far, near = (np.flatnonzero(seen & own)[::each] for own in (at <= inner, at >= outer))
    return Pair(NEAR, FAR, at, seen, near, far, SAMPLE)


def coloured(raster, pair, places):
    """The raster with a colour of its own between each two places of the photo."""
    shade = 60 * np.searchsorted(places, pair.at).astype(np.uint8)
    colour = np.repeat(shade[:, None], 3, axis=1).reshape(*raster.shape, 3)
    return replace(raster, colour=colour)


@given(st.floats(0.9, 1.1), st.integers(1, 7))
def test_lines_end_at_the_place_of_the_end_wherever_the_border_is(raster, off, each):
    found = find_step(pair_of(raster, each=each), TRUE * off, raster)
    assert found.place == pytest.approx(TRUE, abs=2 * SAMPLE * FAR)


@given(st.floats(0.95, 1.05))
def test_where_lines_leave_room_colours_change_at_both_corners(raster, off):
    pair = pair_of(raster, INNER - 0.03, OUTER + 0.03)
    found = find_step(pair, TRUE * off, coloured(raster, pair, [INNER, OUTER]))
    assert found.place == pytest.approx(TRUE, abs=1.5 * SAMPLE * FAR)


@given(st.floats(0.97, 1.03))
def test_where_lines_leave_room_and_no_colour_changes_the_border_stays(raster, off):
    found = find_step(pair_of(raster, INNER - 0.06, OUTER + 0.06), TRUE * off, raster)
    assert found.place == pytest.approx(TRUE * off, abs=SAMPLE * FAR)


@given(st.floats(0.97, 1.03), st.integers(0, 20))
def test_grain_is_no_change_of_colour(raster, off, seed):
    noise = np.random.default_rng(seed).integers(118, 139, (*raster.shape, 3)).astype(np.uint8)
    found = find_step(pair_of(raster, INNER - 0.06, OUTER + 0.06), TRUE * off, replace(raster, colour=noise))
    assert found.place == pytest.approx(TRUE * off, abs=SAMPLE * FAR)


@given(st.floats(0.97, 1.03))
def test_the_edge_of_a_tree_is_no_corner(raster, off):
    pair = pair_of(raster, INNER - 0.06, OUTER + 0.06)
    behind_tree = (pair.at > OUTER + 0.01) & (pair.at < OUTER + 0.05)
    hidden = replace(pair, seen=pair.seen & ~behind_tree)
    found = find_step(hidden, TRUE * off, coloured(raster, pair, [INNER, OUTER]))
    assert found.place == pytest.approx(TRUE, abs=1.5 * SAMPLE * FAR)


def test_few_lines_that_go_on_do_not_move_the_end(raster):
    pair = pair_of(raster)
    cornice = np.flatnonzero((np.arange(raster.size) < 2 * raster.shape[1]) & (pair.at > INNER - 0.02))  # in two rows
    found = find_step(replace(pair, near_points=np.concatenate([pair.near_points, cornice])), 1.05 * TRUE, raster)
    assert found.place == pytest.approx(TRUE, abs=2 * SAMPLE * FAR)


@pytest.mark.parametrize(("inner", "outer", "is_bare"), [(INNER, OUTER, True), (OUTER, OUTER, False)])
def test_a_strip_without_lines_between_walls_full_of_them_is_bare(raster, inner, outer, is_bare):
    assert find_step(pair_of(raster, inner, outer), TRUE, raster).is_bare == is_bare


def test_a_strip_behind_a_hedge_is_not_bare(raster):
    pair = pair_of(raster)
    hidden = replace(pair, seen=pair.seen & ~((pair.at > INNER) & (pair.at < OUTER)))
    assert not find_step(hidden, TRUE, raster).is_bare


def test_a_strip_beside_a_wall_without_lines_is_not_bare(raster):
    pair = pair_of(raster)
    assert not find_step(replace(pair, near_points=np.zeros(0, np.int64)), TRUE, raster).is_bare
