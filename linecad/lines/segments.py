"""Pixels to straight segments, and fragments of one line grouped along its vanishing point.

The paper used MCMLSD, which finds whole lines first. OpenCV's detector gives fragments, so once the frame is known the
fragments of one axis that lie on one image line through its vanishing point and nearly touch become one segment.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from linecad.arrays import Float, Int, true_places
from linecad.geometry import PhotoLength, angles_to, directions_to, lengths, middles, reach_across, vanishing_points
from linecad.line_graph import ManhattanFrame, Segments
from linecad.options import SHORT_REACH
from linecad.scene import Camera

SMALL_WIDTH = 1280.0  # px; narrower photos show lines in fewer pixels than detector and labels ask for
DETECTOR_SCALE = 0.8  # from SMALL_WIDTH on; more in proportion below: the detector's noise floor is in pixels
DETECTOR_SCALE_LIMIT = 1.6  # an enlarged photo has no more to show
GRAIN = 5  # px, side of the median filter before the second look
# Shorter fragments are texture; below the floor the direction of one is noise.
MIN_FRAGMENT = PhotoLength(15.0, floor=6.0)

LABEL_ANGLE = np.radians(3.0)  # largest angle between a segment and its vanishing point, from SMALL_WIDTH on
LABEL_ANGLE_LIMIT = np.radians(5.0)  # the most in narrower photos, where segments are short and it grows in proportion
# Between fragments of one line; no segment is placed better than the floor, and the frame of a small photo is worse.
GROUP_ACROSS = PhotoLength(2.5, floor=1.25)
PAIRS = 2**16  # of fragments that are compared at a time: more would not fit into a processor's cache
GAP_FLOOR = 4.0  # px in any photo, of the largest gap between fragments of one line


def detector_scale(width: int) -> float:
    """How much a photo of that width, px, is enlarged for the detector; falls continuously from 1.6 to 0.8."""
    return min(DETECTOR_SCALE * max(SMALL_WIDTH / width, 1.0), DETECTOR_SCALE_LIMIT)


def label_angle(width: int) -> float:
    """The largest angle, rad, between a segment and its axis in a photo of that width, px; 5 to 3 degrees."""
    return float(min(LABEL_ANGLE * max(SMALL_WIDTH / width, 1.0), LABEL_ANGLE_LIMIT))


def find_segments(grey: NDArray[np.uint8]) -> Segments:
    """All straight segments of a grey photo (H, W), not labelled yet, in the detector's order."""
    detector = cv2.createLineSegmentDetector(cv2.LSD_REFINE_ADV, scale=detector_scale(grey.shape[1]))
    found = detector.detect(grey)[0]
    ends = np.zeros((0, 2, 2)) if found is None else found.reshape(-1, 2, 2).astype(float)
    long_enough = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1) >= MIN_FRAGMENT.px(grey.shape[1])
    ends = ends[long_enough]
    return Segments(ends, np.full(len(ends), -1))


def find_faint_segments(grey: NDArray[np.uint8]) -> Segments:
    """What a second look finds at a photo (H, W) without its grain: edges that noise hides from the first."""
    return find_segments(np.asarray(cv2.medianBlur(grey, GRAIN), np.uint8))


def label_segments(segments: Segments, camera: Camera, frame: ManhattanFrame) -> Segments:
    """The segments that point to one of the three vanishing points, labelled by it (the paper's D_i).

    One that goes on beyond a vanishing point, such as a mast before the end of a street, is not of that axis.
    """
    points = vanishing_points(camera.matrix, frame.rotation)
    sines = np.where(reach_across(segments.ends, points), 1.0, angles_to(segments.ends, points))
    return Segments(segments.ends, sines.argmin(axis=0)).subset(sines.min(axis=0) < np.sin(label_angle(camera.width)))


def group_segments(
    segments: Segments, camera: Camera, frame: ManhattanFrame, largest_gap: float = SHORT_REACH.largest_gap
) -> Segments:
    """Labelled fragments joined into whole segments that pass exactly through their vanishing points.

    The longest fragment of a line leads: it gathers the fragments of its axis within GROUP_ACROSS of its image line
    whose gaps along the line are at most `largest_gap`, in px at the reference width. The joined segment runs through
    the length-weighted mean.
    """
    across, along = _reach(camera.width, largest_gap)
    points = vanishing_points(camera.matrix, frame.axes)
    ends: list[Float] = []
    axes: list[int] = []
    for axis in range(len(points)):
        own = segments.ends[segments.axis == axis]
        lines = _gathered(own, points[axis], across, along)
        alike = _of_one_size(lines)
        centre = _centres(own, alike, len(lines))
        ends.append(_stretched(own, alike, centre, directions_to(centre, points[axis])))
        axes += [axis] * len(lines)
    return Segments(np.concatenate(ends), np.array(axes, np.int64))


def fit_whole(ends: Float, vanishing: Float, width: int) -> Float:
    """Fragments (N, 2, 2) px that point to one vanishing point (3,), as whole segments (M, 2, 2).

    They are gathered as by `group_segments` but not turned to the vanishing point, so that they can tell where it is.
    """
    lines = _gathered(ends, vanishing, *_reach(width, SHORT_REACH.largest_gap))
    alike = _of_one_size(lines)
    centre = _centres(ends, alike, len(lines))
    return _stretched(ends, alike, centre, _fitted_directions(ends, alike, centre))


def _reach(width: int, largest_gap: float) -> tuple[float, float]:
    """How far, px, fragments of one line may lie apart across it and along it."""
    return GROUP_ACROSS.px(width), PhotoLength(largest_gap, GAP_FLOOR).px(width)


