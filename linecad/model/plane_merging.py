"""Which planes that crossings left apart are one plane: offsets of one normal that the noise cannot tell apart.

The windows of two floors lie in one facade, but crossings tie the floors by a long way round, and each step has its
noise. The least squares knows how much comes together: the variance of the difference of two log offsets follows from
its normal equations. Two planes are merged where the difference is within that noise, unless a line that runs along
their normal leads from one to the other: then the photo shows the step between them.
"""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.linalg import splu

from linecad.arrays import Bool, Float, Int
from linecad.line_graph import LineGraph

NOISE_FACTOR = 3.0  # standard deviations; the tolerances of the crossings cover as many
SYSTEMATIC = 0.004  # relative offset; what the frame, the calibration and the detector do to all lines of a plane alike
FARTHEST = 0.015  # relative offset; planes that lie further apart are never merged, however little ties them
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
    """Planes to be merged, given the class `shared` (N, 3) of each coordinate and the component (N,) of each line.

    `normal` (N, N) is the matrix of the normal equations that gave `log_depth` (N,), in units of 1 / tolerance ** 2.
    Equal classes are one plane already.
    """
    count = len(graph.segments)
    classes, axes, members = _planes(graph, shared)
    if len(classes) < 2:
        return Merges(csr_matrix((0, count)), np.zeros(0), np.zeros((0, 2), np.int64), np.zeros(0, np.int64))
    size = np.array([len(own) for own in members])
    means = csr_matrix(
        (np.repeat(1 / size, size), (np.repeat(np.arange(len(size)), size), np.concatenate(members))),
        (len(size), count),
    )
    ray = np.concatenate([graph.rays[own, axis] for own, axis in zip(members, axes.tolist(), strict=True)])
    side = np.sign([graph.rays[own[0], axis] for own, axis in zip(members, axes.tolist(), strict=True)])
    log_ray = np.bincount(np.repeat(np.arange(len(size)), size), np.log(np.abs(ray))) / size
    log_offset = means @ log_depth + log_ray
    spread = splu(normal.tocsc()).solve(means.T.toarray())  # (N, P)
    covariance = np.asarray(means @ spread) / NOISE_FACTOR**2
    apart = _steps(graph, chosen, shared)
    group = np.array([component[own[0]] for own in members])
    candidates = []
    for a in range(len(size)):
        others = np.arange(a + 1, len(size))
        others = others[(axes[others] == axes[a]) & (group[others] == group[a]) & (side[others] == side[a])]
        difference = np.abs(log_offset[others] - log_offset[a])
        sigma = np.sqrt(np.maximum(covariance[a, a] + covariance[others, others] - 2 * covariance[a, others], 0))
        allowed = np.minimum(np.hypot(NOISE_FACTOR * sigma, SYSTEMATIC), FARTHEST)
        for b in np.flatnonzero(difference <= allowed).tolist():
            candidates.append((float(difference[b] / allowed[b]), a, int(others[b])))
    return _joined(sorted(candidates), means, log_ray, log_offset, size, members, classes, axes, apart)


def _planes(graph: LineGraph, shared: Int) -> tuple[list[int], Int, list[Int]]:
    """Classes of coordinates that span a plane on one side of the camera: their number, axis and lines."""
    classes: list[int] = []
    axes: list[int] = []
    members: list[Int] = []
    for axis in range(3):
        own = np.flatnonzero(shared[:, axis] >= 0)
        if len(own) == 0:
            continue
        order = own[np.argsort(shared[own, axis], kind="stable")]
        numbers, starts = np.unique(shared[order, axis], return_index=True)
        for number, lines in zip(numbers.tolist(), np.split(order, starts[1:]), strict=True):
            side = np.sign(graph.rays[lines, axis])
            if len(lines) >= FEWEST_LINES and len(np.unique(graph.axis[lines])) == 2 and abs(side.sum()) == len(side):
                classes.append(number)
                axes.append(axis)
                members.append(np.sort(lines))
    return classes, np.array(axes, np.int64), members


def _steps(graph: LineGraph, chosen: Bool, shared: Int) -> set[tuple[int, int]]:
    """Pairs of classes that a line along their normal leads from one to the other, over SHOWN_STEP px or more."""
    edges = np.flatnonzero(chosen & (graph.kind != "collinear"))
    line = graph.edges[edges].ravel()
    at = shared[graph.edges[edges][:, ::-1].ravel(), graph.axis[line]]  # the class of the other line along this one
    place = np.repeat(graph.crossing[edges], 2, axis=0)
    order = np.argsort(line, kind="stable")
    starts = np.searchsorted(line[order], np.arange(len(graph.segments) + 1))
    pairs: set[tuple[int, int]] = set()
    for start, end in zip(starts[:-1].tolist(), starts[1:].tolist(), strict=True):
        own = order[start:end]
        if len(own) < 2:
            continue
        apart = np.linalg.norm(place[own, None] - place[None, own], axis=2) >= SHOWN_STEP
        first, second = np.nonzero(apart & (at[own, None] < at[None, own]))
        pairs.update(zip(at[own[first]].tolist(), at[own[second]].tolist(), strict=True))
    return pairs


def _joined(
    candidates: list[tuple[float, int, int]],
    means: csr_matrix,
    log_ray: Float,
    log_offset: Float,
    size: Int,
    members: list[Int],
    classes: list[int],
    axes: Int,
    apart: set[tuple[int, int]],
) -> Merges:
    """The candidates that can be joined at once, the surest first: no group is wider than FARTHEST or has a step."""
    groups = {plane: [plane] for plane in range(len(size))}
    home = list(range(len(size)))
    taken = []
    for _, a, b in candidates:
        first, second = groups[home[a]], groups[home[b]]
        if first is second:
            continue
        both = log_offset[[*first, *second]]
        stepped = any(
            (min(classes[p], classes[q]), max(classes[p], classes[q])) in apart for p in first for q in second
        )
        if np.ptp(both) > FARTHEST or stepped:
            continue
        for plane in second:
            home[plane] = home[a]
        groups[home[a]] = first + second
        taken.append((a, b))
    one, other = np.array(taken, np.int64).reshape(-1, 2).T
    return Merges(
        rows=csr_matrix(means[one] - means[other]),
        log_ratio=log_ray[other] - log_ray[one],
        lines=np.array([(members[a][0], members[b][0]) for a, b in taken], np.int64).reshape(-1, 2),
        axis=axes[one],
    )
