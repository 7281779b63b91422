"""Edges too faint or too short to build on, which faces can place once they are known.

A crossing of such an edge tells little of depth, and joins as often what is apart: so no graph is made of them. On the
face that the photo shows around it, an edge needs no crossing.
"""

from collections.abc import Iterable
from dataclasses import replace

import cv2
import numpy as np
from numpy.typing import NDArray

from linecad.arrays import Float, Int, true_places
from linecad.geometry import PhotoLength, lengths, resized_camera, segment_coordinates
from linecad.line_graph import ManhattanFrame, Segments
from linecad.lines.vanishing_point_lines import find_vanishing_point_lines
from linecad.scene import Camera

Pixels = NDArray[np.uint8]
Runs = list[list[tuple[float, float]]]  # from where to where, of each of N segments, px from its first end on

WIDTH = 1920  # px; wider photos are made smaller first, where a faint edge stands out from the grain
WIDTH_OF_WHOLE = 960  # px, the same for whole lines through vanishing points
EVIDENCE = 40.0  # nats, of such a line
WIDTH_OF_COLOURS = 960  # px; photos are stored with half of the resolution in colour
CONTRAST = 9.0  # grey levels that one unit of a or b of CIE Lab counts as
MIDDLE = 128.0  # grey level of the photo's median colour
ERROR = 1.0  # grey levels, by which the detector takes brightness to be off; half of what it usually does
LEAST, LEAST_OF_COLOUR = 10.0, 16.0  # px, of a fragment in the smaller photo: stains differ in colour too
DETECTOR_SCALE = 0.8
TWIN = PhotoLength(4.0, floor=2.0)  # px across, within which a segment repeats another
AT_ONCE = 64  # segments that are compared with all others, so that the arrays stay in fast memory
LEAST_STRETCH = PhotoLength(20.0, floor=8.0)  # px; what is left of a segment beside others is not worth less


def find_details(pixels: Pixels, grey: Pixels) -> Segments:
    """The straight segments of a photo (H, W, 3) RGB and (H, W) grey down to the faint ones, not labelled yet.

    Those of colour too: what differs in colour alone, as painted plaster does, is no edge in grey.
    """
    ends = [_detected(*_smaller(grey, WIDTH), LEAST)]
    ends += [_detected(*colour, LEAST_OF_COLOUR) for colour in _colours(pixels)]
    every = np.concatenate(ends)
    return Segments(every, np.full(len(every), -1))


def find_whole_details(grey: Pixels, camera: Camera, frame: ManhattanFrame) -> Segments:
    """The lines through vanishing points of a grey photo (H, W), labelled, also where it is large.

    A long edge stands out by its length alone, though none of its fragments does.
    """
    small, size = _smaller(grey, WIDTH_OF_WHOLE)
    matrix = resized_camera(camera.matrix, 1 / size)
    camera = replace(camera, width=small.shape[1], height=small.shape[0], matrix=matrix)
    found = find_vanishing_point_lines(small, camera, frame, EVIDENCE)
    return Segments((found.ends + 0.5) * size - 0.5, found.axis)


def _detected(small: Pixels, size: Float, least: float) -> Float:
    """The ends (N, 2, 2) of segments of `least` px or more in a smaller photo, on the pixels of the photo itself."""
    detector = cv2.createLineSegmentDetector(cv2.LSD_REFINE_STD, scale=DETECTOR_SCALE, quant=ERROR)
    found = detector.detect(small)[0]
    ends = np.zeros((0, 2, 2)) if found is None else found.reshape(-1, 2, 2).astype(float)
    ends = ends[lengths(ends[:, 1] - ends[:, 0]) >= least]
    on_photo: Float = (ends + 0.5) * size - 0.5
    return on_photo


