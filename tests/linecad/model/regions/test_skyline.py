"""Cells cut along the outline of the sky and of plants, by masks drawn by hand on a photo of 960 x 720, 2 a sample."""

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from linecad.model.regions import partition
from linecad.model.regions.heaven import Heaven
from linecad.model.regions.raster import take_raster
from linecad.model.regions.skyline import MARGIN, THIN, _is_large, cut_at, find_plants, find_sky, near_outline

PHOTO = shapely.box(-0.5, -0.5, 959.5, 719.5)
HEIGHT = 150  # samples of sky from the top
HEDGE = 440  # px, the row from which on plants hide all


@pytest.fixture(scope="module")
def raster(house):
    return take_raster(house.lines, house.camera, house.rotation, None)


@pytest.fixture(scope="module")
def drawn(raster):
    """A function of places (row, column) that are sky as far down as HEIGHT, or not: the sky of that mask."""

    def draw(*things):
        mask = np.zeros(raster.shape, bool)
        mask[:HEIGHT] = True
        for thing in things:
            mask[thing] = False
        return find_sky(Heaven(mask.ravel(), is_sky=True, is_ceiling=False), raster)

    return draw


@pytest.fixture(scope="module")
def overgrown(house):
    """The raster of a photo with leaves in all its lower rows."""
    rng = np.random.default_rng(4)
    leaves = np.stack([rng.integers(*span, (240, 320)) for span in ((10, 90), (60, 190), (10, 60))], axis=2)
    photo = house.photo.copy()
    photo[HEDGE:] = np.repeat(np.repeat(leaves, 3, axis=0), 3, axis=1)[HEDGE:]
    return take_raster(house.lines, house.camera, house.rotation, photo)


def sky_of(cells, sky):
    """The cells that are sky for the most part, as one."""
    return shapely.union_all([cell for cell in cells if shapely.intersection(cell, sky).area > 0.5 * cell.area])


def test_a_ceiling_is_no_sky(raster):
    heaven = Heaven(np.ones(raster.size, bool), is_sky=False, is_ceiling=True)
    assert find_sky(heaven, raster).is_empty


def test_the_sky_goes_to_the_borders_of_the_photo_and_a_margin_beyond_what_is_sure(drawn):
    sky = drawn()
    assert sky.covers(shapely.box(-0.5, -0.5, 959.5, 300))
    assert sky.bounds[3] == pytest.approx(2 * (HEIGHT + MARGIN), abs=2)


def test_a_bird_and_a_spire_are_in_the_sky_and_a_chimney_is_not(drawn):
    bird, spire = np.s_[40:44, 60:66], np.s_[80:150, 200:203]
    chimney = np.s_[80:150, 300:330]
    sky = drawn(bird, spire, chimney)
    assert sky.covers(shapely.Point(126, 84))
    assert sky.covers(shapely.Point(403, 200))
    assert not sky.covers(shapely.Point(630, 250))


def test_a_cell_of_sky_and_wall_is_cut_between_them(raster, drawn):
    tower = np.s_[60:150, 180:300]
    sky = drawn(tower)
    cells = cut_at([PHOTO], sky, raster)
    assert len(cells) == 2
    seen = sky_of(cells, sky)
    assert seen.symmetric_difference(shapely.intersection(sky, PHOTO)).area < 0.01 * PHOTO.area
    assert not seen.covers(shapely.Point(480, 200))


def test_a_chimney_is_left_out_of_the_outline_of_its_ridge(raster, drawn):
    """The ridge sloped from the middle of the chimney on, with sky below it on either side."""
    sky = drawn(np.s_[HEIGHT - 20 : HEIGHT, 200:225])
    ridge = sky_of(cut_at([PHOTO], sky, raster), sky)
    assert ridge.symmetric_difference(shapely.box(-0.5, -0.5, 959.5, 2 * (HEIGHT + MARGIN))).area < 0.003 * PHOTO.area


@pytest.mark.parametrize(
    "things",
    [
        [np.s_[HEIGHT - 25 : HEIGHT, 100:400]],  # an attic
        [np.s_[HEIGHT - 25 * (4 - n) : HEIGHT, 100 + 25 * n : 300 - 25 * n] for n in range(4)],  # a gable in steps
    ],
)
def test_what_is_no_chimney_stays_as_it_is(things, raster, drawn):
    sky = drawn(*things)
    seen = sky_of(cut_at([PHOTO], sky, raster), sky)
    assert seen.symmetric_difference(shapely.intersection(sky, PHOTO)).area < 0.004 * PHOTO.area


def test_a_gap_between_two_towers_is_cut(raster, drawn):
    sky = drawn(np.s_[110:HEIGHT, :200], np.s_[110:HEIGHT, 240:])
    seen = sky_of(cut_at([PHOTO], sky, raster), sky)
    assert seen.symmetric_difference(shapely.intersection(sky, PHOTO)).area < 0.002 * PHOTO.area


