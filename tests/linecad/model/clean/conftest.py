"""Lines before a camera that looks along y, and the crossings between them."""

import numpy as np
import pytest

from linecad.geometry import project
from linecad.scene import Camera, Intersections, Lines

CAMERA = Camera(3000, 2000, np.array([[2500.0, 0, 1499.5], [0, 2500, 999.5], [0, 0, 1]]), "file")
AHEAD = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])  # world to camera: x right, y forward, z up


def build_lines(rows, component=None):
    """Lines of rows (axis, start point, end point)."""
    ends = np.array([row[1:] for row in rows], float).reshape(-1, 2, 3)
    count = len(rows)
    return Lines(
        id=np.arange(count), axis=[row[0] for row in rows], segment=project(ends, CAMERA.matrix, AHEAD), ends=ends,
        is_boundary=np.zeros(count, bool), component=np.zeros(count, int) if component is None else component,
        confidence=np.full(count, "proven"),
    )  # fmt: skip


def build_crossings(pairs, kind="T", real=True, reason="", in_tree=False):
    count = len(pairs)
    return Intersections(
        lines=np.array(pairs, int).reshape(-1, 2), kind=np.full(count, kind), pixel=np.zeros((count, 2)),
        real=np.full(count, real), in_tree=np.full(count, in_tree), weight=np.ones(count),
        reason=np.full(count, reason),
    )  # fmt: skip


def build_photo(rows, step=40):
    """A grey photo (H, W) with a step of brightness of 15 px beside rows (axis, start, end), level or upright in it."""
    grey = np.full((CAMERA.height, CAMERA.width), 100.0, np.float32)
    for _, start, end in rows:
        (x0, y0), (x1, y1) = project(np.array([start, end], float), CAMERA.matrix, AHEAD)
        is_level = abs(y1 - y0) < abs(x1 - x0)
        picture = grey if is_level else grey.T
        (low, high), at = (sorted([x0, x1]), y0) if is_level else (sorted([y0, y1]), x0)
        low, high, at = (max(0, round(each + 0.5)) for each in (low, high, at))
        picture[at : at + 15, low:high] += step
    return grey


@pytest.fixture
def photo():
    return build_photo


@pytest.fixture
def crossings():
    return build_crossings


@pytest.fixture
def lines():
    return build_lines


@pytest.fixture(scope="session")
def camera():
    return CAMERA


@pytest.fixture(scope="session")
def rotation():
    return AHEAD
