"""Depth in pictures: 16-bit PNG, TIFF of 16 bits or of floating-point numbers; all others are refused by name."""

from pathlib import Path

import numpy as np
from PIL import Image

from linecad.arrays import Bool
from linecad.camera.decoding import quiet_pillow
from linecad.depth.depth_map import WHAT_TO_ASK_FOR, Content, Reading, check_size
from linecad.errors import DepthMapError

PNG_FACTOR = 1 / 256  # m a step: ZoeDepth's and KITTI's
DEPTH_MODES = ("I;16", "I;16B", "I", "F")  # Pillow's names of what holds more than 8 bits a pixel
NARROWEST_GUTTER = 8  # px between two pictures side by side; Depth Anything leaves 50
MOST_GUTTER = 0.2  # of the width
WHITE = 255


def read_picture(path: Path, reading: Reading) -> Content:
    """The depth in a picture of more than 8 bits, of which none tells its kind. Raises DepthMapError and Pillow's."""
    with path.open("rb") as file, quiet_pillow():
        image = Image.open(file)
        check_size(*image.size, path)
        image.load()
        if image.mode not in DEPTH_MODES:
            raise DepthMapError(f"{path} {_what_it_shows(image)}; {WHAT_TO_ASK_FOR}")
        if getattr(image, "n_frames", 1) > 1:
            raise DepthMapError(f"{path} holds several pictures; write its depth alone")
        values = np.asarray(image)
    if values.dtype.kind == "f":
        return Content(values)
    return Content(values * np.float32(PNG_FACTOR if reading.factor is None else reading.factor))


def _what_it_shows(image: Image.Image) -> str:
    """Why a picture of 8 bits is no depth map, as the predicate of its name."""
    pixels = np.asarray(image.convert("RGB"))
    gutter = _gutter((pixels == WHITE).all(axis=(0, 2)))
    if gutter:
        return "shows the photo and its depth side by side, which is for looking at"
    colours = (np.ptp(pixels.astype(np.int16), axis=2) > 0).any()
    return "is a coloured picture, not depth" if colours else "has only 8 bits a pixel, too coarse for depth"


def _gutter(white: Bool) -> bool:
    """Whether white columns (W,) form one band between two pictures."""
    changes = np.flatnonzero(np.diff(white.astype(np.int8)))
    if len(changes) != 2 or white[0] or white[-1]:
        return False
    return bool(NARROWEST_GUTTER <= changes[1] - changes[0] <= MOST_GUTTER * len(white))
