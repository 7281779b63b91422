"""What stands behind a tree, by labels made by hand: a wall above the ground, under a sky."""

import numpy as np
import pytest
import shapely

from linecad.model.regions import partition
from linecad.model.regions.cuts import Borders
from linecad.model.regions.filling import NOWHERE, fill
from linecad.model.regions.labels import Labels
from linecad.model.regions.raster import take_raster
from linecad.model.regions.segments import View
from linecad.model.regions.surfaces import Surface

WALL, OTHER, GROUND, SKY, CLUTTER = range(5)
FOOT, EAVES = 400.0, 150.0  # px from the top
NO_LINES = np.zeros(0, np.int64)
SURFACES = [
    Surface("wall", 1, 8.0, NO_LINES, 0),
    Surface("wall", 0, 9.0, NO_LINES, 1),
    Surface("ground", 2, -2.0, NO_LINES, None),
]
ROOM = [*SURFACES[:GROUND], Surface("ceiling", 2, 2.0, NO_LINES, None)]  # its ceiling is where the ground would be
MEET = np.array([[[100, FOOT], [800, FOOT]]])
NO_MEETS = np.zeros((0, 2, 2))


@pytest.fixture(scope="module")
def raster(house):
    return take_raster(house.lines, house.camera, house.rotation, None)


