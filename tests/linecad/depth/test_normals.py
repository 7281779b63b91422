"""Normals in MoGe's picture, and vectors made one long."""

import numpy as np
import pytest
from depth_files import npy_bytes, picture_bytes
from hypothesis import given
from hypothesis import strategies as st

from linecad.depth.normals import unit_normals
from linecad.errors import DepthMapError


def coloured(normals, none):
    """As MoGe colours them; `none` (H, W) where it has no normal."""
    shown = np.where(none[..., None], 0, normals) * [0.5, -0.5, -0.5] + 0.5
    return (shown.clip(0, 1) * 255).astype(np.uint8)


def test_a_picture_beside_the_depth(depth, read, tmp_path):
    rng = np.random.default_rng(1)
    normals = rng.normal(size=(*depth.shape, 3))
    normals /= np.linalg.norm(normals, axis=2, keepdims=True)
    none = rng.random(depth.shape) < 0.2
    (tmp_path / "normal.png").write_bytes(picture_bytes(coloured(normals, none)))
    found = read(npy_bytes(depth), "depth.npy").normals
    assert not found[none].any()
    np.testing.assert_allclose(np.linalg.norm(found[~none], axis=1), 1, rtol=1e-6)
    cosine = (found * normals).sum(axis=2)[~none]
    assert np.degrees(np.arccos(cosine.min().clip(-1, 1))) < 0.5
    assert read(npy_bytes(depth), "other.npy").normals is None  # only in a folder of MoGe's


@pytest.mark.parametrize("shape", [(41, 60, 3), (40, 60)])
def test_a_picture_of_another_size_or_without_colours(depth, read, tmp_path, shape):
    (tmp_path / "normal.png").write_bytes(picture_bytes(np.zeros(shape, np.uint8)))
    with pytest.raises(DepthMapError, match=r"normal\.png is a picture of 60 x 4"):
        read(npy_bytes(depth), "depth.npy")


@given(st.floats(0.5001, 1.4999), st.floats(-3, 3), st.floats(-1.5, 1.5))
def test_length_is_one(length, turn, height):
    vector = np.array([np.cos(turn) * np.cos(height), np.sin(turn) * np.cos(height), np.sin(height)])
    found = unit_normals((vector * length).reshape(1, 1, 3))
    np.testing.assert_allclose(found[0, 0], vector, atol=1e-6)


def test_fillings_are_no_normals():
    vectors = np.array([[[0, 0, 0], [np.nan, 0, 1], [np.inf, 0, 0], [0, 0, 9], [0.1, 0, 0], [1e30, 1e30, 1e30]]])
    assert not unit_normals(vectors).any()
