"""The camera of one photo without a scene: what was found out, and what people want to know that follows from it.

*tilt* is the angle of the line of sight above the horizon; *roll* is the turn of the camera about its line of sight,
clockwise as seen from behind it, so that the scene in the photo leans the other way. World z is up.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

import numpy as np

from linecad.arrays import Float
from linecad.camera.distortion import open_photo
from linecad.camera.horizontal_frames import HorizontalFrames
from linecad.camera.intrinsics import Calibration, read_calibration
from linecad.camera.photo import Photo
from linecad.camera.refit import find_calibration
from linecad.camera.vanishing_points import INLIER_ANGLE
from linecad.geometry import DIAGONAL_35MM, angles_to, vanishing_points
from linecad.line_graph import ManhattanFrame, Segments
from linecad.lines.segments import find_segments
from linecad.progress import StageReport, silent
from linecad.scene import Camera, Certainty

FLATTEST = 0.01  # sine of the angle between an axis and the image plane; a flatter one vanishes at infinity
NO_HORIZON = 1e-6  # cosine of the tilt, below which the camera looks straight up or down


class Angle(NamedTuple):
    """An angle and its standard error, rad."""

    value: float
    error: float


@dataclass(frozen=True, eq=False)
class VanishingPoint:
    """Where the lines of one axis meet in the photo."""

    axis: int  # 0, 1, 2
    pixel: tuple[float, float] | None  # px; None where it is at infinity, as far as the errors tell
    direction: tuple[float, float]  # unit, in the photo, from the principal point towards it
    share: float  # of the segment length that points to it, 0 to 1


@dataclass(frozen=True, eq=False)
class CameraReport:
    """A photo's camera and Manhattan frame, with the segments that tell them."""

    photo: Photo  # in which everything is measured
    camera: Camera
    taken: Calibration  # of the photo as it was taken, distortion and all
    frames: HorizontalFrames  # the main one is the Manhattan frame
    certainty: Certainty
    segments: Segments  # all that were found; axis -1 where they point to no vanishing point
    notes: tuple[str, ...]

    @property
    def frame(self) -> ManhattanFrame:
        """The Manhattan frame whose axes are those of the world."""
        return self.frames.main

    @property
    def equivalent(self) -> float:
        """Focal length, mm, that gives the same angle across the diagonal of a 36 x 24 mm frame."""
        return self.camera.focal * DIAGONAL_35MM / math.hypot(self.camera.width, self.camera.height)

    @property
    def field_of_view(self) -> tuple[float, float]:
        """Angles, rad, between left and right border, and between top and bottom, through the principal point."""
        (cx, cy), focal = self.camera.matrix[:2, 2].tolist(), self.camera.focal
        across = math.atan((cx + 0.5) / focal) + math.atan((self.camera.width - 0.5 - cx) / focal)
        along = math.atan((cy + 0.5) / focal) + math.atan((self.camera.height - 0.5 - cy) / focal)
        return across, along

    @property
    def tilt(self) -> Angle:
        """How far the camera looks up; negative where it looks down."""
        x, y, z = self.frame.rotation[:, 2].tolist()  # up, in the camera
        level = math.hypot(x, y)
        # A small turn w moves up by w x up; the turns about x and y of the camera move its z.
        error_x, error_y, _ = self.certainty.rotation.tolist()
        error = math.hypot(error_x * y, error_y * x) / level if level > NO_HORIZON else math.hypot(error_x, error_y)
        return Angle(math.atan2(z, level), error)

    @property
    def roll(self) -> Angle:
        """How far the camera is turned clockwise; a camera that looks straight up or down has any roll."""
        x, y, z = self.frame.rotation[:, 2].tolist()
        level = x * x + y * y
        if level <= NO_HORIZON**2:
            return Angle(0.0, math.pi)
        error_x, error_y, error_z = self.certainty.rotation.tolist()
        error = math.hypot(error_x * x * z / level, error_y * y * z / level, error_z)
        return Angle(math.atan2(-x, -y), min(error, math.pi))

    @property
    def horizon(self) -> Float | None:
        """(2, 2) px, where the horizon meets the left and the right border, or top and bottom where it is steep.

        These points may lie outside the photo. None for a camera that looks straight up or down.
        """
        a, b, c = np.linalg.solve(self.camera.matrix.T, self.frame.rotation[:, 2]).tolist()
        if math.hypot(a, b) * self.camera.focal <= NO_HORIZON:
            return None
        if abs(b) >= abs(a):
            return np.array([[x, -(a * x + c) / b] for x in (0.0, self.camera.width - 1.0)])
        return np.array([[-(b * y + c) / a, y] for y in (0.0, self.camera.height - 1.0)])

    @cached_property
    def vanishing_points(self) -> tuple[VanishingPoint, VanishingPoint, VanishingPoint]:
        """Those of x, y and z, each of the end of its axis that lies before the camera."""
        x, y, z = (self._vanishing_point(axis) for axis in range(3))
        return x, y, z

    def _vanishing_point(self, axis: int) -> VanishingPoint:
        towards = self.frame.rotation[:, axis] * (1.0 if self.frame.rotation[2, axis] >= 0 else -1.0)
        x, y, z = towards.tolist()
        error_x, error_y, _ = self.certainty.rotation.tolist()
        size = math.hypot(x, y)
        direction = (x / size, y / size) if size > 0 else (0.0, 0.0)
        pixel = None
        if z > max(FLATTEST, 2 * math.hypot(error_x * y, error_y * x)):
            u, v = (self.camera.matrix[:2] @ towards / z).tolist()
            pixel = (u, v)
        return VanishingPoint(axis, pixel, direction, self._share(axis))

    @property
    def unexplained(self) -> float:
        """Share of the segment length that points to no vanishing point."""
        return self._share(-1)

    def _share(self, axis: int) -> float:
        length = self.segments.length
        return float(length[self.segments.axis == axis].sum() / max(length.sum(), 1e-300))


def find_camera(
    path: Path, camera_file: Path | None = None, focal: float | None = None, on_stage: StageReport = silent
) -> CameraReport:
    """The camera of the photo at `path`, with what is known of it as for `linecad.camera.distortion.open_photo`.

    Raises PhotoError, CameraError, or ReconstructionError where the photo has no Manhattan frame.
    """
    on_stage("reading the photo")
    photo = open_photo(path, camera_file, focal)
    on_stage("finding segments")
    raw = find_segments(photo.grey)
    on_stage(f"finding the Manhattan frame of {len(raw)} segments")
    calibrated = find_calibration(photo, raw, on_stage)
    camera = calibrated.camera
    taken = Calibration(camera.width, camera.height, camera.matrix, camera.distortion)
    if camera_file is not None:
        taken = read_calibration(camera_file)  # only the file itself knows pixels that are not square
    return CameraReport(
        photo=photo,
        camera=camera,
        taken=taken,
        frames=calibrated.frames,
        certainty=calibrated.certainty,
        segments=_labelled(raw, camera, calibrated.frame),
        notes=calibrated.notes,
    )


def _labelled(raw: Segments, camera: Camera, frame: ManhattanFrame) -> Segments:
    """The segments with the axis that `frame.explained` counts them for, or -1."""
    sines = angles_to(raw.ends, vanishing_points(camera.matrix, frame.rotation))
    axis = np.where(sines.min(axis=0) < np.sin(INLIER_ANGLE), sines.argmin(axis=0), -1)
    return Segments(raw.ends, axis)
