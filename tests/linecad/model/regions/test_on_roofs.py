"""Domes and lanterns, told from trees and vans, before the house of the fixtures."""

import numpy as np
import pytest
import shapely

from linecad.model.regions.on_roofs import is_on_roof
from linecad.model.regions.raster import COLUMNS, take_raster

RED = (170, 30, 30)


@pytest.fixture
def at(house, house_regions):
    """A function of a surface or the sky, below and beside which a thing of 80 px stands, and what it is painted as."""
    labels = house_regions.labels
    shown = labels.label[labels.cell].reshape(-1, COLUMNS)
    step = house.camera.width / COLUMNS

    def build(where, colour=RED):
        ground = next(number for number, surface in enumerate(labels.surfaces) if surface.kind == "ground")
        column = next(at for at in range(200, 400) if shown[0, at] == labels.sky and shown[-1, at] == ground)
        row = {
            "eaves": np.argmax(shown[:, column] != labels.sky), "foot": np.argmax(shown[:, column] == ground), "top": 0
        }[where]  # fmt: skip
        x, y = np.rint(np.array([column, row]) * step).astype(int)
        photo = None if colour is None else house.photo.copy()
        if photo is not None:
            photo[max(y - 40, 0) : y + 40, x - 40 : x + 40] = colour
        raster = take_raster(house.lines, house.camera, house.rotation, photo)
        return is_on_roof(shapely.box(x - 40, y - 40, x + 40, y + 40), labels, raster)

    return build


def test_what_stands_on_a_wall_before_the_sky_is_part_of_the_building(at):
    assert at("eaves")


@pytest.mark.parametrize("where", ["foot", "top"])
def test_what_stands_on_the_ground_or_at_the_border_is_not(at, where):
    assert not at(where)


def test_without_a_photo_nothing_is_told(at):
    assert not at("eaves", None)
