"""The stage that puts every body where it most likely is: evidence, facts, scene program."""

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.corrections.corrected import ToldFact
from linecad.geometry import lengths
from linecad.line_graph import LineGraph, Solution
from linecad.progress import StageReport, silent
from linecad.scene import DepthMapReport
from linecad.ties.candidates import CONNECTING, Candidate
from linecad.ties.depth_parts import right_by_map
from linecad.ties.depth_ties import DepthWitness, MapPlaces, follow_map, report_of, ties_to_map
from linecad.ties.evidence import Evidence, find_evidence
from linecad.ties.facts import CERTAIN, IMPLIED, FactTies, ties_of_facts
from linecad.ties.heads import log_height_of_ceiling
from linecad.ties.links import find_links, told_links
from linecad.ties.pieces import ties_between_bodies, with_pieces_heard
from linecad.ties.probability import chances, main_lines, probabilities
from linecad.ties.seams import Seam
from linecad.ties.setting import Setting, Sight
from linecad.ties.weights import mean_of_looks, weigh_candidates, with_feet_once, worth_a_tie
from solver.bodies.search import place
from solver.bodies.ties import Placement, Ties
from solver.choice import boundaries
from solver.depths import end_ratios, near_log_ratio
from solver.options import OnProgress, SolveOptions
from solver.potentials import fit_near_depths
from solver.robust import agreeing_with


@dataclass(frozen=True, eq=False)
class BodyPlaces:
    """Bodies in their places."""

    evidence: Evidence
    facts: tuple[ToldFact, ...]  # about the nodes of the graph
    told: FactTies  # what they say
    # Of each tie: a candidate, the edge of a crossing called real, -1 less the number of a fact, None for a depth map
    sources: tuple[Candidate | int | None, ...]
    ties: Ties
    placement: Placement
    mapped: MapPlaces | None  # what a depth map made of the places, where it was heard
    known: Float | None = None  # (N,) probabilities of the lines, where these were asked for already

    @property
    def log_scale(self) -> Float:
        """(B,) of each body; behind these of the ground, where no map was heard."""
        return self.placement.log_scale if self.mapped is None else self.mapped.log_scale

    @property
    def scale_with_ground(self) -> Float:
        """(B + 1,) log scale of each body and, last, of the ground, also where a map was heard."""
        count = self.evidence.setting.bodies.count
        ground = self.placement.log_scale[count] if self.mapped is None else self.mapped.ground
        return np.append(self.log_scale[:count], ground)

    @cached_property
    def log_depth(self) -> Float:
        """(N,) of all lines there."""
        setting = self.evidence.setting
        body = setting.bodies.body
        moved = np.append(self.log_scale[: setting.bodies.count], 0.0)[body]
        return np.asarray(setting.log_depth + moved)

    def connected_at(self, graph: LineGraph, log_depth: Float) -> Bool:
        """(E,) the crossings of a graph of these lines that agree at depths (N,), as far as a person lets them."""
        evidence = self.evidence
        cut = _across(evidence.setting.bodies.body[graph.edges], self.told.cuts)
        return np.asarray((agreeing_with(graph, log_depth) & ~evidence.fake & ~cut) | evidence.real)

    @cached_property
    def probability(self) -> Float:
        """(N,) that a line's depth relative to component 0 is right within 5 %."""
        if self.known is not None:
            return self.known
        return self.probability_at(self.log_depth, self.connected_at(self.evidence.setting.graph, self.log_depth))

    def probability_at(self, log_depth: Float, connected: Bool) -> Float:
        """The same for lines at depths (N,) near these, where these crossings are `connected` (E,)."""
        evidence, setting, pieces = self.evidence, self.evidence.setting, self.evidence.pieces
        links = find_links(pieces, self.scale_with_ground, self.placement.margin, evidence.reference, self.mapped)
        # What a person ties to the reference stands there.
        certain = self.placement.counted & (self.ties.weight >= IMPLIED)
        told = self.ties.parts(certain, len(self.placement.log_scale))
        links = told_links(links, pieces, evidence.reference, told == told[evidence.reference])
        length = lengths(np.diff(setting.graph.segments.ends, axis=1)[:, 0]) * main_lines(setting, connected)
        found = probabilities(setting, log_depth, pieces, chances(pieces, self.seams, links, length))
        if not isinstance(evidence.heard, DepthWitness) or self.mapped is None:
            return found
        of_part = np.isin(setting.bodies.body, np.flatnonzero(self.mapped.parts))
        return np.where(of_part, right_by_map(evidence.heard.width_of_parts), found)

    @cached_property
    def seams(self) -> list[Seam]:
        """Where bodies are weak, as sure as they are at these places."""
        return with_pieces_heard(list(self.evidence.seams), self.evidence.pieces, self.scale_with_ground)

    @property
    def by_map(self) -> Bool:
        """(N,) lines of bodies that a depth map alone ties to the reference."""
        body = self.evidence.setting.bodies.body
        if self.mapped is None:
            return np.zeros(len(body), bool)
        return np.asarray((body >= 0) & self.mapped.by_map[np.maximum(body, 0)])


