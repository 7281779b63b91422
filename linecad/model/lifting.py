"""A solved line graph to lines in space, made exact: chosen crossings meet in one point to rounding.

The solver leaves each chosen crossing within its tolerance. Least squares spreads that slack; then every coordinate
that chosen crossings share becomes one number, a plane offset. A line of axis x is then the meeting of its y and its z
plane, and two lines that share a plane and cross in the image meet in space exactly.
"""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix, diags_array
from scipy.sparse.linalg import spsolve

from linecad.arrays import Bool, Float, Int, Text
from linecad.directions import UP, across, count_of, directions_of, in_world, level_axes, lies_across, partner
from linecad.graph.connectivity import group_numbers
from linecad.line_graph import LineDepths, LineGraph
from linecad.model.plane_merging import MIN_TOLERANCE, NOISE_FACTOR, Merges, find_merges

LEAST_LEFT = 0.1  # of a line's length, that junctions at both of its ends must leave
ANCHOR = 1e-9  # weight that pins the free scale of a component to the solver's depths


@dataclass(frozen=True, eq=False)
class Lifted:
    """The N lines of a graph in space; the unit is free, lines of different chosen components have unrelated scales."""

    ends: Float  # (N, 2, 3) world
    # (N, K) the components along the normals of the planes that each line can lie in: the two of its frame, and of an
    # upright line those of every frame; NaN along all other directions
    offset: Float
    shared: Int  # (N, K) number of the offset that each of the two of its frame belongs to; -1 elsewhere
    residual: Float  # (E,) how far the log depths of an edge's lines are from its equation
    shift: Float  # (N,) rad by which each line moved off the plane of its segment to become exact


def lift(graph: LineGraph, chosen: Bool, log_depth: Float) -> Lifted:
    """Lines in space for every node of the graph, exact at the chosen crossings (paper, algorithm 1, last steps).

    `chosen` (E,) are the crossings that are real, `log_depth` (N,) depths near which all agree. Planes of one normal
    that the noise cannot tell apart become one.
    """
    log_depth = fit_log_depths(graph, chosen, log_depth)
    shared = _shared_coordinates(graph, chosen)
    merges = find_merges(graph, chosen, _parts(graph, chosen), shared, log_depth, _normal(graph, chosen, log_depth))
    if len(merges.axis):
        log_depth = fit_log_depths(graph, chosen, log_depth, merges)
        shared = _shared_coordinates(graph, chosen, merges)
    offset = _offsets(graph, shared, np.exp(log_depth))
    along, shift = _ends(graph, offset)
    along = _end_at_junctions(graph, chosen, offset, along)
    return Lifted(_points(graph, offset, along), offset, shared, graph.misfit(log_depth), shift)


def fit_log_depths(graph: LineGraph, chosen: Bool, guess: Float, merges: Merges | None = None) -> Float:
    """Weighted least squares of log s_i - log s_j = c_ij over the chosen crossings that say something (N,).

    Planes that were merged are equations more.
    """
    used = chosen & graph.informative
    incidence = _incidence(graph, used)
    weight = 1 / graph.tolerance[used] ** 2
    normal = _normal(graph, chosen, guess)
    # Only the change from the guess is solved for: the anchor is so weak that rounding would move the whole.
    right = incidence.T @ (weight * (graph.log_ratio[used] - incidence @ guess))
    told = _told(graph, chosen, guess)
    right = right + np.bincount(told.line, (told.log_depth - guess[told.line]) / _spread(told) ** 2, len(guess))
    if merges is not None:
        normal = normal + merges.rows.T @ merges.rows / MIN_TOLERANCE**2
        right = right + merges.rows.T @ (merges.log_ratio - merges.rows @ guess) / MIN_TOLERANCE**2
    return np.asarray(guess + spsolve(normal.tocsc(), right))


def _incidence(graph: LineGraph, used: Bool) -> csr_matrix:
    """(E', N) with 1 for the first line of each used edge and -1 for the second."""
    rows = np.arange(used.sum())
    i, j = graph.edges[used].T
    values = np.r_[np.ones(len(rows)), -np.ones(len(rows))]
    return csr_matrix((values, (np.r_[rows, rows], np.r_[i, j])), (len(rows), len(graph.segments)))