def _gathered(ends: Float, vanishing: Float, across: float, along: float) -> list[list[int]]:
    """The fragments of each line, as indices of fragments (N, 2, 2) of one axis, the longest leader first."""
    order = np.argsort(-_length(ends), kind="stable")
    free = np.ones(len(ends), bool)
    direction = directions_to(middles(ends), vanishing)
    lines: list[list[int]] = []
    while len(order):
        leaders = order[: max(1, PAIRS // len(order))]
        pairs = _near(ends, direction, leaders, np.flatnonzero(free), across)
        is_free = free.tolist()
        for leader, start, end in zip(leaders.tolist(), pairs.start[:-1], pairs.start[1:], strict=True):
            if is_free[leader]:
                lines.append(_touching(pairs, range(start, end), is_free, along, leader))
                for own in lines[-1]:
                    is_free[own] = False
        free = np.array(is_free)
        order = order[free[order]]
    return lines


@dataclass(frozen=True, eq=False)
class _Pairs:
    """Leaders with the fragments that are on their image lines, P pairs in the order of the L leaders."""

    start: list[int]  # L + 1, the first pair of each leader, and P
    other: list[int]  # P, the fragment, as they begin along the line of each leader, which is among them
    low: list[float]  # P, px, where it begins along the line
    high: list[float]  # P, px, where it ends


def _near(ends: Float, direction: Float, leaders: Int, others: Int, across: float) -> _Pairs:
    """Those `others` of fragments (N, 2, 2), of directions (N, 2) to their vanishing point, near the leaders' lines."""
    middle = middles(ends)
    normal = direction[leaders] @ np.array([[0.0, 1.0], [-1.0, 0.0]])
    off = np.abs(normal @ middle[others].T - (normal * middle[leaders]).sum(axis=1, keepdims=True))
    # A line that went through its vanishing point would be at infinity there: what lies beyond is another one.
    one_side = direction[leaders] @ direction[others].T > 0
    row, column = true_places(one_side & (off < across))
    leader, other = leaders[row], others[column]
    from_leader, along = ends[other] - middle[leader, None], direction[leader]
    reach = from_leader[..., 0] * along[:, None, 0] + from_leader[..., 1] * along[:, None, 1]
    low, high = np.minimum(*reach.T), np.maximum(*reach.T)
    order = np.lexsort((low, row))
    start = np.searchsorted(row, np.arange(len(leaders) + 1)).tolist()
    return _Pairs(start, other[order].tolist(), low[order].tolist(), high[order].tolist())


def _touching(pairs: _Pairs, among: range, is_free: list[bool], gap: float, leader: int) -> list[int]:
    """The free fragments of a leader's pairs `among` all that hang together with it over gaps of at most `gap` px."""
    # Plain numbers, as a leader has a handful of pairs: NumPy would take longer to be called.
    run: list[int] = []
    furthest = -np.inf
    for at in among:
        other = pairs.other[at]
        if not is_free[other]:
            continue
        if pairs.low[at] > furthest + gap:
            if leader in run:
                break
            run = []
        run.append(other)
        furthest = max(furthest, pairs.high[at])
    return run


def _length(ends: Float) -> Float:
    """Lengths (N,) px of fragments (N, 2, 2)."""
    return lengths(ends[:, 1] - ends[:, 0])


def _of_one_size(lines: list[list[int]]) -> list[tuple[Int, Int]]:
    """The numbers (L,) of the lines of K fragments and these (L, K), for each K: lines of one K are done at once."""
    size = np.array([len(own) for own in lines], np.int64)
    alike = [np.flatnonzero(size == count) for count in np.unique(size)]
    return [(which, np.array([lines[number] for number in which.tolist()])) for which in alike]


def _centres(ends: Float, alike: list[tuple[Int, Int]], count: int) -> Float:
    """The mean (G, 2) of the middles of the fragments of each of `count` lines, by their length."""
    length = _length(ends)
    weighted = middles(ends) * length[:, None]
    centre = np.empty((count, 2))
    for which, own in alike:
        centre[which] = weighted[own].sum(axis=1) / length[own].sum(axis=1)[:, None]
    return centre


def _fitted_directions(ends: Float, alike: list[tuple[Int, Int]], centre: Float) -> Float:
    """The direction (G, 2) of each line that has the least squares of distance along all of its fragments."""
    along, middle, length = ends[:, 1] - ends[:, 0], middles(ends), _length(ends)[:, None]
    spread = np.empty((len(centre), 2, 2))
    for which, own in alike:
        off = middle[own] - centre[which, None]
        spread[which] = (off * length[own]).swapaxes(1, 2) @ off
        spread[which] += (along[own] * length[own]).swapaxes(1, 2) @ along[own] / 12
    directions: Float = np.linalg.eigh(spread)[1][:, :, 1]
    return directions


def _stretched(ends: Float, alike: list[tuple[Int, Int]], centre: Float, direction: Float) -> Float:
    """Segments (G, 2, 2) through the centres (G, 2), along the directions (G, 2) as far as the fragments reach."""
    reach = np.empty((len(centre), 2, 1))
    for which, own in alike:
        off = ends[own].reshape(len(which), -1, 2) - centre[which, None]
        along = off @ direction[which, :, None]
        reach[which, 0], reach[which, 1] = along.min(axis=1), along.max(axis=1)
    segments: Float = centre[:, None] + reach * direction[:, None]
    return segments
