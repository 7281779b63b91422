"""Depths that fit a set of real crossings, or the crossings that contradict each other.

Each connected edge says in logarithms of near-end depths n: |n_i - n_j - step| <= tolerance, and every n lies between 0
and the range. These are difference constraints: they have a solution unless some cycle of them sums to less than zero
(Bellman and Ford).
"""

from dataclasses import dataclass

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.line_graph import LineGraph

SLACK = 1e-7  # log depth, added to every tolerance; far below pixel noise, above what rounding sums up to
LOOK_EVERY = 16  # rounds after which a contradiction is looked for; it shows long before the last round
IMPROVEMENT = 1e-12  # log depth, below which a change is rounding


@dataclass(frozen=True, eq=False)
class Fit:
    """Either depths, and then there is no contradiction, or smallest sets of edges that cannot all be real."""

    near: Float  # (N,) log depth of the near ends; of no meaning where there is a contradiction
    contradictions: tuple[Int, ...]  # each with its edges ascending; some of all that there are

    @property
    def contradiction(self) -> Int:
        """The edges of one contradiction, or none."""
        return self.contradictions[0] if self.contradictions else np.zeros(0, np.int64)


def fit_near_depths(
    graph: LineGraph, step: Float, connected: Bool, log_range: float, guess: Float, slack: float = SLACK
) -> Fit:
    """The depths next to `guess` from below that fit the connected edges; `step` of `solver.depths.near_log_ratio`.

    A contradiction is a cycle of edges whose log ratios do not cancel within their tolerances, or a path between two
    lines that would lie further apart than the range.
    """
    lines = len(graph.segments)
    edges = np.flatnonzero(connected & graph.informative)
    i, j = graph.edges[edges].T
    c, tolerance = step[edges], graph.tolerance[edges] + slack
    every, ground = np.arange(lines), np.full(lines, lines)
    # n[head] <= n[tail] + width; the ground stands for depth 0
    head = np.concatenate([i, j, every, ground])
    tail = np.concatenate([j, i, ground, every])
    width = np.concatenate([c + tolerance, tolerance - c, np.full(lines, log_range + SLACK), np.full(lines, SLACK)])
    edge = np.concatenate([edges, edges, np.full(2 * lines, -1)])
    depth = np.append(guess, 0.0)
    cause = np.full(lines + 1, -1)  # the constraint that last lowered each depth
    for turn in range(1, lines + 3):
        reached = depth[tail] + width
        lowest = depth.copy()
        np.minimum.at(lowest, head, reached)
        lowered = lowest < depth - IMPROVEMENT
        if not lowered.any():
            return Fit(depth[:-1] - depth[-1], ())
        binding = np.flatnonzero(lowered[head] & (reached == lowest[head]))
        cause[head[binding]] = binding
        depth = np.where(lowered, lowest, depth)
        if turn % LOOK_EVERY == 0 or turn > lines:
            circling = _on_a_cycle(cause, tail)
            if len(circling):
                cycles = {tuple(_cycle(node, cause, tail, edge).tolist()): None for node in circling.tolist()}
                return Fit(depth[:-1], tuple(np.array(cycle, np.int64) for cycle in cycles))
    raise AssertionError("depths fall in every round, yet no cycle of constraints is the cause")


def _on_a_cycle(cause: Int, tail: Int) -> Int:
    """Nodes on a cycle of causes; such a cycle has a negative sum, whenever it appears (Tarjan)."""
    start = len(cause)
    before = np.append(np.where(cause >= 0, tail[cause], start), start)
    for _ in range(start.bit_length() + 1):  # each round doubles the steps that are gone back
        before = before[before]
    return np.unique(before[before < start])


def _cycle(node: int, cause: Int, tail: Int, edge: Int) -> Int:
    """The edges of the cycle of causes that `node` hangs on."""
    seen: dict[int, int] = {}
    walked: list[int] = []
    while node not in seen:
        seen[node] = len(walked)
        walked.append(int(cause[node]))
        node = int(tail[walked[-1]])
    around = edge[walked[seen[node] :]]
    return np.unique(around[around >= 0])
