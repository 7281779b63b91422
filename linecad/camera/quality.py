"""How good a camera and its frame are, in one word that scene and camera files publish, and the reason for it."""

from dataclasses import dataclass, field

import numpy as np

from linecad.arrays import Int
from linecad.camera.photo import Bend
from linecad.line_graph import ManhattanFrame
from linecad.scene import CameraSource, Quality

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
STRONG_BEND = 0.1  # of the radius at the corners; one coefficient describes more than this only roughly
LARGEST_OWN_TURN = np.radians(1.0)  # by which the axes may lie off an orthogonal frame
EVEN_ROLL = np.radians(40.0)  # beyond it two axes are almost equally upright


@dataclass(frozen=True)
class Other:
    """How far another camera, which explains the segments almost as well, lies from the one that was taken."""

    focal: float  # relative, its logarithm
    turn: float  # rad


@dataclass
class Findings:
    """What was noticed while a camera was fitted."""

    is_cropped: bool = False  # or may be: the principal point was searched far from the middle
    is_fisheye: bool = False  # lines are bent by more than could be taken out
    is_contradicted: bool = False  # EXIF and vanishing points do not agree
    other: Other | None = None  # camera that explains the segments almost as well
    notes: list[str] = field(default_factory=list)


@dataclass(frozen=True, eq=False)
class Fitted:
    """Everything about a fitted camera that its quality follows from."""

    source: CameraSource
    focal_error: float | None  # relative standard error; None where the camera was given
    turn_error: float  # rad, the largest standard error of the turns
    axes_off: float  # rad, by which the axes usually lie off an orthogonal frame
    lines: Int  # (3,) whole lines along each axis
    frame: ManhattanFrame
    bend: Bend | None  # the distortion that was taken out
    second_share: float  # of the segment length that a second frame explains
    findings: Findings

    @property
    def vanishing_points_tell(self) -> bool:
        """Whether the focal length follows from the vanishing points alone."""
        return self.focal_error is not None and self.source != "exif"

    @property
    def few_for_focal(self) -> bool:
        """Whether the axis with the fewest lines has too few for the focal length that follows from it."""
        return self.vanishing_points_tell and bool(self.lines.min() < ENOUGH_LINES)

    @property
    def few_for_axes(self) -> bool:
        """Whether the second axis has too few lines."""
        return bool(np.sort(self.lines)[1] < ENOUGH_LINES_KNOWN)


def quality_of(fitted: Fitted) -> tuple[Quality, str]:
    """The word, and the weightiest reason for it."""
    for holds, reason in _poor(fitted):
        if holds:
            return "poor", reason
    for holds, reason in _doubtful(fitted):
        if holds:
            return "doubtful", reason
    lines, explained = fitted.lines.sum(), fitted.frame.explained
    return "good", f"{lines} whole lines agree, {explained:.0%} of the segment length runs along the axes"


def _poor(fitted: Fitted) -> list[tuple[bool, str]]:
    """What makes a camera poor: whether it does, and the reason in words, the weightiest first."""
    fewest, middle = np.sort(fitted.lines)[:2]
    explained, turn, focal = fitted.frame.explained, fitted.turn_error, fitted.focal_error
    few = ""
    if fitted.few_for_focal or fitted.few_for_axes:
        few = f", as few lines ({middle if fitted.few_for_axes else fewest}) run along one of them"
    return [
        (explained < POOR_SHARE, f"only {explained:.0%} of the segment length runs along the three axes"),
        (turn > POOR_TURN, f"the axes are known to {np.degrees(turn):.0f} degrees only{few}"),
        (focal is not None and focal > POOR_FOCAL_ERROR, "the photo does not tell its focal length, which is assumed"),
    ]


def _doubtful(fitted: Fitted) -> list[tuple[bool, str]]:
    """What makes a camera doubtful, likewise."""
    findings, bend = fitted.findings, fitted.bend
    fewest, middle = np.sort(fitted.lines)[:2]
    together = fitted.lines.sum()
    explained, turn, focal = fitted.frame.explained, fitted.turn_error, fitted.focal_error
    largest = GOOD_FOCAL_ERROR if fitted.source == "exif" else GOOD_FOCAL_ERROR_ALONE
    upright = np.abs(fitted.frame.rotation[1])
    tilt = float(np.arctan2(upright[:2].max(), upright[2]))
    return [
        (findings.is_fisheye, "the lens bends straight lines by more than could be taken out"),
        (findings.is_contradicted, "EXIF and the vanishing points contradict each other about the focal length"),
        (findings.is_cropped, "the photo may be cropped, so that its principal point lies off the middle"),
        (fitted.source == "default", "the focal length is assumed"),
        (findings.other is not None, "another camera explains the segments almost as well"),
        (fitted.few_for_focal,
         f"few lines ({fewest}) run along one of the three axes, from which the focal length follows"),
        (fitted.few_for_axes, f"few lines ({middle}) run along the second of the three axes"),
        (focal is not None and focal > largest, f"the focal length is known to {focal or 0:.0%} only"),
        (fitted.vanishing_points_tell and together < ENOUGH_TOGETHER,
         f"few lines ({together}) run along the three axes together, from which the focal length follows"),
        (explained < GOOD_SHARE, f"only {explained:.0%} of the segment length runs along the three axes"),
        (bend is not None and abs(bend.radial) > STRONG_BEND,
         "the lens bends lines by so much that one coefficient describes it only roughly"),
        (turn > GOOD_TURN, f"the axes are known to {np.degrees(turn):.1f} degrees only"),
        (fitted.axes_off > LARGEST_OWN_TURN,
         f"the axes are not square: they lie {np.degrees(fitted.axes_off):.1f} degrees off"),
        (tilt > EVEN_ROLL, "the photo is turned so far that another axis may be the upright one"),
        (fitted.second_share > explained / 2, "a second Manhattan frame explains almost as much"),
    ]  # fmt: skip
