"""Pixels to straight segments, and fragments of one line grouped along its vanishing point.

The paper used MCMLSD, which finds whole lines first. OpenCV's detector gives fragments, so once the frame is known the
fragments of one axis that lie on one image line through its vanishing point and nearly touch become one segment.
"""

import cv2
import numpy as np
from numpy.typing import NDArray

from linecad.arrays import Float, Int
from linecad.geometry import PhotoLength, angles_to, directions_to, vanishing_points
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
    """The segments that point to one of the three vanishing points, labelled by it (the paper's D_i)."""
    sines = angles_to(segments.ends, vanishing_points(camera.matrix, frame.rotation))
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
    points = vanishing_points(camera.matrix, frame.rotation)
    ends: list[Float] = []
    axes: list[int] = []
    for axis in range(3):
        own = segments.ends[segments.axis == axis]
        grouped = [_join(own[m], points[axis]) for m in _gathered(own, points[axis], across, along)]
        ends += grouped
        axes += [axis] * len(grouped)
    return Segments(np.array(ends), np.array(axes, np.int64))


def fit_whole(ends: Float, vanishing: Float, width: int) -> Float:
    """Fragments (N, 2, 2) px that point to one vanishing point (3,), as whole segments (M, 2, 2).

    They are gathered as by `group_segments` but not turned to the vanishing point, so that they can tell where it is.
    """
    whole = [_fit(ends[members]) for members in _gathered(ends, vanishing, *_reach(width, SHORT_REACH.largest_gap))]
    return np.array(whole).reshape(-1, 2, 2)


def _reach(width: int, largest_gap: float) -> tuple[float, float]:
    """How far, px, fragments of one line may lie apart across it and along it."""
    return GROUP_ACROSS.px(width), PhotoLength(largest_gap, GAP_FLOOR).px(width)


def _gathered(ends: Float, vanishing: Float, across: float, along: float) -> list[Int]:
    """The fragments of each line, as indices of fragments (N, 2, 2) of one axis, the longest leader first."""
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    middle = ends.mean(axis=1)
    direction = directions_to(middle, vanishing)
    free = np.ones(len(ends), bool)
    lines: list[Int] = []
    for leader in np.argsort(-length, kind="stable"):
        if not free[leader]:
            continue
        normal = np.array([-direction[leader, 1], direction[leader, 0]])
        # A line that went through its vanishing point would be at infinity there: what lies beyond is another one.
        one_side = direction @ direction[leader] > 0
        near = np.flatnonzero(free & one_side & (np.abs((middle - middle[leader]) @ normal) < across))
        reach = (ends[near] - middle[leader]) @ direction[leader]
        members = near[_touching(reach.min(axis=1), reach.max(axis=1), along, int(np.flatnonzero(near == leader)[0]))]
        free[members] = False
        lines.append(members)
    return lines


def _touching(low: Float, high: Float, gap: float, leader: int) -> Int:
    """Indices of the intervals that hang together with the leader's over gaps of at most `gap`."""
    order = np.argsort(low, kind="stable")
    furthest = np.maximum.accumulate(high[order])
    new_run = np.r_[False, low[order][1:] > furthest[:-1] + gap]
    run = np.cumsum(new_run)
    together: Int = order[run == run[np.flatnonzero(order == leader)[0]]]
    return together


def _fit(ends: Float) -> Float:
    """One segment (2, 2) through fragments (M, 2, 2): the line with the least squares of distance along all of them."""
    along, middle = ends[:, 1] - ends[:, 0], ends.mean(axis=1)
    length = np.linalg.norm(along, axis=1)
    centre = np.average(middle, axis=0, weights=length)
    off = middle - centre
    spread = (off * length[:, None]).T @ off + (along * length[:, None]).T @ along / 12
    direction = np.linalg.eigh(spread)[1][:, 1]
    reach = (ends.reshape(-1, 2) - centre) @ direction
    segment: Float = centre + np.array([[reach.min()], [reach.max()]]) * direction
    return segment


def _join(ends: Float, vanishing: Float) -> Float:
    """One segment (2, 2) through fragments (M, 2, 2), turned to pass exactly through the vanishing point."""
    centre = np.average(ends.mean(axis=1), axis=0, weights=np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1))
    direction = directions_to(centre, vanishing)
    reach = (ends.reshape(-1, 2) - centre) @ direction
    segment: Float = centre + np.array([[reach.min()], [reach.max()]]) * direction
    return segment
