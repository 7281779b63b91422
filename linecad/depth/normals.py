"""Normals of surfaces: in MoGe's `normal.png`, where 127 gray stands for none, and of length 1.

Frame: the camera's, x right, y down, z forward. MoGe colours a normal by (x, -y, -z), from -1 to 1 as 0 to 255.
"""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from linecad.camera.decoding import quiet_pillow
from linecad.depth.depth_map import Single, check_size
from linecad.errors import DepthMapError

NO_NORMAL = 127  # of red, green and blue
STEPS = 255
SIGNS = np.array([1, -1, -1], np.float32)
LENGTHS = (0.5, 1.5)  # of a vector that means a normal; others are fillings


def read_normal_picture(path: Path, width: int, height: int) -> Single:
    """The normals (H, W, 3) of a map of that size in a picture; 0 where there is none. Raises DepthMapError."""
    with path.open("rb") as file, quiet_pillow():
        image = Image.open(file)
        check_size(*image.size, path)
        if image.size != (width, height) or image.mode != "RGB":
            raise DepthMapError(
                f"{path} is a picture of {image.size[0]} x {image.size[1]} px ({image.mode}), expected normals of "
                f"{width} x {height} px in RGB as the depth beside it; make both again, or move it away"
            )
        pixels = np.asarray(image)
    # Its writer cut off the fraction: the middle of a step is nearest to what was there.
    vectors = ((pixels + np.float32(0.5)) * np.float32(2 / STEPS) - 1) * SIGNS
    vectors[(pixels == NO_NORMAL).all(axis=2)] = 0
    return unit_normals(vectors)


def unit_normals(vectors: NDArray[Any]) -> Single:
    """Vectors (H, W, 3) with length 1; 0 where they are far from it, or not numbers."""
    normals = vectors.astype(np.float32)
    with np.errstate(all="ignore"):
        length = np.sqrt(np.einsum("ijk,ijk->ij", normals, normals))
        good = (length > LENGTHS[0]) & (length < LENGTHS[1])
        return np.where(good[..., None], normals / length[..., None], np.float32(0))