@pytest.fixture
def filled(house, raster):
    """A function of a tree or other thing (x, y, x, y) px before the three bands of the photo, and what it is."""

    def build(*things, meets=MEET, surfaces=SURFACES, hint=None, never=(), raster=raster, named=NOWHERE):
        frame = shapely.box(-0.5, -0.5, 959.5, 719.5)
        bands = [(SKY, -0.5, EAVES), (WALL, EAVES, FOOT), (GROUND, FOOT, 719.5)]
        boxes = [(shapely.box(*box), label) for label, box in things]
        rings = [shapely.boundary(shape) for shape in (frame, *(box for box, _ in boxes))]
        level = [shapely.LineString([(-0.5, y), (959.5, y)]) for y in (EAVES, FOOT)]
        covered = shapely.union_all([box for box, _ in boxes])
        cells = partition.cells_between([*rings, *shapely.difference(level, covered)])
        middle = [cell.point_on_surface() for cell in cells]
        label = np.array([
            next((number for box, number in boxes if box.contains(point)),
                 next(number for number, top, bottom in bands if top <= point.y < bottom)) for point in middle
        ])  # fmt: skip
        row = raster.step * (np.arange(raster.size) // raster.shape[1] + 0.5)
        of_samples = np.ones((raster.size, 5))
        for number, top, bottom in bands:
            of_samples[(row > top) & (row < bottom), number] = 0
        cell = partition.draw(cells, raster.shape, raster.step)
        of_samples[label[cell] == OTHER, OTHER] = -1  # what it shows speaks for it
        if hint is not None:
            of_samples[label[cell] == CLUTTER, hint] = -1
        of_samples[np.ix_(label[cell] == CLUTTER, never)] = 50
        borders = Borders(np.zeros((0, 2), np.int64), np.zeros(0, np.int64))
        costs = np.zeros((len(cells), 5), np.int64)
        labels = Labels(surfaces, cells, cell, label, of_samples, costs, borders)
        return fill(labels, meets, raster, View(house.camera, house.rotation, None), named)

    return build


def areas(found):
    """Area of each label, px^2, which together are the photo."""
    total = {number: sum(region.area for own, region in found.labels.regions if own == number) for number in range(5)}
    assert sum(total.values()) == pytest.approx(960 * 720)
    return total


def test_a_photo_without_clutter_stays_as_it_is(filled):
    found = filled()
    assert areas(found) == pytest.approx({
        SKY: 960 * (EAVES + 0.5), WALL: 960 * (FOOT - EAVES), GROUND: 960 * (719.5 - FOOT), OTHER: 0, CLUTTER: 0
    })  # fmt: skip
    assert found.clutter.is_empty


def test_a_tree_between_wall_and_ground_is_filled_and_told(filled):
    tree = (300, 250, 360, 500)
    found = filled((CLUTTER, tree))
    assert areas(found) == pytest.approx(areas(filled()))
    assert found.clutter.symmetric_difference(shapely.box(*tree)).area < 1e-3
    (ground,) = [region for number, region in found.labels.regions if number == GROUND]
    assert len(shapely.get_coordinates(ground)) - 1 == 4  # no trace of the tree in its outline


def test_what_is_hidden_is_cut_along_the_meets_alone(filled):
    tree = (300, 250, 360, 500)
    found = filled((CLUTTER, tree), meets=NO_MEETS)
    # One cell, which is more on the wall than on the ground.
    assert areas(found)[WALL] == pytest.approx(areas(filled())[WALL] + 60 * (500 - FOOT))
    assert areas(found)[CLUTTER] == 0


def test_surfaces_that_meet_outside_the_photo_alone_cut_nothing(filled):
    tree, outside = (300, 250, 360, 500), np.array([[[0.0, 900.0], [959.0, 900.0]]])
    assert areas(filled((CLUTTER, tree), meets=outside)) == areas(filled((CLUTTER, tree), meets=NO_MEETS))


def test_a_tree_before_a_wall_alone_is_filled(filled):
    assert areas(filled((CLUTTER, (300, 250, 360, 350)))) == pytest.approx(areas(filled()))


def test_a_wall_does_not_go_on_behind_a_tree_beyond_its_end(filled):
    tree, beside = (420, 250, 600, 500), (500, EAVES, 959.5, FOOT)
    shown = 500.5 * (FOOT - EAVES)
    assert areas(filled((CLUTTER, tree), (SKY, beside)))[WALL] == pytest.approx(shown)
    in_room = areas(filled((CLUTTER, tree), (SKY, beside), surfaces=ROOM))
    assert in_room[WALL] == pytest.approx(shown + (600 - 500) * (FOOT - 250))


def test_trees_beside_the_end_of_a_wall_stay_trees_however_long_they_border_on_it(filled):
    tree, above = (-0.5, 160, 90, 500), (-0.5, EAVES, 90, 160)
    found = filled((CLUTTER, tree), (SKY, above), never=[SKY, GROUND])
    assert areas(found)[WALL] == pytest.approx((959.5 - 90) * (FOOT - EAVES))
    assert areas(found)[CLUTTER] == pytest.approx(90.5 * (500 - 160))


def test_a_wall_that_is_shown_nowhere_is_behind_no_tree(filled):
    tree = (600, 250, 660, 380)
    assert areas(filled((CLUTTER, tree), hint=OTHER)) == pytest.approx(areas(filled()))
    assert areas(filled((CLUTTER, tree), hint=OTHER, surfaces=ROOM))[OTHER] == pytest.approx(60 * 130)


def test_a_tree_before_the_sky_is_not_filled(filled):
    tree = (300, 20, 360, 180)
    found = filled((CLUTTER, tree))
    assert areas(found)[CLUTTER] == pytest.approx(60 * 160)
    assert found.clutter.area == pytest.approx(60 * 160)


def test_a_dome_before_the_sky_is_filled_as_the_wall_below_it(house, filled):
    seen = take_raster(house.lines, house.camera, house.rotation, house.photo)
    found = filled((CLUTTER, (300, 100, 360, 180)), raster=seen)
    assert areas(found)[WALL] == pytest.approx(areas(filled())[WALL] + 60 * (EAVES - 100))


def test_a_dome_that_a_person_named_clutter_stays_it(house, filled):
    seen = take_raster(house.lines, house.camera, house.rotation, house.photo)
    dome = (300, 100, 360, 180)
    found = filled((CLUTTER, dome), raster=seen, named=shapely.box(*dome))
    assert areas(found)[CLUTTER] == pytest.approx(60 * 80)


def test_what_the_border_of_the_photo_cuts_off_is_not_filled(filled):
    along = (-0.5, 710, 959.5, 719.5)
    assert areas(filled((CLUTTER, along)))[CLUTTER] == pytest.approx(960 * 9.5)
    beside = (-0.5, 600, 100, 650)
    assert areas(filled((CLUTTER, beside)))[CLUTTER] == 0


def test_small_regions_vanish_in_their_neighbours(filled):
    # 0.0015 of the photo are 1036.8 px^2.
    assert areas(filled((OTHER, (300, 250, 332, 282))))[OTHER] == 0
    assert areas(filled((OTHER, (300, 250, 333, 283))))[OTHER] == pytest.approx(33 * 33)
    assert filled((OTHER, (300, 250, 332, 282))).clutter.is_empty


def test_the_answer_is_labels_again(filled, raster):
    labels = filled((CLUTTER, (300, 250, 360, 500))).labels
    assert len(labels.cells) == len(labels.label) == len(labels.costs)
    assert labels.cell.shape == (raster.size,)
    samples = labels.label[labels.cell].reshape(raster.shape)
    assert samples[150, 165] == WALL
    assert samples[230, 165] == GROUND
    assert (labels.borders.cost > 0).all()
    shared = {(min(pair), max(pair)): cost for pair, cost in zip(labels.borders.cells.tolist(),
                                                               labels.borders.cost.tolist(), strict=True)}  # fmt: skip
    for (one, other), cost in shared.items():
        length = shapely.intersection(labels.cells[one], labels.cells[other]).length
        assert cost == pytest.approx(100 * length, abs=1)
