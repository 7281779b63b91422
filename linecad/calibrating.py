"""The camera of a photo and its Manhattan frame, from what is known of the camera and from the segments; how sure."""

from dataclasses import dataclass, replace

import numpy as np

from linecad.camerafit import FOCAL, Fit, Prior, View, fit_view, known
from linecad.certainty import ENOUGH_LINES, Doubts, certainty_of, whole_lines, widening
from linecad.corrections import SetFrame
from linecad.framing import usual_aspect
from linecad.geometry import angles_to, central_camera
from linecad.hints import FocalHint
from linecad.photo import Photo
from linecad.scene import Camera, CameraSource, Certainty, Float, Int, ManhattanFrame, Segments
from linecad.segments import fit_whole
from linecad.vanishing import (
    MIN_SEGMENTS,
    best_axes,
    default_focal,
    fit_frame,
    longest,
    name_frame,
    need_segments,
    search_axes,
)

FOCAL_SIGMA = 0.15  # relative standard error above which the vanishing points do not tell the focal length
USUAL_FOCAL_ERROR = 0.4  # of the focal lengths of photos about `default_focal`, relative
USUAL_CENTER_ERROR = 0.015  # of the principal points of whole photos about the middle, of the larger side
CROPPED_CENTER_ERROR = 0.15  # the same of photos from which parts were cut off
LARGEST_TURN_UNKNOWN = np.radians(0.4)  # of axes off the frame: less than else, as the focal length may bend as well
CENTER_GAIN = 15.0  # in log posterior, by which a principal point off the middle must explain more
FOCAL_RANGE = (0.45, 3.0)  # of the larger side: where an unknown focal length is searched
FOCAL_CANDIDATES = 8
STARTS = 3  # the best of them that are followed to their end
BESIDE = (0.9, 0.95, 1.05, 1.1)  # of the best focal length: where the fit is begun again
SEARCHED = 500  # segments, the longest ones, that the search looks at
DRAWS = 1200  # random triples of segments for a known focal length
FOCAL_DRAWS = 400  # and for each candidate of an unknown one
FIRST_ITERATIONS = 12  # of the fit of a candidate
MIN_LENGTH = 10.0  # px at up to SCALE_WIDTH; shorter segments have no say about the camera
MIN_WHOLE_LENGTH = 15.0  # px, the same of whole segments
SCALE_WIDTH = 1500.0  # px; the lengths grow with larger photos
LABEL_ANGLE = np.radians(3.0)  # between fragments and the axis along which they are gathered
CONTRADICTION = 3.0  # standard errors between EXIF and vanishing points


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
    need_segments(raw)
    found = _Finder(photo, raw).find()
    camera = photo.camera
    if camera is None or not _is_given(camera):
        camera = Camera(photo.width, photo.height, found.fit.view.matrix, found.source)
    if photo.bend is not None:
        half = np.hypot(photo.width, photo.height) / 2
        k1 = photo.bend.radial * (camera.focal / half) ** 2
        camera = replace(camera, distortion=(float(k1), 0.0, 0.0, 0.0))
    notes = [*photo.notes, *found.doubts.notes]
    if drawn is None:
        # The lines of one scene share one frame, so that of the least squares is theirs; that each axis may have a turn
        # of its own is for the camera and for the errors.
        K = camera.matrix
        frame = name_frame(raw, K, best_axes(raw, K, found.fit.view.axes, *found.searched))
    else:
        ends = np.array([line.ends for line in drawn.lines])
        frame = fit_frame(ends, np.array([line.axis for line in drawn.lines]), camera.matrix, raw)
        notes.append("the Manhattan frame is that of lines drawn by hand")
    certainty, more = certainty_of(camera, frame, found.fit, found.lines, raw, found.doubts, photo.bend)
    return Calibrated(camera, frame, certainty, (*notes, *more))


def _is_given(camera: Camera) -> bool:
    """Whether the user gave the camera, so that it is not to be estimated."""
    return camera.source in ("file", "focal option")


def prior_of(photo: Photo) -> Prior:
    """What is known of a photo's camera before its segments are looked at, with what EXIF says of it."""
    middle = np.array([(photo.width - 1) / 2, (photo.height - 1) / 2])
    may_be_cropped = photo.framing == "cropped" or (
        photo.framing == "unknown" and not usual_aspect(photo.width, photo.height)
    )
    center_error = CROPPED_CENTER_ERROR if may_be_cropped else USUAL_CENTER_ERROR
    if photo.bend is not None:
        middle, center_error = np.array(photo.bend.center), photo.bend.center_error / max(photo.width, photo.height)
    prior = Prior(
        default_focal(photo.width, photo.height), USUAL_FOCAL_ERROR, middle, center_error,
        largest_turn=LARGEST_TURN_UNKNOWN,
    )  # fmt: skip
    if photo.camera is not None and _is_given(photo.camera):
        return replace(prior, focal=photo.camera.focal, focal_error=0.0)
    if photo.hint is not None:
        return replace(prior, focal=photo.hint.focal, focal_error=photo.hint.relative_error)
    return prior


