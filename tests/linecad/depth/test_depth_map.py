"""The record, and the sizes that are taken."""

from pathlib import Path

import numpy as np
import pytest

from linecad.depth.depth_map import LARGEST_SIDE, MOST_PIXELS, SMALLEST_SIDE, DepthMap, camera_depths, check_size
from linecad.depth.normals import Normals
from linecad.errors import DepthMapError


def test_arrays_are_copies_that_nobody_can_change(depth):
    record = DepthMap("map", depth, depth > 0, "z", np.eye(3), Normals(np.zeros((*depth.shape, 3))))
    depth[0, 0] = 99
    assert record.values[0, 0] != 99
    assert (record.width, record.height) == (60, 40)
    for array in (record.values, record.valid, record.intrinsics, record.normals.vectors):
        with pytest.raises(ValueError, match="read-only"):
            array[0, 0] = 1


@pytest.mark.parametrize(
    ("changes", "what"),
    [
        ({"valid": np.zeros((40, 60), bool)}, "above 0 where valid"),
        ({"valid": np.ones((40, 61), bool)}, "valid has shape"),
        ({"kind": "metres"}, "kind is metres"),
        ({"intrinsics": np.eye(4)}, "intrinsics has shape"),
        ({"normals": Normals(np.zeros((60, 40, 3)))}, "normals has shape"),
    ],
)
def test_what_does_not_fit_together_is_a_mistake(depth, changes, what):
    fields = {"name": "map", "values": depth, "valid": depth > 0, "kind": None} | changes
    with pytest.raises(ValueError, match=what):
        DepthMap(**fields)


def test_sizes_at_the_limits():
    check_size(SMALLEST_SIDE, SMALLEST_SIDE, Path("map"))
    check_size(8192, MOST_PIXELS // 8192, Path("map"))
    for width, height in ((SMALLEST_SIDE - 1, 100), (8192, MOST_PIXELS // 8192 + 1), (LARGEST_SIDE + 1, 20)):
        with pytest.raises(DepthMapError, match=f"{width} x {height} px"):
            check_size(width, height, Path("map"))


@pytest.mark.parametrize(
    ("kind", "values", "depths"),
    [
        ("z", [0.5, 4, 0], [0.5, 4, np.nan]),
        ("distance", [0.5, 4, 0], [0.25, 3.2, np.nan]),
        ("inverse", [0.5, 4, 0], [2, 0.25, np.nan]),
        ("affine-inverse", [0.5, 4, -1], [1 / 1.5, 0.2, np.nan]),
    ],
)
def test_numbers_of_each_kind_are_depths_along_the_axis(kind, values, depths):
    found = camera_depths(np.array(values, float), np.array([2, 1.25, 1]), kind, 1.0)
    assert found == pytest.approx(depths, nan_ok=True)
