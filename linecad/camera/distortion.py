"""Photos as they are measured: read, and freed from the lens distortion that their own segments show.

Lines of a Manhattan scene are straight and run to three vanishing points; a lens that bends them turns their pieces by
angles that grow towards the corners. One radial coefficient is fitted together with the camera and the frame
(`linecad.camera.joint_fit`), so no line has to be followed from end to end.
"""

from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np

from linecad.camera.estimate import best_fit, decisive, gathered, prior_of
from linecad.camera.intrinsics import Calibration, undistort_photo
from linecad.camera.joint_fit import CENTER_X, RADIAL, undistorted
from linecad.camera.photo import Bend, Photo, read_photo
from linecad.camera.uncertainty import whole_lines, widening
from linecad.camera.vanishing_points import MIN_SEGMENTS
from linecad.geometry import central_camera
from linecad.line_graph import Segments
from linecad.lines.segments import find_segments

LARGEST_WIDTH = 1600  # px, of the photo in which the bend is measured: enough for a few px at the corners
RADIAL_ERROR = 0.05  # usual size of the distortion at half the diagonal, a share
LEAST_SIGNIFICANCE = 4.0  # standard errors
LEAST_RADIAL = 0.01  # what bends less is left alone: real photos of lenses without distortion show up to 0.007
LEAST_LINES = 8  # whole ones along the second axis; with less, a wrong frame may be bent to fit
HIGHER_ORDERS = 0.02  # of the distortion: what one coefficient cannot tell of a real lens
# Beyond these the lens is a fisheye, which one coefficient does not describe. With a barrel from 0.15 on the corners of
# the photo have no place in a straight one; one of 0.2 is still found as it is, of 0.3 only 0.22 (docs/decisions/0010).
LARGEST_BARREL, LARGEST_PINCUSHION = 0.2, 0.25


def open_photo(path: Path, camera_file: Path | None = None, focal: float | None = None) -> Photo:
    """The photo as `camera.photo.read_photo` reads it, straightened unless a camera file tells its distortion."""
    return straighten(read_photo(path, camera_file, focal))


def straighten(photo: Photo) -> Photo:
    """The photo without the radial distortion that bends its straight lines; the same photo where they are straight.

    A photo whose camera comes from a file is left alone: the file tells its distortion.
    """
    if photo.camera is not None and photo.camera.source == "file":
        return photo
    bend = find_bend(photo)
    if bend is None or abs(bend.radial) < max(LEAST_SIGNIFICANCE * bend.radial_error, LEAST_RADIAL):
        return photo
    amount = f"{abs(bend.radial):.1%} (standard error {bend.radial_error:.1%}) at the corners"
    if not -LARGEST_BARREL <= bend.radial <= LARGEST_PINCUSHION:
        note = f"straight lines are bent by about {amount}: too much for one coefficient, so nothing was done about it"
        notes = (*photo.notes, f"{note}; give --camera with the lens's distortion")
        return replace(photo, notes=notes, is_fisheye=True)
    half = float(np.hypot(photo.width, photo.height)) / 2
    # Any focal length does, as the coefficient is scaled with it.
    matrix = central_camera(half, photo.width, photo.height)
    matrix[:2, 2] = bend.center
    calibration = Calibration(photo.width, photo.height, matrix, (bend.radial, 0.0, 0.0, 0.0))
    pixels, _ = undistort_photo(photo.pixels, calibration)
    kind = "barrel" if bend.radial < 0 else "pincushion"
    note = f"straight lines were bent by a {kind} distortion of {amount}, which was taken out"
    camera = photo.camera
    if camera is not None:
        matrix = camera.matrix.copy()
        matrix[:2, 2] = bend.center
        camera = replace(camera, matrix=matrix)
    notes = (*photo.notes, note)
    return replace(photo, pixels=pixels, camera=camera, notes=notes, bend=bend, undistortion=calibration)


def find_bend(photo: Photo) -> Bend | None:
    """The radial distortion that makes the segments of a photo most likely; None where they are too few."""
    scale = min(LARGEST_WIDTH / photo.width, 1.0)
    grey = photo.grey
    if scale < 1:
        size = (round(photo.width * scale), round(photo.height * scale))
        grey = np.asarray(cv2.resize(photo.grey, size, interpolation=cv2.INTER_AREA), np.uint8)
    height, width = grey.shape
    raw = find_segments(grey)
    if len(raw) < MIN_SEGMENTS:
        return None
    prior = replace(prior_of(photo).scaled(width / photo.width), radial_error=RADIAL_ERROR)
    fit = best_fit(decisive(raw, width), width, height, prior)
    straight = undistorted(raw.ends, fit.view.radial, fit.view.center, width, height)
    points = fit.view.axes @ fit.view.matrix.T
    lines = whole_lines(gathered(Segments(straight, raw.axis), fit, width), points, max(width, height))
    # A bend shows on the lines of any two axes, so the second counts, not the one with the fewest.
    if np.sort(lines)[1] < LEAST_LINES:
        return None
    wider = widening(np.sort(lines)[1:])
    error = wider * np.sqrt(np.diag(fit.covariance))
    x, y = (fit.view.center + 0.5) * photo.width / width - 0.5
    return Bend(
        fit.view.radial,
        float(np.hypot(error[RADIAL], HIGHER_ORDERS * fit.view.radial)),
        (float(x), float(y)),
        float(error[CENTER_X] * max(photo.width, photo.height)),
    )
