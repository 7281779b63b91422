"""A calibration read from a camera file, and photos and points freed from its distortion.

*matrix* is K of the photo as it was taken, fx and fy possibly different; *square matrix* is K of the photo after the
distortion is gone and its pixels are square: fx on both axes, the same principal point, the same size. Distortion is
OpenCV's: k1 k2 p1 p2 [k3 [k4 k5 k6 [s1 s2 s3 s4 [tau_x tau_y]]]].
"""

from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from linecad.arrays import Float
from linecad.camera.fspy import SUFFIX, read_fspy
from linecad.camera.row_resampling import resample_rows
from linecad.errors import CameraError
from linecad.io import strict_json as strictjson
from linecad.io.strict_json import JsonError, Node

FILE_LIMIT = 10_000_000  # bytes; ground truth files that double as camera files stay below 1 MB
DISTORTION_LENGTHS = (0, 4, 5, 8, 12, 14)
FOCAL_RANGE = (0.1, 50.0)  # of the larger side: a field of view from 169 degrees to 1 degree
PIXEL_RATIO_RANGE = (0.5, 2.0)  # fx / fy; the widest anamorphic lenses stretch by 2
CENTER_MARGIN = 1.0  # of the larger side: how far outside the photo the principal point may lie
NEGLIGIBLE = 1e-3  # px; a difference of fx and fy that moves no pixel by more is rounding
FOLD_GRID = 96  # cells along each side on which the distortion is tested for folding over
REMAP_LIMIT = 32766  # px; cv2.remap takes no longer side
INVERSION_TOLERANCE = 1e-3  # px
NEWTON_STEPS = 8  # from OpenCV's own estimate; each doubles the digits
RAY_STEP = 1e-6  # of the image plane at distance 1, for derivatives
SHAPE = '{"width": px, "height": px, "K": 3 x 3, "distortion": OpenCV coefficients or none}'


@dataclass(frozen=True, eq=False)
class Calibration:
    """What a camera file says about the photo as it was taken."""

    width: int  # px
    height: int  # px
    matrix: Float  # (3, 3) px, no skew
    distortion: tuple[float, ...] = ()  # empty when there is none

    @property
    def square_matrix(self) -> Float:
        """(3, 3) K of the photo once its distortion is gone and its pixels are square."""
        square = self.matrix.copy()
        square[1, 1] = square[0, 0]
        return square

    @property
    def has_square_pixels(self) -> bool:
        """Whether fx and fy agree so well that no pixel has to move."""
        fx, fy = self.matrix[0, 0], self.matrix[1, 1]
        return bool(abs(fy / fx - 1) * self.height <= NEGLIGIBLE)

    @property
    def is_pinhole(self) -> bool:
        """Whether the photo can stay as it is."""
        return self.has_square_pixels and not self.distortion


def check_focal(focal: float, width: int, height: int, found: str) -> None:
    """Raise CameraError unless a focal length in px suits a photo of that size; `found` begins the message."""
    low, high = (share * max(width, height) for share in FOCAL_RANGE)
    if not low <= focal <= high:
        raise CameraError(
            f"{found} is {focal:.6g} px, which does not suit a photo of {width} x {height} px; "
            f"expected {low:.0f} to {high:.0f} px"
        )


def read_calibration(path: Path) -> Calibration:
    """The calibration in a JSON file, of which keys that it does not know are left alone, or in an fSpy project.

    Raises CameraError when the file cannot be read, is malformed, or describes no camera that a photo can come from.
    """
    if path.suffix.lower() == SUFFIX:
        width, height, matrix = read_fspy(path)
        _check_matrix(matrix, width, height, path)
        return Calibration(width, height, matrix)
    try:
        record = strictjson.parse(_read_text(path))
        width, height = record["width"].integer(1), record["height"].integer(1)
        matrix = record["K"].array(3, 3)
        distortion = _distortion(record.get("distortion"))
    except JsonError as error:
        raise CameraError(f"{path}: {error}; a camera file is {SHAPE}") from error
    _check_matrix(matrix, width, height, path)
    calibration = Calibration(width, height, matrix, distortion)
    if distortion and _folds_over(calibration):
        raise CameraError(
            f"the distortion in {path} folds the photo over itself or leaves the range of numbers; "
            "calibrate with fewer coefficients, or check their order (k1 k2 p1 p2 k3 ..)"
        )
    return calibration


