"""The ground that a depth map shows."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import norm

import linecad.ties.depth_ground
from linecad.geometry import central_camera
from linecad.scene import Camera
from linecad.ties.depth_ground import ground_of_map

HEIGHT = 1.6  # m of the camera above the pavement
NARROW = Camera(720, 540, central_camera(800.0, 720, 540), "file")


@pytest.fixture(scope="module")
def street(avenue_walls, build_ground):
    """A function: the camera and what it sees, with a road so far below the camera between two pavements."""
    seen, walls = avenue_walls

    def draw(road=HEIGHT, pavement=HEIGHT):
        beside = [
            replace(build_ground(pavement, None), low=(low, -np.inf, -np.inf), high=(high, np.inf, np.inf))
            for low, high in ((-3.0, -1.5), (1.5, 2.6))
        ]
        return seen.sight, [*walls, build_ground(road, None), *beside]

    return draw


def shown(sight, depth):
    return ground_of_map(depth, depth.kind, 0.0, sight)


@pytest.mark.parametrize("scale", [0.2, 1.0, 30.0])
@pytest.mark.parametrize("kind", ["z", "distance", "inverse"])
def test_the_height_is_that_of_the_camera_in_the_unit_of_the_map(street, build_depth_map, kind, scale):
    sight, surfaces = street()
    found = shown(sight, build_depth_map(sight, surfaces, kind, scale))
    assert found == pytest.approx(np.log(HEIGHT * scale), abs=0.006)


def test_a_shift_of_disparity_is_taken_off(street, build_depth_map):
    sight, surfaces = street()
    depth = build_depth_map(sight, surfaces, "affine-inverse", shift=0.1)
    plain = build_depth_map(sight, surfaces, "inverse")
    added = -float((depth.values - plain.values)[plain.valid].mean())
    assert ground_of_map(depth, "affine-inverse", added, sight) == pytest.approx(np.log(HEIGHT), abs=0.006)


def test_walls_stand_on_the_pavement_not_on_the_road(street, build_depth_map):
    sight, surfaces = street(road=HEIGHT + 0.12)
    assert shown(sight, build_depth_map(sight, surfaces)) == pytest.approx(np.log(HEIGHT), abs=0.006)


def test_what_is_far_above_the_ground_is_no_pavement(street, build_depth_map):
    sight, surfaces = street(pavement=HEIGHT - 0.5)
    assert shown(sight, build_depth_map(sight, surfaces)) == pytest.approx(np.log(HEIGHT), abs=0.006)


def test_without_level_pixels_there_is_no_ground(avenue_walls, build_depth_map):
    seen, walls = avenue_walls
    assert shown(seen.sight, build_depth_map(seen.sight, walls)) is None


def test_a_ceiling_is_no_ground(avenue_walls, build_depth_map, build_ground):
    seen, walls = avenue_walls
    assert shown(seen.sight, build_depth_map(seen.sight, [*walls, build_ground(-2.6, None)])) is None


def test_a_map_without_any_depth_shows_none(street, build_depth_map):
    sight, surfaces = street()
    depth = build_depth_map(sight, surfaces)
    assert shown(sight, replace(depth, values=0 * depth.values, valid=depth.values < 0)) is None


def test_a_wall_that_goes_on_far_below_the_camera_is_no_ground(build_depth_map, build_facade, build_town, build_wall):
    """Its height changes little from one pixel to the next where rays are steep."""
    seen = build_town(build_wall(1, 6.0, np.arange(-2.0, 2.1), np.array([-7.0, -5.0])), pitch=-0.785, camera=NARROW)
    depth = build_depth_map(seen.sight, [build_facade(1, 6.0, (-9.0, 9.0), (-90.0, 9.0))])
    assert shown(seen.sight, depth) is None


def test_a_bump_on_the_flank_of_a_rough_road_is_no_pavement(monkeypatch, street, build_depth_map):
    """Of a pavement few pixels lie between its height and that of the road."""
    sight, surfaces = street()
    rough = norm.ppf(np.linspace(0.001, 0.999, 3000), scale=0.035)
    heights = np.concatenate([rough, np.full(300, -0.08)])
    monkeypatch.setattr(linecad.ties.depth_ground, "_level_heights", lambda *_: heights)
    assert shown(sight, build_depth_map(sight, surfaces)) == pytest.approx(0.0, abs=0.01)


def test_noise_moves_it_little(street, build_depth_map):
    sight, surfaces = street()
    depth = build_depth_map(sight, surfaces)
    noise = np.exp(0.004 * np.random.default_rng(0).standard_normal(depth.values.shape))
    assert shown(sight, replace(depth, values=depth.values * noise)) == pytest.approx(np.log(HEIGHT), abs=0.01)
