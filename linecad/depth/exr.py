"""Depth in OpenEXR files, as MoGe writes them: one channel of depth, or the points of the pixels in R, G and B.

Format: https://github.com/AcademySoftwareFoundation/openexr. Needs the extra `depth`.
"""

from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR
from numpy.typing import NDArray

from linecad.depth.depth_map import MOST_BYTES, WHAT_TO_ASK_FOR, Content, Reading, check_size
from linecad.depth.intrinsics import matrix_of_points
from linecad.errors import DepthMapError

BYTES_A_NUMBER = 4
DEPTH_CHANNELS = ("Y", "Z")
POINT_CHANNELS = ("R", "G", "B")


def read_exr(path: Path, _reading: Reading) -> Content:
    """The depth in an .exr; only points tell their kind. Raises DepthMapError, and what OpenEXR trips over."""
    with OpenEXR.File(str(path), header_only=True) as file:
        _check_header([part.header for part in file.parts], path)
    with OpenEXR.File(str(path), separate_channels=True) as file:
        channels = {name: channel.pixels for name, channel in file.channels().items()}
    sizes = {pixels.shape for pixels in channels.values()}
    if len(sizes) != 1 or len(min(sizes)) != 2:
        raise DepthMapError(f"{path} has channels of different sizes; write its depth alone")
    for name in DEPTH_CHANNELS:
        if name in channels:
            return Content(channels[name])
    if not all(name in channels for name in POINT_CHANNELS):
        held = ", ".join(sorted(channels))
        raise DepthMapError(f"{path} has channels {held}; expected depth in Y or Z, or points in R, G, B")
    return _of_points(np.stack([channels[name] for name in POINT_CHANNELS], axis=-1), path)


def _check_header(headers: list[dict[str, Any]], path: Path) -> None:
    """Raise DepthMapError where the pixels would not fit, or are not one plain picture."""
    if len(headers) != 1 or headers[0]["type"] not in (OpenEXR.scanlineimage, OpenEXR.tiledimage):
        raise DepthMapError(f"{path} holds several pictures or deep ones; write its depth alone")
    (left, top), (right, bottom) = (corner.tolist() for corner in headers[0]["dataWindow"])
    (left_shown, top_shown), (right_shown, bottom_shown) = (c.tolist() for c in headers[0]["displayWindow"])
    width, height = right - left + 1, bottom - top + 1
    check_size(width, height, path)
    if (left, top, right, bottom) != (left_shown, top_shown, right_shown, bottom_shown):
        raise DepthMapError(f"{path} holds only a part of its picture; write all of it")
    if width * height * len(headers[0]["channels"]) * BYTES_A_NUMBER > MOST_BYTES:
        raise DepthMapError(f"{path} has {len(headers[0]['channels'])} channels, too many; write its depth alone")


def _of_points(points: NDArray[Any], path: Path) -> Content:
    """The depth of points (H, W, 3); where all three channels are the same they are one of depth."""
    if np.array_equal(points[..., 0], points[..., 1], equal_nan=True) and np.array_equal(
        points[..., 0], points[..., 2], equal_nan=True
    ):
        return Content(points[..., 0])
    matrix = matrix_of_points(points)
    if matrix is None:
        raise DepthMapError(f"{path} holds colours, not points before a camera; {WHAT_TO_ASK_FOR}")
    return Content(points[..., 2], "z", matrix)
