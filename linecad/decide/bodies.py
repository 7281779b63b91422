"""Rigid bodies: sets of lines that keep their depths relative to each other and share one scale."""

from dataclasses import dataclass

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.graph.connectivity import group_numbers
from linecad.line_graph import LineGraph

HANGING = 4  # lines of a group that may hang on a body loosely: too few to carry a false wall


@dataclass(frozen=True, eq=False)
class Bodies:
    """The rigid bodies of a solved graph."""

    body: Int  # (N,) the body of each line; numbers from `count` on are loose groups and single lines
    count: int  # how many of them are rigid; the rest hangs on bodies too loosely
    rigid: Bool  # (N,) the line is of a rigid body itself, not of a small group that hangs on it

    def joins(self, graph: LineGraph) -> Bool:
        """Mask (E,) of the crossings whose two lines are in one body."""
        first, second = graph.edges.T
        together: Bool = self.body[first] == self.body[second]
        return together

    def merged(self, pairs: Int) -> "Bodies":
        """The same with bodies made one where a pair of lines (P, 2) is known to meet; the largest first again."""
        if len(pairs) == 0:
            return self
        group = group_numbers(int(self.body.max()) + 1, self.body[pairs])[self.body]
        size = np.bincount(group)
        lowest = np.full(len(size), np.iinfo(np.int64).max)
        np.minimum.at(lowest, group, self.body)
        # Groups with a rigid body come before those that only hang together.
        order = sorted(range(len(size)), key=lambda k: (lowest[k] >= self.count, -size[k], lowest[k]))
        new = np.empty(len(size), np.int64)
        new[order] = np.arange(len(size))
        return Bodies(new[group], int((lowest < self.count).sum()), self.rigid)


def with_hanging(body: Int, count: int, edges: Int) -> Int:
    """The bodies (N,), small groups of other lines (-1) added to the body that most of their edges (E, 2) lead to.

    What is left over gets numbers from `count` on, one a group.
    """
    body = body.copy()
    rest = body < 0
    group = group_numbers(len(body), edges[rest[edges].all(axis=1)])
    size = np.bincount(group[rest], minlength=len(body))
    touched: dict[int, list[int]] = {}
    for line, other in np.concatenate([edges, edges[:, ::-1]]).tolist():
        if rest[line] and not rest[other] and size[group[line]] <= HANGING:
            touched.setdefault(int(group[line]), []).append(int(body[other]))
    others = count
    for number in np.unique(group[rest]).tolist():
        own = touched.get(number)
        if own:
            body[rest & (group == number)] = max(set(own), key=lambda one: (own.count(one), -one))
        else:
            body[rest & (group == number)] = others
            others += 1
    return body


def agreeing(graph: LineGraph, chosen: Bool, log_depth: Float) -> Bool:
    """Mask (E,) of the chosen crossings and of those others that agree with the depths (N,) which these give.

    A line gives up the crossings of one direction rather than become a boundary (family B), so the courses that meet
    at a true corner are often not chosen; they connect the two walls all the same.
    """
    group = group_numbers(len(graph.segments), graph.edges[chosen & graph.informative])
    first, second = graph.edges.T
    agrees: Bool = graph.informative & (group[first] == group[second]) & (graph.misfit(log_depth) <= graph.tolerance)
    return chosen | agrees
