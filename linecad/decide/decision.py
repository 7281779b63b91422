"""The final decision: which crossings are real, and the one reason for each.

The program chooses crossings whose depths agree. Agreement is not enough: a near edge that hides the courses of a
farther wall gives thirty crossings that agree with each other and are all fake. So a chosen crossing is refused where
it joins two rigid bodies that do not keep their place under resampling, or that fewer than two lines join. Everything
that follows from the real crossings, boundary flags and planar pairs, is made from what is left.
"""

from dataclasses import dataclass, replace

import numpy as np

from linecad.arrays import Bool, Int, Text
from linecad.corrections.annotations import Annotations
from linecad.decide.bodies import Bodies, agreeing
from linecad.decide.stability import (
    MOST_INCONSISTENT,
    STABILITY,
    STABILITY_IF_INCONSISTENT,
    find_stable_bodies,
    resample,
)
from linecad.graph.connectivity import group_numbers, in_no_block
from linecad.line_graph import LineGraph, Solution
from linecad.options import MIN_COMPONENT, Options
from solver.choice import boundaries, planar_pairs
from solver.families import find_families


@dataclass(frozen=True, eq=False)
class Decision:
    """What is decided about a solved graph of N lines and E crossings."""

    real: Bool  # (E,)
    reason: Text  # (E,) one of linecad.scene.REASONS
    is_boundary: Bool  # (N,) the paper's B_i, of the real crossings
    planar_pairs: Int  # (P, 3) as in Solution, of the real crossings
    bodies: Bodies | None  # rigid bodies; None where every join was taken
    # (N,) the solution holds for the line without reservation: its rigid body is firm, its place depends on more than
    # one crossing, and none of its crossings was refused.
    is_firm: Bool
    notes: tuple[str, ...]

    def within(self, kept: Bool, graph: LineGraph) -> "Decision":
        """The same where only some lines (N,) are kept: no crossing of another line is real, unless annotated."""
        gone = (self.reason == "chosen") & ~kept[graph.edges].all(axis=1)
        reason = np.where(gone, "other group", self.reason)
        return replace(self, real=self.real & ~gone, reason=reason, is_boundary=boundaries(graph, self.real & ~gone))


def decide(
    graph: LineGraph, solution: Solution, options: Options, inconsistency: float | None, annotations: Annotations
) -> Decision:
    """Decide about every crossing of a solved graph.

    `inconsistency` is that of the photo, needed where joins must be stable; `annotations` are a person's annotations.
    """
    reason = np.full(len(graph.edges), "chosen", dtype="<U13")
    reason[~solution.connected] = "not chosen"
    reason[~graph.possible] = "impossible"
    reason[solution.connected & ~_within_groups(graph, solution.connected)] = "uninformative"
    joined = _joins(graph, solution, options, inconsistency, annotations)
    refused = (reason == "chosen") & (joined.reason != "")
    reason[refused] = joined.reason[refused]
    reason[(reason == "chosen") & ~_in_large_groups(graph, reason == "chosen")] = "small group"
    reason[(reason == "chosen") & ~_within_groups(graph, reason == "chosen")] = "uninformative"  # of a group in pieces
    real = reason == "chosen"
    real |= annotations.real
    reason[annotations.real | annotations.fake] = "annotated"
    touched = np.zeros(len(graph.segments), bool)
    touched[graph.edges[refused]] = True
    return Decision(
        real=real,
        reason=reason,
        is_boundary=boundaries(graph, real),
        planar_pairs=_planar_pairs(graph, solution, options, real),
        bodies=joined.bodies,
        is_firm=joined.firm & ~touched & ~in_no_block(len(graph.segments), graph.edges[real & graph.informative]),
        notes=_notes(refused & _in_large_groups(graph, real), joined, inconsistency),
    )


@dataclass(frozen=True, eq=False)
class _Joins:
    """What the joins of bodies come to."""

    bodies: Bodies | None
    firm: Bool  # (N,)
    reason: Text  # (E,) why a crossing must not join its lines; empty where it may
    required: float = 0.0  # stability