@dataclass(frozen=True, eq=False)
class Placed:
    """Lines in their places."""

    solution: Solution  # the crossings that agree there
    places: BodyPlaces
    probability: Float  # (N,) that a line's depth relative to component 0 is right within 5 %
    by_map: Bool  # (N,) lines of bodies that a depth map alone ties to the reference
    depth_map: DepthMapReport | None  # its scale is that of the solution's depths; None where no map was given
    by_hand: Bool | None = None  # (N,) lines that a person drew, or told the length of; None for none

    @property
    def setting(self) -> Setting:
        """The bodies with their inner depths."""
        return self.places.evidence.setting

    @property
    def told(self) -> Bool:
        """(N,) lines that a person drew or measured, or of bodies that a person placed against the reference."""
        evidence, body = self.places.evidence, self.setting.bodies.body
        own = body[self.setting.graph.edges[evidence.real]]
        placed = np.append(self.places.told.ties.bodies, own[own[:, 0] != own[:, 1]])
        told = np.isin(body, placed[(placed >= 0) & (placed != evidence.reference)])
        return told if self.by_hand is None else told | self.by_hand

    @property
    def ties(self) -> Ties:
        """What ties the bodies."""
        return self.places.ties

    @property
    def placement(self) -> Placement:
        """Their scales."""
        return self.places.placement

    @property
    def reference(self) -> int:
        """The body that the others are placed relative to."""
        return self.places.evidence.reference

    @property
    def ground(self) -> tuple[float, float] | None:
        """Log height of the camera above the ground on which walls stand, and the log-odds of all feet that say so.

        The unit is that of the solution's depths; None where no wall shows its foot.
        """
        number = self.setting.bodies.count
        of_feet = (self.ties.bodies == number).any(axis=1) & ~np.asarray(self.ties.yields)
        says_so = self.placement.counted & of_feet
        if not says_so.any():
            return None
        return float(self.places.scale_with_ground[number]), float(self.ties.weight[says_so].sum())

    def height_of_ceiling(self, scale: float) -> float | None:
        """Height of a ceiling above the camera, `scale` times that of the solution's depths; None if no wall tells."""
        ground = None if self.ground is None else self.ground[0]
        found = log_height_of_ceiling(self.setting, self.places.log_scale, ground)
        return None if found is None else scale * float(np.exp(found))


def place_lines(
    graph: LineGraph,
    sight: Sight,
    options: SolveOptions,
    on_progress: OnProgress = None,
    on_stage: StageReport = silent,
) -> Placed:
    """The lines of a graph from a photo, with every body at its most likely scale.

    Keeps to the crossings that `options` call real or fake. Raises SolverError, ContradictionError, or DepthMapError
    where nothing tells what the photo's depth map measures.
    """
    return place_on(find_evidence(graph, sight, options, (), on_stage), graph, options, (), on_progress, on_stage)


def place_on(
    evidence: Evidence,
    graph: LineGraph,
    options: SolveOptions,
    facts: Sequence[ToldFact] = (),
    on_progress: OnProgress = None,
    on_stage: StageReport = silent,
) -> Placed:
    """The lines of a graph with every body where the evidence of its photo and facts about its nodes put it.

    Raises SolverError, or ContradictionError where facts and crossings called real cannot all hold.
    """
    began = time.monotonic()
    found = place_bodies(evidence, options, facts, on_progress, on_stage)
    placement = found.placement
    log_depth = _kept_to(graph, found.log_depth, evidence.real)
    connected = found.connected_at(graph, log_depth)
    solution = Solution(
        status=placement.status,
        solver=placement.solver,
        formulation="bodies",
        objective=placement.objective,
        bound=placement.bound,
        gap=placement.gap,
        seconds=time.monotonic() - began,
        nodes=placement.nodes,
        connected=connected,
        is_boundary=boundaries(graph, connected),
        planar_pairs=np.zeros((0, 3), np.int64),
        log_depth=log_depth,
    )
    depth = evidence.setting.sight.depth
    told = None if depth is None else report_of(depth, evidence.heard, found.mapped)
    probability = found.probability_at(log_depth, connected)
    return Placed(solution, replace(found, known=probability), probability, found.by_map, told)


