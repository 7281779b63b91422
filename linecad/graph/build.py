"""Labelled segments to the paper's line graph: which lines may meet, with what evidence, and what it would mean.

Every crossing of two segments of different axes, each extended by `extension`, is an edge. Two lines that meet agree
along the normal alpha of their plane: s_i d_i = s_j d_j, an equation between the logs of their depths. Its tolerance is
not a free parameter: it is how far the equation moves when the segments move by their pixel noise.
"""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from linecad.arrays import Bool, Float, Int, Text, true_places
from linecad.directions import across, third
from linecad.geometry import PhotoLength, directions_to, lengths, vanishing_points, world_rays
from linecad.graph.cues import Known, weigh
from linecad.line_graph import LineGraph, ManhattanFrame, Segments
from linecad.options import SHORT_REACH, Reach, Weights
from linecad.scene import Camera

EXTENSION_FLOOR = 5.0  # px in any photo: the ends of a segment are not known better
MIN_LENGTH_FLOOR = 10.0  # px in any photo
END_ZONE = PhotoLength(10.0, 2.5)  # a crossing so near an end counts as at the end
CORNER_REACH = PhotoLength(12.0, 3.0)  # between the crossings of a Y or W junction

COLLINEAR_ACROSS = PhotoLength(2.5, 1.25)  # between two segments of one line, as for grouping (linecad.lines.segments)
COLLINEAR_GAP = PhotoLength(1000.0)  # what is further apart says nothing about each other
COLLINEAR_GAP_SHARE = 1.5  # of the shorter segment; a larger gap needs longer segments to be believed

NOISE = PhotoLength(1.25, 0.5)  # across the segment, one standard deviation; the detector is never better
NOISE_FACTOR = 3.0  # standard deviations that a tolerance covers
PAIRS = 2**16  # of segments that are compared at a time: more would not fit into a processor's cache
MAX_TOLERANCE = np.log(1.6)  # beyond it the crossing says nothing about depth


@dataclass(frozen=True, eq=False)
class _Crossings:
    """Crossings of extended segments, before they are judged."""

    edges: Int  # (E, 2)
    point: Float  # (E, 2) px
    gap: Float  # (E, 2) px by which each segment falls short
    inside: Float  # (E, 2) px to the nearer end, for a crossing inside the segment


def build_line_graph(
    segments: Segments,
    camera: Camera,
    frame: ManhattanFrame,
    reach: Reach = SHORT_REACH,
    weights: Weights = "junctions",
    collinear: bool = False,
    pixels: NDArray[np.uint8] | None = None,
) -> LineGraph:
    """The line graph of segments that pass through their vanishing points (paper, section "Line Graph").

    Segments shorter than the reach asks for are left out. `collinear` adds a second kind of edge that the paper does
    not have: two segments on one image line may be one line in space. `weights` names the cues that weigh the edges;
    `pixels` (H, W, 3) are those of the photo, for cues that look at it.
    """
    width = camera.width
    segments = segments.subset(segments.length >= PhotoLength(reach.least_length, MIN_LENGTH_FLOOR).px(width))
    found = _find_crossings(segments, PhotoLength(reach.extension, EXTENSION_FLOOR).px(width))
    kind = _junction_kinds(found, END_ZONE.px(width))
    corner = _corners(found, segments.axis, CORNER_REACH.px(width))
    rays = world_rays(segments.ends.mean(axis=1), camera.matrix, frame.axes)
    coordinate = third(*segments.axis[found.edges].T)
    if collinear:
        pieces = _find_collinear(segments, _directions(segments, camera, frame), width)
        found = _joined(found, pieces)
        kind = np.r_[kind, np.full(len(pieces.edges), "collinear")]
        corner = np.r_[corner, np.zeros(len(pieces.edges), bool)]
        coordinate = np.r_[coordinate, _telling_coordinates(rays, segments.axis, pieces.edges)]
    spread = _ray_spread(segments, camera, frame, NOISE.px(width))
    equation = _equations(rays, spread, found.edges, coordinate)
    tolerance = np.maximum(equation.tolerance, reach.least_tolerance)
    graph = LineGraph(
        segments=segments,
        rays=rays[:, :3],
        end_rays=world_rays(segments.ends, camera.matrix, frame.rotation),
        edges=found.edges,
        crossing=found.point,
        gap=found.gap,
        kind=kind,
        corner=corner,
        weight=np.ones(len(found.edges)),
        coordinate=coordinate,
        log_ratio=equation.log_ratio,
        tolerance=tolerance,
        possible=equation.possible,
        informative=equation.possible & (tolerance <= MAX_TOLERANCE),
        turns=frame.turns,
    )
    return weigh(Known(graph, camera, frame, pixels), weights)