def _colours(pixels: Pixels) -> list[tuple[Pixels, Float]]:
    """What a photo shows in colour alone, green to red and blue to yellow, as grey photos; and sizes as `_smaller`."""
    small, size = _smaller(pixels, WIDTH_OF_COLOURS)
    lab = cv2.cvtColor(small.astype(np.float32) / 255, cv2.COLOR_RGB2Lab)
    apart = (lab[..., 1:] - np.median(lab[..., 1:], axis=(0, 1))) * CONTRAST + MIDDLE
    shades = np.clip(np.rint(apart), 0, 255).astype(np.uint8)
    return [(np.ascontiguousarray(shades[..., channel]), size) for channel in range(2)]


def _smaller(photo: Pixels, width: int) -> tuple[Pixels, Float]:
    """A photo of at most that width, px, and how many of its own pixels (2,) one of that is, across and down."""
    scale = min(1.0, width / photo.shape[1])
    if scale == 1.0:
        return photo, np.ones(2)
    small = cv2.resize(photo, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
    return np.asarray(small, np.uint8), np.array([photo.shape[1] / small.shape[1], photo.shape[0] / small.shape[0]])


def apart_from(segments: Segments, others: Segments, width: int) -> Segments:
    """What is left of the segments in a photo of that width where none of the others of their axis repeats them.

    A segment may leave several stretches.
    """
    return left_of(segments, repeats(segments, others, width), width)


def repeats(segments: Segments, others: Segments, width: int) -> Runs:
    """From where to where along segments (N) any of the others of their axis runs beside them."""
    found: Runs = [[] for _ in range(len(segments))]
    across = TWIN.px(width)
    row, other = _near(segments, others, across)
    place, beside = segment_coordinates(others.ends[other], segments.ends[row, None])
    low, high = place.min(axis=1), place.max(axis=1)
    runs = (np.abs(beside) <= across).all(axis=1) & (high > 0) & (low < segments.length[row])
    for each, start, end in zip(row[runs].tolist(), low[runs].tolist(), high[runs].tolist(), strict=True):
        found[each].append((start, end))
    return found


def left_of(segments: Segments, covered: Runs, width: int) -> Segments:
    """The stretches of segments (N) that are not `covered` and worth a line in a photo of that width."""
    least = LEAST_STRETCH.px(width)
    ends: list[Float] = []
    rows: list[int] = []
    for row, (length, runs) in enumerate(zip(segments.length.tolist(), covered, strict=True)):
        for low, high in _gaps(length, runs):
            if high - low >= least:
                start, along = segments.ends[row, 0], segments.ends[row, 1] - segments.ends[row, 0]
                ends.append(start + np.array([[low], [high]]) * (along / length))
                rows.append(row)
    return Segments(np.array(ends).reshape(-1, 2, 2), segments.axis[np.array(rows, np.int64)])


def _near(segments: Segments, others: Segments, across: float) -> tuple[Int, Int]:
    """Pairs of a segment and another of its axis whose boxes come so near, px; by segment."""
    low, high = (reach(segments.ends, axis=1) for reach in (np.min, np.max))
    other_low, other_high = (reach(others.ends, axis=1) for reach in (np.min, np.max))
    pairs = [np.zeros((0, 2), np.int64)]
    for start in range(0, len(segments), AT_ONCE):
        few = np.s_[start : start + AT_ONCE]
        near = segments.axis[few, None] == others.axis
        for side in range(2):
            near &= low[few, None, side] - across <= other_high[:, side]
            near &= high[few, None, side] + across >= other_low[:, side]
        row, other = true_places(near)
        pairs.append(np.column_stack([row + start, other]))
    row, other = np.concatenate(pairs).T
    return row, other


def _gaps(length: float, covered: list[tuple[float, float]]) -> Iterable[tuple[float, float]]:
    """From where to where along a segment of that length nothing is `covered`."""
    at = 0.0
    for start, end in sorted(covered):
        if start > at:
            yield at, start
        at = max(at, end)
    if at < length:
        yield at, length
