"""Walls by the rays that meet them."""

import numpy as np

from linecad.model.regions.profiles import Wall

RAYS = np.array([[[1.0, 2.0, 0.5], [1.0, -2.0, 0.5]], [[1.0, 0.0, 0.5], [1.0, 0.0, 0.0]]])


def test_a_ray_along_a_wall_meets_it_nowhere():
    """Lines of a photo go through vanishing points, where their own rays run along every wall that they lie in."""
    wall = Wall(1, 4.0, np.array([0.0, 1, 0]), (0,), np.zeros((2, 2), bool))
    assert wall.is_ahead(RAYS).tolist() == [[True, False], [False, False]]
    height = wall.heights(RAYS)
    assert height[0].tolist() == [1.0, -1.0]
    assert not np.isfinite(height[1]).any()