@dataclass(frozen=True, eq=False)
class _Equations:
    """What E edges ask of the log depths of their lines."""

    log_ratio: Float  # (E,)
    tolerance: Float  # (E,) by pixel noise alone
    possible: Bool  # (E,)


def _equations(rays: Float, spread: Float, edges: Int, coordinate: Int) -> _Equations:
    """The equation of each edge (E, 2) in its coordinate (E,), from rays (N, K) and how far noise moves them (N, K)."""
    i, j = edges.T
    component = np.stack([rays[i, coordinate], rays[j, coordinate]], axis=1)
    noise = np.abs(np.stack([spread[i, coordinate], spread[j, coordinate]], axis=1))
    possible = component.prod(axis=1) > 0
    size = np.maximum(np.abs(component), np.finfo(float).tiny)
    tolerance = NOISE_FACTOR * np.hypot(*np.minimum(noise / size, 1e6).T)
    return _Equations(np.where(possible, np.log(size[:, 1] / size[:, 0]), 0.0), tolerance, possible)


def _find_crossings(segments: Segments, extension: float) -> _Crossings:
    """All crossings of segments of different axes, each extended by `extension` px at both ends, row by row."""
    start, along = segments.ends[:, 0], segments.ends[:, 1] - segments.ends[:, 0]
    length = segments.length
    unit = along / length[:, None]
    (x, y), (unit_x, unit_y) = start.T, unit.T

    def may_meet(i: Int, j: Int) -> Bool:
        """Whether `i` meets the extended `j`: that leaves few pairs."""
        turn = unit_x[i] * unit_y[j] - unit_y[i] * unit_x[j]
        with np.errstate(divide="ignore", invalid="ignore"):  # parallel ones
            on_other = ((x[j] - x[i]) * unit_y[i] - (y[j] - y[i]) * unit_x[i]) / turn
        meets: Bool = np.abs(on_other - length[j] / 2) <= length[j] / 2 + extension
        meets &= (np.abs(turn) > 1e-9) & (segments.axis[i] != segments.axis[j])
        return meets

    edges = _pairs(len(segments), may_meet)
    i, j = edges.T
    to, turn = start[j] - start[i], unit_x[i] * unit_y[j] - unit_y[i] * unit_x[j]
    on_own = (to[:, 0] * unit_y[j] - to[:, 1] * unit_x[j]) / turn
    on_other = (to[:, 0] * unit_y[i] - to[:, 1] * unit_x[i]) / turn
    meets = np.abs(on_own - length[i] / 2) <= length[i] / 2 + extension
    edges, position = edges[meets], np.column_stack([on_own, on_other])[meets]
    to_end = np.minimum(position, length[edges] - position)  # negative outside the segment
    point = (start[i] + on_own[:, None] * unit[i])[meets]
    return _Crossings(edges, point, np.maximum(-to_end, 0), np.maximum(to_end, 0))


