"""Lanes of a photo that is painted by rays: what lies where on the ground is known."""

import numpy as np
import pytest

from linecad.directions import directions_of, partner
from linecad.geometry import world_rays
from linecad.model.regions.lanes import EDGE, NEAREST, ROW, SIDE, Lane, differences_of, find_edges, find_lanes, mean_of
from linecad.model.regions.raster import take_raster
from linecad.model.regions.segments import View
from linecad.scene import Camera, Lines

CAMERA = Camera(960, 640, np.array([[800.0, 0, 479.5], [0, 800.0, 319.5], [0, 0, 1]]), "file")
LEVEL = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])  # a camera that looks along y
NO_LINES = np.zeros(0, np.int64)
NONE = Lines(
    NO_LINES, NO_LINES, np.zeros((0, 2, 2)), np.zeros((0, 2, 3)), np.zeros(0, bool), NO_LINES, np.zeros(0, "U9")
)
DARK, LIGHT = 80, 160


def lanes_of(distance, axis=1, turns=(), hidden=None):
    """The lanes of a ground that is light further beside a camera than a distance; None is shown above the horizon."""
    v, u = np.mgrid[0:640, 0:960].astype(float)
    axes = directions_of(turns)
    rays = world_rays(np.stack([u, v], axis=2), CAMERA.matrix, LEVEL)
    below = -rays[..., 2]
    photo = np.full((640, 960, 3), DARK, np.uint8)
    photo[np.abs(rays @ axes[int(partner(axis))]) > distance * below] = LIGHT
    view = View(CAMERA, LEVEL, photo, turns)
    raster = take_raster(NONE, CAMERA, LEVEL, photo, None, turns)
    is_ground = -raster.rays[:, 2] > 0.01
    if hidden is not None:
        is_ground &= ~hidden(raster.rays)
    return find_lanes(is_ground, raster, view)


@pytest.mark.parametrize("distance", [1.0, 2.0, 3.5])
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_an_edge_lies_in_the_row_of_its_distance(distance, side):
    (lane,) = lanes_of(distance)[1, side]
    (edge,) = find_edges(lane, 0.08)
    assert np.log(NEAREST) + (edge.row - 0.5) * ROW == pytest.approx(np.log(distance), abs=1.5 * ROW)
    assert lane.length[edge.row][edge.columns].sum() > 0.08


def test_a_street_of_a_further_frame_has_lanes_of_its_own():
    lanes = lanes_of(2.0, axis=4, turns=(0.2,))
    assert set(lanes) == {(along, side) for along in (0, 1, 3, 4) for side in (-1.0, 1.0)}
    (edge,) = find_edges(lanes[4, -1.0][0], 0.08)
    assert np.log(NEAREST) + (edge.row - 0.5) * ROW == pytest.approx(np.log(2.0), abs=1.5 * ROW)


def test_what_is_no_ground_is_not_shown():
    lanes = lanes_of(2.0, hidden=lambda rays: rays[:, 0] < 0)
    assert lanes[1, -1.0] == []
    (lane,) = lanes[1, 1.0]
    assert lane.shown.any()
    assert not (lane.length[~lane.shown] > 0).any()


def flat(rows, columns, rng):
    """A lane that is shown everywhere, of noise."""
    colour = rng.normal(50, 1, (rows, columns, 3)).astype(np.float32)
    return Lane(colour, np.ones((rows, columns), bool), np.full((rows, columns), 1 / columns))


def test_differences_are_of_the_rows_on_both_sides():
    rng = np.random.default_rng(0)
    lane = flat(40, 64, rng)
    lane.colour[20:, :, 0] += 10
    across, seen = differences_of(lane)
    assert seen[SIDE:-SIDE].all()
    assert not seen[:SIDE].any()
    assert np.allclose(across[20, :, 0], 10, atol=1)
    assert np.abs(across[20 + 2 * SIDE : -SIDE]).max() < 1


def test_an_edge_is_no_longer_than_where_it_differs_as_it_mostly_does():
    rng = np.random.default_rng(1)
    lane = flat(60, 200, rng)
    lane.colour[30:, :120, 0] += 3 * EDGE
    lane.colour[30:, 160:, 0] -= 3 * EDGE
    (edge,) = find_edges(lane, 0.3)
    assert edge.row == 30
    assert edge.columns[:100].all()
    assert not edge.columns[140:].any()
    assert find_edges(lane, 0.8) == []


def test_a_mean_is_of_what_is_shown():
    lane = flat(10, 4, np.random.default_rng(2))
    lane.shown[:] = [True, False, True, True]
    lane.shown[2:5, 2] = False
    known, mean = mean_of(lane, slice(2, 6))
    assert known.tolist() == [True, False, True, True]
    assert np.allclose(mean[0], lane.colour[2:6, 0].mean(axis=0))
    assert np.allclose(mean[2], lane.colour[5, 2])
