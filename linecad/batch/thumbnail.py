"""A small picture of a photo for the page of a batch, and beside it the photo with its lines."""

from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from exporters.colours import line_colour
from linecad.io.files import write_bytes_atomically
from linecad.scene import Scene

WIDTH, HEIGHT = 320, 240  # px, at most, of each half
QUALITY = 80  # of the JPEG
PALE = 0.55  # of the photo's colours are kept under the lines
FRACTION_BITS = 4  # of the coordinates that OpenCV draws with


def write_thumbnail(path: Path, pixels: NDArray[np.uint8], scene: Scene | None) -> None:
    """Write the small picture of a photo (H, W, 3), and of its scene if there is one. Raises OutputError."""
    height, width = pixels.shape[:2]
    scale = min(WIDTH / width, HEIGHT / height, 1.0)
    size = (max(round(width * scale), 1), max(round(height * scale), 1))
    small = np.asarray(cv2.resize(pixels, size, interpolation=cv2.INTER_AREA), np.uint8)
    halves = [small] if scene is None else [small, _with_lines(small, scene)]
    found, data = cv2.imencode(".jpg", np.hstack(halves)[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, QUALITY])
    assert found, "a small picture of 8 bits can always be encoded"
    write_bytes_atomically(path, data.tobytes())


def _with_lines(small: NDArray[np.uint8], scene: Scene) -> NDArray[np.uint8]:
    """The small photo, pale, with the segments of the scene's lines in the colours of their axes."""
    height, width = small.shape[:2]
    drawn = (small * PALE + 255 * (1 - PALE)).astype(np.uint8)
    lines = scene.lines
    scale = np.array([width / scene.camera.width, height / scene.camera.height])
    # Pixel centres lie at whole numbers in both pictures.
    ends = np.round(((lines.segment + 0.5) * scale - 0.5) * 2**FRACTION_BITS)
    ends = np.clip(ends, -(2**20), 2**20).astype(np.int64)  # OpenCV takes no coordinates far outside
    for axis, boundary, (start, end) in zip(lines.axis, lines.is_boundary, ends, strict=True):
        colour = [round(255 * part) for part in line_colour(int(axis), bool(boundary))]
        cv2.line(drawn, start.tolist(), end.tolist(), colour, 1, cv2.LINE_AA, FRACTION_BITS)
    return drawn
