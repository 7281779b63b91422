"""Camera matrices that stand beside depth, the one that points in space tell, and how they agree with the camera."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from linecad.arrays import Float
from linecad.depth.depth_map import DepthMap
from linecad.geometry import central_camera
from linecad.scene import Camera

OTHER_FOCAL = 0.05  # share of the camera's focal length by which that of a map may differ without a note
PINHOLE_MISFIT = 0.01  # of the width, px; points that lie further off the pixels' rays come from another camera
FEWEST_POINTS = 100
MOST_POINTS = 20_000  # of the points, evenly taken: enough for four numbers


def camera_matrix(found: NDArray[Any], width: int, height: int) -> Float | None:
    """K (3, 3) in px of a map of that size, of a matrix in px or in widths and heights; None where it is no K."""
    matrix = np.array(found, np.float64)
    if matrix.shape != (3, 3) or not np.isfinite(matrix).all():
        return None
    if min(matrix[0, 0], matrix[1, 1]) <= 0 or matrix[1, 0] != 0 or matrix[2].tolist() != [0, 0, 1]:
        return None
    if max(matrix[0, 2], matrix[1, 2]) <= 1:  # no principal point lies in the first pixel: these are shares (MoGe)
        matrix[0] *= width
        matrix[1] *= height
    return matrix


def matrix_of_angles(horizontal: float, vertical: float, width: int, height: int) -> Float:
    """K (3, 3) in px of a map with these fields of view, rad, its principal point in the middle."""
    matrix = central_camera(width / 2 / math.tan(horizontal / 2), width, height)
    matrix[1, 1] = height / 2 / math.tan(vertical / 2)
    return matrix


def matrix_of_points(points: NDArray[Any]) -> Float | None:
    """K (3, 3) in px of the pinhole whose rays points (H, W, 3) lie on; None where they lie on no pinhole's.

    x runs right, y down, z forward; a pixel without a point has a z of 0 or less, or not finite.
    """
    width = points.shape[1]
    flat = points.reshape(-1, 3)
    chosen = np.linspace(0, len(flat) - 1, min(MOST_POINTS, len(flat))).astype(np.int64)
    x, y, z = flat[chosen].astype(np.float64).T
    with np.errstate(all="ignore"):
        across, down = x / z, y / z
        good = (z > 0) & np.isfinite(across) & np.isfinite(down)
        good &= (abs(across) < width) & (abs(down) < width)  # rays beside which numbers mean nothing
    if good.sum() < FEWEST_POINTS:
        return None
    row, column = np.divmod(chosen[good], width)
    matrix = np.eye(3)
    for axis, (slope, pixel) in enumerate(((across[good], column), (down[good], row))):
        fit = _line(slope, pixel)
        if fit is None or np.abs(fit[0] * slope + fit[1] - pixel).mean() > PINHOLE_MISFIT * width:
            return None
        matrix[axis, axis], matrix[axis, 2] = fit
    return matrix


def _line(slope: Float, pixel: NDArray[np.int64]) -> tuple[float, float] | None:
    """Focal length and center with pixel ~ focal slope + center; None where they do not grow together."""
    spread = slope - slope.mean()
    variance = float(spread @ spread)
    if variance == 0:
        return None
    focal = float(spread @ (pixel - pixel.mean())) / variance
    return (focal, float(pixel.mean() - focal * slope.mean())) if 0 < focal < np.inf else None


def note_on_intrinsics(depth: DepthMap, camera: Camera) -> tuple[str, ...]:
    """A note where a map on the photo's pixels was made with another focal length than the camera's, else none."""
    if depth.intrinsics is None:
        return ()
    # Of a map that was stretched to the photo, the two may differ a little.
    focal = math.sqrt(depth.intrinsics[0, 0] * depth.intrinsics[1, 1])
    off = focal / camera.focal - 1
    if abs(off) <= OTHER_FOCAL:
        return ()
    return (
        f"the depth map was made with a focal length of {focal:.0f} px, {abs(off):.0%} "
        f"{'more' if off > 0 else 'less'} than the camera's {camera.focal:.0f} px; hand that to the network, or give "
        "--focal",
    )
