"""Rigid bodies: lines that stay together, at one depth relative to each other, whatever else is left out.

The depths of a photo are fitted again and again without a random part of its lines (`linecad.decide.stability`). Two
lines are *together* in a fit when crossings that agree connect them and their depths have not moved against each other.
Lines that one bar alone joins are not together in the fits without the bar: a body that is held by one bundle of
crossings is two bodies, and the bundle is evidence for how they stand to each other.
"""

from dataclasses import dataclass

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.decide.stability import LEAST_TOLERANCE, SAME_DEPTH, Fits
from linecad.graph.connectivity import group_numbers
from linecad.line_graph import LineGraph

TOGETHER = 0.9  # share of the fits in which a line is together with the core of its body
LEAST_CORE = 5  # lines
LEAST_BODY = 4  # lines, with those that hang on it
SEEDS = 60  # lines about which a core is looked for
REFINED = 3  # times that the lines of a core are found anew, relative to all of it
HANGING_STEPS = 4  # lines that hang on lines that hang on a body, and so on


@dataclass(frozen=True, eq=False)
class RigidBodies:
    """The N lines of a graph in B bodies."""

    body: Int  # (N,) -1 for lines of none
    count: int  # B

    @property
    def size(self) -> Int:
        """(B,) lines of each body."""
        return np.bincount(self.body[self.body >= 0], minlength=self.count)


def find_rigid_bodies(graph: LineGraph, log_depth: Float, fits: Fits) -> RigidBodies:
    """Part the lines of a graph into rigid bodies, the largest cores first.

    `log_depth` (N,) is the fit to all lines, relative to which `fits` moved. Lines that are in no core hang on the body
    that most of their crossings agree with; groups of LEAST_BODY lines that hang on none are bodies of their own.
    """
    body = _cores(log_depth, fits)
    agrees = agreeing(graph, log_depth)
    edges = graph.edges[agrees]
    body = with_hanging(body, edges, graph.weight[agrees])
    rest = body < 0
    group = group_numbers(len(body), edges[rest[edges].all(axis=1)])
    body = np.where(rest, body.max(initial=-1) + 1 + group, body)
    size = np.bincount(body, minlength=1)
    large = size >= LEAST_BODY
    new = np.where(large, np.cumsum(large) - 1, -1)
    return RigidBodies(new[body], int(large.sum()))


def _cores(log_depth: Float, fits: Fits) -> Int:
    """The core (N,) that each line is in, or -1."""
    shift = fits.depth - log_depth
    body, free, count = np.full(len(log_depth), -1), np.ones(len(log_depth), bool), 0
    while True:
        core = _largest_star(fits, shift, free)
        for _ in range(REFINED):
            core = free & (togetherness(fits, shift, core) >= TOGETHER) if core.any() else core
        if core.sum() < LEAST_CORE:
            return body
        body[core] = count
        free &= ~core
        count += 1


def _largest_star(fits: Fits, shift: Float, free: Bool) -> Bool:
    """Mask (N,) of the most free lines that are together with one of them."""
    lines = np.flatnonzero(free)
    star = np.zeros(len(free), bool)
    if len(lines) == 0:
        return star
    seeds = lines[np.linspace(0, len(lines) - 1, min(SEEDS, len(lines))).astype(np.int64)]
    both, together = np.zeros((len(seeds), len(lines))), np.zeros((len(seeds), len(lines)))
    for present, group, moved in zip(fits.present, fits.group, shift, strict=True):
        seen = present[seeds, None] & present[lines]
        both += seen
        together += (
            seen & (group[seeds, None] == group[lines]) & (np.abs(moved[seeds, None] - moved[lines]) < SAME_DEPTH)
        )
    holds = (both > 0) & (together >= TOGETHER * both)
    star[lines[holds[holds.sum(axis=1).argmax()]]] = True
    return star


def togetherness(fits: Fits, shift: Float, core: Bool) -> Float:
    """(N,) share of the fits in which a line is together with most of a core (N,), of those in which both are seen.

    `shift` (F, N) is by how much each line moved in each fit.
    """
    together, seen = np.zeros(len(core)), np.zeros(len(core))
    for present, group, moved in zip(fits.present, fits.group, shift, strict=True):
        own = core & present
        if not own.any():
            continue
        main = own & (group == np.bincount(group[own]).argmax())
        at = np.median(moved[main])
        together += present & (group == group[np.argmax(main)]) & (np.abs(moved - at) < SAME_DEPTH)
        seen += present
    return np.asarray(np.where(seen > 0, together / np.maximum(seen, 1), 0.0))


def agreeing(graph: LineGraph, log_depth: Float) -> Bool:
    """(E,) crossings that tell something and agree with log depths (N,)."""
    return graph.informative & (graph.misfit(log_depth) <= np.maximum(graph.tolerance, LEAST_TOLERANCE))


def with_hanging(body: Int, edges: Int, weight: Float) -> Int:
    """The bodies (N,), other lines (-1) with the body that the heaviest of their edges (E, 2) lead to."""
    body, count = body.copy(), int(body.max(initial=-1)) + 1
    both = np.concatenate([edges, edges[:, ::-1]])
    heavy = np.concatenate([weight, weight])
    for _ in range(HANGING_STEPS):
        loose = (body[both[:, 0]] < 0) & (body[both[:, 1]] >= 0)
        if not loose.any():
            break
        line, other = both[loose].T
        votes = np.bincount(line * count + body[other], heavy[loose], len(body) * count).reshape(-1, count)
        own = np.unique(line)
        body[own] = votes[own].argmax(axis=1)
    return body
