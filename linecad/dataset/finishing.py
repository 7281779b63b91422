"""What a camera makes of radiance: exposure, a soft lens, darker corners, a tone curve, noise, JPEG.

A renderer of few samples a pixel leaves more noise than any camera, which parts the segments that a detector finds. It
is taken out first: single bright pixels by a median, the rest by non-local means, as cameras themselves do.
"""

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
FIREFLY = 2.5  # times the median around it, from which a pixel's light is the renderer's accident
MEDIAN = 5  # px, its width
RENDER_NOISE = 22.0  # of 255 with one sample a pixel; it falls with the root of their number
PATCH, SEARCH = 5, 15  # px, widths that non-local means compares and looks in
QUALITY = (88, 96)  # of the JPEG file


def develop(radiance: Image, samples: int, rng: Generator) -> NDArray[np.uint8]:
    """A photo (H, W, 3), 8 bit BGR, of linear radiance (H, W, 3) rendered with so many samples a pixel."""
    radiance = _without_fireflies(radiance)
    height, width = radiance.shape[:2]
    luminance = radiance @ np.array([0.2126, 0.7152, 0.0722], np.float32)
    image = radiance * (MIDDLE_GREY * rng.uniform(0.8, 1.25) / np.exp(np.log(luminance + 1e-3).mean()))
    blur = rng.uniform(*BLUR) * max(width / REFERENCE, 0.5)
    image = cv2.GaussianBlur(image.astype(np.float32), (0, 0), blur)
    y, x = np.mgrid[:height, :width]
    off_axis = ((x - width / 2) ** 2 + (y - height / 2) ** 2) / (width**2 + height**2) * 4
    image = image * (1 - rng.uniform(*VIGNETTE) * off_axis)[..., None]
    image = 1.25 * image * (1 + image / 9) / (1 + image)  # rolls highlights off
    image = _decode(_denoise(_encode(image), samples))
    deviation = np.sqrt(rng.uniform(*SHOT_NOISE) * np.maximum(image, 0) + READ_NOISE)
    return np.ascontiguousarray(
        _encode((image + deviation * rng.standard_normal(image.shape)).astype(np.float32))[..., ::-1]
    )


def _without_fireflies(radiance: Image) -> Image:
    around = np.stack([cv2.medianBlur(np.ascontiguousarray(radiance[..., k]), MEDIAN) for k in range(3)], axis=-1)
    is_firefly = radiance.sum(axis=-1) > FIREFLY * around.sum(axis=-1)
    return np.where(is_firefly[..., None], around, radiance)


def _denoise(encoded: NDArray[np.uint8], samples: int) -> NDArray[np.uint8]:
    strength = RENDER_NOISE / samples**0.5
    return np.asarray(cv2.fastNlMeansDenoisingColored(encoded, None, strength, strength, PATCH, SEARCH), np.uint8)


def _encode(light: Image) -> NDArray[np.uint8]:
    """8 bits by the curve of sRGB."""
    clipped = np.clip(light, 0, 1)
    encoded = np.where(clipped <= 0.0031308, 12.92 * clipped, 1.055 * clipped ** (1 / 2.4) - 0.055)
    return (255 * encoded + 0.5).astype(np.uint8)


def _decode(encoded: NDArray[np.uint8]) -> Image:
    value = encoded.astype(np.float32) / 255
    light: Image = np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4).astype(np.float32)
    return light


def write_photo(photo: NDArray[np.uint8], path: Path, rng: Generator) -> None:
    """Write a photo (H, W, 3), BGR, as JPEG. Raises OSError where it cannot be written."""
    quality = int(rng.integers(*QUALITY))
    done, data = cv2.imencode(".jpg", photo, [cv2.IMWRITE_JPEG_QUALITY, quality])
    assert done
    path.write_bytes(data.tobytes())
