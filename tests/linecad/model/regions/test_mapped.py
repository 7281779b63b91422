"""A box of a room, or a street between two walls, as a depth map sees it: true depths with errors that are known."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from linecad.depth.depth_map import DepthMap
from linecad.geometry import central_camera
from linecad.model.regions.mapped import (
    LEAST_WIDTH,
    MAP_COST,
    MOST_BY_MAP,
    MOST_WIDTH,
    SOLID_COST,
    MappedDepths,
    costs_by_map,
    is_of_map_at,
    laid_on,
    with_mapped,
)
from linecad.model.regions.raster import take_raster
from linecad.model.regions.surfaces import Surface
from linecad.scene import Camera, Lines

CAMERA = Camera(480, 320, central_camera(300.0, 480, 320), "file")
AHEAD = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
NO_LINES = np.zeros(0, np.int64)
NONE = Lines(
    NO_LINES, NO_LINES, np.zeros((0, 2, 2)), np.zeros((0, 2, 3)), np.zeros(0, bool), NO_LINES, np.zeros(0, "U9")
)
RASTER = take_raster(NONE, CAMERA, AHEAD, None)
ROOM = {("wall", 0): [-2.0, 2.5], ("wall", 1): [6.0], ("level", 2): [-1.5, 1.2]}


def seen(planes, raster=RASTER):
    """The depth (S,) of the nearest plane on each ray, by axis and offset."""
    depth = np.full(raster.size, np.inf)
    for axis, offset in planes:
        with np.errstate(divide="ignore"):
            there = offset / raster.rays[:, axis]
        depth = np.where((there > 0) & (there < depth), there, depth)
    return np.where(np.isfinite(depth), depth, np.nan)


def mapped(planes, width=LEAST_WIDTH, noise=0.0, seed=0):
    depth = seen(planes) * np.exp(noise * np.random.default_rng(seed).standard_normal(RASTER.size))
    return replace(RASTER, map_depth=depth, map_width=width)


PLANES = [(axis, offset) for (_, axis), offsets in ROOM.items() for offset in offsets]


@settings(max_examples=15, deadline=None)
@given(
    st.floats(-3, -1.5),
    st.floats(1.5, 3),
    st.floats(5, 10),
    st.floats(-1.4, -1),
    st.floats(0.8, 1.3),
    st.integers(0, 9),
)
def test_a_map_of_a_room_gives_its_walls_its_floor_and_its_ceiling(left, right, front, floor, ceiling, seed):
    planes = [(0, left), (0, right), (1, front), (2, floor), (2, ceiling)]
    found = with_mapped([], mapped(planes, noise=0.003, seed=seed))
    known = {(surface.kind, surface.axis, np.sign(surface.offset)): surface.offset for surface in found}
    wanted = [("wall", 0, left), ("wall", 0, right), ("wall", 1, front), ("ground", 2, floor), ("ceiling", 2, ceiling)]
    for kind, axis, offset in wanted:
        assert known[kind, axis, np.sign(offset)] == pytest.approx(offset, rel=0.01)
    assert len(found) == len(wanted)


def test_walls_that_are_known_are_not_found_again():
    known = [Surface("wall", axis, offset, NO_LINES, None) for axis, offset in PLANES if axis != 2]
    found = with_mapped(known, mapped(PLANES))
    assert found[: len(known)] == known
    assert {surface.kind for surface in found[len(known) :]} == {"ground", "ceiling"}


def test_near_lines_of_a_wall_the_map_has_no_other():
    """The map has a wall 10 % too far; where lines show it, the map's own stays away."""
    raster = mapped([(1, 6.6)])
    everywhere = np.arange(raster.size)
    raster = replace(raster, line=np.zeros(raster.size, np.int64), at=everywhere)
    known = [Surface("wall", 1, 6.0, np.array([0]), 0)]
    assert with_mapped(known, raster) == known
    assert len(with_mapped([Surface("wall", 1, 6.0, np.array([1]), 0)], raster)) == 2


@pytest.mark.parametrize(("height", "moves"), [(-1.45, False), (-2.4, True)])
def test_a_ground_that_is_far_off_the_map_goes_there_unless_feet_are_sure(height, moves):
    raster = mapped(PLANES)
    ground = Surface("ground", 2, height, NO_LINES, None)
    assert with_mapped([ground], raster)[0].offset == pytest.approx(-1.5 if moves else height, rel=0.01)
    assert with_mapped([ground], raster, ground)[0] is ground
    on_lines = replace(ground, plane=4)
    assert with_mapped([on_lines], raster)[0] is on_lines


def test_without_a_map_nothing_changes():
    known = [Surface("wall", 1, 6.0, NO_LINES, None)]
    assert with_mapped(known, RASTER) is known
    assert laid_on(RASTER, None, CAMERA) is RASTER


def test_a_map_is_read_at_the_pixels_of_the_samples():
    v, u = np.mgrid[:320, :480]
    values = (1.0 + u + 1000.0 * v).astype(np.float32)
    depth = DepthMap("map.npz", values, values > 0, "z")
    raster = laid_on(RASTER, MappedDepths(depth, "z", 0.0, 1.0, np.eye(3), 0.001), CAMERA)
    middle = raster.samples_of(np.array([[100.0, 50.0]])).round().astype(int)[0]
    assert raster.map_depth[middle[1] * raster.shape[1] + middle[0]] == pytest.approx(50101.0, abs=1001)


