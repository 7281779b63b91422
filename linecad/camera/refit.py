"""The camera of a photo, fitted again to the lines that meet in space where vanishing points alone tell it.

What meets nothing (cables, kerbs, trees) is mostly no line of the scene. Cameras that were given, or that EXIF tells
of, get no better by a second fit (docs/decisions/0009).
"""

import numpy as np

from linecad.arrays import Bool, Float
from linecad.camera.estimate import Calibrated, calibrate, calibrate_again
from linecad.camera.photo import Photo
from linecad.corrections.edits import SetFrame
from linecad.geometry import PhotoLength, lengths, middles, segment_coordinates
from linecad.graph.build import build_line_graph
from linecad.graph.connectivity import components
from linecad.line_graph import Segments
from linecad.lines.segments import group_segments, label_segments
from linecad.options import LONG_REACH, MIN_COMPONENT
from linecad.progress import StageReport, silent
from solver.robust import RobustFit

NEAR_LINE = PhotoLength(3.0, floor=0.9)  # across a line: what lies within it is a piece of it
PAIRS = 2**16  # of segments and lines that are compared at a time: more would not fit into a processor's cache


def find_calibration(
    photo: Photo, raw: Segments, on_stage: StageReport = silent, drawn: SetFrame | None = None
) -> Calibrated:
    """Camera and frame of a photo with segments `raw`; from vanishing points alone, fitted again to lines that meet.

    Lines that a person has `drawn` along the axes give the frame instead of the segments. Raises ReconstructionError
    when the photo has no Manhattan frame.
    """
    first = calibrate(photo, raw, drawn)
    if first.prior is None or drawn is not None:
        return first
    on_stage("fitting the camera again to the lines that meet in space")
    lines = _lines_that_meet(photo, raw, first)
    if lines is None:
        return first
    chosen = raw.subset(_lies_on(raw.ends, lines.ends, NEAR_LINE.px(photo.width)))
    return calibrate_again(photo, raw, first, chosen)


def _lines_that_meet(photo: Photo, raw: Segments, calibrated: Calibrated) -> Segments | None:
    """The whole lines of a photo in groups whose crossings a robust fit at long reach agrees with; None without any."""
    camera, frame = calibrated.camera, calibrated.frame
    whole = group_segments(label_segments(raw, camera, frame), camera, frame, LONG_REACH.largest_gap)
    graph = build_line_graph(whole, camera, frame, LONG_REACH, "odds", True, photo.pixels)
    agrees = graph.informative & (graph.misfit(RobustFit(graph).depths()) <= graph.tolerance)
    met = [part for part in components(graph, agrees) if len(part) >= MIN_COMPONENT]
    return graph.segments.subset(np.concatenate(met)) if met else None


def _lies_on(ends: Float, lines: Float, reach: float) -> Bool:
    """Which segments (N, 2, 2) have their middle within `reach` px of one of the lines (M, 2, 2)."""
    length = lengths(lines[:, 1] - lines[:, 0])
    middle = middles(ends)
    some = max(1, PAIRS // len(lines))
    near = np.zeros(len(ends), bool)
    for first in range(0, len(ends), some):
        own = slice(first, first + some)
        place, beside = segment_coordinates(middle[own, None], lines)
        near[own] = ((np.abs(beside) < reach) & (place > -reach) & (place < length + reach)).any(axis=1)
    return near