def _normal(graph: LineGraph, chosen: Bool, log_depth: Float) -> csr_matrix:
    """Matrix (N, N) of the normal equations at depths (N,), in units of 1 / tolerance ** 2."""
    used = chosen & graph.informative
    incidence = _incidence(graph, used)
    weight = diags_array(1 / graph.tolerance[used] ** 2)
    told = _told(graph, chosen, log_depth)
    known = np.bincount(told.line, 1 / _spread(told) ** 2, len(graph.segments))
    return csr_matrix(incidence.T @ weight @ incidence + diags_array(ANCHOR + known))


def _told(graph: LineGraph, chosen: Bool, log_depth: Float) -> LineDepths:
    """What unary cues tell of the depths, without what is an outlier at depths (N,).

    The scale of these depths means nothing in each group of lines that chosen crossings (E,) connect, so an outlier is
    what is far off the median of its group.
    """
    told = graph.depths if graph.depths is not None else LineDepths.none()
    off = told.log_depth - log_depth[told.line]
    group = _parts(graph, chosen)[told.line]
    for number in np.unique(group):
        off[group == number] -= np.median(off[group == number])
    return told.chosen(~(told.may_be_outlier & (np.abs(off) > _spread(told))))


def _spread(told: LineDepths) -> Float:
    """(M,) half width of the interval about each depth that its noise explains, as the tolerance of a crossing."""
    spread: Float = NOISE_FACTOR * told.sigma
    return spread


def _parts(graph: LineGraph, chosen: Bool) -> Int:
    """Number (N,) of the group of lines that each line is in by chosen crossings that tell about depth."""
    return group_numbers(len(graph.segments), graph.edges[chosen & graph.informative])


def _shared_coordinates(graph: LineGraph, chosen: Bool, merges: Merges | None = None) -> Int:
    """Numbers (N, K) such that two components have the same number when crossings or merges make them equal.

    Only in one frame: an upright line that stood in the planes of two would be where these meet, and they may be so
    nearly parallel that the noise of both moves it far.
    """
    directions = count_of(graph.turns)
    has = lies_across(graph.axis[:, None], np.arange(directions))
    axes = np.array([level_axes(frame) for frame in range(len(graph.turns) + 1)])
    has[graph.axis == UP] = (np.arange(directions) == axes[graph.home[graph.axis == UP], :, None]).any(axis=1)
    chosen = chosen & graph.in_one_frame
    edges = graph.edges[chosen]
    # Crossing lines share one component, the pieces of one line share all of theirs.
    pieces = edges[graph.axis[edges[:, 0]] == graph.axis[edges[:, 1]]]
    piece, of_piece = np.nonzero(has[pieces[:, 0]])
    coordinate = np.r_[graph.coordinate[chosen], of_piece]
    i, j = np.concatenate([edges, pieces[piece]]).T
    if merges is not None:
        coordinate = np.r_[coordinate, merges.axis]
        i, j = np.r_[i, merges.lines[:, 0]], np.r_[j, merges.lines[:, 1]]
    places = np.column_stack([directions * i + coordinate, directions * j + coordinate])
    shared = group_numbers(directions * len(graph.segments), places).reshape(-1, directions)
    shared[~has] = -1
    return shared


def _offsets(graph: LineGraph, shared: Int, depth: Float) -> Float:
    """One number (N, K) for each shared component: the mean of what its lines say, by their certainty.

    Where an upright line stands in other frames than its own follows from those.
    """
    say = depth[:, None] * graph.components
    # A segment's noise moves its ray by about the same angle everywhere, so its coordinates move with its depth.
    certainty = np.broadcast_to(1 / depth[:, None] ** 2, say.shape)
    own = shared >= 0
    groups = int(shared.max(initial=-1)) + 1
    total = np.bincount(shared[own], (say * certainty)[own], groups)
    mass = np.bincount(shared[own], certainty[own], groups)
    offset = np.full(shared.shape, np.nan)
    number = total / np.maximum(mass, np.finfo(float).tiny)
    offset[own] = number[shared[own]]
    for frame in range(len(graph.turns) + 1 if graph.turns else 0):
        upright = np.flatnonzero((graph.axis == UP) & (graph.home == frame))
        vectors, level = directions_of(graph.turns), list(level_axes(frame))
        foot = offset[upright][:, level] @ vectors[level]
        others = [axis for axis in range(len(vectors)) if axis not in (*level, UP)]
        offset[upright[:, None], others] = foot @ vectors[others].T
    return offset


