"""The stage that puts every body where it most likely is: fit, rigid bodies, evidence, scene program."""

import time
from dataclasses import dataclass, replace

import numpy as np

from linecad.arrays import Bool, Float
from linecad.decide.stability import resample
from linecad.geometry import lengths
from linecad.line_graph import LineGraph, Solution
from linecad.progress import StageReport, silent
from linecad.scene import DepthMapReport
from linecad.ties.bodies import find_rigid_bodies
from linecad.ties.candidates import Candidate, find_candidates
from linecad.ties.depth_ties import DepthWitness, MapPlaces, follow_map, hear, report_of, ties_to_map
from linecad.ties.links import find_links
from linecad.ties.pieces import find_pieces, with_stays
from linecad.ties.probability import chances, main_lines, probabilities
from linecad.ties.seams import find_seams
from linecad.ties.setting import Setting, Sight
from linecad.ties.weights import weigh_candidates
from solver.annotations import check_annotations, read_annotations
from solver.bodies.search import place
from solver.bodies.ties import Placement, Ties
from solver.choice import boundaries
from solver.depths import end_ratios, near_log_ratio
from solver.families import find_families
from solver.options import FAMILIES, OnProgress, SolveOptions
from solver.potentials import fit_near_depths
from solver.robust import RobustFit, agreeing_with

FITS = 21  # without some lines; each line is left out of seven
CERTAIN = 1e6  # weight of what a person called real


@dataclass(frozen=True, eq=False)
class Placed:
    """Lines in their places."""

    solution: Solution  # the crossings that agree there
    setting: Setting
    ties: Ties
    placement: Placement
    reference: int  # the body that the others are placed relative to
    probability: Float  # (N,) that a line's depth relative to component 0 is right within 5 %
    by_map: Bool  # (N,) lines of bodies that a depth map alone ties to the reference
    depth_map: DepthMapReport | None  # its scale is that of the solution's depths; None where no map was given

    @property
    def ground(self) -> tuple[float, float] | None:
        """Log height of the camera above the ground on which walls stand, and the log-odds of all that says so.

        The unit is that of the solution's depths; None where no wall shows its foot.
        """
        number = self.setting.bodies.count
        says_so = self.placement.counted & (self.ties.bodies == number).any(axis=1)
        if not says_so.any():
            return None
        return float(self.placement.log_scale[number]), float(self.ties.weight[says_so].sum())


@dataclass(frozen=True, eq=False)
class BodyPlaces:
    """Bodies in their places."""

    ties: Ties
    placement: Placement
    reference: int  # the body that the others are placed relative to
    log_scale: Float  # (B + 1,) of bodies there and, last, of the ground
    log_depth: Float  # (N,) of all lines there
    heard: DepthWitness | str  # the depth map, or why it was left out
    mapped: MapPlaces | None  # what it made of the places, where it was heard


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
    began = time.monotonic()
    ratios = end_ratios(graph)
    real, fake = read_annotations(graph, options)
    if real.any():
        check_annotations(graph, find_families(graph, frozenset(FAMILIES)), options, real, ratios)
    on_stage("fitting depths, with and without some of the lines")
    setting = _setting(graph, sight, options, real, fake)
    on_stage(f"finding what ties {setting.bodies.count} bodies")
    found = place_bodies(setting, find_candidates(setting), real, options, on_progress, on_stage)
    placement, body = found.placement, setting.bodies.body
    log_depth = _kept_to(graph, found.log_depth, real, ratios)
    connected = (agreeing_with(graph, log_depth) & ~fake) | real
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
    mapped = found.mapped
    probability = _how_sure(setting, found, log_depth, connected)
    by_map = np.zeros(len(body), bool) if mapped is None else (body >= 0) & mapped.by_map[np.maximum(body, 0)]
    told = None if sight.depth is None else report_of(sight.depth, found.heard, mapped)
    return Placed(solution, setting, found.ties, placement, found.reference, probability, by_map, told)


