"""Normals made one long where somebody asks, and the axes that they say."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from linecad.depth.normals import OUTSIDE, UNTOLD, Normals
from linecad.geometry import rotation_about

FIRST = np.zeros(1, np.int64)


def one(vector):
    """Normals of one pixel."""
    return Normals(np.array(vector, np.float32).reshape(1, 1, 3))


@given(st.floats(0.5001, 1.4999), st.floats(-3, 3), st.floats(-1.5, 1.5))
def test_length_is_one(length, turn, height):
    vector = np.array([np.cos(turn) * np.cos(height), np.sin(turn) * np.cos(height), np.sin(height)])
    np.testing.assert_allclose(one(vector * length).at(FIRST, FIRST)[0], vector, atol=1e-6)


@pytest.mark.parametrize(
    "filling", [(0, 0, 0), (np.nan, 0, 1), (np.inf, 0, 0), (0, 0, 9), (0.1, 0, 0), (1e30, 1e30, 1e30)]
)
def test_fillings_are_no_normals(filling):
    assert not one(filling).at(FIRST, FIRST).any()
    assert one(filling).axes_at(FIRST, FIRST, np.eye(3)).tolist() == [UNTOLD]


@pytest.mark.parametrize("shape", [(4, 5), (4, 5, 2), (20,)])
def test_what_is_no_map_of_vectors_is_a_mistake(shape):
    with pytest.raises(ValueError, match="vectors has shape"):
        Normals(np.zeros(shape))


def test_a_map_of_other_pixels_shows_theirs_or_none():
    vectors = np.random.default_rng(2).normal(size=(4, 5, 3))
    vectors /= np.linalg.norm(vectors, axis=2, keepdims=True)
    row, column = np.array([3, OUTSIDE, 0])[:, None], np.array([4, 1])[None]
    laid = Normals(vectors).laid(row, column)
    assert laid.shape == (3, 2)
    found = laid.at(np.array([0, 0, 1, 2]), np.array([0, 1, 1, 1]))
    np.testing.assert_allclose(found, [vectors[3, 4], vectors[3, 1], [0, 0, 0], vectors[0, 1]])
    with pytest.raises(ValueError, match="laid onto a photo already"):
        laid.laid(row, column)


@given(
    st.integers(0, 2), st.sampled_from([-1.0, 1.0]), st.floats(0, 6.3), st.floats(0, 44), st.floats(-3, 3),
    st.floats(-1.5, 1.5),
)  # fmt: skip
def test_the_axis_is_the_nearest_in_the_world_or_none(axis, sign, around, degrees, turn, tilt):
    if abs(degrees - 30) < 0.01:
        return
    rotation = rotation_about(np.array([0.3, 0.2, 0.9]) * turn) @ rotation_about(np.array([1.0, 0, 0]) * tilt)
    others = [other for other in range(3) if other != axis]
    world = np.zeros(3)
    world[axis] = sign * np.cos(np.radians(degrees))
    world[others] = np.sin(np.radians(degrees)) * np.array([np.cos(around), np.sin(around)])
    found = one(rotation @ world).axes_at(FIRST, FIRST, rotation)
    nearest = np.abs(world).argmax()  # 60 degrees or less from another axis, but never less than 45
    expected = axis if degrees < 30 else UNTOLD
    assert nearest == axis or degrees > 44.9
    assert found.tolist() == [expected]
