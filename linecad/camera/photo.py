"""A photo read from a file: upright, straightened pixels and what is known of the camera that took it."""

import math
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from linecad.camera.crop_history import Crop, CropHistory, find_crop_history
from linecad.camera.decoding import Decoded, decode_image
from linecad.camera.exif import read_tags
from linecad.camera.exif_focal import ExifFocal, find_exif_focal
from linecad.camera.intrinsics import DISTORTION_LENGTHS, Calibration, check_focal, read_calibration, undistort_photo
from linecad.errors import CameraError
from linecad.geometry import central_camera
from linecad.scene import Camera, CameraSource

OUTSIDE_NOTED = 0.005  # share of the undistorted photo that lies outside the old one; less is not worth a note
OUTSIDE_REFUSED = 0.5
TURNED_NOTE = "the photo was turned by its EXIF orientation; the camera file is taken to be for the turned photo"


@dataclass(frozen=True)
class Bend:
    """A radial distortion about a point: r (1 + radial (r / half)^2) for r, with half of the diagonal, px."""

    radial: float  # share of half the diagonal by which a point that far out was moved out; negative is a barrel
    radial_error: float  # standard error
    center: tuple[float, float]  # px, also the principal point
    center_error: float  # px, standard error of each coordinate


@dataclass(frozen=True, eq=False)
class Photo:
    """A photo in which everything can be measured."""

    name: str  # file name, without its folder
    pixels: NDArray[np.uint8]  # (H, W, 3) RGB, read-only; upright, undistorted, square pixels
    camera: Camera | None  # None: the focal length must come from the vanishing points
    notes: tuple[str, ...] = ()  # warnings: what did not stop the work
    exif_focal: ExifFocal | None = None  # None where EXIF tells nothing or the camera was given
    crop: Crop = "unknown"  # whether parts were cut off since the photo was taken, so that its middle moved
    bend: Bend | None = None  # the distortion that was taken out because the photo's own lines showed it
    is_fisheye: bool = False  # its own lines showed more distortion than one coefficient can take out
    undistortion: Calibration | None = None  # by which its pixels were moved (`places_taken`); None: they were not

    def __post_init__(self) -> None:
        if self.pixels.dtype != np.uint8 or self.pixels.ndim != 3 or self.pixels.shape[2] != 3:
            raise ValueError(f"Photo.pixels is {self.pixels.dtype} {self.pixels.shape}, expected uint8 (H, W, 3)")
        pixels = self.pixels.view()
        pixels.flags.writeable = False
        object.__setattr__(self, "pixels", pixels)

    @property
    def width(self) -> int:
        """Width in px."""
        return int(self.pixels.shape[1])

    @property
    def height(self) -> int:
        """Height in px."""
        return int(self.pixels.shape[0])

    def removed_distortion(self, focal: float) -> tuple[float, ...]:
        """OpenCV's coefficients of the bend that was taken out, for a focal length in px; none where none was."""
        if self.bend is None:
            return ()
        half = math.hypot(self.width, self.height) / 2
        return (self.bend.radial * (focal / half) ** 2, 0.0, 0.0, 0.0)

    @cached_property
    def grey(self) -> NDArray[np.uint8]:
        """(H, W) luminance, read-only."""
        grey: NDArray[np.uint8] = np.asarray(cv2.cvtColor(self.pixels, cv2.COLOR_RGB2GRAY), np.uint8)
        grey.flags.writeable = False
        return grey


def read_photo(path: Path, camera_file: Path | None = None, focal: float | None = None) -> Photo:
    """Read a photo; the camera comes from `camera_file`, else from `focal` (px), else from EXIF, else it stays None.

    With a camera file the photo is undistorted and its pixels are made square. Raises PhotoError when the file is no
    photo that linecad takes, and CameraError when the camera is malformed, does not belong to the photo, or is given
    twice.
    """
    path = Path(path)
    if camera_file is not None and focal is not None:
        raise CameraError("both a camera file and a focal length were given; give one of them")
    calibration = None if camera_file is None else read_calibration(Path(camera_file))
    decoded = decode_image(path)
    height, width = decoded.pixels.shape[:2]
    tags = read_tags(decoded.exif)
    history = find_crop_history(tags, width, height, decoded.turned)
    if calibration is not None:
        _check_belongs(calibration, f"{camera_file}", decoded, f"{path}")
        photo = _calibrated(path.name, decoded, calibration, f"{camera_file}", "as the camera file says")
        notes = (TURNED_NOTE, *photo.notes) if decoded.turned else photo.notes
        return replace(photo, crop=history.crop, notes=notes)
    if focal is not None:
        check_focal(focal, width, height, "the focal length")
        given = _centred_camera(width, height, focal, "focal option")
        return Photo(path.name, decoded.pixels, given, decoded.notes + _history_notes(history), None, history.crop)
    exif_focal, told = find_exif_focal(tags, history, width, height)
    camera = None if exif_focal is None else _centred_camera(width, height, exif_focal.focal, "exif")
    notes = decoded.notes + told + _history_notes(history, exif_focal)
    return Photo(path.name, decoded.pixels, camera, notes, exif_focal, history.crop)


