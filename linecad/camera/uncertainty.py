"""How sure a camera and its Manhattan frame are, in standard errors and in plain words."""

from dataclasses import dataclass, field
from itertools import permutations

import numpy as np

from linecad.arrays import Float, Int
from linecad.camera.joint_fit import CENTER_X, CENTER_Y, FOCAL, TURNS, Fit
from linecad.camera.photo import Bend
from linecad.geometry import angles_to, plane_normals
from linecad.line_graph import ManhattanFrame, Segments
from linecad.scene import Camera, Certainty, Quality

GOOD_FOCAL_ERROR = 0.05  # relative standard error up to which a focal length is good
GOOD_FOCAL_ERROR_ALONE = 0.03  # the same from vanishing points alone: on real photos they err twice as much
POOR_FOCAL_ERROR = 0.25
GOOD_TURN = np.radians(1.0)  # standard error of the rotation about an axis of the camera
POOR_TURN = np.radians(5.0)
GOOD_SHARE = 0.5  # of the segment length that runs along the axes; below it other lines may have made the frame
POOR_SHARE = 0.3
# Whole lines along the axis that has fewest: with less, one cable or joint in the paving may have made that axis. The
# figures are from 300 made photos (docs/decisions/0012).
ENOUGH_LINES = 20
ENOUGH_TOGETHER = 120  # along all three: a few kerbs that are not parallel to the house outweigh it else
ENOUGH_LINES_KNOWN = 12  # along the second axis, where the camera was given: the third follows from two
FEW_LINES = 20.0  # standard errors grow as the root of 1 + this over the lines of that axis
# An axis held by few lines may be another direction altogether. How far wrong the camera then is, times a chance that
# falls with the lines, is part of its standard error; figures from the same photos.
WRONG_AXIS_FOCAL = 0.5  # relative
WRONG_AXIS_TURN = np.radians(12.0)
WRONG_AXIS_LINES = 5.0  # whole lines that make the chance e times smaller
OTHER_GAIN = 0.08  # of the segments: by so much less log posterior, another camera explains them almost as well
OTHER_FOCAL = 0.1  # relative; cameras nearer than this and OTHER_TURN are one
OTHER_TURN = np.radians(3.0)
LINE_ANGLE = np.radians(1.0)  # between a whole line and its axis
LINE_LENGTH = 0.02  # of the larger side, of a line that counts
STRONG_BEND = 0.1  # of the radius at the corners; one coefficient describes more than this only roughly
LARGEST_OWN_TURN = np.radians(1.0)  # by which the axes may lie off an orthogonal frame
EVEN_ROLL = np.radians(40.0)  # beyond it two axes are almost equally upright
SECOND_FRAME_SHARE = 0.08  # of the segment length that a second frame must explain
SECOND_FRAME_PEAK = 3.0  # times what lines of all directions would give
SECOND_FRAME_WIDTH = np.radians(1.5)  # of the directions that belong to one frame
LEVEL = np.radians(10.0)  # a plane that holds the upright within this tells no level direction


@dataclass(frozen=True)
class Other:
    """How far another camera, which explains the segments almost as well, lies from the one that was taken."""

    focal: float  # relative, its logarithm
    turn: float  # rad


@dataclass
class Doubts:
    """What was noticed while a camera was fitted."""

    is_cropped: bool = False  # or may be: the principal point was searched far from the middle
    is_fisheye: bool = False  # lines are bent by more than could be taken out
    is_contradicted: bool = False  # EXIF and vanishing points do not agree
    other: "Other | None" = None  # camera that explains the segments almost as well
    notes: list[str] = field(default_factory=list)


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
        turn = _turn_between(best.view.axes, fit.view.axes)
        if focal > OTHER_FOCAL or turn > OTHER_TURN:
            return Other(focal, turn)
    return None


def _turn_between(first: Float, second: Float) -> float:
    """The angle, rad, between two frames (3, 3), rows, whose axes may have other names and signs."""
    cosines = np.abs(first @ second.T)
    # For each way to name the axes: |trace| with the best signs is that of the smallest turn, or of its mirror.
    best = max(float(sum(cosines[axis, name] for axis, name in enumerate(names))) for names in permutations(range(3)))
    return float(np.arccos(np.clip((best - 1) / 2, -1, 1)))


def certainty_of(
    camera: Camera, frame: ManhattanFrame, fit: Fit, lines: Int, raw: Segments, doubts: Doubts, bend: Bend | None
) -> tuple[Certainty, list[str]]:
    """The standard errors of `fit` and what they mean, and notes on what else a user should know.

    `lines` (3,) are the whole lines along each axis, `raw` all segments, `bend` is the distortion that was taken out.
    """
    size = max(camera.width, camera.height)
    error = _whole_errors(fit, lines, is_told=camera.source not in ("vanishing points", "default"), other=doubts.other)
    focal = None if camera.is_given else float(error[FOCAL])
    center = None if camera.is_given else (float(error[CENTER_X] * size), float(error[CENTER_Y] * size))
    half = np.hypot(camera.width, camera.height) / 2
    second = second_frame(raw, camera, frame)
    quality, reason = _quality(camera, frame, fit, error, lines, focal, doubts, second, bend)
    certainty = Certainty(
        rotation=error[TURNS],
        focal=None if focal is None else focal * camera.focal,
        center=center,
        radial=None if bend is None else _k1_error(bend, camera.focal / half, focal or 0.0),
        quality=quality,
        reason=reason,
    )
    notes = []
    if second is not None:
        turn, share = second
        notes.append(
            f"a second Manhattan frame, turned by {np.degrees(turn):.0f} degrees about the upright, explains "
            f"{share:.0%} of the segment length, the first {frame.explained:.0%}: lines along it are left out"
        )
    return certainty, notes


