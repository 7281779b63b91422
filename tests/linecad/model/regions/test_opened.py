"""Windows tell along which axis a wall faces: what another way faces costs more there."""

import numpy as np
import pytest
import shapely

from linecad.corrections.edits import NoWindow
from linecad.depth.normals import UNTOLD
from linecad.geometry import central_camera
from linecad.model.openings.shown import WallShown
from linecad.model.regions.opened import EACH, MOST, TURNED, costs_by_openings, with_walls_shown
from linecad.model.regions.raster import take_raster
from linecad.model.regions.surfaces import Surface
from linecad.scene import Camera, Lines

CAMERA = Camera(480, 360, central_camera(300.0, 480, 360), "file")
AHEAD = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
NONE = Lines(
    id=np.zeros(0, int), axis=np.zeros(0, int), segment=np.zeros((0, 2, 2)), ends=np.zeros((0, 2, 3)),
    is_boundary=np.zeros(0, bool), component=np.zeros(0, int), confidence=np.zeros(0, "<U9"),
)  # fmt: skip


def raster_with(*shown, turns=(), faces=()):
    return with_walls_shown(take_raster(NONE, CAMERA, AHEAD, None, turns=turns), shown, faces)


def square(left, top, side, axis=1, is_opening=True):
    return WallShown(axis, shapely.box(left - 0.5, top - 0.5, left + side - 0.5, top + side - 0.5), is_opening)


def surfaces(*axes):
    return [Surface("ground" if axis == 2 else "wall", axis, 5.0, np.zeros(0, np.int64), None) for axis in axes]


def test_without_openings_nothing_is_told():
    raster = raster_with()
    assert (raster.opened == UNTOLD).all()
    assert not costs_by_openings(raster, surfaces(0, 1, 2)).any()


def test_a_window_costs_what_faces_another_way():
    raster = raster_with(square(100, 50, 20))
    inside = raster.opened == 1
    assert inside.sum() == 20 * 20
    costs = costs_by_openings(raster, surfaces(0, 1, 2))
    np.testing.assert_allclose(costs[inside], [[TURNED + EACH / 400, 0, TURNED + EACH / 400]] * 400)
    assert not costs[~inside].any()


def test_each_window_adds_the_same_but_for_tiny_ones():
    large, small, tiny = (raster_with(square(100, 50, side)) for side in (60, 10, 2))
    each = [raster.opened_cost.sum() - TURNED * (raster.opened == 1).sum() for raster in (large, small)]
    assert each == pytest.approx([EACH, EACH])
    assert tiny.opened_cost.max() == MOST


def test_wall_between_windows_tells_less_than_they_do():
    raster = raster_with(square(100, 50, 20, is_opening=False), square(110, 50, 20, axis=0))
    at = raster.opened.reshape(raster.shape)[60]
    assert (at[100:110] == 1).all()
    assert (at[110:130] == 0).all()  # the surer of two
    assert raster.opened_cost.reshape(raster.shape)[60, 105] == TURNED


def test_walls_of_frames_that_hardly_turn_are_not_told_apart():
    turned = costs_by_openings(raster_with(square(100, 50, 20), turns=(0.2,)), surfaces(3, 4))
    assert (turned.max(axis=0) > 0).tolist() == [True, False]


def test_what_a_person_calls_no_window_says_nothing():
    raster = raster_with(square(100, 50, 20), square(200, 50, 20), faces=(NoWindow((110.0, 60.0)),))
    assert np.unique(np.flatnonzero(raster.opened == 1) % raster.shape[1]).tolist() == list(range(200, 220))
