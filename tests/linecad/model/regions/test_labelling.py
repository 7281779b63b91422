"""Labels of a painted house: its two walls, the ground and the sky."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
import shapely

from linecad.geometry import project
from linecad.model.regions.heaven import look_up
from linecad.model.regions.labelling import SURFACE, find_labels, price_per_sample
from linecad.model.regions.raster import take_raster
from linecad.model.regions.segments import View
from linecad.model.regions.surfaces import Surface

LIMIT = 440  # px from the top; the ground ends there, some way behind the house


def labels_of(house, more=()):
    """Labels by the lines and the picture of a house; `more` are surfaces that it does not have."""
    view = View(house.camera, house.rotation, house.photo)
    raster = take_raster(house.lines, house.camera, house.rotation, house.photo)
    surfaces = [*house.surfaces(), *more]
    return find_labels(house.lines, surfaces, raster, look_up(raster), view)


@pytest.fixture(scope="module")
def found(house):
    return labels_of(house)


def test_the_price_of_a_sample_counts_cells_corners_and_the_surfaces_that_are_shown(found, house):
    raster = take_raster(house.lines, house.camera, house.rotation, house.photo)
    count = len(np.unique(found.label[found.label < found.sky]))
    assert count > 0
    assert price_per_sample(found, raster) == pytest.approx(found.price / raster.size + count * SURFACE, abs=1e-6)
    more = [*found.surfaces, found.surfaces[0]]  # one that no cell shows
    label = found.label + (found.label >= found.sky)
    unseen = replace(found, surfaces=more, label=label, costs=np.insert(found.costs, found.sky, 0, axis=1))
    assert price_per_sample(unseen, raster) == pytest.approx(price_per_sample(found, raster))


def shown(found, house):
    """What each sample shows, numbered as in the truth of the house; -1 for other surfaces."""
    names = {(0, 2.0): 0, (1, 8.0): 1, (2, -2.0): 2}
    numbers = [names.get((surface.axis, surface.offset), -1) for surface in found.surfaces] + [3, 4]
    return np.array(numbers)[found.label[found.cell]].reshape(house.camera.height // 2, -1)


def test_walls_ground_and_sky_are_where_they_are(house, found):
    picture, truth = shown(found, house), house.truth[::2, ::2]
    for number in (0, 1, 3):
        assert ((picture == number) & (truth == number)).sum() > 0.98 * (truth == number).sum()
    near = np.arange(picture.shape[0])[:, None] > LIMIT / 2
    assert ((picture == 2) & (truth == 2))[near[:, 0]].sum() > 0.98 * ((truth == 2) & near).sum()
    assert not ((picture == 2) & (truth != 2)).sum() > 0.01 * picture.size


def test_surfaces_that_nothing_shows_are_left_out(house, found):
    assert sorted((surface.axis, surface.offset) for surface in found.surfaces) == [(0, 2.0), (1, 8.0), (2, -2.0)]
    assert found.label.max() <= found.clutter == found.sky + 1 == 4
    # A plane just behind the front with three of its lines would win some of it back, less than a surface costs.
    rows = np.flatnonzero((house.lines.ends[:, :, 1] == 8).all(axis=1))[:3]
    assert len(labels_of(house, [Surface("wall", 1, 8.5, rows, 99)]).surfaces) == 3


def test_walls_have_few_corners_and_hardly_a_hole(found):
    for number, surface in enumerate(found.surfaces):
        if surface.kind == "wall":
            regions = [region for own, region in found.regions if own == number]
            wall = max(regions, key=lambda region: region.area)
            assert wall.area > 0.99 * sum(region.area for region in regions)
            assert shapely.Polygon(wall.exterior).area < 1.02 * wall.area
            # But for slivers between collinear lines, thinner than a pixel, that filling gives to it.
            outline = wall.buffer(0.01, join_style="mitre").buffer(-0.01, join_style="mitre").simplify(0.1).exterior
            assert len(shapely.get_coordinates(outline)) - 1 <= 6


def test_walls_meet_the_sky_without_a_step(found):
    walls = [number for number, surface in enumerate(found.surfaces) if surface.kind == "wall"]
    for region in (region for number, region in found.regions if number in walls):
        corners = shapely.get_coordinates(region.exterior)[:-1]
        along = np.roll(corners, -1, axis=0) - corners
        before = np.roll(along, 1, axis=0)
        turn = np.sign(before[:, 0] * along[:, 1] - before[:, 1] * along[:, 0])
        short = np.linalg.norm(along, axis=1) < 0.05 * shapely.length(region) / 2
        assert not ((turn * np.roll(turn, -1) < 0) & short & (region.area > 1)).any()


@pytest.mark.parametrize(("right", "is_cut_off"), [(3.4, False), (5.0, True)])
def test_a_long_step_is_cut_off_only_where_it_is_worth_its_corners(make_house, right, is_cut_off):
    """The sky seems to reach into the front, down to a line: 14 and 28 % of the photo's width, 2 % high."""
    line = np.array([[2.0, 8, 1.45], [right, 8, 1.45]])
    house = make_house(edges_too=[(0, line)])
    corners = np.concatenate([line, line[::-1] + np.array([0, 0, 0.18])])
    outline = project(corners, house.camera.matrix, house.rotation)
    photo = house.photo.copy()
    cv2.fillPoly(photo, [np.rint(outline).astype(np.int32)], (120, 170, 235))
    found = labels_of(replace(house, photo=photo))
    x, y = outline.mean(axis=0).astype(int) // 2
    assert (shown(found, house)[y, x] == 3) == is_cut_off


def test_regions_cover_the_photo_once(found):
    regions = [region for _, region in found.regions]
    frame = shapely.box(-0.5, -0.5, 959.5, 719.5)
    assert sum(region.area for region in regions) == pytest.approx(frame.area)
    assert shapely.union_all(regions).symmetric_difference(frame).area < 1e-3


def test_without_a_photo_nothing_is_sky(house):
    found = labels_of(replace(house, photo=None))
    assert not (found.label == found.sky).any()
    assert {(surface.axis, surface.offset) for surface in found.surfaces} >= {(0, 2.0), (1, 8.0)}
