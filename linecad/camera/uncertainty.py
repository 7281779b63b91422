"""How sure a camera and its Manhattan frame are, in standard errors."""

import numpy as np

from linecad.arrays import Float, Int
from linecad.camera.horizontal_frames import HorizontalFrames
from linecad.camera.joint_fit import CENTER_X, CENTER_Y, FOCAL, TURNS, Fit
from linecad.camera.photo import Bend
from linecad.camera.quality import Findings, Fitted, Other, quality_of
from linecad.geometry import angle_between_frames, angles_to
from linecad.scene import Camera, Certainty

FEW_LINES = 20.0  # standard errors grow as the root of 1 + this over the lines of that axis
# An axis of few lines may be another direction altogether. How far wrong the camera then is, times a chance that
# falls with the lines, is part of its standard error; figures from the made photos of linecad.camera.quality.
WRONG_AXIS_FOCAL = 0.5  # relative
WRONG_AXIS_TURN = np.radians(12.0)
WRONG_AXIS_LINES = 5.0  # whole lines that make the chance e times smaller
OTHER_GAIN = 0.08  # of the segments: by so much less log posterior, another camera explains them almost as well
OTHER_FOCAL = 0.1  # relative; cameras nearer than this and OTHER_TURN are one
OTHER_TURN = np.radians(3.0)
LINE_ANGLE = np.radians(1.0)  # between a whole line and its axis
LINE_LENGTH = 0.02  # of the larger side, of a line that counts


def whole_lines(ends: Float, points: Float, size: float) -> Int:
    """How many whole segments (N, 2, 2) px run to each vanishing point (3, 3); `size` is the larger side, px."""
    sines = angles_to(ends, points)
    counts = (sines.min(axis=0) < np.sin(LINE_ANGLE)) & (
        np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1) > LINE_LENGTH * size
    )
    return np.bincount(sines.argmin(axis=0)[counts], minlength=3)


def widening(lines: Int) -> float:
    """The factor on standard errors for whole lines along each axis (3,) px, where the focal length was estimated."""
    return float(np.sqrt(1 + FEW_LINES / max(float(lines.min()), 0.5)))


def _k1_error(bend: Bend, focal: float, focal_error: float) -> float:
    """Standard error of OpenCV's k1, for a focal length over half the diagonal with its relative error."""
    return float(np.hypot(bend.radial_error, 2 * bend.radial * focal_error) * focal**2)


def wrong_axis(lines: int) -> float:
    """By how much the chance of a wrong axis counts, from 1, where it has so many whole lines."""
    return float(np.exp(-lines / WRONG_AXIS_LINES))


def other_camera(best: Fit, fits: list[Fit], segments: int) -> Other | None:
    """The most likely of `fits` that is another camera or frame than `best` and explains the segments almost as well.

    `segments` is the number of segments that were fitted: as they are not independent, what counts is the log
    posterior for each of them. Axes have no names here.
    """
    for fit in sorted(fits, key=lambda one: -one.log_posterior):
        if best.log_posterior - fit.log_posterior > OTHER_GAIN * segments:
            return None
        focal = float(abs(np.log(fit.view.focal / best.view.focal)))
        turn, _ = angle_between_frames(fit.view.axes.T, best.view.axes.T)
        if focal > OTHER_FOCAL or turn > OTHER_TURN:
            return Other(focal, turn)
    return None


def certainty_of(
    camera: Camera, frames: HorizontalFrames, fit: Fit, lines: Int, findings: Findings, bend: Bend | None
) -> tuple[Certainty, list[str]]:
    """The standard errors of `fit` and what they mean, and notes on what else a user should know.

    `lines` (3,) are the whole lines along each axis, `bend` is the distortion that was taken out.
    """
    size = max(camera.width, camera.height)
    is_told = camera.source not in ("vanishing points", "default")
    error = _whole_errors(fit, lines, is_told, findings.other)
    focal = None if camera.is_given else float(error[FOCAL])
    center = None if camera.is_given else (float(error[CENTER_X] * size), float(error[CENTER_Y] * size))
    half = np.hypot(camera.width, camera.height) / 2
    fitted = Fitted(
        source=camera.source,
        focal_error=focal,
        turn_error=float(error[TURNS].max()),
        axes_off=fit.turn,
        lines=lines,
        frame=frames.main,
        bend=bend,
        second_share=max((frame.share for frame in frames.further), default=0.0),
        findings=findings,
    )
    quality, reason = quality_of(fitted)
    certainty = Certainty(
        rotation=error[TURNS],
        focal=None if focal is None else focal * camera.focal,
        center=center,
        radial=None if bend is None else _k1_error(bend, camera.focal / half, focal or 0.0),
        quality=quality,
        reason=reason,
    )
    return certainty, [_frames_note(frames)] if frames.further else []


def _frames_note(frames: HorizontalFrames) -> str:
    """Which horizontal frames there are beside the main one."""
    further = [
        f"turned by {np.degrees(frame.turn):.1f} ± {np.degrees(frame.error):.1f} degrees about the upright "
        f"({frame.share:.0%} of the segment length)"
        for frame in frames.further
    ]
    first = f"{frames.frames[0].share:.0%} of the segment length runs level along the first"
    told = f"{len(frames.frames)} horizontal frames: {first}; {', '.join(further)}"
    unsound = len(frames.further) - len(frames.sound.further)
    if not unsound:
        return told
    which = "the others" if unsound == len(further) else f"{unsound} of them, seen on little of the photo or not well,"
    return f"{told}; lines of {which} are left out"


def _whole_errors(fit: Fit, lines: Int, is_told: bool, other: Other | None) -> Float:
    """Standard errors (7,) of the parameters of a fit, with the chance that an axis, or the whole camera, is wrong.

    `is_told` says that the focal length is known from elsewhere: then two axes give the third.
    """
    variance = np.diag(fit.covariance).copy()
    chance = wrong_axis(int(np.sort(lines)[1 if is_told else 0]))
    variance[TURNS] += (WRONG_AXIS_TURN * chance) ** 2
    if not is_told:
        variance[FOCAL] += (WRONG_AXIS_FOCAL * chance) ** 2
    if other is not None:  # either is right by an even chance
        variance[TURNS] += (other.turn / 2) ** 2
        variance[FOCAL] += (other.focal / 2) ** 2
    errors: Float = np.sqrt(variance)
    return errors
