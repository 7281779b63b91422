"""Lines of a photo of 3840 px whose upper half is sky, with a wall on the right."""

import numpy as np
import pytest
import shapely

from linecad.geometry import central_camera
from linecad.model.on_faces.in_sky import LONG, in_the_sky
from linecad.scene import Camera, Lines

WIDTH = 3840
CAMERA = Camera(WIDTH, 2160, central_camera(3000.0, WIDTH, 2160), "file")
X, Y, Z = range(3)
WALL = shapely.box(1800, 500, WIDTH, 1000)
SKY = shapely.difference(shapely.box(-1, -1, WIDTH, 1000), WALL)  # beyond the border, as that of a photo


def found(*segments, axis=X, probability=0.9, sky=SKY, pieces=()):
    """Whether each segment is in the sky."""
    count = len(segments)
    lines = Lines(
        np.arange(count), np.full(count, axis), np.array(segments, float), np.ones((count, 2, 3)),
        np.zeros(count, bool), np.zeros(count, int), np.full(count, "weak"), np.full(count, probability),
        pieces=pieces,
    )  # fmt: skip
    return in_the_sky(lines, sky, CAMERA).tolist()


WIRE = [[200, 300], [1600, 250]]


def test_a_wire_is_in_the_sky_and_what_is_on_a_wall_is_not():
    edge, wall, ground = [[1800, 520], [1800, 980]], [[1820, 700], [1980, 700]], [[300, 1400], [900, 1400]]
    assert found(WIRE, edge, wall, ground, axis=Y) == [True, False, False, False]


def test_a_mast_stays():
    assert found([[900, 200], [900, 900]], axis=Z) == [False]


@pytest.mark.parametrize(("above", "is_wire"), [(40, False), (90, False), (110, True)])
def test_a_railing_on_a_roof_stays(above, is_wire):
    assert found([[200, 1000 - above], [1600, 1000 - above]]) == [is_wire]


@pytest.mark.parametrize(("before", "is_wire"), [(0.3, True), (0.6, False)])
def test_a_wire_may_end_at_a_house(before, is_wire):
    start = 1700 - 1000 * (1 - before)
    assert found([[start, 700], [start + 1000, 700]]) == [is_wire]


@pytest.mark.parametrize(
    ("length", "probability", "goes"),
    [(LONG.px(WIDTH) - 1, 0.6, False), (LONG.px(WIDTH) - 1, 0.4, True), (LONG.px(WIDTH) + 1, 0.6, True)],
)
def test_a_ledge_that_is_likely_stays(length, probability, goes):
    assert found([[500, 400], [500 + length, 400]], probability=probability) == [goes]


def test_a_line_joined_of_pieces_is_where_they_are():
    """A cornice on two towers with the sky between."""
    towers = shapely.union_all([shapely.box(0, 300, 400, 1000), shapely.box(2000, 300, 2400, 1000)])
    whole, parts = [[50, 400], [2350, 400]], np.array([[[50, 400], [390, 400]], [[2010, 400], [2350, 400]]], float)
    sky = shapely.difference(shapely.box(0, 0, WIDTH, 1000), towers)
    assert found(whole, sky=sky) == [True]
    assert found(whole, sky=sky, pieces=(parts,)) == [False]


@pytest.mark.parametrize("y", [2, 60])
def test_a_wire_at_the_border_of_the_photo_is_in_the_sky(y):
    assert found([[200, y], [1600, y]]) == [True]


def test_without_a_sky_nothing_is_in_it():
    assert found(WIRE, sky=shapely.Polygon()) == [False]
    assert found(WIRE, axis=Z) == [False]
    assert found([[200, 300], [1600, 250]], [[0, 100], [3839, 100]]) == [True, True]
