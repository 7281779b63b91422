"""A camera and a frame that were found against the true ones, in standard errors and in plain measures."""

import time
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.spatial.transform import Rotation

from linecad.arrays import Float
from linecad.camera.distortion import straighten
from linecad.camera.estimate import Calibrated
from linecad.camera.photo import Photo
from linecad.camera.refit import find_calibration
from linecad.errors import LinecadError
from linecad.geometry import angle_between_frames, angles_to, vanishing_points
from linecad.line_graph import Segments
from linecad.lines.segments import find_segments

NEAR_FOCAL, NEAR_TURN = 0.05, np.radians(1.0)  # relative and rad: recovered, whatever the standard errors say
FAR_FOCAL, FAR_TURN = 0.05, np.radians(1.5)  # beyond one of them, a wrong answer that is called good is a silent one
SIGMAS, FAR_SIGMAS = 2.0, 3.0
NEAR_ANGLE = np.radians(2.0)  # between a segment and the vanishing point that explains it
FINITE = 5.0  # of the larger side; vanishing points within it of the photo's middle count as finite


@dataclass(frozen=True)
class Verdict:
    """What was found in one photo, against the truth."""

    name: str
    kind: str
    perspective: int  # finite vanishing points of the true frame
    error: str | None = None  # the message, where nothing was found
    turn: float = np.nan  # rad
    focal: float = np.nan  # relative error, signed
    sigmas: dict[str, tuple[float, ...]] = field(default_factory=dict)  # errors in standard errors, by quantity
    focal_sigma: float | None = None  # relative standard error
    quality: str = ""
    reason: str = ""
    notes: tuple[str, ...] = ()
    seconds: float = 0.0  # of `calibrate`
    explained: tuple[float, float] = (0.0, 0.0)  # share of the segment length, by the true frame and by the found one
    found: Calibrated | None = None

    @property
    def focal_off(self) -> float:
        """The relative error of the focal length without its sign."""
        return abs(self.focal)

    @property
    def is_recovered(self) -> bool:
        """Whether focal length and rotation are right, by a fixed limit or by the standard errors."""
        return self.error is None and (
            (abs(self.focal) < NEAR_FOCAL or self._within("focal", SIGMAS))
            and (self.turn < NEAR_TURN or self._within("rotation", SIGMAS))
        )

    @property
    def is_flagged(self) -> bool:
        """Whether linecad refused the photo or doubts its own answer."""
        return self.error is not None or self.quality != "good"

    @property
    def is_silently_wrong(self) -> bool:
        """Whether an answer that is called good is far from the truth by any measure."""
        if self.is_flagged:
            return False
        focal = abs(self.focal) > FAR_FOCAL and not self._within("focal", FAR_SIGMAS)
        turn = self.turn > FAR_TURN and not self._within("rotation", FAR_SIGMAS)
        return focal or turn

    def _within(self, quantity: str, sigmas: float) -> bool:
        """Whether all errors of a quantity are within so many standard errors; False where it has none."""
        found = self.sigmas.get(quantity, ())
        return bool(found) and max(map(abs, found)) <= sigmas


