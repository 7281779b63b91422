"""Uprights end on the ground that the photo shows at their lower end."""

import numpy as np
import pytest

from linecad.model.clean.buried import ending_on_ground, grounds_of
from linecad.model.clean.sight import Sight
from linecad.scene import Face, Plane

X, Y, Z = range(3)
FLOOR, WALL = -1.0, 10.0
OUTLINE = np.array([[-4.0, 4.0, FLOOR], [4.0, 4.0, FLOOR], [4.0, WALL, FLOOR], [-4.0, WALL, FLOOR]])


def upright(low, high=1.0, x=0.0, y=WALL):
    return (Z, (x, y, low), (x, y, high))


@pytest.fixture
def lowest(lines, camera, rotation):
    """Where lines end at last, their lower ends, above a floor before a wall."""

    def find(*rows, outline=OUTLINE, holes=(), kind="ground", stays=None):
        sight = Sight(camera.matrix, rotation, None)
        plane = Plane(0, Z, float(outline[0, 2]), (), (Face(0, outline, holes, kind),))
        before = lines(rows)
        held = np.zeros((len(rows), 2), bool) if stays is None else np.array(stays)
        after = ending_on_ground(before, grounds_of((plane,), sight), sight, held)
        np.testing.assert_array_equal(after.ends[before.axis != Z], before.ends[before.axis != Z])
        np.testing.assert_array_equal(after.ends[:, :, Z].max(axis=1), before.ends[:, :, Z].max(axis=1))
        np.testing.assert_array_equal(after.ends[:, :, :Z], before.ends[:, :, :Z])
        return after.ends[:, :, Z].min(axis=1).tolist()

    return find


def test_an_upright_that_runs_on_below_the_ground_ends_on_it(lowest):
    assert lowest(upright(-1.6), upright(-1.2, x=1.0)) == [FLOOR, FLOOR]


def test_each_line_keeps_its_own_end(lowest):
    level = (X, (-1, WALL, 0.5), (1, WALL, 0.5))
    assert lowest(level, upright(-0.5, x=3.0), upright(-1.6, x=2.0)) == [0.5, -0.5, FLOOR]


def test_what_ends_above_the_ground_or_misses_it_by_little_stays(lowest):
    assert lowest(upright(-0.5), upright(-1.05, x=1.0)) == [-0.5, -1.05]


def test_what_is_mostly_below_the_ground_stays(lowest):
    assert lowest(upright(-1.6, -1.2)) == [-1.6]
    assert lowest(upright(-1.6, -0.5)) == [-1.6]
    assert lowest(upright(-1.6, -0.3)) == [FLOOR]
    assert lowest(upright(-1.15, -0.92)) == [-1.15]


def test_an_end_that_meets_a_line_or_is_to_stay_stays(lowest):
    assert lowest(upright(-1.6), (X, (-1, WALL, -1.6), (1, WALL, -1.6)))[0] == -1.6
    assert lowest(upright(-1.6), stays=[[True, False]]) == [-1.6]
    assert lowest(upright(-1.6), stays=[[False, True]]) == [FLOOR]


def test_what_a_line_crosses_below_the_ground_stays(lowest):
    assert lowest(upright(-1.6), (X, (-1, WALL, -1.3), (1, WALL, -1.3)))[0] == -1.6
    assert lowest(upright(-1.6), (X, (-1, WALL, -0.8), (1, WALL, -0.8)))[0] == FLOOR


def test_only_where_the_photo_shows_the_ground(lowest):
    aside = OUTLINE + np.array([9.0, 0, 0])
    hole = np.array([[-1.0, 5.0, FLOOR], [1.0, 5.0, FLOOR], [1.0, 9.0, FLOOR], [-1.0, 9.0, FLOOR]])
    assert lowest(upright(-1.6), outline=aside) == [-1.6]
    assert lowest(upright(-1.6), holes=(hole,)) == [-1.6]
    assert lowest(upright(-1.6), kind="ceiling") == [-1.6]


def test_an_end_behind_the_camera_stays(lowest):
    assert lowest(upright(-1.6, y=-3.0), upright(-1.6)) == [-1.6, FLOOR]


def test_levels_do_not_end_on_the_ground(lowest):
    assert lowest((X, (-2, 8.0, -1.5), (2, 8.0, -1.5)), (Y, (0, -5.0, -1.5), (0, 9.0, -1.5))) == [-1.5, -1.5]