def read_photo_of(path: Path, camera: Camera) -> Photo:
    """Read a photo again with the camera that a scene has, as `linecad.camera.distortion.open_photo` made it at first.

    The camera stays as it is, with its source and its distortion. Raises PhotoError when the file is no photo that
    linecad takes, and CameraError when it has another size or the distortion is not OpenCV's.
    """
    path = Path(path)
    if len(camera.distortion) not in DISTORTION_LENGTHS:
        raise CameraError(
            f"the camera of the scene has {len(camera.distortion)} coefficients of distortion, expected "
            f"{', '.join(map(str, DISTORTION_LENGTHS))}; make the scene again, or give the calibration with --camera"
        )
    decoded = decode_image(path)
    matrix = camera.matrix.copy()
    if camera.taken_fy is not None:
        matrix[1, 1] = camera.taken_fy
    calibration = Calibration(camera.width, camera.height, matrix, camera.distortion)
    _check_belongs(calibration, "the scene", decoded, f"{path}")
    return replace(_calibrated(path.name, decoded, calibration, "the scene", "as in the scene"), camera=camera)


def _history_notes(history: CropHistory, exif_focal: ExifFocal | None = None) -> tuple[str, ...]:
    """What the photo went through, where its focal length or principal point hangs on it."""
    if history.crop == "cropped":
        return (f"{history.remark}; its principal point may lie off the middle",)
    return (history.remark,) if exif_focal and history.remark else ()


def _centred_camera(width: int, height: int, focal: float, source: CameraSource) -> Camera:
    """A camera with its principal point in the middle of the photo."""
    return Camera(width, height, central_camera(focal, width, height), source)


def _check_belongs(calibration: Calibration, camera_name: str, decoded: Decoded, photo_name: str) -> None:
    height, width = decoded.pixels.shape[:2]
    size = (calibration.width, calibration.height)
    if size == (width, height):
        return
    found = f"{camera_name} is for {size[0]} x {size[1]} px, {photo_name} has {width} x {height} px"
    if size == (height, width):
        if decoded.turned:
            raise CameraError(
                f"{found} because its EXIF orientation turns it; give the calibration of the turned photo"
            )
        raise CameraError(f"{found}: one of them lies on its side; turn it")
    raise CameraError(f"{found}; give the calibration of this photo at this size")


def _calibrated(name: str, decoded: Decoded, calibration: Calibration, camera_name: str, why: str) -> Photo:
    """The photo with the distortion of its calibration removed and its pixels made square."""
    pixels, notes = decoded.pixels, list(decoded.notes)
    if not calibration.is_pinhole:
        pixels, outside = undistort_photo(pixels, calibration)
        done = ["lens distortion removed"] if calibration.distortion else []
        done += [] if calibration.has_square_pixels else ["pixels made square"]
        notes.append(" and ".join(done) + f", {why}")
        if outside > OUTSIDE_REFUSED:
            raise CameraError(
                f"after the distortion in {camera_name} is removed, {outside:.0%} of the picture lies outside {name}; "
                "check the coefficients and their order"
            )
        if outside > OUTSIDE_NOTED:
            notes.append(
                f"{outside:.1%} of the undistorted photo lies outside the photo as taken and repeats its border"
            )
    camera = Camera(
        calibration.width,
        calibration.height,
        calibration.square_matrix,
        "file",
        calibration.distortion,
        not calibration.has_square_pixels,
        None if calibration.matrix[1, 1] == calibration.matrix[0, 0] else float(calibration.matrix[1, 1]),
    )
    undistortion = None if calibration.is_pinhole else calibration
    return Photo(name, pixels, camera, tuple(notes), undistortion=undistortion)