@dataclass(frozen=True, eq=False)
class _Found:
    """The most likely view of a photo."""

    fit: Fit
    lines: Int  # (3,) whole lines along each axis
    source: CameraSource
    doubts: Doubts
    searched: tuple[Float, ...] = ()  # axes (3, 3) at which the search for the frame ended


class _Finder:
    """The search for the view of one photo."""

    def __init__(self, photo: Photo, raw: Segments) -> None:
        self.photo, self.raw = photo, raw
        self.width, self.height = photo.width, photo.height
        self.middle = np.array([(self.width - 1) / 2, (self.height - 1) / 2])
        self.ends = decisive(raw, self.width)

    def find(self) -> _Found:
        """With the camera that is known, else with what EXIF and the vanishing points say of it."""
        camera = self.photo.camera
        if camera is not None and _is_given(camera):
            prior = known(camera.matrix)
            axes = search_axes(self.ends[:SEARCHED], camera.matrix, DRAWS)
            start = View(axes, camera.focal, camera.matrix[:2, 2])
            fit, lines = self._whole(fit_view(self.ends, self.width, self.height, start, prior), prior)
            return _Found(fit, lines, camera.source, Doubts(is_fisheye=self.photo.is_fisheye), (axes,))
        doubts = Doubts(is_fisheye=self.photo.is_fisheye)
        best, prior = self._best(doubts)
        alone, lines = self._whole(best, prior)
        wider = widening(lines)
        error = wider * _focal_error(alone)
        if self.photo.hint is not None:
            return self._with_hint(self.photo.hint, alone, lines, prior, doubts)
        if error <= FOCAL_SIGMA:
            doubts.notes.append(
                f"focal length guessed from the vanishing points: {alone.view.focal:.0f} px, standard error {error:.1%}"
            )
            return _Found(_widened(alone, wider), lines, "vanishing points", doubts)
        assumed = replace(prior, focal_error=0.0)
        fit, lines = self._whole(self._at(central_camera(prior.focal, self.width, self.height), assumed), assumed)
        doubts.notes.append(
            f"focal length not known and not to be told from the vanishing points; {prior.focal:.0f} px assumed "
            "(28 mm equivalent), so depths may be stretched; give --focal or --camera"
        )
        covariance = alone.covariance * wider**2
        covariance[FOCAL, FOCAL] = max(error, USUAL_FOCAL_ERROR / 2) ** 2
        return _Found(replace(fit, covariance=covariance), lines, "default", doubts)

    def _best(self, doubts: Doubts) -> tuple[Fit, Prior]:
        """The most likely view without EXIF, and what was assumed of the principal point."""
        usual = replace(
            prior_of(self.photo), focal=default_focal(self.width, self.height), focal_error=USUAL_FOCAL_ERROR
        )
        doubts.is_cropped = usual.center_error == CROPPED_CENTER_ERROR
        if doubts.is_cropped or self.photo.bend is not None:
            return best_fit(self.ends, self.width, self.height, usual), usual
        free = replace(usual, center_error=CROPPED_CENTER_ERROR)
        best = best_fit(self.ends, self.width, self.height, usual)
        wide = fit_view(self.ends, self.width, self.height, best.view, free)
        if wide.log_posterior - best.log_posterior <= CENTER_GAIN:
            return best, usual
        doubts.is_cropped = True
        off = wide.view.center - self.middle
        doubts.notes.append(
            f"the vanishing points put the principal point {np.hypot(*off):.0f} px off the middle, as after a crop or "
            "with a shifted lens"
        )
        return wide, free

    def _with_hint(self, hint: FocalHint, alone: Fit, lines: Int, prior: Prior, doubts: Doubts) -> _Found:
        """EXIF and vanishing points together; where they contradict each other, the one that is better supported."""
        wider = widening(lines)
        error = wider * _focal_error(alone)
        apart = abs(np.log(alone.view.focal / hint.focal)) / np.hypot(error, hint.relative_error)
        if apart > CONTRADICTION:
            doubts.is_contradicted = True
            told = f"EXIF says a focal length of {hint.focal:.0f} px, the vanishing points {alone.view.focal:.0f} px"
            if error < hint.relative_error / 2 and lines.min() >= ENOUGH_LINES:
                doubts.notes.append(f"{told}; the vanishing points are better supported and are believed")
                return _Found(_widened(alone, wider), lines, "vanishing points", doubts)
            doubts.notes.append(f"{told}; EXIF is believed, since few lines speak against it")
        # Errors of the segments are `wider` than the fit knows, so what EXIF says weighs by so much more.
        trusted = replace(prior, focal=hint.focal, focal_error=hint.relative_error / wider)
        at_hint = self._at(central_camera(hint.focal, self.width, self.height), trusted)
        near = fit_view(self.ends, self.width, self.height, alone.view, trusted)
        fit, lines = self._whole(max(at_hint, near, key=lambda one: one.log_posterior), trusted)
        return _Found(_widened(fit, wider), lines, "exif", doubts)

    def _at(self, K: Float, prior: Prior) -> Fit:
        """The most likely view near a camera matrix."""
        axes = search_axes(self.ends[:SEARCHED], K, DRAWS)
        return fit_view(self.ends, self.width, self.height, View(axes, K[0, 0], K[:2, 2]), prior)

    def _whole(self, fit: Fit, prior: Prior) -> tuple[Fit, Int]:
        """The fit again on whole segments, and how many of these run along each axis.

        What the detector broke into several fragments says more about its direction when it is whole.
        """
        least = MIN_WHOLE_LENGTH * max(self.width / SCALE_WIDTH, 1.0)
        ends = gathered(self.raw, fit, self.width)
        long = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1) >= least
        chosen = ends[long] if long.sum() >= MIN_SEGMENTS else ends
        fit = fit_view(chosen, self.width, self.height, fit.view, prior)
        if self.photo.bend is not None and prior.center_error > 0:
            # The photo was straightened about this point, so it stays; how sure it is, is another matter.
            center = np.array(self.photo.bend.center)
            pinned = replace(prior, center=center, center_error=0.0)
            start = replace(fit.view, center=center)
            there = fit_view(chosen, self.width, self.height, start, pinned)
            fit = replace(there, covariance=fit.covariance)
        points = fit.view.axes @ fit.view.matrix.T
        return fit, whole_lines(gathered(self.raw, fit, self.width), points, max(self.width, self.height))