def _ends(graph: LineGraph, offset: Float) -> tuple[Float, Float]:
    """Places (N, 2) along the exact lines nearest to the rays of the segments' ends; and the angle (N,)."""
    rows = np.arange(len(graph.segments))
    sides = across(graph.axis)
    fixed = np.take_along_axis(offset, sides, axis=1)
    rays = np.take_along_axis(graph.end_components, sides[:, None, :].repeat(2, axis=1), axis=2)
    # Of all points of a ray, the one whose two fixed coordinates are nearest to the line's.
    depth = (rays * fixed[:, None]).sum(axis=2) / np.maximum((rays**2).sum(axis=2), np.finfo(float).tiny)
    along = depth * graph.end_components[rows[:, None], np.arange(2), graph.axis[:, None]]
    missed = depth[..., None] * rays - fixed[:, None]
    length = np.linalg.norm(_points(graph, offset, along), axis=2)
    shift = (np.linalg.norm(missed, axis=2) / np.maximum(length, np.finfo(float).tiny)).max(axis=1)
    return along, shift


def _points(graph: LineGraph, offset: Float, along: Float) -> Float:
    """World points (N, 2, 3) at places (N, 2) along the exact lines."""
    return in_world(along, graph.axis, np.take_along_axis(offset, across(graph.axis), axis=1), graph.turns)


def _end_at_junctions(graph: LineGraph, chosen: Bool, offset: Float, along: Float) -> Float:
    """Places (N, 2) of ends; those short of chosen crossings, or near them, moved to the outermost junction exactly."""
    edges = np.flatnonzero(chosen & (graph.kind != "collinear"))  # those have no point in common
    line = graph.edges[edges]
    to_ends = np.linalg.norm(graph.segments.ends[line] - graph.crossing[edges, None, None], axis=3)
    there = _ends_there(graph.kind[edges, None], graph.gap[edges], to_ends.min(axis=2))
    place = _junctions(graph, offset, line)[there]
    end = (2 * line + to_ends.argmin(axis=2))[there]  # place in the flat (N, 2)
    highest, lowest = np.full(2 * len(along), -np.inf), np.full(2 * len(along), np.inf)
    np.maximum.at(highest, end, place)
    np.minimum.at(lowest, end, place)
    is_high = (along > along[:, ::-1]).ravel()
    outermost = np.where(is_high, highest, lowest)
    moved = along.copy()
    own = np.unique(end)
    moved[own // 2, own % 2] = outermost[own]
    # Between two lines whose planes became one nothing would be left of a line: its end that was nearer goes there.
    flat = np.flatnonzero(np.abs(np.diff(moved)[:, 0]) < LEAST_LEFT * np.abs(np.diff(along)[:, 0]))
    further = np.abs(moved[flat] - along[flat]).argmax(axis=1)
    moved[flat, further] = along[flat, further]
    return moved


def _junctions(graph: LineGraph, offset: Float, line: Int) -> Float:
    """Places (E, 2) along pairs of lines (E, 2) where each of them meets the other.

    A line of the same frame, and an upright one, stands at a component along this one's axis. A level line of another
    frame is met where this one goes through its upright plane.
    """
    axis = graph.axis[line]
    place = offset[line[:, ::-1], axis]
    skew = np.isnan(place)
    if skew.any():
        own, other = line[skew], line[:, ::-1][skew]
        vectors = directions_of(graph.turns)
        beside, normal = partner(graph.axis[own]), partner(graph.axis[other])
        way = offset[other, normal] - offset[own, beside] * (vectors[beside] * vectors[normal]).sum(axis=1)
        place[skew] = way / (vectors[graph.axis[own]] * vectors[normal]).sum(axis=1)
    return place


def _ends_there(kind: Text, gap: Float, to_end: Float) -> Bool:
    """Which lines (M, 2) end at crossings (M, 1): both do at an L, one does at a T, and an X is passed by all it joins.

    `gap` (M, 2) is by how much each falls short, `to_end` (M, 2) how far its end is from the crossing.
    """
    is_stem: Bool = (kind != "X") & (gap[:, ::-1] <= 0) & (to_end < to_end[:, ::-1])
    ends_there: Bool = (gap > 0) | (kind == "L") | is_stem
    return ends_there