def judge(
    name: str,
    kind: str,
    photo: Photo,
    matrix: Float,
    rotation: Float,
    radial: float = 0.0,
    second: Float | None = None,
) -> Verdict:
    """Straighten and calibrate a photo, and compare. `matrix` (3, 3) is the true K, `rotation` the true frame.

    Where the scene has a `second` frame, either is right. Straightening keeps the focal length and the photo's middle.
    """
    perspective = finite_points(matrix, rotation, photo.width, photo.height)
    verdict = Verdict(name, kind, perspective)
    seconds = 0.0
    try:
        straight = straighten(photo)
        raw: Segments = find_segments(straight.grey)
        began = time.perf_counter()
        found = find_calibration(straight, raw)
        seconds = time.perf_counter() - began
    except LinecadError as error:
        return replace(verdict, error=str(error), seconds=seconds)
    camera, certainty = found.camera, found.certainty
    # The middle of a straightened photo that is larger or smaller than the photo is the same place.
    moved = np.array([straight.width - photo.width, straight.height - photo.height]) / 2
    turns = [turn_between(found.frame.rotation, true) for true in (rotation, second) if true is not None]
    turn = min(turns, key=lambda one: float(np.linalg.norm(one)))
    sigmas = {"rotation": _in_sigmas(turn, certainty.rotation)}
    relative = camera.focal / matrix[0, 0] - 1
    if certainty.focal is not None:
        sigmas["focal"] = _in_sigmas([camera.focal - matrix[0, 0]], [certainty.focal])
    if certainty.center is not None:
        sigmas["principal point"] = _in_sigmas(camera.matrix[:2, 2] - matrix[:2, 2] - moved, certainty.center)
    if certainty.radial is not None:
        removed = camera.distortion[0] if camera.distortion else 0.0
        sigmas["k1"] = _in_sigmas([removed - radial], [certainty.radial])
    return replace(
        verdict,
        turn=float(np.linalg.norm(turn)),
        focal=float(relative),
        sigmas=sigmas,
        focal_sigma=None if certainty.focal is None else certainty.focal / camera.focal,
        quality=certainty.quality,
        reason=certainty.reason,
        notes=found.notes,
        seconds=seconds,
        explained=(_explained(raw, matrix, rotation), _explained(raw, camera.matrix, found.frame.rotation)),
        found=found,
    )


def _explained(raw: Segments, matrix: Float, rotation: Float) -> float:
    """Share of the segment length that points to one of the vanishing points of a frame."""
    near = angles_to(raw.ends, vanishing_points(matrix, rotation)).min(axis=0) < np.sin(NEAR_ANGLE)
    return float(raw.length[near].sum() / raw.length.sum())


def _in_sigmas(errors: Float | list[float], sigmas: Float | tuple[float, ...] | list[float]) -> tuple[float, ...]:
    """Errors over their standard errors; infinite where an error is called 0 and is not."""
    with np.errstate(divide="ignore", invalid="ignore"):
        ratios = np.nan_to_num(np.asarray(errors) / np.asarray(sigmas), nan=0.0, posinf=np.inf, neginf=-np.inf)
    return tuple(ratios.tolist())


def turn_between(found: Float, true: Float) -> Float:
    """Rotation vector (3,), rad, about x, y and z of the camera, that takes the true frame to the found one.

    Axes have no names here: the found ones are those that fit best.
    """
    _, names = angle_between_frames(found, true)
    named = found[:, list(names)]
    turn = (named * np.sign((named * true).sum(axis=0))) @ true.T
    return np.asarray(Rotation.from_matrix(turn).as_rotvec())


def finite_points(matrix: Float, rotation: Float, width: int, height: int) -> int:
    """How many of the three vanishing points lie within FINITE larger sides of the photo's middle."""
    return int(_is_finite(matrix, rotation, width, height).sum())


def finite_level_points(matrix: Float, rotation: Float, width: int, height: int) -> int:
    """The same of the two axes that are not the upright one."""
    finite = _is_finite(matrix, rotation, width, height)
    return int(np.delete(finite, np.abs(rotation[1]).argmax()).sum())


def _is_finite(matrix: Float, rotation: Float, width: int, height: int) -> Float:
    points = (matrix @ rotation).T
    with np.errstate(divide="ignore", invalid="ignore"):
        away = np.linalg.norm(points[:, :2] / points[:, 2:] - ((width - 1) / 2, (height - 1) / 2), axis=1)
    finite: Float = away < FINITE * max(width, height)  # NaN is not
    return finite


def area_below(errors: Float, limit: float) -> float:
    """Area under the share of errors (N,) that are smaller than a threshold, from 0 to `limit`, over `limit`.

    Missing answers are infinite errors.
    """
    return float(np.clip(1 - np.asarray(errors) / limit, 0, None).mean())