def _joins(
    graph: LineGraph, solution: Solution, options: Options, inconsistency: float | None, annotations: Annotations
) -> _Joins:
    """Which crossings join what must not be joined."""
    count, may = len(graph.segments), np.full(len(graph.edges), "", dtype="<U13")
    if options.joins_used == "all":
        return _Joins(None, np.ones(count, bool), may)
    agrees = agreeing(graph, solution.connected, solution.log_depth)
    sure = graph.edges[annotations.real & solution.connected & graph.informative]
    if options.joins_used == "biconnected":
        from linecad.decide.blocks import find_blocks

        bodies = find_blocks(graph, agrees).merged(sure)
        return _Joins(bodies, bodies.rigid, np.where(bodies.joins(graph), may, "loose"))
    if inconsistency is None:
        raise ValueError("stable joins need the inconsistency of the photo")
    is_inconsistent = inconsistency > MOST_INCONSISTENT
    fits = resample(graph, options.solve.seed)
    stable = find_stable_bodies(graph, agrees, solution.log_depth, fits, is_inconsistent)
    merged = stable.bodies.merged(sure)
    reason = np.where(merged.joins(graph), may, "unstable")
    if not is_inconsistent:
        return _Joins(merged, stable.firm, reason, STABILITY)
    from linecad.decide.blocks import find_blocks

    blocks = find_blocks(graph, agrees & stable.bodies.joins(graph))
    bodies = blocks.merged(sure)
    reason = np.where(bodies.joins(graph), may, np.where(reason == "", "loose", reason))
    return _Joins(bodies, blocks.rigid & stable.firm, reason, STABILITY_IF_INCONSISTENT)


def _within_groups(graph: LineGraph, chosen: Bool) -> Bool:
    """Mask (E,) of the crossings of two lines that chosen crossings connect which tell about depth.

    A chosen crossing between two such groups lies so near the horizon that it says nothing about depth: the groups
    have scales of their own, and a coordinate that they shared would be two numbers.
    """
    group = group_numbers(len(graph.segments), graph.edges[chosen & graph.informative])
    first, second = graph.edges.T
    within: Bool = group[first] == group[second]
    return within


def _in_large_groups(graph: LineGraph, chosen: Bool) -> Bool:
    """Mask (E,) of the crossings whose two lines are in groups of MIN_COMPONENT lines or more."""
    group = group_numbers(len(graph.segments), graph.edges[chosen & graph.informative])
    large: Bool = (np.bincount(group) >= MIN_COMPONENT)[group]
    return np.asarray(large[graph.edges].all(axis=1))


def _planar_pairs(graph: LineGraph, solution: Solution, options: Options, real: Bool) -> Int:
    """The planar pairs of the real crossings; those of the program where it sees none, or nothing was refused."""
    if len(solution.planar_pairs) == 0 or np.array_equal(real, solution.connected):
        return solution.planar_pairs
    return planar_pairs(find_families(graph, options.solve.without | {"cycles", "boundary"}), real)


def _notes(refused: Bool, joins: _Joins, inconsistency: float | None) -> tuple[str, ...]:
    """What a reader should know; `refused` (E,) are the refused crossings of lines that the scene has."""
    notes = []
    if joins.required == STABILITY_IF_INCONSISTENT:
        notes.append(
            f"crossings in this photo often contradict each other (inconsistency {inconsistency:.2f}, usually up to "
            f"{MOST_INCONSISTENT}), as where buildings hide each other: lines reach less far, and joins must be more "
            "stable"
        )
    if refused.any():
        found, why = set(joins.reason[refused].tolist()), []
        if "unstable" in found:
            why.append(f"that keep their place in less than {joins.required:.0%} of the fits without some lines")
        if "loose" in found:
            why.append("that fewer than two lines join")
        notes.append(
            f"{int(refused.sum())} crossings join bodies of lines {' or '.join(why)}, and are not taken for real: "
            "such a join is often a near edge before a far wall"
        )
    return tuple(notes)
