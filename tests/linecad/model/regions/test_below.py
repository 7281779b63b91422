"""Walls that go down to the ground, by walls before the camera whose lower part was taken for ground."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_array_equal

from linecad.model.regions.below import HIDDEN_COST, LEAST, WALL_COST, walls_above, with_feet
from linecad.model.regions.evidence import BEHIND, depths
from tests.linecad.model.regions.test_corners import GROUND, known_of

WALL, _, GROUND_ROW, SKY, CLUTTER = range(5)
COST = 2.0


def cut_off(distance, lowest):
    """What is known where a wall is told down to the height `lowest` alone, and ground below it."""
    known = known_of([(1, distance, -2.0, 2.0), (1, 30.0, 100.0, 101.0)])  # the second is not seen
    height = known.raster.rays[:, 2] * distance / known.raster.rays[:, 1]
    return replace(known, shown=np.where((known.shown == WALL) & (height < lowest), GROUND_ROW, known.shown)), height


def costs_of(known):
    return np.full((known.raster.size, len(known.surfaces) + 2), COST, order="F")


@settings(deadline=None, max_examples=30)
@given(st.floats(4, 10), st.floats(GROUND + 0.2, 0.5))
def test_what_a_wall_hides_is_dear_as_ground_and_cheap_as_that_wall(distance, lowest):
    known, _ = cut_off(distance, lowest)
    ground = known.surfaces[GROUND_ROW]
    changed = with_feet(costs_of(known), known, ground)
    above = walls_above(known, GROUND_ROW) == WALL
    hidden = above & (depths(known.raster, known.surfaces)[:, GROUND_ROW] > distance * BEHIND)
    assume(hidden.mean() >= LEAST)
    assert_array_equal(changed[hidden, GROUND_ROW], COST + HIDDEN_COST)
    assert_array_equal(changed[hidden, WALL], WALL_COST)
    assert_array_equal(changed[~hidden], COST)


def test_the_ground_before_a_wall_keeps_its_cost():
    known, height = cut_off(6.0, -0.5)
    before = height < GROUND
    assert before.any()
    assert_array_equal(with_feet(costs_of(known), known, known.surfaces[GROUND_ROW])[before], COST)


def test_borders_that_follow_a_foot_roughly_change_nothing():
    known, height = cut_off(6.0, GROUND + 0.03)
    hidden = (known.shown == GROUND_ROW) & (height > GROUND) & (walls_above(known, GROUND_ROW) == WALL)
    assert 0 < hidden.mean() < LEAST
    assert_array_equal(with_feet(costs_of(known), known, known.surfaces[GROUND_ROW]), COST)


def test_plants_before_a_wall_hide_its_foot():
    known, _ = cut_off(6.0, -0.5)
    green = np.array([110, 110, 145], np.uint8)
    hedge = np.zeros((*known.raster.shape, 3), np.uint8) + green
    grown = replace(known, raster=replace(known.raster, colour=hedge))
    assert (walls_above(known, GROUND_ROW) == WALL).any()
    assert not (walls_above(grown, GROUND_ROW) == WALL).any()


def test_a_ground_whose_height_is_not_sure_changes_nothing():
    known, _ = cut_off(6.0, -0.5)
    costs = costs_of(known)
    assert with_feet(costs, known, None) is costs


@pytest.mark.parametrize(("between", "expected"), [(CLUTTER, WALL), (GROUND_ROW, WALL), (SKY, -1)])
def test_a_car_before_a_wall_does_not_end_it_and_sky_does(between, expected):
    known, _ = cut_off(6.0, -0.5)
    shown = known.shown.reshape(known.raster.shape).copy()
    column = shown.shape[1] // 2
    first = int(np.flatnonzero(shown[:, column] == GROUND_ROW)[0])
    shown[first : first + 3, column] = between
    above = walls_above(replace(known, shown=shown.ravel()), GROUND_ROW).reshape(shown.shape)
    assert above[first + 3, column] == expected
