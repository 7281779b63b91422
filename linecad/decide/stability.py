"""Which lines keep their place when others are left out: rigid bodies by resampling.

The depths of a photo are fitted again and again, each time without a random part of its lines. Where many lines that
are independent of each other agree, nothing moves. Where two walls are joined by a few lines, or by crossings that
contradict others and won by a little, the fit finds another answer as soon as these lines are missing. The *stability*
of a line is the share of the fits, among those in which it is connected to its body at all, that leave it at its depth
relative to the body.

How much stability is required depends on the photo, since agreement is worth less where much is fake. Two figures tell:
how many wide corners (both lines end well before they would meet) contradict the depths, and how unstable the lines are
on the whole. Their sum is the *inconsistency* of the photo: small for one building, whatever its shape, large for
streets of several buildings that hide each other.
"""

import functools
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.decide.bodies import Bodies, with_hanging
from linecad.geometry import PhotoLength
from linecad.graph.connectivity import group_numbers
from linecad.line_graph import LineGraph
from linecad.threads import thread_count
from solver.robust import RobustFit

FITS = 30
FITS_FOR_INCONSISTENCY = 9
LEFT_OUT = 0.3  # of the lines, in each fit
SAME_DEPTH = 0.015  # log depth; a line that moves less against its body keeps its place
LEAST_BODY = 5  # lines
SEEDS = 60  # lines about which the core of a body is looked for
LEAST_SEEN = 3  # fits in which two lines of a core are connected and in place
MANY_BODIES = 40  # bodies that are sought; what is left after so many is crumbs
FIRM = 0.95  # stability from which a line is as sure as the solution

WIDE_CORNER = PhotoLength(20.0)  # that the wider gap of a corner has at least
CONTRADICTION = 3.0  # tolerances, and CONTRADICTION times LEAST_TOLERANCE at least, from which a crossing contradicts
LEAST_TOLERANCE = 0.01  # log depth
PRIOR_CORNERS, PRIOR_FAKE = 20.0, 0.1  # corners that are taken as seen, with this share of contradictions
UNSTABLE = 0.3  # of the mean lack of stability, that counts as much as one contradiction
MOST_INCONSISTENT = 0.16  # of a consistent photo
STABILITY = 0.55  # required in a consistent photo
STABILITY_IF_INCONSISTENT = 0.95  # required in an inconsistent one


@dataclass(frozen=True, eq=False)
class Fits:
    """Fits without some lines."""

    present: Bool  # (F, N)
    depth: Float  # (F, N) log depth; 0 where a line is absent
    group: Int  # (F, N) lines of one number are connected by crossings that agree in this fit


def resample(graph: LineGraph, seed: int = 0, fits: int = FITS) -> Fits:
    """So many fits, each without LEFT_OUT of the lines; in each three of them no line is left out twice."""
    count = len(graph.segments)
    random = np.random.default_rng(seed)
    first, second = graph.edges.T
    present = np.ones((fits, count), bool)
    in_turn = int(1 / LEFT_OUT)
    for number in range(fits):
        if number % in_turn == 0:
            rank = random.permutation(count) / max(1, count)
        out = LEFT_OUT * (number % in_turn)
        present[number] = (rank < out) | (rank >= out + LEFT_OUT)
    with ThreadPoolExecutor(thread_count()) as pool:  # the linear algebra of sparse systems runs beside the interpreter
        depth = np.array(list(pool.map(functools.partial(_fit_present, graph), present))).reshape(fits, count)
    group = np.zeros((fits, count), np.int64)
    for number in range(fits):
        agrees = graph.informative & present[number, first] & present[number, second]
        agrees &= graph.misfit(depth[number]) <= np.maximum(graph.tolerance, LEAST_TOLERANCE)
        group[number] = group_numbers(count, graph.edges[agrees])
    return Fits(present, depth, group)


def _fit_present(graph: LineGraph, present: Bool) -> Float:
    """Log depths (N,) by the lines that are present (N,), 0 for the others."""
    # Of a graph without the others: half of the crossings go with three lines of ten.
    depth = np.zeros(len(present))
    depth[present] = RobustFit(graph.subset(np.flatnonzero(present))).depths()
    return depth


@dataclass(frozen=True, eq=False)
class StableBodies:
    """Rigid bodies of lines that keep together when others are left out."""

    bodies: Bodies
    firm: Bool  # (N,) lines of rigid bodies with a stability of FIRM or more: as sure as the solution


