"""Labels made by hand: their regions and their price."""

import numpy as np
import pytest
import shapely

from linecad.model.regions.cuts import Borders, energy
from linecad.model.regions.labels import CORNER, UNIT, Labels, united
from linecad.model.regions.surfaces import Surface


def squares(label):
    """A row of unit squares with labels of one surface, sky and clutter."""
    cells = [shapely.box(x, 0, x + 1, 1) for x in range(len(label))]
    pairs = np.column_stack([np.arange(len(label) - 1), np.arange(1, len(label))])
    costs = np.arange(3 * len(label)).reshape(-1, 3)
    surfaces = [Surface("wall", 1, 8.0, np.zeros(0, np.int64), 0)]
    return Labels(
        surfaces,
        cells,
        np.zeros(50, np.int64),
        np.array(label),
        np.zeros((50, 3)),
        costs,
        Borders(pairs, np.full(len(pairs), 7)),
    )


def test_regions_are_connected_unions_without_needless_corners():
    regions = squares([0, 0, 1, 0]).regions
    assert sorted((number, region.area) for number, region in regions) == [(0, 1), (0, 2), (1, 1)]
    assert [len(region.exterior.coords) - 1 for _, region in regions] == [4, 4, 4]


def test_the_price_is_that_of_labels_and_of_corners():
    row = squares([0, 0, 1, 0])
    assert row.price == pytest.approx(energy(row.costs, row.borders, row.label) / UNIT + 3 * 5 * CORNER * 50)


def test_corners_of_sky_and_clutter_are_none_of_faces():
    row = squares([0, 0, 1, 2])
    assert row.price_of_faces == pytest.approx(energy(row.costs, row.borders, row.label) / UNIT + 5 * CORNER * 50)


def test_united_cells_are_one_where_they_touch_along_a_side():
    side = united([shapely.box(0, 0, 1, 1), shapely.box(1, 0, 2, 1)])
    assert [shapely.get_coordinates(each).shape[0] - 1 for each in side] == [4]
    assert len(united([shapely.box(0, 0, 1, 1), shapely.box(1, 1, 2, 2)])) == 2
    ring = [shapely.box(x, y, x + 1, y + 1) for x in range(3) for y in range(3) if (x, y) != (1, 1)]
    (around,) = united(ring)
    assert len(around.interiors) == 1