@pytest.mark.parametrize(
    ("bodies", "parts", "believed"),
    [
        (0.001, 0.001, LEAST_WIDTH),
        (0.02, 0.01, 0.02),
        (0.02, 0.03, 0.045),
        (0.05, 0.03, 0.05),
        (0.02, 0.3, MOST_WIDTH),
        (0.02, np.inf, MOST_WIDTH),  # nothing tells
    ],
)
def test_a_map_is_believed_as_far_as_bodies_and_corners_tell(bodies, parts, believed):
    ones = np.ones((320, 480), np.float32)
    seen = MappedDepths(DepthMap("map.npz", ones, ones > 0, "z"), "z", 0.0, 1.0, np.eye(3), bodies, parts)
    assert laid_on(RASTER, seen, CAMERA).map_width == pytest.approx(believed)


def test_costs_are_those_of_a_cauchy_error_above_the_nearest():
    surfaces = [Surface("wall", 1, offset, NO_LINES, None) for offset in (5.0, 6.0, 9.0)]
    raster = mapped([(1, 6.1)], width=0.02)
    depth = np.column_stack([surface.offset / raster.rays[:, 1] for surface in surfaces])
    found = costs_by_map(raster, surfaces, depth, limit=20.0)
    own = [min(MAP_COST * np.log1p((np.log(6.1 / offset) / 0.02) ** 2), MOST_BY_MAP) for offset in (5.0, 6.0, 9.0)]
    np.testing.assert_allclose(found[:, :3], np.broadcast_to(np.array(own) - min(own), (raster.size, 3)), atol=1e-9)
    np.testing.assert_allclose(found[:, 3:], SOLID_COST)  # neither sky nor clutter
    far = costs_by_map(raster, surfaces, depth, limit=2.0)
    np.testing.assert_allclose(far[:, 3], 0.0)
    off = costs_by_map(replace(raster, map_depth=raster.map_depth * 1.3), surfaces, depth, limit=20.0)
    np.testing.assert_allclose(off[:, 4], 0.0)  # nothing explains it


def with_lines(raster):
    """The raster with a point of line 0 in every sample."""
    return replace(raster, line=np.zeros(raster.size, np.int64), at=np.arange(raster.size))


def cost_of(surface, raster):
    """The mean cost by the map of a surface beside a wall that the map has 15 % too near."""
    other = Surface("wall", 1, 6.9, NO_LINES, None)
    with np.errstate(divide="ignore"):
        depth = np.column_stack([each.offset / raster.rays[:, each.axis] for each in (surface, other)])
    met = np.isfinite(raster.map_depth) & (depth > 0).all(axis=1)
    return costs_by_map(raster, [surface, other], np.where(depth > 0, depth, np.inf), 20.0)[met, 0].mean()


def test_a_map_that_is_off_a_wall_by_one_factor_shows_that_wall():
    raster = with_lines(mapped([(1, 6.0)], width=0.02))
    wall = Surface("wall", 1, 5.0, np.array([0]), 0)
    assert cost_of(wall, raster) == 0.0
    assert cost_of(replace(wall, lines=np.array([1])), raster) > 0.3, "other lines show it"
    # Where a third of the wall is as deep as the map has it, the rest is something else.
    third = np.arange(raster.size) % raster.shape[1] < raster.shape[1] // 3
    parted = replace(raster, map_depth=np.where(third, seen([(1, 5.0)]), raster.map_depth))
    assert cost_of(wall, replace(parted, map_depth=np.where(third, np.nan, raster.map_depth))) == 0.0
    assert cost_of(wall, parted) > 0.1


def test_a_ground_without_lines_is_the_level_that_the_map_has_elsewhere():
    raster = mapped([(2, -1.9)], width=0.02)
    ground = Surface("ground", 2, -1.4, NO_LINES, None)
    assert cost_of(ground, raster) == 0.0
    assert cost_of(replace(ground, kind="wall"), raster) > 0.2
    assert cost_of(replace(ground, offset=-0.6), raster) > 0.2, "three times as low is another level"


def test_where_the_map_has_nothing_it_says_nothing():
    surfaces = [Surface("wall", 1, 5.0, NO_LINES, None)]
    raster = replace(RASTER, map_depth=np.full(RASTER.size, np.nan), map_width=0.02)
    depth = (5.0 / raster.rays[:, 1])[:, None]
    assert not costs_by_map(raster, surfaces, depth, 20.0).any()
    assert with_mapped(surfaces, raster) == surfaces


def test_a_wall_that_has_lines_is_none_that_a_map_alone_shows():
    box = np.array([[3.0, -1.0, -1.0], [3.0, 1.0, 1.0]])
    of_map = Surface("wall", 0, 3.0, NO_LINES, None, box)
    place = Surface("kerb", 0, 3.01, NO_LINES, None)
    assert is_of_map_at(of_map, place)
    assert not is_of_map_at(replace(of_map, lines=np.array([4])), place)
    assert not is_of_map_at(replace(of_map, box=None), place)
    assert not is_of_map_at(of_map, replace(place, offset=4.0))
    assert not is_of_map_at(of_map, replace(place, axis=1))
