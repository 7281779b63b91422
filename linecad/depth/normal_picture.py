"""Normals in MoGe's `normal.png`, beside its depth."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from linecad.camera.decoding import quiet_pillow
from linecad.depth.depth_map import check_size
from linecad.errors import DepthMapError


def read_normal_picture(path: Path, width: int, height: int) -> NDArray[np.uint8]:
    """The colours (H, W, 3) of the normals of a map of that size. Raises DepthMapError."""
    with path.open("rb") as file, quiet_pillow():
        image = Image.open(file)
        check_size(*image.size, path)
        if image.size != (width, height) or image.mode != "RGB":
            raise DepthMapError(
                f"{path} is a picture of {image.size[0]} x {image.size[1]} px ({image.mode}), expected normals of "
                f"{width} x {height} px in RGB as the depth beside it; make both again, or move it away"
            )
        return np.asarray(image)
