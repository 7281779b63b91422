"""How far walls go: two of a made house that meet in a corner, by labels made by hand."""

from dataclasses import replace

import numpy as np
import pytest
import shapely

from linecad.geometry import project
from linecad.model.regions import partition
from linecad.model.regions.cuts import Borders
from linecad.model.regions.filling import fill
from linecad.model.regions.labels import Labels
from linecad.model.regions.raster import take_raster
from linecad.model.regions.segments import View
from linecad.model.regions.surfaces import Surface
from linecad.model.regions.wall_ends import ends_of_walls

FRONT, SIDE, GROUND, SKY, CLUTTER = range(5)
FOOT, EAVES, LEFT, BORDER = 440.0, 180.0, 400.0, 959.5  # px; the side vanishes at 358
NO_LINES = np.zeros(0, np.int64)
SURFACES = [
    Surface("wall", 1, 8.0, NO_LINES, 0),
    Surface("wall", 0, 2.0, NO_LINES, 1),
    Surface("ground", 2, -2.0, NO_LINES, None),
]
ROOM = [*SURFACES[:GROUND], Surface("ceiling", 2, 2.0, NO_LINES, None)]


@pytest.fixture(scope="module")
def raster(house):
    return take_raster(house.lines, house.camera, house.rotation, None)


@pytest.fixture(scope="module")
def view(house):
    return View(house.camera, house.rotation, None)


@pytest.fixture(scope="module")
def corner(house):
    """The column of the corner, px; the front is to its right."""
    top, bottom = project(np.array([[2.0, 8.0, 1.6], [2.0, 8.0, -2.0]]), house.camera.matrix, house.rotation)
    assert top[0] == pytest.approx(bottom[0])
    return float(top[0])


@pytest.fixture
def labels(raster, corner):
    """A function of what else there is (label, box px): side and front above the ground, the border at `at`."""

    def build(*things, at=corner, surfaces=SURFACES):
        boxes = [
            *things,
            (SIDE, (LEFT, EAVES, at, FOOT)),
            (FRONT, (at, EAVES, 900.0, FOOT)),
            (GROUND, (-0.5, FOOT, BORDER, 719.5)),
            (SKY, (-0.5, -0.5, BORDER, 719.5)),
        ]
        cells = partition.cells_between([shapely.boundary(shapely.box(*box)) for _, box in boxes])
        label = np.array([
            next(number for number, box in boxes if shapely.box(*box).contains(cell.point_on_surface()))
            for cell in cells
        ])  # fmt: skip
        cell = partition.draw(cells, raster.shape, raster.step)
        of_samples = np.ones((raster.size, 5))
        of_samples[:, GROUND] = 0.5
        costs, borders = np.zeros((len(cells), 5), np.int64), Borders(np.zeros((0, 2), np.int64), NO_LINES)
        return Labels(surfaces, cells, cell, label, of_samples, costs, borders)

    return build


def wedge(corner, wide):
    """The foot of the side and the ground before it, left of the corner, taken for the front."""
    return FRONT, (corner - wide, FOOT - 60.0, corner, FOOT + 40.0)


def test_walls_that_end_at_their_corner_end_there(labels, raster, view, corner):
    ends = ends_of_walls(labels(), raster, view)
    assert ends[FRONT].low == pytest.approx(2.0)
    assert ends[SIDE].low == pytest.approx(8.0)
    assert ends[FRONT].beyond == ends[SIDE].beyond == ()
    np.testing.assert_allclose(ends[FRONT].uprights[0, :, 0], corner, atol=1e-6)


def test_what_is_called_a_wall_beyond_its_corner_is_none_of_it(labels, raster, view, corner):
    ends = ends_of_walls(labels(wedge(corner, 60.0)), raster, view)
    assert ends[FRONT].low == pytest.approx(2.0)
    assert shapely.union_all(ends[FRONT].beyond).symmetric_difference(shapely.box(*wedge(corner, 60.0)[1])).area < 1e-3
    np.testing.assert_allclose(ends[FRONT].uprights[0, :, 0], corner, atol=1e-6)
    assert ends[SIDE].beyond == ()


def test_a_wall_goes_on_beyond_another_that_only_abuts_on_it(labels, raster, view):
    ends = ends_of_walls(labels((FRONT, (100.0, EAVES, 300.0, FOOT))), raster, view)
    assert ends[FRONT].beyond == ()
    assert ends[FRONT].low < 0


@pytest.mark.parametrize("off", [-60.0, 60.0])
def test_a_border_away_from_where_two_walls_meet_is_no_corner(labels, raster, view, corner, off):
    ends = ends_of_walls(
        labels((FRONT, (corner - 70.0, FOOT - 60.0, corner + 70.0, FOOT)), at=corner + off), raster, view
    )
    assert ends[FRONT].beyond == ()
    assert ends[FRONT].low < 1.9


def test_a_low_border_is_no_corner(labels, raster, view, corner):
    between = SKY, (corner - 20.0, EAVES, corner + 20.0, FOOT - 90.0)  # leaves 30 of 720 px; 36 are asked for
    assert ends_of_walls(labels(between, wedge(corner, 60.0)), raster, view)[FRONT].low < 1.9


def test_walls_of_a_room_have_no_ends(labels, raster, view):
    assert ends_of_walls(labels(surfaces=ROOM), raster, view) == {}


def test_walls_of_two_frames_have_no_corner(labels, raster, view, corner):
    far = replace(SURFACES[SIDE], axis=1, offset=9.0)  # parallel to the front: they meet nowhere
    found = labels(wedge(corner, 60.0), surfaces=[SURFACES[FRONT], far, SURFACES[GROUND]])
    assert ends_of_walls(found, raster, view)[FRONT].beyond == ()


def test_what_is_beyond_becomes_what_is_around_it(labels, raster, view, corner):
    filled = fill(labels(wedge(corner, 60.0)), np.zeros((0, 2, 2)), raster, view)
    (front,) = [region for number, region in filled.labels.regions if number == FRONT]
    assert front.symmetric_difference(shapely.box(corner, EAVES, 900.0, FOOT)).area < 1e-3
    assert filled.clutter.is_empty


def test_a_hedge_before_a_corner_hides_both_walls(labels, raster, view, corner):
    hedge = CLUTTER, (corner - 80.0, FOOT - 120.0, corner + 80.0, FOOT + 30.0)
    foot = np.array([[[100.0, FOOT], [800.0, FOOT]]])
    filled = fill(labels(hedge, wedge(corner, 60.0)), foot, raster, view)
    shown = {number: region for number, region in filled.labels.regions if number in (FRONT, SIDE)}
    assert shown[FRONT].bounds[0] == pytest.approx(corner, abs=1e-3)
    assert shown[SIDE].bounds[2] == pytest.approx(corner, abs=1e-3)
