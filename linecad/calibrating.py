"""The camera of a photo and its Manhattan frame, from what is known of the camera and from the segments."""

from dataclasses import dataclass

import numpy as np

from linecad.corrections import SetFrame
from linecad.geometry import central_camera
from linecad.photo import Photo
from linecad.scene import Camera, Certainty, ManhattanFrame, Segments
from linecad.vanishing import FOCAL_SIGMA, default_focal, find_focal, find_frame, fit_frame

MIN_FRAME_SHARE = 0.3  # of the segment length; a frame that explains less is doubtful


@dataclass(frozen=True, eq=False)
class Calibrated:
    """A camera and its Manhattan frame, how sure both are, and the doubts in words."""

    camera: Camera
    frame: ManhattanFrame
    certainty: Certainty
    notes: tuple[str, ...]  # those of the photo among them


def calibrate(photo: Photo, raw: Segments, drawn: SetFrame | None = None) -> Calibrated:
    """The camera and the frame of a photo with segments `raw`, as `linecad.segments.find_segments` gives them.

    Lines that a person has `drawn` along the axes give the frame instead of the segments. Raises ReconstructionError
    when the photo has no Manhattan frame.
    """
    camera, notes = _camera(photo, raw)
    if drawn is None:
        frame = find_frame(raw, camera.matrix)
    else:
        ends = np.array([line.ends for line in drawn.lines])
        frame = fit_frame(ends, np.array([line.axis for line in drawn.lines]), camera.matrix, raw)
        notes.append("the Manhattan frame is that of lines drawn by hand")
    if frame.explained < MIN_FRAME_SHARE:
        notes.append(f"only {frame.explained:.0%} of the segment length runs along the three Manhattan directions")
    certainty = Certainty(np.zeros(3), None, None, None, "doubtful", "it was not examined")
    return Calibrated(camera, frame, certainty, tuple(notes))


def _camera(photo: Photo, raw: Segments) -> tuple[Camera, list[str]]:
    """The photo's camera, or one whose focal length the vanishing points tell; and the doubts about it."""
    notes = list(photo.notes)
    if photo.camera is not None:
        return photo.camera, notes
    guess = find_focal(raw, photo.width, photo.height)
    if guess.relative_error <= FOCAL_SIGMA:
        notes.append(
            f"focal length guessed from the vanishing points: {guess.focal:.0f} px, "
            f"standard error {guess.relative_error:.1%} or more; principal point assumed in the middle"
        )
        matrix = central_camera(guess.focal, photo.width, photo.height)
        return Camera(photo.width, photo.height, matrix, "vanishing points"), notes
    focal = default_focal(photo.width, photo.height)
    notes.append(
        f"focal length not known and not to be told from the vanishing points; {focal:.0f} px assumed "
        "(28 mm equivalent), so depths may be stretched; give --focal or --camera"
    )
    return Camera(photo.width, photo.height, central_camera(focal, photo.width, photo.height), "default"), notes