def second_frame(raw: Segments, camera: Camera, frame: ManhattanFrame) -> tuple[float, float] | None:
    """A second frame with the same upright, as its turn, rad in (0, pi / 2), and its share of the segment length.

    A segment that no axis explains and that is level in space has one direction: across the upright, in its plane.
    Directions a right angle apart are one frame's. None where no turn gathers many.
    """
    sines = angles_to(raw.ends, (camera.matrix @ frame.rotation).T)
    free = (sines > np.sin(2 * SECOND_FRAME_WIDTH)).all(axis=0)
    normals = plane_normals(raw.ends[free], camera.matrix) @ frame.rotation  # in the world
    length = raw.length[free]
    tells = np.hypot(normals[:, 0], normals[:, 1]) > np.sin(LEVEL)
    direction = np.arctan2(-normals[tells, 0], normals[tells, 1]) % (np.pi / 2)
    length = length[tells]
    if length.sum() == 0:
        return None
    turns = np.linspace(0, np.pi / 2, 180, endpoint=False)
    apart = np.abs(turns[:, None] - direction)
    apart = np.minimum(apart, np.pi / 2 - apart)
    gathered = np.where(apart < SECOND_FRAME_WIDTH, length, 0.0).sum(axis=1)
    best = int(gathered.argmax())
    share = float(gathered[best] / raw.length.sum())
    by_chance = length.sum() * 2 * SECOND_FRAME_WIDTH / (np.pi / 2)
    if share < SECOND_FRAME_SHARE or gathered[best] < SECOND_FRAME_PEAK * by_chance:
        return None
    return float(turns[best]), share


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


def _quality(
    camera: Camera,
    frame: ManhattanFrame,
    fit: Fit,
    error: Float,
    lines: Int,
    focal: float | None,
    doubts: Doubts,
    second: tuple[float, float] | None,
    bend: Bend | None,
) -> tuple[Quality, str]:
    """The word, and the weightiest reason for it."""
    turn = float(error[TURNS].max())
    fewest, middle = np.sort(lines)[:2]
    largest = GOOD_FOCAL_ERROR if camera.source == "exif" else GOOD_FOCAL_ERROR_ALONE
    upright = np.abs(frame.rotation[1])
    tilt = float(np.arctan2(upright[:2].max(), upright[2]))
    of_focal = focal is not None and camera.source != "exif" and fewest < ENOUGH_LINES
    of_axes = middle < ENOUGH_LINES_KNOWN
    why = f", as few lines ({middle if of_axes else fewest}) run along one of them" if of_focal or of_axes else ""
    poor = [
        (frame.explained < POOR_SHARE, f"only {frame.explained:.0%} of the segment length runs along the three axes"),
        (turn > POOR_TURN, f"the axes are known to {np.degrees(turn):.0f} degrees only{why}"),
        (focal is not None and focal > POOR_FOCAL_ERROR, "the photo does not tell its focal length, which is assumed"),
    ]
    doubtful = [
        (doubts.is_fisheye, "the lens bends straight lines by more than could be taken out"),
        (doubts.is_contradicted, "EXIF and the vanishing points contradict each other about the focal length"),
        (doubts.is_cropped, "the photo may be cropped, so that its principal point lies off the middle"),
        (camera.source == "default", "the focal length is assumed"),
        (doubts.other is not None, "another camera explains the segments almost as well"),
        (of_focal, f"few lines ({fewest}) run along one of the three axes, from which the focal length follows"),
        (of_axes, f"few lines ({middle}) run along the second of the three axes"),
        (focal is not None and focal > largest, f"the focal length is known to {focal or 0:.0%} only"),
        (focal is not None and camera.source != "exif" and lines.sum() < ENOUGH_TOGETHER,
         f"few lines ({lines.sum()}) run along the three axes together, from which the focal length follows"),
        (frame.explained < GOOD_SHARE, f"only {frame.explained:.0%} of the segment length runs along the three axes"),
        (bend is not None and abs(bend.radial) > STRONG_BEND,
         "the lens bends lines by so much that one coefficient describes it only roughly"),
        (turn > GOOD_TURN, f"the axes are known to {np.degrees(turn):.1f} degrees only"),
        (fit.turn > LARGEST_OWN_TURN, f"the axes are not square: they lie {np.degrees(fit.turn):.1f} degrees off"),
        (tilt > EVEN_ROLL, "the photo is turned so far that another axis may be the upright one"),
        (second is not None and second[1] > frame.explained / 2, "a second Manhattan frame explains almost as much"),
    ]  # fmt: skip
    for holds, reason in poor:
        if holds:
            return "poor", reason
    for holds, reason in doubtful:
        if holds:
            return "doubtful", reason
    return "good", f"{lines.sum()} whole lines agree, {frame.explained:.0%} of the segment length runs along the axes"
