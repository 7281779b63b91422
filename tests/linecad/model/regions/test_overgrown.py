"""Feet of walls that a hedge may hide."""

from dataclasses import replace

import numpy as np
import pytest

from linecad.model.regions.find import Look, find_regions
from linecad.model.regions.overgrown import is_in_the_open
from linecad.model.regions.raster import take_raster
from linecad.model.regions.segments import View
from linecad.model.regions.surfaces import FIRM_FEET, GroundOfFeet

LOW = GroundOfFeet(5.0, FIRM_FEET)  # the lines of the house end 2.0 below the camera
HEDGE = 440  # px, the row from which on plants hide all


def overgrown(photo):
    """The photo with leaves in all its lower rows."""
    rng = np.random.default_rng(4)
    found = photo.copy()
    leaves = np.stack([rng.integers(*span, found.shape[:2]) for span in ((10, 90), (60, 190), (10, 60))], axis=2)
    found[HEDGE:] = np.repeat(np.repeat(leaves[::3, ::3], 3, axis=0), 3, axis=1)[: found.shape[0], : found.shape[1]][
        HEDGE:
    ]
    return found


def is_open(house, photo, lines):
    raster = take_raster(lines, house.camera, house.rotation, photo, None, ())
    return is_in_the_open(LOW, lines, raster, View(house.camera, house.rotation, photo))


def test_plants_below_the_lines_hide_feet(house):
    assert is_open(house, house.photo, house.lines)
    assert not is_open(house, overgrown(house.photo), house.lines)


def test_where_no_line_ends_below_the_horizon_nothing_is_known(house):
    above = replace(house.lines, ends=house.lines.ends + np.array([0.0, 0.0, 9.0]))
    assert not is_open(house, house.photo, above)


@pytest.mark.parametrize(("hedge", "ground"), [(False, -5.0), (True, -2.0)])
def test_firm_feet_far_below_the_lines_put_the_ground_where_no_plants_hide_them(house, hedge, ground):
    look = Look(overgrown(house.photo) if hedge else house.photo, LOW, None)
    found = find_regions(house.planes, house.lines, house.camera, house.rotation, look).labels
    assert [each.offset for each in found.surfaces if each.kind == "ground"] == [ground]
