"""A made depth map of a corridor, and ways to write and refuse files of it."""

import numpy as np
import pytest

from linecad.depth.read import read_depth_map
from linecad.errors import DepthMapError

HEIGHT, WIDTH, FOCAL = 40, 60, 50.0
CENTER = (29.0, 21.0)  # px


@pytest.fixture
def depth():
    """Depths (H, W) of a slanted wall with a near post before it; no two pixels of the wall are alike."""
    y, x = np.mgrid[:HEIGHT, :WIDTH]
    wall = 3 + x * 0.05 + y * 0.0007
    wall[:, 20:24] = 1.5 + y[:, 20:24] * 0.001
    return wall.astype(np.float32)


@pytest.fixture
def read(tmp_path):
    """A depth map read from bytes under a name."""

    def read_bytes(data, name="map", reading=None):
        path = tmp_path / name
        path.write_bytes(data)
        return read_depth_map(path, reading)

    return read_bytes


@pytest.fixture
def refuse(read):
    """The one line with which bytes under a name are refused."""

    def refuse_bytes(data, name="map", reading=None):
        with pytest.raises(DepthMapError) as caught:
            read(data, name, reading)
        message = str(caught.value)
        assert "\n" not in message
        assert name in message
        return message

    return refuse_bytes


@pytest.fixture
def every_normal():
    """The normals (H, W, 3) of all pixels of a map."""

    def of_all(normals):
        row, column = np.indices(normals.shape)
        return normals.at(row.ravel(), column.ravel()).reshape(*normals.shape, 3)

    return of_all