def _focal_error(fit: Fit) -> float:
    """Relative standard error of the focal length."""
    return float(np.sqrt(fit.covariance[FOCAL, FOCAL]))


def _widened(fit: Fit, factor: float) -> Fit:
    """The fit with standard errors larger by a factor."""
    return replace(fit, covariance=fit.covariance * factor**2)


def decisive(raw: Segments, width: int) -> Float:
    """Ends (N, 2, 2) of the segments that are long enough to decide about the camera, the longest first."""
    long = raw.length >= MIN_LENGTH * max(width / SCALE_WIDTH, 1.0)
    return longest(raw.subset(long) if long.sum() >= len(raw) / 10 else raw)


def best_fit(ends: Float, width: int, height: int, prior: Prior) -> Fit:
    """The most likely view of segments (N, 2, 2) px, the longest first, whose focal length may be anything usual."""
    larger = max(width, height)
    fixed = replace(prior, radial_error=0.0)
    found = []
    focals = np.geomspace(FOCAL_RANGE[0] * larger, FOCAL_RANGE[1] * larger, FOCAL_CANDIDATES)
    for number, focal in enumerate(focals):
        axes = search_axes(ends[:SEARCHED], central_camera(focal, width, height), FOCAL_DRAWS, seed=number)
        start = View(axes, float(focal), prior.center)
        found.append(fit_view(ends[:SEARCHED], width, height, start, fixed, iterations=FIRST_ITERATIONS))
    found.sort(key=lambda fit: -fit.log_posterior)
    fits = [fit_view(ends, width, height, fit.view, prior) for fit in found[:STARTS]]
    best = max(fits, key=lambda fit: fit.log_posterior)
    # The likelihood of many segments has optima close to each other: look beside the best.
    beside = [replace(best.view, focal=best.view.focal * factor) for factor in BESIDE]
    fits = [best, *(fit_view(ends, width, height, view, prior) for view in beside)]
    return max(fits, key=lambda fit: fit.log_posterior)


def gathered(raw: Segments, fit: Fit, width: int) -> Float:
    """Ends (M, 2, 2) of all segments, those along an axis joined to whole ones that keep their own direction."""
    points = fit.own_axes @ fit.view.matrix.T
    sines = angles_to(raw.ends, points)
    near, axis = sines.min(axis=0) < np.sin(LABEL_ANGLE), sines.argmin(axis=0)
    whole = [fit_whole(raw.ends[near & (axis == number)], points[number], width) for number in range(3)]
    return np.concatenate([*whole, raw.ends[~near]])
