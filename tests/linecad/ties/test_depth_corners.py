"""How exact a map is by its own corners: on an exact map of two walls that meet, and on widths that were drawn."""

from dataclasses import replace

import numpy as np
import pytest

from linecad.geometry import project
from linecad.line_graph import Segments
from linecad.ties.depth_corners import jumps_at_corners, width_by_corners

CORNER = (2.0, 12.0)  # x and y, where a wall across the view and one along it meet


@pytest.fixture(scope="module")
def seen(build_town, build_wall, small_camera):
    """The camera, with some lines on both walls."""
    across = build_wall(1, CORNER[1], np.array([-2.0, -0.5, 1.0]), np.array([-1.0, 0.2, 1.1]))
    along = build_wall(0, CORNER[0], np.array([9.0, 10.0, 11.0]), np.array([-0.8, 0.4, 1.0]))
    return build_town(across, along, camera=small_camera)


@pytest.fixture(scope="module")
def exact(seen, build_facade, build_depth_map):
    walls = [build_facade(1, CORNER[1], (-3.0, CORNER[0]), (-2, 2)), build_facade(0, CORNER[0], (7.0, 12.0), (-2, 2))]
    return build_depth_map(seen.sight, walls)


def segment(seen, *ends, axis=2):
    """A line between two points in space, as the camera sees it."""
    pixels = project(np.array([ends], float), seen.sight.matrix, seen.sight.rotation)
    return Segments(pixels, np.array([axis]))


def corner(seen, low=-1.5, high=1.5, **fields):
    return segment(seen, (*CORNER, low), (*CORNER, high), **fields)


def jumps(depth, lines, seen):
    return jumps_at_corners(depth, "z", 0.0, lines, seen.sight)


def broken(depth, seen, by):
    """The map with the wall along the view farther by that log."""
    (edge, _), _ = project(np.array([[[*CORNER, 0.0]] * 2]), seen.sight.matrix, seen.sight.rotation)[0]
    is_along = np.arange(depth.width) > edge
    return replace(depth, values=np.where(is_along, depth.values * np.exp(by), depth.values))


def test_an_exact_map_has_no_jump_at_a_corner(seen, exact):
    assert jumps(exact, corner(seen), seen) == pytest.approx([0.0], abs=2e-3)


@pytest.mark.parametrize("by", [0.1, -0.3])
def test_a_wall_that_is_off_jumps_by_as_much(seen, exact, by):
    assert jumps(broken(exact, seen, by), corner(seen), seen) == pytest.approx([abs(by)], abs=3e-3)


@pytest.mark.parametrize("kind", ["distance", "inverse", "affine-inverse"])
def test_every_kind_of_map_is_read(seen, build_facade, build_depth_map, kind):
    walls = [build_facade(1, CORNER[1], (-3.0, CORNER[0]), (-2, 2)), build_facade(0, CORNER[0], (7.0, 12.0), (-2, 2))]
    added = 0.2 if kind == "affine-inverse" else 0.0  # of the largest number, which is 1.2 times that then
    depth = build_depth_map(seen.sight, walls, kind, shift=added)
    shift = -depth.values[depth.valid].max() * added / (1 + added)
    assert jumps_at_corners(depth, kind, shift, corner(seen), seen.sight) == pytest.approx([0.0], abs=2e-3)


def test_a_line_within_a_wall_tells_nothing(seen, exact):
    assert len(jumps(exact, segment(seen, (-1.0, CORNER[1], -1.0), (-1.0, CORNER[1], 1.0)), seen)) == 0


@pytest.mark.parametrize("axis", [-1, 3, 4])
def test_lines_of_no_axis_and_of_other_frames_tell_nothing(seen, exact, axis):
    assert len(jumps(exact, corner(seen, axis=axis), seen)) == 0


def test_a_short_line_tells_nothing(seen, exact):
    assert len(jumps(exact, corner(seen, -0.1, 0.1), seen)) == 0


def test_a_corner_counts_once(seen, exact):
    both = corner(seen, -1.5, -0.1).joined(corner(seen, 0.2, 1.5))
    assert len(jumps(exact, both, seen)) == 1


def test_what_the_map_does_not_show_tells_nothing(seen, exact):
    (edge, _), _ = project(np.array([[[*CORNER, 0.0]] * 2]), seen.sight.matrix, seen.sight.rotation)[0]
    valid = np.broadcast_to(np.arange(exact.width) < edge, exact.valid.shape) & exact.valid
    half = replace(exact, values=np.where(valid, exact.values, 0.0), valid=valid)
    assert len(jumps(half, corner(seen), seen)) == 0


@pytest.mark.parametrize("width", [0.012, 0.035, 0.08])
def test_the_width_is_about_that_of_the_walls(width):
    random = np.random.default_rng(0)
    walls = width * random.standard_cauchy((2, 300))
    assert 0.6 < width_by_corners(np.abs(walls[0] - walls[1])) / width < 1.5


def test_without_corners_the_width_is_that_of_published_networks():
    assert width_by_corners(np.zeros(0)) == pytest.approx(0.02, rel=0.1)