def undistort_photo(pixels: NDArray[np.uint8], calibration: Calibration) -> tuple[NDArray[np.uint8], float]:
    """Resample a photo so that it obeys `square_matrix`; same size, border pixels repeated where it shows nothing.

    `pixels` is (H, W, 3). Returns the new pixels and the share of them that lies outside the old photo. Raises
    CameraError when a side is too long for the resampling.
    """
    height, width = pixels.shape[:2]
    if max(width, height) > REMAP_LIMIT:
        raise CameraError(
            f"a photo of {width} x {height} px is too long to be undistorted; scale it (and its calibration) "
            f"down to {REMAP_LIMIT} px"
        )
    coefficients = np.array(calibration.distortion)
    if not calibration.distortion:  # only rows move, and all of a row as its first pixel
        _, column = cv2.initUndistortRectifyMap(
            calibration.matrix, coefficients, None, calibration.square_matrix, (1, height), cv2.CV_32FC1
        )
        place = np.asarray(column[:, 0], np.float64)
        return resample_rows(pixels, place), float(((place < -0.5) | (place > height - 0.5)).mean())
    map_x, map_y = places_taken(calibration)
    straight = cv2.remap(pixels, map_x, map_y, cv2.INTER_LANCZOS4, borderMode=cv2.BORDER_REPLICATE)
    outside = (map_x < -0.5) | (map_x > width - 0.5) | (map_y < -0.5) | (map_y > height - 0.5)
    return np.asarray(straight, np.uint8), float(outside.mean())


