"""Which planes that crossings left apart are one plane: offsets of one normal that the noise cannot tell apart.

The windows of two floors lie in one facade, but crossings connect the floors by a long way round, and each step has its
noise. The least squares knows how much comes together: the variance of the difference of two log offsets follows from
its normal equations. Two planes are merged where the difference is within that noise, unless a line that runs along
their normal leads from one to the other: then the photo shows the step between them.
"""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.linalg import splu

from linecad.arrays import Bool, Float, Int, true_places
from linecad.directions import count_of
from linecad.geometry import lengths
from linecad.line_graph import LineGraph

NOISE_FACTOR = 3.0  # standard deviations; the tolerances of the crossings cover as many
SYSTEMATIC = 0.004  # relative offset; what the frame, the calibration and the detector do to all lines of a plane alike
FARTHEST = 0.015  # relative offset; planes further apart are never merged, however few crossings connect them
MIN_TOLERANCE = 0.002  # relative depth by which merged planes may differ before they become one number
FEWEST_LINES = 3  # of a plane that is merged
SHOWN_STEP = 8.0  # px in any photo; a line along the normal that goes so far shows that two planes are apart


@dataclass(frozen=True, eq=False)
class Merges:
    """Pairs of planes that are one: equations between the mean log depths of their lines."""

    rows: csr_matrix  # (M, N) 1 / n for the lines of one plane, -1 / n for those of the other
    log_ratio: Float  # (M,) what rows @ log_depth must be
    lines: Int  # (M, 2) a line of each plane
    axis: Int  # (M,) the normal


def find_merges(
    graph: LineGraph, chosen: Bool, component: Int, shared: Int, log_depth: Float, normal: csr_matrix
) -> Merges:
    """Planes to be merged, given the class `shared` (N, K) of each coordinate and the component (N,) of each line.

    `normal` (N, N) is the matrix of the normal equations that gave `log_depth` (N,), in units of 1 / tolerance ** 2.
    Equal classes are one plane already.
    """
    planes = _planes(graph, shared, log_depth)
    if len(planes.number) < 2:
        count = len(graph.segments)
        return Merges(csr_matrix((0, count)), np.zeros(0), np.zeros((0, 2), np.int64), np.zeros(0, np.int64))
    spread = splu(normal.tocsc()).solve(planes.means.T.toarray())  # (N, P)
    covariance = np.asarray(planes.means @ spread) / NOISE_FACTOR**2
    group = np.array([component[own[0]] for own in planes.lines])
    alike = np.stack([planes.axis, group, planes.side])  # what two planes must have in common
    candidates = []
    for a in range(len(group)):
        others = np.arange(a + 1, len(group))
        others = others[(alike[:, others] == alike[:, a, None]).all(axis=0)]
        difference = np.abs(planes.log_offset[others] - planes.log_offset[a])
        sigma = np.sqrt(np.maximum(covariance[a, a] + covariance[others, others] - 2 * covariance[a, others], 0))
        allowed = np.minimum(np.hypot(NOISE_FACTOR * sigma, SYSTEMATIC), FARTHEST)
        for b in np.flatnonzero(difference <= allowed).tolist():
            candidates.append((float(difference[b] / allowed[b]), a, int(others[b])))
    taken = _joined(sorted(candidates), planes, _steps(graph, chosen, shared))
    one, other = np.array(taken, np.int64).reshape(-1, 2).T
    return Merges(
        rows=csr_matrix(planes.means[one] - planes.means[other]),
        log_ratio=planes.log_ray[other] - planes.log_ray[one],
        lines=np.array([(planes.lines[a][0], planes.lines[b][0]) for a, b in taken], np.int64).reshape(-1, 2),
        axis=planes.axis[one],
    )


