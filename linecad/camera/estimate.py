"""The camera of a photo and its Manhattan frame, from what is known of the camera and from the segments; how sure."""

from dataclasses import dataclass, field, replace

import numpy as np

from linecad.arrays import Float, Int
from linecad.camera.crop_history import usual_aspect
from linecad.camera.exif_focal import ExifFocal
from linecad.camera.horizontal_frames import HorizontalFrames, find_horizontal_frames, only_frame
from linecad.camera.joint_fit import FOCAL, Fit, Prior, View, fit_view, known
from linecad.camera.photo import Photo
from linecad.camera.quality import ENOUGH_LINES, Findings
from linecad.camera.uncertainty import certainty_of, other_camera, whole_lines, widening
from linecad.camera.vanishing_points import (
    MIN_SEGMENTS,
    best_axes,
    default_focal,
    fit_frame,
    longest,
    name_frame,
    need_segments,
    search_axes,
)
from linecad.corrections.edits import SetFrame
from linecad.geometry import angles_to, central_camera
from linecad.line_graph import ManhattanFrame, Segments
from linecad.lines.segments import fit_whole
from linecad.scene import Camera, CameraSource, Certainty

FOCAL_SIGMA = 0.15  # relative standard error above which the vanishing points do not tell the focal length
USUAL_FOCAL_ERROR = 0.4  # of the focal lengths of photos about `default_focal`, relative
USUAL_CENTER_ERROR = 0.015  # of the principal points of whole photos about the middle, of the larger side
CROPPED_CENTER_ERROR = 0.15  # the same of photos from which parts were cut off
LARGEST_TURN_UNKNOWN = np.radians(0.4)  # of axes off the frame: less than else, as the focal length may bend as well
CENTER_GAIN = 3.0  # in log posterior, by which a principal point off the middle must explain more
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
REAL_SCENES = 1.5  # by which the focal lengths of York Urban's photos err more than standard errors say
CONTRADICTION = 3.0  # standard errors between EXIF and vanishing points


@dataclass(frozen=True, eq=False)
class Calibrated:
    """A camera and its Manhattan frame, how sure both are, and notes on it."""

    camera: Camera
    frames: HorizontalFrames  # the main one is the Manhattan frame
    certainty: Certainty
    notes: tuple[str, ...]  # those of the photo among them
    prior: Prior | None = None  # of a focal length from the vanishing points alone
    findings: Findings = field(default_factory=Findings)

    @property
    def frame(self) -> ManhattanFrame:
        """The Manhattan frame whose axes are those of the world."""
        return self.frames.main


def calibrate(photo: Photo, raw: Segments, drawn: SetFrame | None = None) -> Calibrated:
    """The camera and the frame of a photo with segments `raw`, as `linecad.lines.segments.find_segments` gives them.

    Lines that a person has `drawn` along the axes give the frame instead of the segments. Raises ReconstructionError
    when the photo has no Manhattan frame.
    """
    need_segments(raw)
    return _calibrated(photo, raw, raw, _Finder(photo, raw).find(), drawn)


def calibrate_again(photo: Photo, raw: Segments, first: Calibrated, chosen: Segments) -> Calibrated:
    """The same from the `chosen` ones of the segments alone, beginning at a first calibration.

    Only a camera whose focal length comes from the vanishing points alone is fitted again; the first calibration comes
    back where the chosen segments are too few or do not tell the focal length.
    """
    if first.prior is None or len(chosen) < MIN_SEGMENTS:
        return first
    finder = _Finder(photo, chosen)
    focal, K = first.camera.focal, first.camera.matrix
    start = fit_view(finder.ends, photo.width, photo.height, View(first.frame.rotation.T, focal, K[:2, 2]), first.prior)
    fit, counts = finder.whole(start, first.prior)
    wider = widening(counts)
    if wider * _focal_error(fit) > FOCAL_SIGMA:
        return first
    found = _Found(_widened(fit, wider), counts, first.camera.source, first.findings, prior=first.prior)
    return _calibrated(photo, raw, chosen, found, None)


def _calibrated(photo: Photo, raw: Segments, chosen: Segments, found: "_Found", drawn: SetFrame | None) -> Calibrated:
    """Camera and frame of a view; of the segments `raw` those that are `chosen` say where the axes are."""
    camera = photo.camera
    if camera is None or not camera.is_given:
        camera = Camera(photo.width, photo.height, found.fit.view.matrix, found.source)
    if photo.bend is not None:
        camera = replace(camera, distortion=photo.removed_distortion(camera.focal))
    notes = [*photo.notes, *found.findings.notes]
    if drawn is None:
        # The lines of one scene share one frame, so that of the least squares is theirs; that each axis may have a turn
        # of its own is for the camera and for the errors.
        K = camera.matrix
        frame = name_frame(raw, K, best_axes(chosen, K, found.fit.view.axes, *found.searched))
        frames = find_horizontal_frames(raw, camera, frame)
    else:
        ends = np.array([line.ends for line in drawn.lines])
        frame = fit_frame(ends, np.array([line.axis for line in drawn.lines]), camera.matrix, raw)
        notes.append("the Manhattan frame is that of lines drawn by hand")
        frames = only_frame(raw, camera, frame)
    certainty, more = certainty_of(camera, frames, found.fit, found.lines, found.findings, photo.bend)
    if camera.source == "vanishing points" and certainty.focal is not None:
        notes.append(
            f"focal length guessed from the vanishing points: {camera.focal:.0f} px, standard error "
            f"{certainty.focal / camera.focal:.1%}"
        )
    return Calibrated(camera, frames, certainty, (*notes, *more), found.prior, found.findings)


