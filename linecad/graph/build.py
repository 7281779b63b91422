"""Labelled segments to the paper's line graph: which lines may meet, with what evidence, and what it would mean.

Every crossing of two segments of different axes, each extended by `extension`, is an edge. Two lines that meet agree
in the third coordinate alpha: s_i d_i = s_j d_j, an equation between the logs of their depths. Its tolerance is not a
free parameter: it is how far the equation moves when the segments move by their pixel noise.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from linecad.arrays import Bool, Float, Int, Text
from linecad.geometry import PhotoLength, directions_to, vanishing_points, world_rays
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
    rays = world_rays(segments.ends.mean(axis=1), camera.matrix, frame.rotation)
    coordinate = 3 - segments.axis[found.edges].sum(axis=1)
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
        rays=rays,
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
    )
    return weigh(Known(graph, camera, frame, pixels), weights)


@dataclass(frozen=True, eq=False)
class _Equations:
    """What E edges ask of the log depths of their lines."""

    log_ratio: Float  # (E,)
    tolerance: Float  # (E,) by pixel noise alone
    possible: Bool  # (E,)


def _equations(rays: Float, spread: Float, edges: Int, coordinate: Int) -> _Equations:
    """The equation of each edge (E, 2) in its coordinate (E,), from rays (N, 3) and how far noise moves them (N, 3)."""
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
    edges, points, reach = [], [], []
    for i in range(len(segments)):
        others = np.flatnonzero(segments.axis[i + 1 :] != segments.axis[i]) + i + 1
        to = start[others] - start[i]
        turn = unit[i, 0] * unit[others, 1] - unit[i, 1] * unit[others, 0]
        crossing = np.abs(turn) > 1e-9
        others, to, turn = others[crossing], to[crossing], turn[crossing]
        on_own = (to[:, 0] * unit[others, 1] - to[:, 1] * unit[others, 0]) / turn
        on_other = (to[:, 0] * unit[i, 1] - to[:, 1] * unit[i, 0]) / turn
        meets = (np.abs(on_own - length[i] / 2) <= length[i] / 2 + extension) & (
            np.abs(on_other - length[others] / 2) <= length[others] / 2 + extension
        )
        edges.append(np.column_stack([np.full(meets.sum(), i), others[meets]]))
        points.append(start[i] + on_own[meets, None] * unit[i])
        reach.append(np.column_stack([on_own[meets], on_other[meets]]))
    if not edges:
        return _Crossings(np.zeros((0, 2), np.int64), np.zeros((0, 2)), np.zeros((0, 2)), np.zeros((0, 2)))
    pairs, position = np.concatenate(edges), np.concatenate(reach)
    to_end = np.minimum(position, length[pairs] - position)  # negative outside the segment
    return _Crossings(pairs, np.concatenate(points), np.maximum(-to_end, 0), np.maximum(to_end, 0))


def _find_collinear(segments: Segments, direction: Float, width: int) -> _Crossings:
    """Pairs of segments of one axis that lie on one image line, one after the other; the point is between them."""
    across = COLLINEAR_ACROSS.px(width)
    middle, length = segments.ends.mean(axis=1), segments.length
    edges, points, gaps = [], [], []
    for i in range(len(segments)):
        others = np.flatnonzero(segments.axis[i + 1 :] == segments.axis[i]) + i + 1
        to = middle[others] - middle[i]
        own = np.abs(to[:, 0] * direction[i, 1] - to[:, 1] * direction[i, 0])
        other = np.abs(to[:, 0] * direction[others, 1] - to[:, 1] * direction[others, 0])
        reach = (segments.ends[others] - middle[i]) @ direction[i]
        ahead = reach.min(axis=1) - length[i] / 2
        behind = -length[i] / 2 - reach.max(axis=1)
        gap = np.maximum(ahead, behind)
        shorter = np.minimum(length[i], length[others])
        limit = np.minimum(COLLINEAR_GAP.px(width), COLLINEAR_GAP_SHARE * shorter)
        one_line = (np.maximum(own, other) < across) & (gap > 0) & (gap <= limit)
        side = np.where(ahead > behind, 1, -1)[one_line]
        edges.append(np.column_stack([np.full(one_line.sum(), i), others[one_line]]))
        points.append(middle[i] + (side * (length[i] + gap[one_line]) / 2)[:, None] * direction[i])
        gaps.append(np.column_stack([gap[one_line], gap[one_line]]) / 2)
    if not edges:
        return _Crossings(np.zeros((0, 2), np.int64), np.zeros((0, 2)), np.zeros((0, 2)), np.zeros((0, 2)))
    gap_halves = np.concatenate(gaps)
    return _Crossings(np.concatenate(edges), np.concatenate(points), gap_halves, np.zeros_like(gap_halves))


def _joined(first: _Crossings, second: _Crossings) -> _Crossings:
    return _Crossings(
        np.concatenate([first.edges, second.edges]),
        np.concatenate([first.point, second.point]),
        np.concatenate([first.gap, second.gap]),
        np.concatenate([first.inside, second.inside]),
    )


def _telling_coordinates(rays: Float, axis: Int, edges: Int) -> Int:
    """Of the two coordinates (E,) in which collinear lines agree, the one that is further from the camera's zero."""
    first = (axis[edges[:, 0]] + 1) % 3
    second = (axis[edges[:, 0]] + 2) % 3
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
    at_node: list[list[int]] = [[] for _ in range(len(axis))]
    for edge, (i, j) in enumerate(found.edges.tolist()):
        at_node[i].append(edge)
        at_node[j].append(edge)
    third = 3 - axis[found.edges].sum(axis=1)
    is_corner = np.zeros(len(found.edges), bool)
    for own in at_node:
        mine = np.array(own, np.int64)
        if len(mine) < 2:
            continue
        near = np.linalg.norm(found.point[mine, None] - found.point[None, mine], axis=2) <= reach
        is_corner[mine] |= (near & (third[mine, None] != third[None, mine])).any(axis=1)
    return is_corner


def _directions(segments: Segments, camera: Camera, frame: ManhattanFrame) -> Float:
    """(N, 2) unit vector in the photo from the middle of each segment to its vanishing point."""
    points = vanishing_points(camera.matrix, frame.rotation)[segments.axis]
    return directions_to(segments.ends.mean(axis=1), points)


def _ray_spread(segments: Segments, camera: Camera, frame: ManhattanFrame, noise: float) -> Float:
    """How far the world rays (N, 3) of the middles move when the segments move across by `noise` px."""
    middle, towards = segments.ends.mean(axis=1), _directions(segments, camera, frame)
    across = np.stack([-towards[:, 1], towards[:, 0]], axis=1) * noise
    spread: Float = world_rays(middle + across, camera.matrix, frame.rotation) - world_rays(
        middle, camera.matrix, frame.rotation
    )
    return spread
