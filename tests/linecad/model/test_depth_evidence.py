"""The depths of a map of each kind, in the scene's unit, against planes whose depth is known."""

from types import SimpleNamespace

import numpy as np
import pytest

from linecad.depth.depth_map import DepthMap
from linecad.geometry import central_camera
from linecad.model.depth_evidence import depths_of, normals_of
from linecad.scene import DepthMapReport
from linecad.ties.depth_ties import DepthWitness

MATRIX = central_camera(100.0, 64, 48)
SHIFT, SCALE, FACTOR = 0.02, 2.5, 1.6  # of the map's numbers, of the map over the bodies, of the scene over the bodies


def placed(values, kind, shift=None, left_out="", heard=None):
    told = DepthMapReport("map.npz", left_out, *((None,) * 4 if left_out else (kind, shift, SCALE, 0.02)))
    depth = DepthMap("map.npz", values.astype(np.float32), values > 0, kind)
    places = SimpleNamespace(evidence=SimpleNamespace(heard=heard))
    return SimpleNamespace(depth_map=told, places=places, setting=SimpleNamespace(sight=SimpleNamespace(depth=depth)))


@pytest.mark.parametrize("kind", ["z", "distance", "inverse", "affine-inverse"])
def test_the_depths_are_those_of_the_scene(kind):
    v, u = np.mgrid[:48, :64]
    true = 4.0 + 0.01 * u + 0.02 * v  # at the bodies' scale
    slant = np.hypot(1.0, np.hypot((u - 31.5) / 100, (v - 23.5) / 100))
    of_map = true * SCALE
    values = {"z": of_map, "distance": of_map * slant, "inverse": 1 / of_map, "affine-inverse": 1 / of_map - SHIFT}[
        kind
    ]
    values[3, 4] = 0.0
    shift = SHIFT if kind == "affine-inverse" else 0.0
    found = depths_of(placed(values, kind, shift), FACTOR, MATRIX)
    assert found.width == 0.02
    depth = found.at(np.arange(48), np.arange(64))
    assert np.isnan(depth[3, 4])
    known = np.isfinite(depth)
    assert known.sum() == known.size - 1
    np.testing.assert_allclose(depth[known], (true * FACTOR)[known], rtol=1e-4)
    np.testing.assert_array_equal(found.at(np.array([3, 7]), np.array([4, 9, 2])), depth[[3, 7]][:, [4, 9, 2]])
    places = np.array([[4.0, 3.0], [9.4, 6.6], [2.0, 7.0], [-1.0, 7.0], [64.0, 7.0], [9.0, 48.0]])
    np.testing.assert_array_equal(found.near(places), [np.nan, depth[7, 9], depth[7, 2], *[np.nan] * 3])


def test_how_exact_a_map_is_for_lines_is_known_where_it_was_heard():
    values = np.ones((48, 64))
    heard = DepthWitness(reading=None, width=0.02, worth=1.0, weight=1.0, words=None, width_of_parts=0.013, ground=None)
    assert depths_of(placed(values, "z", 0.0, heard=heard), FACTOR, MATRIX).width_of_parts == 0.013
    assert depths_of(placed(values, "z", 0.0), FACTOR, MATRIX).width_of_parts == np.inf


def test_a_map_that_was_left_out_and_none_at_all_say_nothing():
    assert depths_of(None, FACTOR, MATRIX) is None
    assert normals_of(None) is None
    left_out = placed(np.ones((48, 64)), "z", left_out="it is off")
    assert depths_of(left_out, FACTOR, MATRIX) is None
    assert normals_of(left_out) is None
    without = SimpleNamespace(depth_map=None, setting=SimpleNamespace(sight=SimpleNamespace(depth=None)))
    assert depths_of(without, FACTOR, MATRIX) is None
