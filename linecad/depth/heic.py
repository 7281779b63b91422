"""The depth image that phones put into a HEIC photo. Needs the extra `depth`.

Format: ISO/IEC 23008-12, an auxiliary image; what its steps mean stands in H.265's depth representation message.
"""

from pathlib import Path
from typing import Any

import numpy as np
import pillow_heif
from numpy.typing import NDArray

from linecad.depth.depth_map import Content, Kind, Reading, check_size
from linecad.errors import DepthMapError

INVERSE_Z, DISPARITY = 0, 1  # H.265's types of depth representation


def read_heic(path: Path, _reading: Reading) -> Content:
    """The depth image of a HEIC photo. Raises DepthMapError, and what libheif trips over."""
    photo = pillow_heif.open_heif(path, convert_hdr_to_8bit=False)  # decodes nothing yet
    images = photo.info["depth_images"]
    if not images:
        raise DepthMapError(f"{path} holds no depth image; take the photo in portrait mode, or ask a network for depth")
    width, height = images[0].size
    check_size(width, height, path)
    steps = np.asarray(images[0])
    if steps.ndim != 2:
        raise DepthMapError(f"{path} holds a coloured depth image, not steps of depth; ask a network for depth")
    # More than 8 bits come moved up to 16, and their last step falls short of it by 0.1 %, less than a phone can see.
    values, kind = _meaning(steps, np.iinfo(steps.dtype).max, images[0].info["metadata"], path)
    return Content(values, kind)


def _meaning(steps: NDArray[Any], last: int, told: dict[str, Any], path: Path) -> tuple[NDArray[Any], Kind | None]:
    """What steps from 0 to `last` stand for, and of which kind that is."""
    code = told.get("representation_type")
    if code is None:
        return steps, None
    if code not in (INVERSE_Z, DISPARITY):
        raise DepthMapError(f"{path} codes its depth in a way that linecad does not know; ask a network for depth")
    shares = steps / np.float32(last)
    near, far = told.get("z_near"), told.get("z_far")
    if code == INVERSE_Z and near is not None and far is not None and 0 < near < far:
        return shares * (1 / near - 1 / far) + 1 / far, "inverse"
    low, high = told.get("d_min"), told.get("d_max")
    if code == DISPARITY and low is not None and high is not None and low < high:
        return shares * (high - low) + low, "affine-inverse"
    return steps, "affine-inverse"