def place_bodies(
    setting: Setting,
    candidates: list[Candidate],
    real: Bool,
    options: SolveOptions,
    on_progress: OnProgress = None,
    on_stage: StageReport = silent,
) -> BodyPlaces:
    """The bodies where candidates, crossings that a person called `real` (E,) and the sight's depth map put them."""
    size = setting.bodies.size
    ties = _with_sure(weigh_candidates(candidates, size), setting, real)
    heard = hear(setting, candidates, setting.sight.depth)
    if isinstance(heard, DepthWitness):
        ties = ties.joined(ties_to_map(heard, size))
    reference = int(size.argmax()) if setting.bodies.count else 0
    on_stage(f"placing {setting.bodies.count} bodies by {len(ties)} ties")
    # The ground is one more body, and the map another where it ties any.
    count = max(setting.bodies.count + 1, int(ties.bodies.max(initial=-1)) + 1)
    placement = place(ties, count, reference, options, on_progress)
    log_scale, mapped = placement.log_scale, None
    if isinstance(heard, DepthWitness):
        mapped = follow_map(heard, ties, placement, reference, size)
        log_scale = mapped.log_scale
    body = setting.bodies.body
    log_depth = setting.log_depth + np.where(body >= 0, log_scale[np.maximum(body, 0)], 0.0)
    at = np.append(log_scale[: setting.bodies.count], placement.log_scale[setting.bodies.count])
    return BodyPlaces(ties, placement, reference, at, log_depth, heard, mapped)


def _how_sure(setting: Setting, places: BodyPlaces, log_depth: Float, connected: Bool) -> Float:
    """(N,) that the depth of a line is right, where these crossings are `connected` (E,)."""
    seams = find_seams(setting)
    pieces = find_pieces(setting, seams)
    seams = with_stays(seams, pieces, places.log_scale)
    links = find_links(pieces, places.log_scale, places.placement.margin, places.reference, places.mapped)
    length = lengths(np.diff(setting.graph.segments.ends, axis=1)[:, 0]) * main_lines(setting, connected)
    return probabilities(setting, log_depth, pieces, chances(pieces, seams, links, length))


def _setting(graph: LineGraph, sight: Sight, options: SolveOptions, real: Bool, fake: Bool) -> Setting:
    believed = replace(
        graph, weight=np.where(real, CERTAIN, graph.weight), informative=graph.informative & ~fake
    )  # fmt: skip
    log_depth = RobustFit(believed).depths()
    fits = resample(believed, options.seed, FITS)
    bodies = find_rigid_bodies(believed, log_depth, fits)
    return Setting(believed, log_depth, bodies, fits, sight)


def _with_sure(ties: Ties, setting: Setting, real: Bool) -> Ties:
    """The ties, and one for each crossing of two bodies that a person called real, which outweighs all others."""
    graph, body = setting.graph, setting.bodies.body
    first, second = graph.edges.T
    sure = np.flatnonzero(real & graph.informative & (body[first] >= 0) & (body[second] >= 0))
    sure = sure[body[first[sure]] != body[second[sure]]]
    i, j = graph.edges[sure].T
    asked = graph.log_ratio[sure] - setting.log_depth[i] + setting.log_depth[j]
    return ties.joined(
        Ties(
            np.column_stack([body[i], body[j]]),
            asked,
            graph.tolerance[sure],
            np.full(len(sure), CERTAIN),
            np.full(len(sure), -1),
        )
    )


def _kept_to(graph: LineGraph, log_depth: Float, real: Bool, ratios: Float) -> Float:
    """Log depths (N,) moved as far as the crossings ask that a person called real."""
    if not real.any():
        return log_depth
    to_middle = np.log(ratios.min(axis=1))
    near = log_depth + to_middle
    lowest = near.min()
    fitted = fit_near_depths(graph, near_log_ratio(graph, ratios), real, np.inf, near - lowest).near
    moved: Float = fitted + lowest - to_middle
    return moved
