"""Rows resampled as OpenCV would resample the whole photo."""

import cv2
import numpy as np
import pytest

from linecad.camera.row_resampling import resample_rows


@pytest.mark.parametrize("stretch", [1.0017, 0.9, 1.3])
def test_pixels_are_those_of_opencv(stretch: float) -> None:
    random = np.random.default_rng(0)
    pixels = random.choice([0, 3, 128, 250, 255], size=(90, 70, 3)).astype(np.uint8)
    place = (np.arange(90) - 41.3) * stretch + 41.3  # outside the photo at both borders where it is more than 1
    map_x, map_y = np.meshgrid(np.arange(70, dtype=np.float32), place.astype(np.float32))
    expected = cv2.remap(pixels, map_x, map_y, cv2.INTER_LANCZOS4, borderMode=cv2.BORDER_REPLICATE)
    assert np.array_equal(resample_rows(pixels, place), expected)


def test_places_may_be_fewer_than_rows() -> None:
    pixels = np.arange(20, dtype=np.uint8)[:, None, None].repeat(9, axis=1).repeat(3, axis=2)
    assert resample_rows(pixels, np.array([4.0, 9.0, 10.0]))[:, 0, 0].tolist() == [4, 9, 10]