def test_what_is_thin_is_not_cut_off(raster, drawn):
    sky = drawn()
    above = shapely.box(-0.5, -0.5, 959.5, 296)  # a line 3 px above the outline, and another one below
    below = shapely.box(-0.5, 296, 959.5, 719.5)
    assert cut_at([above, below], sky, raster) == [above, below]


def test_a_part_twice_as_wide_as_a_rim_is_large(raster):
    """Without its rim a polygon of no area is left of it, of which shapely warned."""
    left, top = 326.24534935066754, 504.84530734784875
    low = top + 2 * THIN * raster.step
    part = shapely.Polygon([(left, top), (left + 250, top), (left + 250, np.nextafter(low, 1000)), (left, low)])
    assert _is_large(part, shapely.box(0, 0, 900, top), raster)


def test_a_strip_of_a_wall_that_runs_up_into_the_sky_is_cut(raster, drawn):
    sky = drawn()
    end = sky.bounds[3] + 2
    wall = shapely.union_all([shapely.box(-0.5, end, 959.5, 719.5), shapely.box(300, -0.5, 308, end)])
    beside = [shapely.box(-0.5, -0.5, 300, end), shapely.box(308, -0.5, 959.5, end)]
    cells = cut_at([wall, *beside], sky, raster)
    assert len(cells) == 4
    assert sky_of(cells, sky).covers(shapely.box(301, 0, 307, 280))


def test_the_outline_goes_to_a_corner_that_is_near(raster, drawn):
    sky = drawn()
    below = 2 * HEIGHT + 8.0
    lines = [shapely.LineString([(-0.5, below), (400, below)]), shapely.LineString([(400, -0.5), (400, 719.5)])]
    cells = partition.cells_between([PHOTO.boundary, *lines])
    assert len(cells) == 3
    cut = cut_at(cells, sky, raster)
    assert len(cut) == 4
    corners = np.concatenate([shapely.get_coordinates(cell) for cell in cut])
    near = np.linalg.norm(corners - [400, below], axis=1) < 12
    assert np.ptp(corners[near], axis=0) == pytest.approx([0, 0], abs=1e-5)  # no step at the line's end


def test_no_sky_leaves_the_cells(raster):
    assert cut_at([PHOTO], shapely.Polygon(), raster) == [PHOTO]
    assert not near_outline(shapely.Polygon(), raster).any()


def test_plants_go_to_the_borders_of_the_photo(overgrown):
    plants = find_plants(overgrown)
    assert plants.covers(shapely.box(-0.5, HEDGE + 20, 959.5, 719.5))
    assert plants.bounds[1] == pytest.approx(HEDGE, abs=20)


def test_where_nothing_grows_there_are_no_plants(raster):
    assert find_plants(raster).is_empty


def test_only_cells_of_a_mask_are_cut_at_plants(overgrown):
    left, right = shapely.box(-0.5, -0.5, 400, 719.5), shapely.box(400, -0.5, 959.5, 719.5)
    where = np.zeros(overgrown.shape, bool)
    where[100:110, 50:60] = True
    cells = cut_at([left, right], find_plants(overgrown), overgrown, where.ravel())
    assert len(cells) == 3
    assert sum(shapely.covers(cell, shapely.Point(700, 100)) and cell.area == right.area for cell in cells) == 1
    assert sorted(cell.bounds[3] < HEDGE + 20 for cell in cells if cell.bounds[2] <= 400) == [False, True]


def test_borders_may_follow_the_outline(raster, drawn):
    near = near_outline(drawn(), raster)
    assert near[HEIGHT : HEIGHT + 3, 5:-5].all()
    assert not near[10 : HEIGHT - 10, 10:-10].any()  # the borders of the photo are its outline too
    assert not near[HEIGHT + 10 :].any()


@given(st.lists(st.integers(20, 200), min_size=4, max_size=12), st.integers(0, 100))
def test_cells_still_fill_the_photo(raster, heights, at):
    """A skyline of towers of any height, one beside the other."""
    mask = np.zeros(raster.shape, bool)
    for number, column in enumerate(np.array_split(np.arange(raster.shape[1]), len(heights))):
        mask[: heights[number], column] = True
    sky = find_sky(Heaven(mask.ravel(), is_sky=True, is_ceiling=False), raster)
    upright = shapely.LineString([(9.6 * at, -0.5), (9.6 * at, 719.5)])
    cells = cut_at(partition.cells_between([PHOTO.boundary, upright]), sky, raster)
    assert sum(cell.area for cell in cells) == pytest.approx(PHOTO.area)
    assert shapely.union_all(cells).area == pytest.approx(PHOTO.area)
    assert all(cell.is_valid for cell in cells)
