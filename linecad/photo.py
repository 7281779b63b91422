"""A photo read from a file: upright, straightened pixels and what is known of the camera that took it."""

import math
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Literal

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import ExifTags

from linecad.calibration import FOCAL_RANGE, Calibration, check_focal, read_calibration, undistort_photo
from linecad.decoding import Decoded, decode_image
from linecad.errors import CameraError
from linecad.geometry import DIAGONAL_35MM, central_camera
from linecad.scene import Camera, CameraSource

Framing = Literal["whole", "cropped", "unknown"]

ASPECT_TOLERANCE = 0.01  # relative; rounding to whole pixels changes the aspect of a scaled photo by less
SCALE_TOLERANCE = 0.002  # relative; below it a photo counts as not resized
RESOLUTION_TOLERANCE = 0.02  # relative; sensor resolutions that differ by more along x and y contradict each other
OUTSIDE_NOTED = 0.005  # share of the undistorted photo that lies outside the old one; less is not worth a note
OUTSIDE_REFUSED = 0.5
MM_PER_RESOLUTION_UNIT = {2: 25.4, 3: 10.0, 4: 1.0, 5: 0.001}  # EXIF FocalPlaneResolutionUnit: inch, cm, mm, um


@dataclass(frozen=True)
class FocalHint:
    """What EXIF says of the focal length, and how far to trust it."""

    focal: float  # px, of this photo
    relative_error: float  # standard error over focal length
    origin: str  # where it stands, in words that fit after "focal length from"


@dataclass(frozen=True, eq=False)
class Photo:
    """A photo in which everything can be measured."""

    name: str  # file name, without its folder
    pixels: NDArray[np.uint8]  # (H, W, 3) RGB, read-only; upright, undistorted, square pixels
    camera: Camera | None  # None: the focal length must come from the vanishing points
    notes: tuple[str, ...] = ()  # doubts that did not stop the work
    hint: FocalHint | None = None  # where the camera is that of EXIF; also of a photo whose camera is None
    framing: Framing = "unknown"  # whether parts were cut off since the photo was taken, so that its middle moved

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
    if calibration is not None:
        _check_belongs(calibration, f"{camera_file}", decoded, f"{path}")
        return _calibrated(path.name, decoded, calibration, f"{camera_file}")
    if focal is not None:
        check_focal(focal, width, height, "the focal length")
        camera = _centred_camera(width, height, focal, "focal option")
        return Photo(path.name, decoded.pixels, camera, decoded.notes)
    exif_focal, note = focal_from_exif(decoded.exif, width, height)
    return Photo(
        name=path.name,
        pixels=decoded.pixels,
        camera=None if exif_focal is None else _centred_camera(width, height, exif_focal, "exif"),
        notes=decoded.notes + ((note,) if note else ()),
    )


def focal_from_exif(exif: dict[int, Any], width: int, height: int) -> tuple[float | None, str]:
    """Focal length in px that EXIF tags give for a photo of that size, or None; and a note on how far to trust it."""
    stored = [_positive(exif.get(tag)) for tag in (ExifTags.Base.ExifImageWidth, ExifTags.Base.ExifImageHeight)]
    long, short = max(width, height), min(width, height)
    # Programs turn photos without turning these two numbers, so only their order of size means something.
    long_taken, short_taken = max(stored), min(stored)
    if short_taken == 0:
        long_taken, short_taken = long, short
    # A photo is cut before it is scaled, and most cuts keep one side whole.
    scale = max(long / long_taken, short / short_taken)
    is_cropped = abs((long / short) / (long_taken / short_taken) - 1) > ASPECT_TOLERANCE

    equivalent = _positive(exif.get(ExifTags.Base.FocalLengthIn35mmFilm))
    length = _positive(exif.get(ExifTags.Base.FocalLength))
    resolution = _pixels_per_mm(exif)
    if equivalent:
        focal = equivalent / DIAGONAL_35MM * math.hypot(long_taken, short_taken) * scale
        note = f"focal length from EXIF (35 mm equivalent, {equivalent:g} mm), often wrong by a few per cent"
    elif length and resolution:
        focal = length * resolution * scale
        note = f"focal length from EXIF ({length:g} mm and the sensor's resolution)"
    else:
        return None, ""
    if not FOCAL_RANGE[0] * long <= focal <= FOCAL_RANGE[1] * long:
        return None, f"focal length from EXIF ({focal:.4g} px) does not suit {width} x {height} px and is ignored"
    if is_cropped:
        note += (
            f"; the photo seems cropped (taken with {long_taken:.0f} x {short_taken:.0f} px), "
            "so focal length and principal point are doubtful"
        )
    elif abs(scale - 1) > SCALE_TOLERANCE:
        note += f"; the photo was taken with {long_taken:.0f} x {short_taken:.0f} px and resized"
    return focal, note


def _pixels_per_mm(exif: dict[int, Any]) -> float:
    """Resolution of the sensor in the photo as taken, px per mm; 0 when EXIF does not say or contradicts itself."""
    unit = MM_PER_RESOLUTION_UNIT.get(exif.get(ExifTags.Base.FocalPlaneResolutionUnit, 2), 0.0)
    along_x = _positive(exif.get(ExifTags.Base.FocalPlaneXResolution))
    along_y = _positive(exif.get(ExifTags.Base.FocalPlaneYResolution)) or along_x
    if not (unit and along_x) or abs(along_x / along_y - 1) > RESOLUTION_TOLERANCE:
        return 0.0
    return along_x / unit


def _positive(value: Any) -> float:
    """An EXIF value as a positive finite number; 0 for anything else (EXIF itself writes 0 for "unknown")."""
    try:
        number = float(value)
    except (TypeError, ValueError, ZeroDivisionError, OverflowError):
        return 0.0
    return number if math.isfinite(number) and number > 0 else 0.0


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


def _calibrated(name: str, decoded: Decoded, calibration: Calibration, camera_name: str) -> Photo:
    """The photo with the distortion of its calibration removed and its pixels made square."""
    pixels, notes = decoded.pixels, list(decoded.notes)
    if decoded.turned:
        notes.append(
            "the photo was turned by its EXIF orientation; the camera file is taken to be for the turned photo"
        )
    if not calibration.is_pinhole:
        pixels, outside = undistort_photo(pixels, calibration)
        done = ["lens distortion removed"] if calibration.distortion else []
        done += [] if calibration.has_square_pixels else ["pixels made square"]
        notes.append(" and ".join(done) + ", as the camera file says")
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
        calibration.width, calibration.height, calibration.square_matrix, "file", distortion=calibration.distortion
    )
    return Photo(name, pixels, camera, tuple(notes))
