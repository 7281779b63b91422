"""Areas that a person told: none shares a place with another, cells end at them, and no evidence outweighs them."""

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from linecad.model.regions import partition
from linecad.model.regions.heaven import Heaven
from linecad.model.regions.raster import take_raster
from linecad.model.regions.surfaces import Surface
from linecad.model.regions.told import FALSE, KEPT, NOTHING, Before, Told

WIDTH, HEIGHT = 960, 720
PHOTO = shapely.box(-0.5, -0.5, WIDTH - 0.5, HEIGHT - 0.5)
NONE = np.zeros(0, np.int64)
SURFACES = [Surface("wall", 1, 8.0, NONE, 0), Surface("ground", 2, -2.0, NONE, None)]


@pytest.fixture(scope="module")
def raster(house):
    return take_raster(house.lines, house.camera, house.rotation, house.photo)


# Corners around a place, in the order of their angles; some lie outside the photo.
corners = st.builds(
    lambda u, v, reach: np.column_stack(
        [
            u + np.array(reach) * np.cos(2 * np.pi * np.arange(len(reach)) / len(reach)),
            v + np.array(reach) * np.sin(2 * np.pi * np.arange(len(reach)) / len(reach)),
        ]
    ),
    st.floats(0, WIDTH),
    st.floats(0, HEIGHT),
    st.lists(st.floats(20, 400), min_size=3, max_size=9),
)
lassos = st.lists(st.tuples(corners, st.sampled_from(["ground", "sky", "clutter"])), min_size=1, max_size=4)


def told_of(lassos, camera):
    told = Told()
    for polygon, word in lassos:
        told = told.with_area(polygon, word, camera)
    return told


@given(lassos)
def test_areas_share_no_place_and_the_last_word_counts(house, lassos):
    told = told_of(lassos, house.camera)
    shapes = [area.shape for area in told.areas]
    assert sum(shape.area for shape in shapes) == pytest.approx(shapely.union_all(shapes).area, abs=1e-3)
    last = shapely.make_valid(shapely.Polygon(lassos[-1][0])).intersection(PHOTO)
    assert told.shapes(lassos[-1][1]).intersection(last).area == pytest.approx(last.area, abs=1e-3)


@given(lassos, st.lists(st.tuples(st.floats(0, WIDTH), st.floats(0, HEIGHT)), min_size=2, max_size=8))
def test_cells_cover_the_photo_once_without_holes_and_end_at_areas(house, lassos, points):
    told = told_of(lassos, house.camera)
    ends = np.array(points).repeat(2, axis=0)[1:-1].reshape(-1, 2, 2)
    ends = ends[np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1) > 1]
    border, _ = partition.extended(ends, WIDTH, HEIGHT, WIDTH / 480)
    cells = told.cut(border)
    assert sum(cell.area for cell in cells) == pytest.approx(PHOTO.area)
    assert not any(cell.interiors for cell in cells)
    for area in told.areas:
        inside = shapely.area(shapely.intersection(np.array(cells, object), area.shape))
        part = np.minimum(inside, shapely.area(cells) - inside)
        assert part.max() < 1e-2  # px^2: no cell is partly in it


@given(lassos, st.integers(0, 2**16))
def test_what_was_told_costs_nothing_and_all_else_more_than_anything(house, raster, lassos, seed):
    costs = np.random.default_rng(seed).uniform(0, 50, (raster.size, 4))
    told = told_of(lassos, house.camera)
    found = told.over(costs, SURFACES, raster)
    column = {"ground": 1, "sky": 2, "clutter": 3}
    covered = np.zeros(raster.size, bool)
    for word in column:
        inside = told.samples(word, raster)
        assert not (covered & inside).any()
        covered |= inside
        assert (found[inside, column[word]] == 0).all()
        assert (np.delete(found[inside], column[word], axis=1) == FALSE).all()
    np.testing.assert_array_equal(found[~covered], costs[~covered])


def test_behind_told_clutter_the_costs_are_what_they_were(house, raster):
    told = Told().with_area(np.array([[100, 100], [300, 100], [300, 300]]), "clutter", house.camera)
    costs = np.ones((raster.size, 4))
    np.testing.assert_array_equal(told.over(costs, SURFACES, raster, with_clutter=False), costs)


def test_away_from_areas_what_was_seen_is_kept_but_for_new_surfaces(house, raster):
    told = Told().with_area(np.array([[0, 0], [40, 0], [40, 40], [0, 40]]), "sky", house.camera)
    told = Told(told.areas, (), told.camera, Before(SURFACES[:1], np.zeros(raster.size, np.int64)))
    found = told.over(np.zeros((raster.size, 4)), SURFACES, raster)
    np.testing.assert_array_equal(found[-1], [0, 0, KEPT, KEPT])
    near = np.flatnonzero(~told.samples("sky", raster))[0]
    np.testing.assert_array_equal(found[near], 0)


def test_a_told_wall_is_nowhere_else_and_ends_the_one_in_its_plane(house, raster):
    wall = Surface("wall", 1, 8.0, NONE, 0)
    told = Told().with_area(np.array([[200, 200], [400, 200], [400, 400], [200, 400]]), wall, house.camera)
    seen = np.full(raster.shape, 2)
    seen[100:250, 80:300] = 0  # the piece of the other one that the told one cuts
    seen[:20, :20] = 0  # another piece of it
    told = Told(told.areas, (), told.camera, Before(SURFACES, seen.ravel()))
    found = told.over(np.zeros((raster.size, 5)), [SURFACES[0], wall, SURFACES[1]], raster).reshape(*raster.shape, 5)
    assert found[150, 150].tolist() == [FALSE, 0, FALSE, FALSE, FALSE]
    assert found[240, 290, :2].tolist() == [FALSE, FALSE]
    assert found[5, 5, :2].tolist() == [0, FALSE]


def test_told_sky_shows_what_the_sky_looks_like(house, raster):
    told = Told().with_area(np.array([[0, 0], [90, 0], [90, 90], [0, 90]]), "sky", house.camera)
    room = Heaven(np.ones(raster.size, bool), is_sky=False, is_ceiling=True)
    heaven = told.sky(room, raster)
    assert heaven.is_sky
    assert not heaven.is_ceiling
    assert NOTHING.sky(room, raster) is room


def test_an_area_outside_the_photo_is_told(house):
    told = Told().with_area(np.array([[-90, -90], [-50, -90], [-50, -50]]), "sky", house.camera)
    assert told.areas == ()
    assert told.notes == ("a part of the photo that you named lies outside it",)
