"""Storeys from rows of windows."""

from dataclasses import replace

import numpy as np
import pytest

from exporters.ifc.storeys import build_storeys, storey_of
from exporters.ifc.voids import Void, build_voids
from exporters.model import build_model


@pytest.fixture(scope="module")
def void(row):
    return build_voids(build_model(row))[0]


def window(void: Void, sill: float, head: float, plane: int = 1, kind: str = "window") -> Void:
    fitting = replace(void.fitting, kind=kind)
    return replace(void, fitting=fitting, plane=plane, low=np.array([0, 0, sill]), high=np.array([1, 0, head]))


def levels(voids):
    return [(storey.sill, storey.windows) for storey in build_storeys(voids)]


def test_a_row_of_windows_above_another_begins_a_storey(void):
    rows = [window(void, sill, sill + 1.4) for sill in (3.9, 0.9, 6.8) for _ in range(3)]
    assert levels(rows) == [(0.9, 3), (3.9, 3), (6.8, 3)]


def test_a_single_window_tells_none_as_it_may_be_that_of_a_stair(void):
    rows = [window(void, 0.9, 2.3), window(void, 0.9, 2.3), window(void, 2.4, 3.8)]
    assert levels(rows) == [(0.9, 2)]


def test_two_windows_at_one_height_in_two_walls_are_no_row(void):
    assert levels([window(void, 0.9, 2.3, plane=1), window(void, 0.9, 2.3, plane=2)]) == []


def test_doors_tell_none(void):
    assert levels([window(void, 0.0, 2.1, kind="door")] * 3) == []


def test_rows_of_two_walls_that_reach_past_each_other_are_of_one_storey(void):
    rows = [window(void, 1.0, 2.5, plane=1)] * 2 + [window(void, 1.4, 2.7, plane=2)] * 4
    assert levels(rows) == [(1.0, 6)]


@pytest.mark.parametrize(
    ("sill", "head", "number"), [(-1.0, 1.0, 0), (0.9, 2.3, 0), (2.5, 3.8, 0), (3.5, 5.0, 1), (9.0, 9.5, 1)]
)
def test_an_opening_is_in_the_storey_of_its_middle_and_below_all_in_the_lowest(void, sill, head, number):
    storeys = build_storeys([window(void, each, each + 1.4) for each in (0.9, 3.9) for _ in range(2)])
    assert storey_of(storeys, window(void, sill, head)) == number


def test_without_storeys_it_is_in_none(void):
    assert storey_of((), void) is None
