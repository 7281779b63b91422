"""The photo on a coarse raster."""

import cv2
import numpy as np
import pytest
import shapely

from linecad.depth.normals import UNTOLD, Normals
from linecad.geometry import project, world_rays
from linecad.model.regions.raster import COLUMNS, take_raster


@pytest.fixture(scope="module")
def raster(house):
    return take_raster(house.lines, house.camera, house.rotation, house.photo)


def test_samples_have_one_width_in_every_photo(raster):
    assert raster.shape == (360, COLUMNS)
    assert raster.step == 2
    assert raster.size == 360 * COLUMNS == len(raster.rays) == len(raster.gradient) == len(raster.votes)
    assert raster.samples_of(np.array([[0.5, 0.5], [958.5, 718.5]])).tolist() == [[0, 0], [479, 359]]


def test_samples_in_a_shape_are_those_whose_middles_are(raster):
    inside = raster.inside(shapely.box(-0.5, -0.5, 100.5, 50.5)).reshape(raster.shape)
    row, column = np.nonzero(inside)
    assert (row.max() + 1) * raster.step == pytest.approx(51, abs=raster.step)
    assert (column.max() + 1) * raster.step == pytest.approx(101, abs=raster.step)
    assert inside.sum() == (row.max() + 1) * (column.max() + 1)


def test_rays_are_those_of_the_middles_of_samples(house, raster):
    expected = world_rays(np.array([[2 * 7 + 0.5, 2 * 3 + 0.5]]), house.camera.matrix, house.rotation)
    assert raster.rays[3 * COLUMNS + 7] == pytest.approx(expected[0])


def test_points_lie_on_their_lines_no_further_apart_than_samples(house, raster):
    points = raster.line_rays * raster.line_depth[:, None]
    for number in range(len(house.lines)):
        own = raster.line == number
        fixed = [axis for axis in range(3) if axis != house.lines.axis[number]]
        assert points[own][:, fixed] == pytest.approx(np.tile(house.lines.ends[number, 0, fixed], (own.sum(), 1)))
        pixels = project(points[own], house.camera.matrix, house.rotation)
        assert np.linalg.norm(np.diff(pixels, axis=0), axis=1).max() < raster.step
        assert pixels[[0, -1]] == pytest.approx(house.lines.segment[number])
        row, column = np.divmod(raster.at[own], COLUMNS)
        assert np.abs(raster.samples_of(pixels) - np.column_stack([column, row])).max() <= 0.5 + 1e-9


def test_marks_and_distances(raster):
    own = raster.line == 0
    marked = raster.marked(own)
    assert set(np.flatnonzero(marked)) == set(raster.at[own].tolist())
    distance = raster.distance(marked)
    assert (distance[marked] == 0).all()
    row, column = np.divmod(np.flatnonzero(marked), COLUMNS)
    assert distance[0] == pytest.approx(np.hypot(row, column).min(), rel=0.02)
    assert np.isinf(raster.distance(np.zeros(raster.size, bool))).all()


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_edges_vote_for_the_axis_that_they_run_along(house, axis):
    middle, ends = np.array([3.0, 9.0, -1.0]), np.zeros((2, 3))
    ends[1, axis] = 8.0 if axis == 1 else 1.5
    segment = project(ends + middle, house.camera.matrix, house.rotation)
    photo = np.full((720, 960, 3), 90, np.uint8)
    cv2.line(photo, *np.rint(segment).astype(int).tolist(), (220, 220, 220), 12)
    votes = take_raster(house.lines, house.camera, house.rotation, photo).votes.sum(axis=0)
    assert votes.argmax() == axis
    assert votes[axis] > 0.6 * votes.sum()


def test_edges_that_point_nowhere_vote_for_no_axis(house):
    photo = np.full((720, 960, 3), 90, np.uint8)
    cv2.line(photo, (700, 100), (850, 200), (220, 220, 220), 12)
    votes = take_raster(house.lines, house.camera, house.rotation, photo).votes.sum(axis=0)
    assert votes.argmax() == len(votes) - 1


def test_without_a_photo_there_are_lines_and_no_edges(house):
    raster = take_raster(house.lines, house.camera, house.rotation, None)
    assert raster.votes.sum() == 0
    assert raster.gradient.max() < 1e-3
    assert set(raster.line.tolist()) == set(range(len(house.lines)))


def test_normals_say_which_way_samples_face(house, raster):
    assert (raster.facing == UNTOLD).all()
    vectors = np.zeros((720, 960, 3))
    vectors[:, 100:] = -house.rotation[:, 1]
    facing = take_raster(house.lines, house.camera, house.rotation, house.photo, Normals(vectors)).facing
    assert (facing.reshape(360, COLUMNS)[:, :50] == UNTOLD).all()
    assert (facing.reshape(360, COLUMNS)[:, 50:] == 1).all()
