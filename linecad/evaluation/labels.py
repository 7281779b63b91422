"""Which crossings of a line graph are real, by the exact truth of a made photo (docs/reference/labels.md).

A segment of the photo is an *edge* of the scene, a *surface* line (both sides show one plane: a shadow, paint, mortar)
or *spurious*; edges and surface lines have a true line in space. A crossing is real where the two true lines meet.
"""

from dataclasses import dataclass

import numpy as np

from linecad.arrays import Bool, Float, Int, Text
from linecad.dataset.truth import NOTHING, Truth
from linecad.evaluation.frames import true_directions
from linecad.evaluation.overlap import Overlaps, find_overlaps, union_length
from linecad.geometry import angles_to, vanishing_points
from linecad.line_graph import LineGraph, Segments

REAL, FAKE, UNDECIDED = 1, 0, -1

EDGE_REACH = 2.0  # px between a segment and the visible edge that it shows
EDGE_ANGLE = np.radians(1.5)  # between the two in the image
EDGE_SHARE = 0.4  # of the segment's length that must run along the edge
EDGE_PENALTY = 0.1  # per px: of two edges that a segment runs along, the nearer is preferred by this much of the share
ONE_LINE = 0.01  # m between two edges of one line in space
PARALLEL = np.cos(np.radians(0.1))  # of the directions of such edges, and of the normals of quads in one plane
SIDE = 2.5  # px to either side of a segment, where the planes beside it are looked up
SIDE_STEP = 3.0  # px between the places along the segment where that is done
SIDE_SHARE = 0.7  # of those places that must show one plane on both sides
ONE_PLANE = 0.005  # m between two quads of one plane
LABEL_ANGLE = np.radians(1.0)  # between a true line or plane and the axis that the segment is labelled with

REAL_GAP, REAL_SHARE = 0.02, 0.005  # m and share of the depth; lines that pass nearer meet
FAKE_GAP, FAKE_SHARE = 0.06, 0.01  # m and share of the depth; lines that pass further apart do not


@dataclass(frozen=True, eq=False)
class TrueLines:
    """What each of N segments shows."""

    kind: Text  # (N,) edge, surface, spurious
    right: Bool  # (N,) the line runs along the axis that the segment is labelled with; False for spurious ones
    point: Float  # (N, 3) of the line in space, world of the truth, m; NaN for spurious ones
    direction: Float  # (N, 3) unit vector along it; NaN for spurious ones


def find_true_lines(truth: Truth, segments: Segments, axes: Float | None = None) -> TrueLines:
    """What each segment shows. `axes` (3, K) are the found directions that name the segments' axes, if not the truth's.

    Those of the main frame stand for the true axes that they are nearest to, further ones for themselves.
    """
    directions = true_directions(truth.rotation if axes is None else axes, truth.rotation)
    count = len(segments)
    kind = np.full(count, "spurious", "<U8")
    right = np.zeros(count, bool)
    point, direction = np.full((count, 3), np.nan), np.full((count, 3), np.nan)
    edge_along = truth.edges[:, 1] - truth.edges[:, 0]
    edge_along = edge_along / np.linalg.norm(edge_along, axis=1, keepdims=True)
    normal, offset = truth.planes()
    # Sine of the angle (K, N) between each segment and the image of each direction
    astray = angles_to(segments.ends, vanishing_points(truth.matrix, truth.rotation @ directions.T))
    for i, ends in enumerate(segments.ends):
        axis = int(segments.axis[i])
        along = directions[axis]
        edge = _edge_of(truth, edge_along, ends)
        if edge != NOTHING:
            kind[i], point[i], direction[i] = "edge", truth.edges[edge, 0], edge_along[edge]
            right[i] = abs(edge_along[edge] @ along) >= np.cos(LABEL_ANGLE)
            continue
        quad = _plane_beside(truth, normal, offset, ends)
        if quad != NOTHING:
            kind[i] = "surface"
            right[i] = abs(normal[quad] @ along) <= np.sin(LABEL_ANGLE) and astray[axis, i] <= np.sin(EDGE_ANGLE)
            point[i], direction[i] = _lift(truth, ends, quad, normal[quad], along if right[i] else None)
    return TrueLines(kind, right & (segments.axis >= 0), point, direction)


def label_crossings(truth: Truth, graph: LineGraph, axes: Float | None = None) -> Int:
    """REAL, FAKE or UNDECIDED for each crossing (E,) of a graph; `axes` as in `find_true_lines`."""
    lines = find_true_lines(truth, graph.segments, axes)
    return judge_crossings(truth, graph, lines)


def judge_crossings(truth: Truth, graph: LineGraph, lines: TrueLines) -> Int:
    """The same, for segments that are labelled already.

    With d the distance of the two true lines (infinite) and z the mean of the depths at which the ray of the crossing
    passes nearest to them: real if d < max(2 cm, 0.5 % z), fake if d > max(6 cm, 1 % z). Two pieces of one line are
    real by the same limits, their distance being that of parallel lines. A crossing with a spurious or wrongly labelled
    line, or one behind the camera, is fake.
    """
    label = np.full(len(graph.edges), FAKE, np.int64)
    i, j = graph.edges.T
    judged = np.flatnonzero(lines.right[i] & lines.right[j])
    i, j = i[judged], j[judged]
    depth = depths_at_crossings(truth, graph, lines)[:, judged]
    one_axis = graph.axis[i] == graph.axis[j]
    apart = _distance(lines.point[i], lines.direction[i], lines.point[j], lines.direction[j], one_axis)
    mean = depth.mean(axis=0)
    before = (depth > 0).all(axis=0)
    real = before & (apart < np.maximum(REAL_GAP, REAL_SHARE * mean))
    fake = ~before | (apart > np.maximum(FAKE_GAP, FAKE_SHARE * mean))
    label[judged] = np.where(real, REAL, np.where(fake, FAKE, UNDECIDED))
    return label


