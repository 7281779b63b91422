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
from linecad.graph.connectivity import group_numbers
from linecad.line_graph import LineDepths, LineGraph
from linecad.model.plane_merging import MIN_TOLERANCE, NOISE_FACTOR, Merges, find_merges

ANCHOR = 1e-9  # weight that pins the free scale of a component to the solver's depths


@dataclass(frozen=True, eq=False)
class Lifted:
    """The N lines of a graph in space; the unit is free, lines of different chosen components have unrelated scales."""

    ends: Float  # (N, 2, 3) world
    offset: Float  # (N, 3) the two coordinates that define each line; NaN along its own axis
    shared: Int  # (N, 3) number of the offset that each coordinate belongs to; -1 along the line's own axis
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
    ends, shift = _ends(graph, offset)
    ends = _end_at_junctions(graph, chosen, offset, ends)
    return Lifted(ends, offset, shared, graph.misfit(log_depth), shift)


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
    """Numbers (N, 3) such that two coordinates have the same number when crossings or merges make them equal."""
    count = 3 * len(graph.segments)
    i, j = graph.edges[chosen].T
    # Crossing lines share one coordinate, the pieces of one line share both of theirs.
    also = graph.axis[i] == graph.axis[j]
    coordinate = np.r_[graph.coordinate[chosen], (3 - graph.axis[i] - graph.coordinate[chosen])[also]]
    i, j = np.r_[i, i[also]], np.r_[j, j[also]]
    if merges is not None:
        coordinate = np.r_[coordinate, merges.axis]
        i, j = np.r_[i, merges.lines[:, 0]], np.r_[j, merges.lines[:, 1]]
    shared = group_numbers(count, np.column_stack([3 * i + coordinate, 3 * j + coordinate])).reshape(-1, 3)
    shared[np.arange(len(graph.segments)), graph.axis] = -1
    return shared


def _offsets(graph: LineGraph, shared: Int, depth: Float) -> Float:
    """One number (N, 3) for each shared coordinate: the mean of what its lines say, by their certainty."""
    say = depth[:, None] * graph.rays
    # A segment's noise moves its ray by about the same angle everywhere, so its coordinates move with its depth.
    certainty = np.broadcast_to(1 / depth[:, None] ** 2, say.shape)
    own = shared >= 0
    groups = int(shared.max(initial=-1)) + 1
    total = np.bincount(shared[own], (say * certainty)[own], groups)
    mass = np.bincount(shared[own], certainty[own], groups)
    offset = np.full(shared.shape, np.nan)
    offset[own] = (total / np.maximum(mass, np.finfo(float).tiny))[shared[own]]
    return offset


def _ends(graph: LineGraph, offset: Float) -> tuple[Float, Float]:
    """Ends (N, 2, 3): the points of the exact line nearest to the rays of the segment's ends; and the angle (N,)."""
    count = len(graph.segments)
    rows = np.arange(count)
    across = np.stack([(graph.axis + 1) % 3, (graph.axis + 2) % 3], axis=1)
    fixed = np.take_along_axis(offset, across, axis=1)
    rays = np.take_along_axis(graph.end_rays, across[:, None, :].repeat(2, axis=1), axis=2)
    # Of all points of a ray, the one whose two fixed coordinates are nearest to the line's.
    depth = (rays * fixed[:, None]).sum(axis=2) / np.maximum((rays**2).sum(axis=2), np.finfo(float).tiny)
    ends = np.empty((count, 2, 3))
    ends[rows[:, None], np.arange(2), graph.axis[:, None]] = (
        depth * graph.end_rays[rows[:, None], np.arange(2), graph.axis[:, None]]
    )
    for column in range(2):
        ends[rows[:, None], np.arange(2), across[:, column, None]] = fixed[:, column, None]
    missed = depth[..., None] * rays - fixed[:, None]
    length = np.linalg.norm(ends, axis=2)
    shift = (np.linalg.norm(missed, axis=2) / np.maximum(length, np.finfo(float).tiny)).max(axis=1)
    return ends, shift


def _end_at_junctions(graph: LineGraph, chosen: Bool, offset: Float, ends: Float) -> Float:
    """Ends that fall short of chosen crossings, or stop near them, moved to the outermost junction exactly."""
    edges = np.flatnonzero(chosen & (graph.kind != "collinear"))  # those have no point in common
    line = graph.edges[edges]
    to_ends = np.linalg.norm(graph.segments.ends[line] - graph.crossing[edges, None, None], axis=3)
    there = _ends_there(graph.kind[edges, None], graph.gap[edges], to_ends.min(axis=2))
    place = offset[line[:, ::-1], graph.axis[line]][there]
    end = (2 * line + to_ends.argmin(axis=2))[there]  # place in the flat (N, 2)
    highest, lowest = np.full(2 * len(ends), -np.inf), np.full(2 * len(ends), np.inf)
    np.maximum.at(highest, end, place)
    np.minimum.at(lowest, end, place)
    along = np.take_along_axis(ends, graph.axis[:, None, None], axis=2)[..., 0]
    is_high = (along > along[:, ::-1]).ravel()
    outermost = np.where(is_high, highest, lowest)
    moved = ends.copy()
    own = np.unique(end)
    moved[own // 2, own % 2, graph.axis[own // 2]] = outermost[own]
    return moved


def _ends_there(kind: Text, gap: Float, to_end: Float) -> Bool:
    """Which lines (M, 2) end at crossings (M, 1): both do at an L, one does at a T, and an X is passed by all it joins.

    `gap` (M, 2) is by how much each falls short, `to_end` (M, 2) how far its end is from the crossing.
    """
    is_stem: Bool = (kind != "X") & (gap[:, ::-1] <= 0) & (to_end < to_end[:, ::-1])
    ends_there: Bool = (gap > 0) | (kind == "L") | is_stem
    return ends_there
