"""Depth in .npz and .npy files, by the names and shapes that networks give it."""

import zipfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from linecad.arrays import Float
from linecad.depth.arrays_in_files import Archive, read_npy
from linecad.depth.depth_map import SMALLEST_SIDE, WHAT_TO_ASK_FOR, Content, Kind, Reading, check_size
from linecad.depth.intrinsics import camera_matrix, matrix_of_points
from linecad.errors import DepthMapError
from linecad.geometry import central_camera

# What networks call their depth, the first that is there counts; and what such a name tells of its kind.
KIND_OF_NAME: dict[str, Kind | None] = {
    "depth": None, "depth_map": None, "predicted_depth": None, "points": "z", "disparity": "affine-inverse",
}  # fmt: skip
MATRICES = ("intrinsics", "K", "intrinsics_norm")
FOCAL = "focallength_px"
NORMALS = ("normal", "normals")
MASK = "mask"
COLOUR_CHANNELS = (3, 4)


def read_npz_depth(path: Path, reading: Reading) -> Content:
    """The depth in an .npz and what stands beside it. Raises DepthMapError."""
    with zipfile.ZipFile(path) as file:
        archive = Archive(path, file)
        name = _depth_name(archive, reading)
        view = reading.view
        content = _content(archive.read(name), view, name, path)
        height, width = content.values.shape
        kind = KIND_OF_NAME.get(name) or content.kind
        matrix = _matrix(archive, view, width, height)
        if kind is None and name != "predicted_depth" and (matrix is not None or "points" in archive):
            kind = "z"  # only networks of cameras and points write these, and their depth is z
        matrix = content.intrinsics if matrix is None else matrix
        normals = _beside(archive, NORMALS, view, (height, width, 3))
        mask = _beside(archive, (MASK,), view, (height, width))
        if mask is not None and mask.dtype != np.bool_:
            mask = None  # a mask in numbers means something else in each program
    return Content(content.values, kind, matrix, normals, mask)


def read_npy_depth(path: Path, reading: Reading) -> Content:
    """The depth in an .npy, which tells its kind only where it holds points. Raises DepthMapError."""
    return _content(read_npy(path), reading.view, "the array", path)


def _depth_name(archive: Archive, reading: Reading) -> str:
    """Which array of the archive holds the depth."""
    held = ", ".join(archive.shapes) or "nothing that is made of numbers"
    if reading.array is not None:
        if reading.array not in archive:
            raise DepthMapError(f"{archive.path} holds {held}, but no array {reading.array}; name one that is there")
        return reading.array
    named = [name for name in KIND_OF_NAME if name in archive]
    large = [name for name, shape in archive.shapes.items() if sum(side >= SMALLEST_SIDE for side in shape) >= 2]
    if not named and len(large) != 1:
        raise DepthMapError(f"{archive.path} holds {held}; say which array is the depth, or name it depth")
    return (named or large)[0]


def _content(array: NDArray[Any], view: int | None, name: str, path: Path) -> Content:
    """The map (H, W) in an array of one of the shapes in use."""
    array = _one_view(array, view, name, path)
    is_points = array.ndim == 3 and array.shape[2] in COLOUR_CHANNELS
    if array.ndim != 2 and not is_points:
        raise DepthMapError(f"{name} of {path} has shape {_shape(array)}, expected that of a map, height x width")
    check_size(array.shape[1], array.shape[0], path)
    if array.dtype.itemsize == 1:
        kind = "a coloured picture" if is_points else "a picture of 8 bits a pixel"
        raise DepthMapError(f"{path} holds {kind}, too coarse for depth; {WHAT_TO_ASK_FOR}")
    if not is_points:
        return Content(array)
    matrix = matrix_of_points(array[..., :3])
    if matrix is None and name != "points":
        raise DepthMapError(f"{path} holds colours or other triples, not points before a camera; {WHAT_TO_ASK_FOR}")
    return Content(array[..., 2], "z", matrix)


def _one_view(array: NDArray[Any], view: int | None, name: str, path: Path) -> NDArray[Any]:
    """The array of one photo, without axes of length 1."""
    squeezed = array.squeeze()
    has_views = squeezed.ndim == 4 or (squeezed.ndim == 3 and squeezed.shape[2] not in COLOUR_CHANNELS)
    if not has_views:
        if view not in (None, 0):
            raise DepthMapError(f"{name} of {path} is of one photo, but photo {view} was asked for; ask for 0")
        return squeezed
    if squeezed.ndim == 3 and squeezed.shape[0] in COLOUR_CHANNELS and view is None and name == "points":
        return np.moveaxis(squeezed, 0, 2)
    count = len(squeezed)
    if view is None or not 0 <= view < count:
        raise DepthMapError(f"{path} holds the depth of {count} photos; say which one, from 0 to {count - 1}")
    one: NDArray[Any] = squeezed[view]
    return one


def _beside(archive: Archive, names: tuple[str, ...], view: int | None, shape: tuple[int, ...]) -> NDArray[Any] | None:
    """An array that belongs to the depth, of this shape for each photo; None where there is none."""
    for name in names:
        if name in archive and archive.shapes[name][-len(shape) :] == shape:
            array = archive.read(name).reshape(-1, *shape)
            if (view or 0) < len(array):
                one: NDArray[Any] = array[view or 0]
                return one
    return None


def _matrix(archive: Archive, view: int | None, width: int, height: int) -> Float | None:
    """K in px of the map, where one stands beside the depth."""
    for name in MATRICES:
        found = _beside(archive, (name,), view, (3, 3))
        matrix = None if found is None else camera_matrix(found, width, height)
        if matrix is not None:
            return matrix
    focal = float(archive.read(FOCAL).flat[0]) if FOCAL in archive and archive.shapes[FOCAL] in ((), (1,)) else 0.0
    return central_camera(focal, width, height) if 0 < focal < np.inf else None


def _shape(array: NDArray[Any]) -> str:
    return " x ".join(map(str, array.shape)) or "of a single number"
