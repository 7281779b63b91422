"""The depth image in a HEIC photo, in files made here box by box."""

import numpy as np
import pytest
from depth_files import Z_FAR, Z_NEAR, heic_bytes, representation

pytest.importorskip("pillow_heif", reason="the extra `depth` is not installed")
PHOTO = np.full((128, 128, 3), 90, np.uint8)
STEPS = np.tile(np.linspace(0, 255, 64).astype(np.uint8), (64, 1))  # libheif codes blocks of 64 px


def test_inverse_depth_between_its_limits(read):
    found = read(heic_bytes(PHOTO, STEPS, representation(0, z_near=Z_NEAR, z_far=Z_FAR)), "IMG_1.HEIC")
    assert found.kind == "inverse"
    assert found.name == "IMG_1.HEIC"
    assert found.valid.all()
    np.testing.assert_allclose(1 / found.values, 1 / (1 / Z_FAR + STEPS / 255 * (1 / Z_NEAR - 1 / Z_FAR)), rtol=1e-5)


def test_disparity_between_its_limits(read):
    found = read(heic_bytes(PHOTO, STEPS, representation(1, d_min=0.25, d_max=3.0)))
    assert found.kind == "affine-inverse"
    np.testing.assert_allclose(found.values, 0.25 + STEPS / 255 * 2.75, rtol=1e-5)


def test_ten_bits(read):
    """libheif codes ten of the sixteen bits."""
    steps = np.tile(np.linspace(0, 65_535, 64).astype(np.uint16), (64, 1))
    found = read(heic_bytes(PHOTO, steps, representation(0, z_near=Z_NEAR, z_far=Z_FAR)))
    wanted = 1 / Z_FAR + steps / 65_535 * (1 / Z_NEAR - 1 / Z_FAR)
    np.testing.assert_allclose(found.values, wanted, atol=2e-3 / Z_NEAR)
    assert len(np.unique(found.values)) == 64


@pytest.mark.parametrize(("message", "kind"), [(b"", None), (representation(1), "affine-inverse")])
def test_without_limits_the_steps_stay(read, message, kind):
    found = read(heic_bytes(PHOTO, STEPS, message))
    assert found.kind == kind
    np.testing.assert_array_equal(found.values, STEPS)
    np.testing.assert_array_equal(found.valid, STEPS > 0)


def test_other_codes_are_refused(refuse):
    message = representation(2, z_near=Z_NEAR, z_far=Z_FAR)
    assert "codes its depth in a way" in refuse(heic_bytes(PHOTO, STEPS, message))


def test_a_photo_without_depth_says_what_to_do(refuse):
    assert "portrait mode" in refuse(heic_bytes(PHOTO))


@pytest.mark.parametrize("share", [0.01, 0.1, 0.5, 0.98])
def test_cut_off_files(refuse, share):
    data = heic_bytes(PHOTO, np.random.default_rng(0).integers(0, 255, (64, 64)).astype(np.uint8))
    assert refuse(data[: int(share * len(data))])


def test_a_depth_image_that_claims_100_gigabytes(refuse):
    size = (64).to_bytes(4, "big") * 2
    data = heic_bytes(PHOTO, STEPS)
    assert data.count(size) == 1
    claimed = (200_000).to_bytes(4, "big") + (125_000).to_bytes(4, "big")
    assert refuse(data.replace(size, claimed))