def _find_collinear(segments: Segments, direction: Float, width: int) -> _Crossings:
    """Pairs of segments of one axis that lie on one image line, one after the other; the point is between them."""
    across = COLLINEAR_ACROSS.px(width)
    middle, length = segments.ends.mean(axis=1), segments.length
    (x, y), (along_x, along_y) = middle.T, direction.T

    def off(i: Int, j: Int, line: Int) -> Float:
        """Distance, px, between the middles of `i` and `j` across one of the two."""
        distance: Float = np.abs((x[j] - x[i]) * along_y[line] - (y[j] - y[i]) * along_x[line])
        return distance

    edges = _pairs(len(segments), lambda i, j: (segments.axis[i] == segments.axis[j]) & (off(i, j, i) < across))
    edges = edges[off(edges[:, 0], edges[:, 1], edges[:, 1]) < across]
    i, j = edges.T
    reach = ((segments.ends[j] - middle[i, None]) @ direction[i, :, None])[..., 0]
    ahead = reach.min(axis=1) - length[i] / 2
    behind = -length[i] / 2 - reach.max(axis=1)
    gap = np.maximum(ahead, behind)
    shorter = np.minimum(length[i], length[j])
    one_line = (gap > 0) & (gap <= np.minimum(COLLINEAR_GAP.px(width), COLLINEAR_GAP_SHARE * shorter))
    side = np.where(ahead > behind, 1, -1)
    point = middle[i] + (side * (length[i] + gap) / 2)[:, None] * direction[i]
    halves = np.column_stack([gap, gap])[one_line] / 2
    return _Crossings(edges[one_line], point[one_line], halves, np.zeros_like(halves))


def _pairs(count: int, may_be: Callable[[Int, Int], Bool]) -> Int:
    """The pairs (P, 2), the smaller number first, for which `may_be` of indices (R, 1) and (count,) holds, in order."""
    found = [np.zeros((0, 2), np.int64)]
    every, rows = np.arange(count), max(1, PAIRS // max(1, count))
    for first in range(0, count, rows):
        row, column = true_places(may_be(every[first : first + rows, None], every))
        found.append(np.column_stack([row + first, column])[column > row + first])
    return np.concatenate(found)


def _joined(first: _Crossings, second: _Crossings) -> _Crossings:
    return _Crossings(
        np.concatenate([first.edges, second.edges]),
        np.concatenate([first.point, second.point]),
        np.concatenate([first.gap, second.gap]),
        np.concatenate([first.inside, second.inside]),
    )


def _telling_coordinates(rays: Float, axis: Int, edges: Int) -> Int:
    """Of the two coordinates (E,) in which collinear lines agree, the one that is further from the camera's zero."""
    first, second = across(axis[edges[:, 0]]).T
    size = np.abs(rays)
    by_first = np.minimum(size[edges[:, 0], first], size[edges[:, 1], first])
    by_second = np.minimum(size[edges[:, 0], second], size[edges[:, 1], second])
    return np.asarray(np.where(by_first >= by_second, first, second))


def _junction_kinds(found: _Crossings, zone: float) -> Text:
    """L where both segments end at the crossing, T where one does, X where both go on."""
    ends_here = (found.inside <= zone).sum(axis=1)
    return np.asarray(np.array(["X", "T", "L"])[ends_here])


def _corners(found: _Crossings, axis: Int, reach: float) -> Bool:
    """Crossings (E,) next to which one of the two lines also crosses a line of the third axis: a Y or W junction."""
    node = found.edges.ravel()
    order = np.argsort(node, kind="stable")
    first = np.searchsorted(node[order], np.arange(len(axis) + 1)).tolist()
    edge, normal = order // 2, third(*axis[found.edges].T)
    is_corner = np.zeros(len(found.edges), bool)
    for low, high in pairwise(first):
        mine = edge[low:high]
        own = normal[mine]
        if high - low < 2 or (own == own[0]).all():
            continue
        point = found.point[mine]
        near = lengths(point[:, None] - point) <= reach
        is_corner[mine] |= (near & (own[:, None] != own)).any(axis=1)
    return is_corner


def _directions(segments: Segments, camera: Camera, frame: ManhattanFrame) -> Float:
    """(N, 2) unit vector in the photo from the middle of each segment to its vanishing point."""
    points = vanishing_points(camera.matrix, frame.axes)[segments.axis]
    return directions_to(segments.ends.mean(axis=1), points)


def _ray_spread(segments: Segments, camera: Camera, frame: ManhattanFrame, noise: float) -> Float:
    """How far the rays (N, K) of the middles move when the segments move across by `noise` px."""
    middle, towards = segments.ends.mean(axis=1), _directions(segments, camera, frame)
    beside = np.stack([-towards[:, 1], towards[:, 0]], axis=1) * noise
    spread: Float = world_rays(middle + beside, camera.matrix, frame.axes) - world_rays(
        middle, camera.matrix, frame.axes
    )
    return spread
