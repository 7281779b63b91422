"""What a camera makes of radiance: exposure, a soft lens, darker corners, a tone curve, noise, JPEG."""

from pathlib import Path

import cv2
import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from linecad.dataset.textures import Image

MIDDLE_GREY = 0.26  # where the mean logarithm of the light is put
BLUR = (0.35, 0.7)  # px at REFERENCE, standard deviation of the lens
REFERENCE = 1920.0  # px
VIGNETTE = (0.05, 0.25)  # loss of light in the corners
SHOT_NOISE = (0.6e-4, 2.5e-4)  # variance of the light per light
READ_NOISE = 2e-6  # variance of the light
QUALITY = (88, 96)  # of the JPEG file


def develop(radiance: Image, rng: Generator) -> NDArray[np.uint8]:
    """A photo (H, W, 3), 8 bit BGR, of linear radiance (H, W, 3)."""
    height, width = radiance.shape[:2]
    luminance = radiance @ np.array([0.2126, 0.7152, 0.0722], np.float32)
    image = radiance * (MIDDLE_GREY * rng.uniform(0.8, 1.25) / np.exp(np.log(luminance + 1e-3).mean()))
    blur = rng.uniform(*BLUR) * max(width / REFERENCE, 0.5)
    image = cv2.GaussianBlur(image.astype(np.float32), (0, 0), blur)
    y, x = np.mgrid[:height, :width]
    off_axis = ((x - width / 2) ** 2 + (y - height / 2) ** 2) / (width**2 + height**2) * 4
    image = image * (1 - rng.uniform(*VIGNETTE) * off_axis)[..., None]
    image = 1.25 * image * (1 + image / 9) / (1 + image)  # rolls highlights off
    deviation = np.sqrt(rng.uniform(*SHOT_NOISE) * np.maximum(image, 0) + READ_NOISE)
    image = np.clip(image + deviation * rng.standard_normal(image.shape), 0, 1)
    encoded = np.where(image <= 0.0031308, 12.92 * image, 1.055 * image ** (1 / 2.4) - 0.055)
    return np.ascontiguousarray((255 * encoded + 0.5).astype(np.uint8)[..., ::-1])


def write_photo(photo: NDArray[np.uint8], path: Path, rng: Generator) -> None:
    """Write a photo (H, W, 3), BGR, as JPEG. Raises OSError where it cannot be written."""
    quality = int(rng.integers(*QUALITY))
    done, data = cv2.imencode(".jpg", photo, [cv2.IMWRITE_JPEG_QUALITY, quality])
    assert done
    path.write_bytes(data.tobytes())