def prior_of(photo: Photo) -> Prior:
    """What is known of a photo's camera before its segments are looked at, with what EXIF says of it."""
    middle = np.array([(photo.width - 1) / 2, (photo.height - 1) / 2])
    may_be_cropped = photo.crop == "cropped" or (
        photo.crop == "unknown" and not usual_aspect(photo.width, photo.height)
    )
    center_error = CROPPED_CENTER_ERROR if may_be_cropped else USUAL_CENTER_ERROR
    if photo.bend is not None:
        middle, center_error = np.array(photo.bend.center), photo.bend.center_error / max(photo.width, photo.height)
    prior = Prior(
        default_focal(photo.width, photo.height), USUAL_FOCAL_ERROR, middle, center_error,
        largest_turn=LARGEST_TURN_UNKNOWN,
    )  # fmt: skip
    if photo.camera is not None and photo.camera.is_given:
        return replace(prior, focal=photo.camera.focal, focal_error=0.0)
    if photo.exif_focal is not None:
        return replace(prior, focal=photo.exif_focal.focal, focal_error=photo.exif_focal.relative_error)
    return prior


@dataclass(frozen=True, eq=False)
class _Found:
    """The most likely view of a photo."""

    fit: Fit
    lines: Int  # (3,) whole lines along each axis
    source: CameraSource
    findings: Findings
    searched: tuple[Float, ...] = ()  # axes (3, 3) at which the search for the frame ended
    prior: Prior | None = None


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
        if camera is not None and camera.is_given:
            prior = known(camera.matrix)
            axes = search_axes(self.ends[:SEARCHED], camera.matrix, DRAWS)
            start = View(axes, camera.focal, camera.matrix[:2, 2])
            fit, lines = self.whole(fit_view(self.ends, self.width, self.height, start, prior), prior)
            return _Found(fit, lines, camera.source, Findings(is_fisheye=self.photo.is_fisheye), (axes,))
        findings = Findings(is_fisheye=self.photo.is_fisheye)
        best, prior = self._best(findings)
        alone, lines = self.whole(best, prior)
        if self.photo.exif_focal is not None:
            return self._with_exif(self.photo.exif_focal, alone, lines, prior, findings)
        wider = widening(lines)
        error = wider * _focal_error(alone)
        if error <= FOCAL_SIGMA:
            return _Found(_widened(alone, wider), lines, "vanishing points", findings, prior=prior)
        assumed = replace(prior, focal_error=0.0)
        fit, lines = self.whole(self._at(central_camera(prior.focal, self.width, self.height), assumed), assumed)
        findings.notes.append(
            f"focal length not known and not to be told from the vanishing points; {prior.focal:.0f} px assumed "
            "(28 mm equivalent), so depths may be stretched; give --focal or --camera"
        )
        covariance = alone.covariance * wider**2
        covariance[FOCAL, FOCAL] = max(error, USUAL_FOCAL_ERROR) ** 2
        return _Found(replace(fit, covariance=covariance), lines, "default", findings)

    def _best(self, findings: Findings) -> tuple[Fit, Prior]:
        """The most likely view without EXIF, and what was assumed of the principal point."""
        usual = replace(
            prior_of(self.photo), focal=default_focal(self.width, self.height), focal_error=USUAL_FOCAL_ERROR
        )
        findings.is_cropped = usual.center_error == CROPPED_CENTER_ERROR
        fits = likely_fits(self.ends, self.width, self.height, usual)
        best = fits[0]
        findings.other = other_camera(best, fits, len(self.ends))
        if findings.is_cropped or self.photo.bend is not None:
            return best, usual
        free = replace(usual, center_error=CROPPED_CENTER_ERROR)
        wide = fit_view(self.ends, self.width, self.height, best.view, free)
        # Where an axis has few lines, they move the principal point to wherever suits them.
        gain = wide.log_posterior - best.log_posterior
        if gain <= CENTER_GAIN or self._lines(best).min() < ENOUGH_LINES:
            return best, usual
        findings.is_cropped = True
        off = wide.view.center - self.middle
        findings.notes.append(
            f"the vanishing points put the principal point {np.hypot(*off):.0f} px off the middle, as after a crop or "
            "with a shifted lens"
        )
        return wide, free

    def _with_exif(self, exif: ExifFocal, alone: Fit, lines: Int, prior: Prior, findings: Findings) -> _Found:
        """EXIF and vanishing points together; where they contradict each other, the one that is better supported."""
        wider = widening(lines)
        error = wider * _focal_error(alone)
        apart = abs(np.log(alone.view.focal / exif.focal)) / np.hypot(error, exif.relative_error)
        if apart > CONTRADICTION:
            findings.is_contradicted = True
            told = f"EXIF says a focal length of {exif.focal:.0f} px, the vanishing points {alone.view.focal:.0f} px"
            is_sure = error < exif.relative_error / 2 and lines.min() >= ENOUGH_LINES and findings.other is None
            if is_sure and self.photo.crop != "whole":
                findings.notes.append(f"{told}; the vanishing points are better supported and are believed")
                return _Found(_widened(alone, wider), lines, "vanishing points", findings, prior=prior)
            # EXIF of a photo that is as it was taken is seldom far off; lines that are not square are common.
            findings.notes.append(f"{told}; EXIF is believed")
            findings.other = None
            given = replace(prior, focal=exif.focal, focal_error=0.0)
            fit, lines = self._at_exif_focal(exif, replace(alone.view, focal=exif.focal), given)
            fit = _widened(fit, wider)
            fit.covariance[FOCAL, FOCAL] = exif.relative_error**2
            return _Found(fit, lines, "exif", findings)
        findings.other = None
        # Errors of the segments are `wider` than the fit knows, and those of real scenes wider still, so what EXIF says
        # weighs by so much more.
        trusted = replace(prior, focal=exif.focal, focal_error=exif.relative_error / wider / REAL_SCENES)
        fit, lines = self._at_exif_focal(exif, alone.view, trusted)
        return _Found(_widened(fit, wider), lines, "exif", findings)

    def _at_exif_focal(self, exif: ExifFocal, near: View, prior: Prior) -> tuple[Fit, Int]:
        """The better of two fits, from a search at EXIF's focal length and from a view `near`, on whole segments."""
        fits = [
            self._at(central_camera(exif.focal, self.width, self.height), prior),
            fit_view(self.ends, self.width, self.height, near, prior),
        ]
        return self.whole(max(fits, key=lambda one: one.log_posterior), prior)

    def _at(self, K: Float, prior: Prior) -> Fit:
        """The most likely view near a camera matrix."""
        axes = search_axes(self.ends[:SEARCHED], K, DRAWS)
        return fit_view(self.ends, self.width, self.height, View(axes, K[0, 0], K[:2, 2]), prior)

    def whole(self, fit: Fit, prior: Prior) -> tuple[Fit, Int]:
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
        return fit, self._lines(fit)

    def _lines(self, fit: Fit) -> Int:
        """How many whole segments run along each axis (3,)."""
        points = fit.view.axes @ fit.view.matrix.T
        return whole_lines(gathered(self.raw, fit, self.width), points, max(self.width, self.height))


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
    return likely_fits(ends, width, height, prior)[0]


