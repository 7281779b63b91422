"""Lines before walls of known places, and the depth map of what is seen there."""

from dataclasses import replace

import numpy as np
import pytest

from linecad.arrays import rows_of
from linecad.depth.depth_map import DepthMap
from linecad.directions import MAIN, directions_of
from linecad.geometry import central_camera, project, world_rays
from linecad.model.on_faces import by_map
from linecad.model.on_faces.by_map import LEAST_OFF, ONE_SURFACE, factors_by_map
from linecad.model.regions.mapped import MappedDepths
from linecad.scene import Camera, Lines

WIDTH, HEIGHT, FOCAL = 640, 480, 500.0
CAMERA = Camera(WIDTH, HEIGHT, central_camera(FOCAL, WIDTH, HEIGHT), "file")
AHEAD = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])  # x right, y away, z up
FAR = 8.0
UPRIGHT = [[1.2, FAR, -1.0], [1.2, FAR, 1.0]]
LEVEL = [[-1.2, FAR, 0.6], [1.5, FAR, 0.6]]


def lines_at(*ends):
    ends = np.array(ends, float)
    axis = np.abs(ends[:, 1] - ends[:, 0]).argmax(axis=1)
    count = len(ends)
    return Lines(
        np.arange(count), axis, project(ends, CAMERA.matrix, AHEAD), ends, np.zeros(count, bool),
        np.zeros(count, np.int64), np.full(count, "supported"),
    )  # fmt: skip


def mapped(values, factor=1.0):
    values = np.broadcast_to(np.asarray(values, np.float32), (HEIGHT, WIDTH)).copy()
    return MappedDepths(DepthMap("map.npz", values, values > 0, "z"), "z", 0.0, factor, CAMERA.matrix, 0.012)


def factors(lines, found, turns=()):
    return factors_by_map(lines, found, CAMERA, AHEAD, turns)


def beside(left, right):
    """The depths of the map to both sides of the upright."""
    column = project(np.array(UPRIGHT[0]), CAMERA.matrix, AHEAD)[0]
    return np.where(np.arange(WIDTH) < column, left, right)


@pytest.mark.parametrize("line", [UPRIGHT, LEVEL], ids=["upright", "level"])
@pytest.mark.parametrize("times", [0.6, 0.85, 1.2, 2.0])
def test_a_line_goes_where_the_map_has_both_of_its_sides(line, times):
    # A wall across the view has one depth.
    assert factors(lines_at(line), mapped(FAR * times)) == pytest.approx([times], rel=1e-5)
    assert factors(lines_at(line), mapped(FAR * times / 3, factor=3.0)) == pytest.approx([times], rel=1e-5)


def test_what_is_nearly_where_the_map_has_it_stays():
    assert factors(lines_at(UPRIGHT, LEVEL), mapped(FAR * np.exp(0.9 * LEAST_OFF))).tolist() == [1.0, 1.0]


def test_the_edge_of_what_stands_before_something_stays_where_one_side_has_it():
    for other in (0.5, 2.0):
        assert factors(lines_at(UPRIGHT), mapped(beside(FAR, FAR * other))).tolist() == [1.0]


def test_of_two_surfaces_the_line_is_the_edge_of_the_nearer_one():
    for left, right in ((0.5, 0.7), (0.7, 0.5), (0.5, 2.0)):
        assert np.log(max(left, right) / min(left, right)) > ONE_SURFACE
        found = factors(lines_at(UPRIGHT), mapped(beside(FAR * left, FAR * right)))
        assert found == pytest.approx([0.5], rel=1e-5)


def test_on_one_uneven_surface_it_is_in_the_middle():
    found = factors(lines_at(UPRIGHT), mapped(beside(FAR * 0.5, FAR * 0.54)))
    assert found == pytest.approx([np.sqrt(0.5 * 0.54)], rel=1e-5)


def test_leaves_and_rails_tell_no_depth():
    noise = np.exp(np.random.default_rng(0).uniform(-1, 1, (HEIGHT, WIDTH)))
    assert factors(lines_at(UPRIGHT), mapped(FAR * 0.5 * noise)).tolist() == [1.0]