def depths_at_crossings(truth: Truth, graph: LineGraph, lines: TrueLines) -> Float:
    """(2, E) camera depths, m, at which the ray of each crossing passes nearest to its two true lines; NaN without."""
    rays = truth.rays(graph.crossing)
    return np.stack([depth_on(rays, lines.point[n], lines.direction[n]) for n in graph.edges.T])


def _edge_of(truth: Truth, along: Float, ends: Float) -> int:
    """The edge of the scene that a segment (2, 2) shows, or NOTHING."""
    found = find_overlaps(ends, truth.pieces, EDGE_REACH, EDGE_ANGLE)
    length = float(np.linalg.norm(ends[1] - ends[0]))
    best, chosen = -np.inf, NOTHING
    for edge, members in _one_line(truth, along, found):
        share = union_length(found.start, found.end, members) / length
        if share <= EDGE_SHARE:
            continue
        distance = np.average(found.distance[members], weights=(found.end - found.start)[members])
        score = share - EDGE_PENALTY * float(distance)
        if score > best:
            best, chosen = score, edge
    return chosen


def _one_line(truth: Truth, along: Float, found: Overlaps) -> list[tuple[int, Bool]]:
    """The overlaps grouped by line in space: an edge of each, and the mask of the overlaps that belong to it."""
    edges = truth.piece_edge[found.piece]
    groups: list[tuple[int, Bool]] = []
    left = np.ones(len(edges), bool)
    while left.any():
        edge = int(edges[left.argmax()])
        middle = truth.edges[edges].mean(axis=1)
        off = np.linalg.norm(np.cross(middle - truth.edges[edge].mean(axis=0), along[edge]), axis=1)
        same = left & (off < ONE_LINE) & (np.abs(along[edges] @ along[edge]) > PARALLEL)
        same[left.argmax()] = True
        groups.append((edge, same))
        left &= ~same
    return groups


def _plane_beside(truth: Truth, normal: Float, offset: Float, ends: Float) -> int:
    """A quad of the one plane that both sides of a segment (2, 2) show, or NOTHING."""
    length = float(np.linalg.norm(ends[1] - ends[0]))
    count = max(4, int(np.ceil(length / SIDE_STEP)))
    along = (ends[1] - ends[0]) / length
    middle = ends[0] + ((np.arange(count) + 0.5) * length / count)[:, None] * along
    across = SIDE * np.array([-along[1], along[0]])
    sides = np.stack([truth.quad_at(middle + across), truth.quad_at(middle - across)])
    shown = sides[sides != NOTHING]
    if len(shown) == 0:
        return NOTHING
    quad = int(np.bincount(shown).argmax())
    turn = normal @ normal[quad]
    together = (np.abs(turn) > PARALLEL) & (np.abs(offset * np.sign(turn) - offset[quad]) < ONE_PLANE)
    both = (together[sides] & (sides != NOTHING)).all(axis=0)
    return quad if both.mean() > SIDE_SHARE else NOTHING


def _lift(truth: Truth, ends: Float, quad: int, normal: Float, known: Float | None) -> tuple[Float, Float]:
    """A point and the direction of the line in the plane of a quad that a segment (2, 2) shows.

    Where the line is known to run along a direction (3,), it is that direction exactly: a pixel of noise at the ends of
    a short segment on the ground would turn it by degrees.
    """
    middle = ends.mean(axis=0)[None]
    point = truth.rays(middle)[0] * truth.quad_depth(middle, np.array([quad]))[0]
    if known is None:
        lifted = truth.rays(ends) * truth.quad_depth(ends, np.full(2, quad))[:, None]
        along = lifted[1] - lifted[0]
    else:
        along = known - (normal @ known) * normal
    return point, along / np.linalg.norm(along)


def depth_on(rays: Float, point: Float, direction: Float) -> Float:
    """Camera depth (N,) at which rays (N, 3) of depth 1 pass nearest to lines; NaN for a ray along its line."""
    along = (rays * direction).sum(axis=1)
    squared = (rays**2).sum(axis=1)
    onto = (rays * point).sum(axis=1) - along * (direction * point).sum(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        depth: Float = onto / (squared - along**2)
    return depth


def _distance(first: Float, along: Float, second: Float, other: Float, parallel: Bool) -> Float:
    """Distance (N,) of two infinite lines, each a point (N, 3) and a unit direction (N, 3); some are parallel."""
    turn = np.cross(along, other)
    to = second - first
    size = np.where(parallel, 1.0, np.linalg.norm(turn, axis=1))
    skew = np.abs((to * turn).sum(axis=1)) / size
    beside = np.linalg.norm(np.cross(to, along), axis=1)
    return np.asarray(np.where(parallel, beside, skew))