def find_stable_bodies(
    graph: LineGraph, chosen: Bool, log_depth: Float, fits: Fits, is_inconsistent: bool
) -> StableBodies:
    """Part the lines of a solved graph into bodies that keep together in the fits.

    `chosen` (E,) are the crossings that agree with the depths `log_depth` (N,). In an inconsistent photo more stability
    is required, and relative to the majority of what is connected. Small groups that fall off a body stay with it.
    """
    count = len(graph.segments)
    edges = graph.edges[chosen & graph.informative]
    required = STABILITY_IF_INCONSISTENT if is_inconsistent else STABILITY
    body = np.full(count, -1)
    firm, free, loose = np.zeros(count, bool), np.ones(count, bool), np.zeros(count, bool)
    bodies = 0
    while bodies < MANY_BODIES:
        part = _largest_part(count, edges, free)
        if part.sum() < LEAST_BODY:
            break
        # Where crossings contradict each other, relative to the majority first. Where two bodies are of one size,
        # that keeps nothing in place.
        for core in [part] * is_inconsistent + [_core(part, log_depth, fits, required)]:
            share = stability(part, log_depth, fits, core)
            kept = _largest_part(count, edges, part & (share >= required))
            if kept.sum() >= LEAST_BODY:
                break
        else:
            free &= ~part
            loose |= part
            continue
        body[kept] = bodies
        firm[kept] = share[kept] >= FIRM
        free &= ~kept
        bodies += 1
    edges = edges[~loose[edges].any(axis=1)]
    return StableBodies(Bodies(with_hanging(body, bodies, edges), bodies, body >= 0), firm)


def stability(part: Bool, log_depth: Float, fits: Fits, core: Bool | None = None) -> Float:
    """(N,) share of the fits that leave a line of `part` (N,) where `log_depth` has it, relative to the others.

    Relative to the lines of `core` (N,) if it is given. Fits in which the line is absent, or not connected to most of
    these, say nothing; without any the share is 1.
    """
    core = part if core is None else core
    kept, moved = np.zeros(len(part)), np.zeros(len(part))
    for present, depth, group in zip(fits.present, fits.depth, fits.group, strict=True):
        seen = core & present
        if not seen.any():
            continue
        connected = part & present & (group == np.bincount(group[seen]).argmax())
        shift = depth - log_depth
        same = np.abs(shift - _densest(shift[connected & core])) < SAME_DEPTH
        kept += connected & same
        moved += connected & ~same
    return np.asarray(np.where(kept + moved > 0, kept / np.maximum(kept + moved, 1), 1.0))


def _core(part: Bool, log_depth: Float, fits: Fits, required: float) -> Bool:
    """Mask (N,) of the most lines of `part` (N,) that keep their place relative to one line of it.

    In a photo of two bodies of one size most lines are now of the one, now of the other: the majority is no reference.
    """
    lines = np.flatnonzero(part)
    seeds = lines[np.linspace(0, len(lines) - 1, min(SEEDS, len(lines))).astype(np.int64)]
    kept, moved = np.zeros((len(seeds), len(lines))), np.zeros((len(seeds), len(lines)))
    for present, depth, group in zip(fits.present, fits.depth, fits.group, strict=True):
        connected = (group[seeds, None] == group[lines]) & present[seeds, None] & present[lines]
        shift = depth - log_depth
        same = np.abs(shift[seeds, None] - shift[lines]) < SAME_DEPTH
        kept += connected & same
        moved += connected & ~same
    holds = (kept >= LEAST_SEEN) & (kept >= required * (kept + moved))
    core = np.zeros(len(part), bool)
    core[lines[holds[holds.sum(axis=1).argmax()]]] = True
    return core


def inconsistency_of(graph: LineGraph, log_depth: Float, fits: Fits, width: int) -> float:
    """How often crossings contradict each other in the largest part of a photo `width` px wide, by depths (N,)."""
    first, second = graph.edges.T
    off = graph.misfit(log_depth)
    agrees = graph.informative & (off <= np.maximum(graph.tolerance, LEAST_TOLERANCE))
    part = _largest_part(len(graph.segments), graph.edges[agrees], np.ones(len(graph.segments), bool))
    inside = graph.informative & part[first] & part[second]
    wide = inside & (graph.kind == "L") & (graph.gap.max(axis=1) > WIDE_CORNER.px(width))
    against = off > CONTRADICTION * np.maximum(graph.tolerance, LEAST_TOLERANCE)
    fake = (float((wide & against).sum()) + PRIOR_CORNERS * PRIOR_FAKE) / (float(wide.sum()) + PRIOR_CORNERS)
    lack = float(1 - stability(part, log_depth, fits)[part].mean()) if part.any() else 0.0
    return fake + UNSTABLE * lack


def _densest(values: Float) -> float:
    """The middle of the densest interval of twice SAME_DEPTH."""
    ordered = np.sort(values)
    counts = np.searchsorted(ordered, ordered + 2 * SAME_DEPTH) - np.arange(len(ordered))
    start = int(counts.argmax())
    return float(np.median(ordered[start : start + counts[start]]))


def _largest_part(count: int, edges: Int, lines: Bool) -> Bool:
    """Mask (N,) of the largest group that edges connect among the masked lines."""
    group = group_numbers(count, edges[lines[edges].all(axis=1)])
    if not lines.any():
        return np.zeros(count, bool)
    largest: Bool = lines & (group == np.bincount(group[lines]).argmax())
    return largest