def places_taken(calibration: Calibration) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Where every pixel of the undistorted photo lay in the photo as taken: x and y (H, W), px."""
    size = (calibration.width, calibration.height)
    x, y = cv2.initUndistortRectifyMap(
        calibration.matrix, np.array(calibration.distortion), None, calibration.square_matrix, size, cv2.CV_32FC1
    )
    return np.asarray(x, np.float32), np.asarray(y, np.float32)


def distort_points(points: Float, matrix: Float, distortion: tuple[float, ...], new_matrix: Float) -> Float:
    """Where pixels (N, 2) of the undistorted photo (K `new_matrix`) lay in the photo as taken; (N, 2) px."""
    rays = np.column_stack([np.reshape(points, (-1, 2)), np.ones(len(points))]) @ np.linalg.inv(new_matrix).T
    return _project(rays[:, :2] / rays[:, 2:], matrix, distortion)


def undistort_points(points: Float, matrix: Float, distortion: tuple[float, ...], new_matrix: Float) -> Float:
    """Where pixels (N, 2) of the photo as taken (K `matrix`) lie in the undistorted one (K `new_matrix`); (N, 2) px.

    For a photo that `read_photo` read with a camera file, `matrix` and `distortion` are what the file says and
    `new_matrix` is `photo.camera.matrix`. A point that no ray of the model reaches comes back as NaN.
    """
    points = np.asarray(points, np.float64).reshape(-1, 2)
    if len(points) == 0:
        return points
    rays: Float = np.asarray(cv2.undistortPoints(points[:, None], matrix, np.array(distortion)), np.float64)[:, 0]
    # OpenCV stops after five rounds wherever it is; Newton steps finish the work, and what does not get there shows.
    step = RAY_STEP * np.eye(2)
    with np.errstate(all="ignore"):
        for _ in range(NEWTON_STEPS):
            here = _project(rays, matrix, distortion)
            along_x = (_project(rays + step[0], matrix, distortion) - here) / RAY_STEP
            along_y = (_project(rays + step[1], matrix, distortion) - here) / RAY_STEP
            missing = points - here
            step_x, step_y = _cross(missing, along_y), _cross(along_x, missing)
            rays = rays + np.column_stack([step_x, step_y]) / _cross(along_x, along_y)[:, None]
        off = np.linalg.norm(points - _project(rays, matrix, distortion), axis=1)
        straight: Float = rays * np.diag(new_matrix)[:2] + new_matrix[:2, 2]
    straight[~(off < INVERSION_TOLERANCE)] = np.nan
    return straight


def _cross(a: Float, b: Float) -> Float:
    """(..., 2) and (..., 2) to the signed area (...) that they span."""
    area: Float = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return area


def _project(rays: Float, matrix: Float, distortion: tuple[float, ...]) -> Float:
    """Rays (N, 2), x / z and y / z, to distorted pixels (N, 2)."""
    points = np.column_stack([rays, np.ones(len(rays))])
    pixels, _ = cv2.projectPoints(points[:, None], np.zeros(3), np.zeros(3), matrix, np.array(distortion))
    return np.asarray(pixels, np.float64)[:, 0]


def _folds_over(calibration: Calibration) -> bool:
    """Whether two places of the undistorted photo come from one place of the photo as taken.

    Looks at the cells of a grid: the distortion may bend them but not turn them over. This covers the radial part,
    whose distorted radius must grow with the true one, as well as the tangential and tilted parts and any pole.
    """
    x = np.linspace(-0.5, calibration.width - 0.5, FOLD_GRID + 1)
    y = np.linspace(-0.5, calibration.height - 0.5, FOLD_GRID + 1)
    grid = np.stack(np.meshgrid(x, y), axis=-1)
    taken = distort_points(
        grid.reshape(-1, 2), calibration.matrix, calibration.distortion, calibration.square_matrix
    ).reshape(grid.shape)
    if not np.isfinite(taken).all():
        return True
    with np.errstate(all="ignore"):  # coefficients near the end of the range of numbers overflow here: also a fold
        area = _cross(taken[:-1, 1:] - taken[:-1, :-1], taken[1:, :-1] - taken[:-1, :-1])
    return not bool((area > 0).all() and np.isfinite(area).all())


def _read_text(path: Path) -> str:
    """The text of a camera file, or CameraError."""
    try:
        if not path.is_file():
            raise CameraError(f"{path} is {'a folder' if path.is_dir() else 'missing'}; a camera file is {SHAPE}")
        size = path.stat().st_size
        if size > FILE_LIMIT:
            raise CameraError(f"{path} has {size / 1e6:.0f} MB, far too much; a camera file is {SHAPE}")
        return path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as error:
        raise CameraError(f"{path} is not text in UTF-8; a camera file is {SHAPE}") from error
    except OSError as error:
        raise CameraError(f"{path} cannot be read ({error.strerror}); check its permissions") from error


def _distortion(node: Node | None) -> tuple[float, ...]:
    """OpenCV's coefficients; none where there is no list, or all are zero."""
    if node is None or node.value is None:
        return ()
    entries = node.items()
    if len(entries) == 1 and isinstance(entries[0].value, list):
        node = entries[0]  # the 1 x N array that cv2.calibrateCamera returns
    numbers = tuple(node.array(None).tolist())
    if len(numbers) not in DISTORTION_LENGTHS:
        raise node.wrong(f"{', '.join(map(str, DISTORTION_LENGTHS))} coefficients")
    return numbers if any(numbers) else ()


def _check_matrix(matrix: Float, width: int, height: int, path: Path) -> None:
    if matrix[2].tolist() != [0, 0, 1] or matrix[1, 0] != 0:
        raise CameraError(f"{path} has a K that is not [[fx,0,cx],[0,fy,cy],[0,0,1]]; check the order of its entries")
    if matrix[0, 1] != 0:
        raise CameraError(f"{path} has a skew of {matrix[0, 1]:.6g} in K, which linecad does not model; set it to 0")
    for name, focal in (("fx", matrix[0, 0]), ("fy", matrix[1, 1])):
        check_focal(float(focal), width, height, f"{name} in {path}")
    ratio = matrix[0, 0] / matrix[1, 1]
    if not PIXEL_RATIO_RANGE[0] <= ratio <= PIXEL_RATIO_RANGE[1]:
        raise CameraError(f"{path} has fx / fy = {ratio:.4g}, pixels too far from square; check K")
    margin = CENTER_MARGIN * max(width, height)
    x, y = matrix[0, 2], matrix[1, 2]
    if not (-margin <= x <= width + margin and -margin <= y <= height + margin):
        raise CameraError(
            f"{path} has its principal point at ({x:.6g}, {y:.6g}), far outside {width} x {height} px; check K"
        )
