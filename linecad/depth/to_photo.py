"""A depth map laid onto the pixels of a photo, whatever its own size and shape.

A map shows the whole photo: each of its sides counts from 0 to 1 along the photo's, x and y apart, as the networks
that work in squares have it. Every pixel of the photo takes its numbers from the one of the map that it lies in: a
mean across a jump of depth would stand where nothing is.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from linecad.arrays import Float, Int
from linecad.camera.intrinsics import Calibration, places_taken
from linecad.camera.photo import Photo
from linecad.depth.depth_map import DepthMap, Single
from linecad.depth.normals import OUTSIDE, Normals
from linecad.errors import DepthMapError
from linecad.geometry import resized_camera

SAME_SHAPE = 0.02  # share by which the ratios of two sides may differ through rounding and multiples of 14 px
STRIP = 32  # rows
OTHER_SHAPE = 0.1  # from which share on they do not


def map_to_photo(depth: DepthMap, photo: Photo, is_of_undistorted: bool = False) -> DepthMap:
    """The depth of each pixel of the photo, as it was straightened; no depth where that shows nothing of the map.

    The map is of the photo as taken, upright, unless `is_of_undistorted`: then it is of the photo as linecad
    straightened it. Depths themselves stay: they do not hang on where in the photo a point is seen. `intrinsics`
    become those of the photo's size. Raises DepthMapError where the map lies on its side.
    """
    _check_upright(depth, photo)
    if photo.undistortion is None or is_of_undistorted:
        row = _index(np.arange(photo.height), photo.height, depth.height)
        column = _index(np.arange(photo.width), photo.width, depth.width)
        values = depth.values.take(column, axis=1).take(row, axis=0)  # a third of the time of np.ix_
        normals = None if depth.normals is None else depth.normals.laid(row[:, None], column[None])
    else:
        values, normals = _straightened(depth, photo.undistortion)
    return DepthMap(depth.name, values, values > 0, depth.kind, _matrix_in_photo(depth, photo), normals)


def _straightened(depth: DepthMap, undistortion: Calibration) -> tuple[Single, Normals | None]:
    """Values and normals of a map on the pixels of the photo that was straightened by that; 0 where that shows none."""
    x_taken, y_taken = places_taken(undistortion)
    width, height = undistortion.width, undistortion.height
    values, taken = np.empty((height, width), np.float32), depth.values.ravel()
    row_of, column_of = np.empty((2, *((height, width) if depth.normals is not None else (0, 0))), np.int16)
    # Strip by strip: what is made on the way stays in the processor's cache, which halves the time.
    for start in range(0, height, STRIP):
        strip = slice(start, start + STRIP)
        x, y = x_taken[strip], y_taken[strip]
        inside = (x >= -0.5) & (x < width - 0.5) & (y >= -0.5) & (y < height - 0.5)
        row, column = _index(y, height, depth.height), _index(x, width, depth.width)
        values[strip] = taken.take(row * depth.width + column) * inside
        if depth.normals is not None:
            row_of[strip], column_of[strip] = np.where(inside, row, OUTSIDE), column
    return values, None if depth.normals is None else depth.normals.laid(row_of, column_of)


def _index(place: NDArray[Any], length: int, own: int) -> Int:
    """Which of `own` pixels along a side of the map the places along a side of `length` px lie in, the nearest."""
    scale = own / length
    return np.clip(place * scale + 0.5 * scale, 0, own - 1).astype(np.int64)


def _check_upright(depth: DepthMap, photo: Photo) -> None:
    """Raise DepthMapError where a map has the shape of the photo on its side."""
    own, photos = depth.width / depth.height, photo.width / photo.height
    is_turned = abs(own * photos - 1) < SAME_SHAPE
    if is_turned and abs(own / photos - 1) > OTHER_SHAPE:
        raise DepthMapError(
            f"{depth.name} has {depth.width} x {depth.height} px, {photo.name} {photo.width} x {photo.height}: one of "
            "them lies on its side; turn the photo upright for the network"
        )


def _matrix_in_photo(depth: DepthMap, photo: Photo) -> Float | None:
    """The map's K in px of a photo."""
    if depth.intrinsics is None:
        return None
    scale = np.array([photo.width / depth.width, photo.height / depth.height])
    return resized_camera(depth.intrinsics, scale)