@dataclass(frozen=True, eq=False)
class _Planes:
    """P classes of coordinates that span a plane on one side of the camera."""

    number: list[int]  # P, of the class
    axis: Int  # (P,) the normal
    lines: list[Int]  # P, ascending
    side: Float  # (P,) of the camera, 1 or -1
    means: csr_matrix  # (P, N) takes a value of each line to the mean over the lines of each plane
    log_ray: Float  # (P,) mean log of the lines' rays along the normal
    log_offset: Float  # (P,) of the plane's distance from the camera


def _planes(graph: LineGraph, shared: Int, log_depth: Float) -> _Planes:
    numbers: list[int] = []
    axes: list[int] = []
    members: list[Int] = []
    for axis in range(count_of(graph.turns)):
        own = np.flatnonzero(shared[:, axis] >= 0)
        if len(own) == 0:
            continue
        order = own[np.argsort(shared[own, axis], kind="stable")]
        found, starts = np.unique(shared[order, axis], return_index=True)
        for number, lines in zip(found.tolist(), np.split(order, starts[1:]), strict=True):
            side = np.sign(graph.components[lines, axis])
            if len(lines) >= FEWEST_LINES and len(np.unique(graph.axis[lines])) > 1 and abs(side.sum()) == len(side):
                numbers.append(number)
                axes.append(axis)
                members.append(np.sort(lines))
    size = np.array([len(own) for own in members], np.int64)
    plane = np.repeat(np.arange(len(size)), size)
    line = np.concatenate([np.zeros(0, np.int64), *members])
    ray = graph.components[line, np.repeat(axes, size).astype(np.int64)]
    means = csr_matrix((np.repeat(1 / size, size), (plane, line)), (len(size), len(graph.segments)))
    log_ray = np.bincount(plane, np.log(np.abs(ray)), len(size)) / size
    side = np.sign([graph.components[own[0], axis] for own, axis in zip(members, axes, strict=True)])
    return _Planes(numbers, np.array(axes, np.int64), members, side, means, log_ray, means @ log_depth + log_ray)


def _steps(graph: LineGraph, chosen: Bool, shared: Int) -> set[tuple[int, int]]:
    """Pairs of classes that a line along their normal leads from one to the other, over SHOWN_STEP px or more."""
    edges = np.flatnonzero(chosen & (graph.kind != "collinear"))
    line = graph.edges[edges].ravel()
    at = shared[graph.edges[edges][:, ::-1].ravel(), graph.axis[line]]  # the class of the other line along this one
    place = np.repeat(graph.crossing[edges], 2, axis=0)
    order = np.argsort(line, kind="stable")
    starts = np.searchsorted(line[order], np.arange(len(graph.segments) + 1))
    classes = int(shared.max(initial=0)) + 1
    found = [np.zeros(0, np.int64)]
    for start, end in zip(starts[:-1].tolist(), starts[1:].tolist(), strict=True):
        own = order[start:end]
        if len(own) < 2:
            continue
        apart = lengths(place[own, None] - place[None, own]) >= SHOWN_STEP
        first, second = true_places(apart & (at[own, None] < at[None, own]))
        found.append(at[own[first]] * classes + at[own[second]])
    return {divmod(pair, classes) for pair in np.unique(np.concatenate(found)).tolist()}


def _joined(
    candidates: list[tuple[float, int, int]], planes: _Planes, apart: set[tuple[int, int]]
) -> list[tuple[int, int]]:
    """The pairs of planes that can be joined at once, the surest first: no group is wider than FARTHEST or has a step.

    Not simply connected components: whether a pair is taken depends on those that were taken before.
    """
    group = np.arange(len(planes.number))
    taken = []
    for _, a, b in candidates:
        if group[a] == group[b]:
            continue
        first, second = (np.flatnonzero(group == group[plane]).tolist() for plane in (a, b))
        pairs = {tuple(sorted((planes.number[p], planes.number[q]))) for p in first for q in second}
        if np.ptp(planes.log_offset[[*first, *second]]) > FARTHEST or pairs & apart:
            continue
        group[second] = group[a]
        taken.append((a, b))
    return taken