def place_bodies(
    evidence: Evidence,
    options: SolveOptions,
    facts: Sequence[ToldFact] = (),
    on_progress: OnProgress = None,
    on_stage: StageReport = silent,
    near: Float | None = None,
) -> BodyPlaces:
    """The bodies where the evidence of a photo and facts about the nodes of its graph put them.

    The search begins at the log scales `near` (B,) of bodies, ground and map, if they are known. Raises SolverError, or
    ContradictionError where facts and crossings called real cannot all hold.
    """
    setting, heard, reference = evidence.setting, evidence.heard, evidence.reference
    size, told = setting.bodies.size, ties_of_facts(setting, facts)
    ties, sources = tie_up(evidence, facts, told)
    if isinstance(heard, DepthWitness):
        ties = ties.joined(ties_to_map(heard, size))
    on_stage(f"placing {setting.bodies.count} bodies by {len(ties)} ties")
    # The ground is one more body, and the map another where it ties any.
    count = max(setting.bodies.count + 1, int(ties.bodies.max(initial=-1)) + 1)
    placement = place(ties, count, reference, options, on_progress, near)
    mapped = None
    if isinstance(heard, DepthWitness):
        mapped = follow_map(heard, ties, placement, reference, size)
    sources += [None] * (len(ties) - len(sources))
    return BodyPlaces(evidence, tuple(facts), told, tuple(sources), ties, placement, mapped)


def tie_up(evidence: Evidence, facts: Sequence[ToldFact], told: FactTies) -> tuple[Ties, list[Candidate | int | None]]:
    """The ties of bodies, all but those of a depth map, and what each is of (`BodyPlaces.sources`).

    ContradictionError where facts and crossings called real cannot all hold.
    """
    setting = evidence.setting
    sure, edges = _sure(setting, evidence.real)
    told.check(facts, sure, setting.graph.edges[edges])
    kept = kept_candidates(evidence, told.cuts)
    between, of_pieces = ties_between_bodies(evidence.pieces, setting.bodies.count)
    stands = [number for number, each in enumerate(of_pieces) if not _is_cut(each, told.cuts)]
    found, candidates = mean_of_looks(
        (weigh_candidates(kept, setting.bodies.size), worth_a_tie(kept)),
        (between.subset(np.array(stands, np.int64)), [of_pieces[number] for number in stands]),
    )
    found = with_feet_once(found, candidates)
    return found.joined(sure).joined(told.ties), [*candidates, *edges.tolist(), *(-1 - told.number).tolist()]


def kept_candidates(evidence: Evidence, cuts: frozenset[tuple[int, int]]) -> list[Candidate]:
    """The candidates that a person lets stand who says that some pairs of bodies are not connected."""
    return [each for each in evidence.candidates if not _is_cut(each, cuts)]


def _is_cut(candidate: Candidate, cuts: frozenset[tuple[int, int]]) -> bool:
    return candidate.kind in CONNECTING and candidate.bodies in cuts


def _sure(setting: Setting, real: Bool) -> tuple[Ties, Int]:
    """A tie for each crossing of two bodies that a person called real, which outweighs all found ones; their edges."""
    graph, body = setting.graph, setting.bodies.body
    first, second = graph.edges.T
    sure = np.flatnonzero(real & graph.informative & (body[first] >= 0) & (body[second] >= 0))
    sure = sure[body[first[sure]] != body[second[sure]]]
    i, j = graph.edges[sure].T
    asked = graph.log_ratio[sure] - setting.log_depth[i] + setting.log_depth[j]
    ties = Ties(
        np.column_stack([body[i], body[j]]),
        asked,
        graph.tolerance[sure],
        np.full(len(sure), CERTAIN),
        np.full(len(sure), -1),
    )
    return ties, sure


def _across(bodies: Int, cuts: frozenset[tuple[int, int]]) -> Bool:
    """Mask (E,) of pairs of bodies (E, 2) that are cut from each other."""
    ordered = np.sort(bodies, axis=1).tolist()
    return np.array([tuple(pair) in cuts for pair in ordered], bool) if cuts else np.zeros(len(bodies), bool)


def _kept_to(graph: LineGraph, log_depth: Float, real: Bool) -> Float:
    """Log depths (N,) moved as far as the crossings ask that a person called real."""
    if not real.any():
        return log_depth
    ratios = end_ratios(graph)
    to_middle = np.log(ratios.min(axis=1))
    near = log_depth + to_middle
    lowest = near.min()
    fitted = fit_near_depths(graph, near_log_ratio(graph, ratios), real, np.inf, near - lowest).near
    moved: Float = fitted + lowest - to_middle
    return moved
