"""Normals in MoGe's picture."""

import numpy as np
import pytest
from depth_files import npy_bytes, picture_bytes

from linecad.errors import DepthMapError


def coloured(normals, none):
    """As MoGe colours them; `none` (H, W) where it has no normal."""
    shown = np.where(none[..., None], 0, normals) * [0.5, -0.5, -0.5] + 0.5
    return (shown.clip(0, 1) * 255).astype(np.uint8)


def test_a_picture_beside_the_depth(depth, read, every_normal, tmp_path):
    rng = np.random.default_rng(1)
    normals = rng.normal(size=(*depth.shape, 3))
    normals /= np.linalg.norm(normals, axis=2, keepdims=True)
    none = rng.random(depth.shape) < 0.2
    (tmp_path / "normal.png").write_bytes(picture_bytes(coloured(normals, none)))
    found = every_normal(read(npy_bytes(depth), "depth.npy").normals)
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