def likely_fits(ends: Float, width: int, height: int, prior: Prior) -> list[Fit]:
    """Views to which fits of these segments came from different starts, the most likely first."""
    larger = max(width, height)
    fixed = replace(prior, radial_error=0.0)
    found = []
    is_given = prior.focal_error == 0
    focals = np.geomspace(FOCAL_RANGE[0] * larger, FOCAL_RANGE[1] * larger, FOCAL_CANDIDATES)
    for number, focal in enumerate([prior.focal] if is_given else focals):
        axes = search_axes(ends[:SEARCHED], central_camera(focal, width, height), FOCAL_DRAWS, seed=number)
        start = View(axes, float(focal), prior.center)
        found.append(fit_view(ends[:SEARCHED], width, height, start, fixed, iterations=FIRST_ITERATIONS))
    found.sort(key=lambda fit: -fit.log_posterior)
    fits = [fit_view(ends, width, height, fit.view, prior) for fit in found[:STARTS]]
    best = max(fits, key=lambda fit: fit.log_posterior)
    # The likelihood of many segments has optima close to each other: look beside the best.
    beside = [] if is_given else [replace(best.view, focal=best.view.focal * factor) for factor in BESIDE]
    fits += [fit_view(ends, width, height, view, prior) for view in beside]
    return sorted(fits, key=lambda fit: -fit.log_posterior)


def gathered(raw: Segments, fit: Fit, width: int) -> Float:
    """Ends (M, 2, 2) of all segments, those along an axis joined to whole ones that keep their own direction."""
    points = fit.own_axes @ fit.view.matrix.T
    sines = angles_to(raw.ends, points)
    near, axis = sines.min(axis=0) < np.sin(LABEL_ANGLE), sines.argmin(axis=0)
    whole = [fit_whole(raw.ends[near & (axis == number)], points[number], width) for number in range(3)]
    return np.concatenate([*whole, raw.ends[~near]])
