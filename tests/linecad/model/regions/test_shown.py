"""What every part of the photo was taken for, on a raster."""

from types import SimpleNamespace

import numpy as np
import pytest
import shapely

from linecad.model.regions.raster import COLUMNS
from linecad.model.regions.shown import cells_of

WIDTH, HEIGHT = 4 * COLUMNS, 2 * COLUMNS  # px, so that a sample is 4 x 4 px
LEFT_IS_WALL = np.tile(np.arange(COLUMNS) >= COLUMNS // 2, (COLUMNS // 2, 1)).astype(np.int64).ravel()


def filled(clutter, roofs=()):
    """A wall to the left, the sky to the right."""
    labels = SimpleNamespace(
        surfaces=[SimpleNamespace(kind="wall")], label=np.array([0, 1]), cell=LEFT_IS_WALL, clutter=2
    )
    return SimpleNamespace(labels=labels, clutter=clutter, roofs=[SimpleNamespace(polygon=each) for each in roofs])


def shown(filled):
    cells = cells_of(filled, SimpleNamespace(width=WIDTH, height=HEIGHT))
    return np.array(cells.kinds)[cells.number]


def test_each_sample_has_the_kind_of_its_cell():
    found = shown(filled(shapely.Polygon()))
    assert found.shape == (COLUMNS // 2, COLUMNS)
    assert (found[:, : COLUMNS // 2] == "wall").all()
    assert (found[:, COLUMNS // 2 :] == "sky").all()


def test_clutter_hides_what_was_filled_in_but_not_in_its_holes():
    hole = shapely.box(400, 400, 480, 480)
    found = shown(filled(shapely.box(200, 200, 800, 800) - hole))
    assert found[75, 75] == "clutter"
    assert found[110, 110] == "wall"
    assert (found == "clutter").sum() * 16 == pytest.approx(600 * 600 - 80 * 80, rel=0.02)


def test_a_roof_lies_before_what_the_labels_say_and_clutter_before_it():
    found = shown(filled(shapely.box(1000, 0, 1400, 100), [shapely.box(1200, 0, 1600, 400)]))
    assert found[50, 350] == "roof"
    assert found[10, 325] == "clutter"
    assert found[50, 290] == "sky"
