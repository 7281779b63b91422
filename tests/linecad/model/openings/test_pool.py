"""What is judged of a wall: a window of which only the panes have edges is one of the rectangles, and is taken."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from linecad.model.openings.pool import build_pool
from linecad.model.openings.raster import build_raster, look
from linecad.model.openings.walls import find_walls

WALL, GLASS = (225, 222, 215), (70, 80, 90)
NEAR = 0.12


@pytest.fixture(scope="module")
def white(facade, painted):
    """The facade, its frames and bars as white as the wall: of each window only two by three panes are seen."""
    pixels = facade.pixels.copy()
    painted(pixels, -6, 6, -2.0, 3.8, WALL)
    for u0, u1, v0, v1 in facade.boxes:
        across, up = np.linspace(u0, u1, 3), np.linspace(v0, v1, 4)
        for left, right in pairwise(across):
            for low, high in pairwise(up):
                painted(pixels, left + 0.04, right - 0.04, low + 0.04, high - 0.04, GLASS)
    return replace(facade, pixels=pixels)


def in_plane(pool):
    return np.column_stack([pool.raster.u[pool.box[:, :2]], pool.raster.v[pool.box[:, 2:]]])


def test_a_window_without_edges_of_its_own_is_judged(white):
    wall = find_walls(white.planes, white.lines, white.camera, white.rotation)[0]
    pool = build_pool(build_raster(wall, look(white.pixels)))
    assert pool.log_odds().shape == (len(pool.box),)
    for box in white.boxes:
        assert np.abs(in_plane(pool) - box).max(axis=1).min() < NEAR, box


def test_each_rectangle_is_judged_once(white, facade):
    for each in (white, facade):
        wall = find_walls(each.planes, each.lines, each.camera, each.rotation)[0]
        pool = build_pool(build_raster(wall, look(each.pixels)))
        assert len(np.unique(pool.box, axis=0)) == len(pool.box)


def test_it_is_taken_in_place_of_its_panes(white):
    found = np.array([[each.u0, each.u1, each.v0, each.v1] for each in white.openings()])
    for box in white.boxes:
        assert np.abs(found - box).max(axis=1).min() < NEAR, box
    assert len(found) == len(white.boxes)