def test_a_side_that_the_map_does_not_see_says_nothing():
    """Such as the sky beside the edge of a roof."""
    assert factors(lines_at(UPRIGHT), mapped(beside(FAR * 0.5, 0.0))).tolist() == [1.0]


def test_outside_of_the_photo_the_map_says_nothing():
    at_edge = [[FAR * (WIDTH / 2 - 1) / FOCAL, FAR, -1.0], [FAR * (WIDTH / 2 - 1) / FOCAL, FAR, 1.0]]
    assert factors(lines_at(at_edge), mapped(FAR * 0.5)).tolist() == [1.0]


def test_a_line_along_the_view_is_moved_as_a_whole(monkeypatch):
    """The map has it on a wall to the side that is nearer than its own: the same factor all along."""
    monkeypatch.setattr(by_map, "LEAST_HEARD", 0.9)
    along = [[2.0, 5.0, 0.8], [2.0, 9.0, 0.8]]
    pixel = np.arange(WIDTH) - (WIDTH - 1) / 2
    wall = np.where(pixel > 0, 1.2 * FOCAL / np.maximum(pixel, 1e-3), 0)  # x = 1.2 m
    assert factors(lines_at(along), mapped(wall)) == pytest.approx([0.6], rel=0.02)


def test_a_bar_before_a_wall_stays_where_the_map_has_it():
    """Beside it the map shows the wall on both sides."""
    column = project(np.array(UPRIGHT[0]), CAMERA.matrix, AHEAD)[0]
    bar = np.where(np.abs(np.arange(WIDTH) - column) < 2, FAR, 2 * FAR)
    assert factors(lines_at(UPRIGHT), mapped(bar)).tolist() == [1.0]
    assert factors(lines_at(UPRIGHT), mapped(np.full(WIDTH, 2 * FAR))) == pytest.approx([2.0], rel=1e-5)


@pytest.mark.parametrize("times", [1.0, 0.7, 1.4])
def test_what_is_seen_on_a_slanted_surface_is_on_it(times):
    """A level line on the ground far away: a few px below the map is much nearer, above much farther."""
    below = 1.5
    far = [[-3.0, 40.0, -below], [3.0, 40.0, -below]]
    under = np.arange(HEIGHT) - (HEIGHT - 1) / 2
    ground = np.where(under > 0.5, FOCAL * below / np.maximum(under, 0.5), 0.0)
    sides = [ground[round((HEIGHT - 1) / 2 + FOCAL * below / 40.0 + by)] for by in (-3, 3)]
    assert sides[0] > 40 * np.exp(LEAST_OFF)
    assert sides[1] < 40 * np.exp(-LEAST_OFF)
    found = factors(lines_at(far), mapped(times * ground[:, None]))
    assert found == pytest.approx([times], rel=0.02)


def test_what_is_many_times_as_far_is_something_else():
    assert factors(lines_at(UPRIGHT), mapped(FAR * 5)).tolist() == [1.0]


def test_of_two_sides_leaves_tell_no_depth():
    leaves = 0.4 * FAR * np.exp(np.random.default_rng(0).uniform(-0.3, 0.3, (HEIGHT, WIDTH)))
    assert factors(lines_at(UPRIGHT), mapped(beside(leaves, FAR * 0.7))).tolist() == [1.0]


def test_of_no_lines_nothing_is_asked():
    none = lines_at(UPRIGHT)
    assert len(factors(rows_of(none, np.zeros(0, np.int64)), mapped(FAR))) == 0


@pytest.mark.parametrize("times", [0.7, 1.0])
def test_a_line_of_a_turned_wall_goes_along_its_rays(times):
    turns = (0.4,)
    along, normal = directions_of(turns)[MAIN:]
    foot = 6 * normal + np.array([0, 0, 0.9])
    ends = np.array([foot - along, foot + 1.5 * along])
    line = replace(lines_at(ends), axis=np.array([MAIN]))
    rays = world_rays(np.stack(np.meshgrid(np.arange(WIDTH), np.arange(HEIGHT)), axis=2), CAMERA.matrix, AHEAD)
    wall = 6 * times / np.maximum(rays @ normal, 1e-3)
    assert factors(line, mapped(wall), turns) == pytest.approx([times], rel=0.01)
