"""A facade names the openings that it cuts."""

import numpy as np
import pytest

from linecad.dataset.facades import build_facade, draw_style
from linecad.dataset.modelling import Model, Wall

X, Y = np.eye(3)[0], np.eye(3)[1]


@pytest.mark.parametrize("detailed", [True, False])
def test_every_hole_is_named_with_one_door(detailed):
    rng = np.random.default_rng(4)
    model = Model()
    model.start_body("building")
    wall = Wall(model, np.array([3.0, -2.0, 0.0]), Y, X)
    build_facade(wall, 12.0, 14.0, draw_style(rng), rng, detailed)
    assert len(model.openings) == len(wall.openings) >= 8
    assert sum(model.opening_is_door) == 1
    assert set(model.opening_body) == {0}
    for corners, (along, up) in zip(model.openings, wall.openings, strict=True):
        np.testing.assert_allclose(corners[0], wall.at(along[0], up[0]))
        np.testing.assert_allclose(corners[1], wall.at(along[1], up[0]))
        np.testing.assert_allclose(corners[2], wall.at(along[0], up[1]))


def test_the_door_stands_on_the_ground():
    rng = np.random.default_rng(4)
    model = Model()
    model.start_body("building")
    build_facade(Wall(model, np.zeros(3), Y, X), 12.0, 14.0, draw_style(rng), rng)
    door = model.openings[model.opening_is_door.index(True)]
    assert door[0][2] == 0.0
    assert door[2][2] > door[1][1] - door[0][1]
