"""All that a photo tells of the places of its bodies, found once: what a person says of bodies needs no second look."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.corrections.corrected import ToldFact
from linecad.corrections.edits import Cut
from linecad.decide.stability import LEAST_TOLERANCE, resample
from linecad.line_graph import LineGraph
from linecad.progress import StageReport, silent
from linecad.ties.bodies import RigidBodies, find_rigid_bodies
from linecad.ties.candidates import Candidate, find_candidates
from linecad.ties.depth_ties import DepthWitness, hear
from linecad.ties.facts import CERTAIN
from linecad.ties.looks import Looks
from linecad.ties.pieces import Pieces, find_pieces
from linecad.ties.seams import Seam, find_seams
from linecad.ties.setting import Setting, Sight
from solver.annotations import check_annotations, read_annotations
from solver.depths import end_ratios
from solver.families import find_families
from solver.options import FAMILIES, SolveOptions
from solver.robust import RobustFit

FITS = 21  # without some lines; each line is left out of seven


@dataclass(frozen=True, eq=False)
class Evidence:
    """What a photo tells of the places of its bodies, before anything is placed."""

    setting: Setting
    candidates: tuple[Candidate, ...]
    seams: tuple[Seam, ...]  # where bodies are weak
    pieces: Pieces  # the bodies parted at all of these
    heard: DepthWitness | str  # the depth map, or why it was left out
    real: Bool  # (E,) crossings that a person called so
    fake: Bool  # (E,)
    reference: int  # the body that the others are placed relative to: the largest, or what is left of that

    def without_photo(self) -> "Evidence":
        """The same without pixels: small enough to hand on, and enough to place bodies."""
        sight = replace(self.setting.sight, pixels=None, depth=None)
        return replace(self, setting=replace(self.setting, sight=sight))


def find_evidence(
    graph: LineGraph,
    sight: Sight,
    options: SolveOptions,
    facts: Sequence[ToldFact] = (),
    on_stage: StageReport = silent,
) -> Evidence:
    """What a photo tells of the bodies of a graph's lines; of `facts` about its nodes only cuts matter here.

    Keeps to the crossings that `options` call real or fake. Raises SolverError, ContradictionError, or DepthMapError
    where nothing tells what the photo's depth map measures.
    """
    real, fake = read_annotations(graph, options)
    if real.any():
        ratios = end_ratios(graph)
        check_annotations(graph, find_families(graph, frozenset(FAMILIES)), options, real, ratios)
    on_stage("fitting depths, with and without some of the lines")
    setting, reference = _setting(graph, sight, options, real, fake, facts)
    on_stage(f"finding what ties {setting.bodies.count} bodies")
    looks = Looks(setting)
    candidates = find_candidates(setting, looks)
    seams = find_seams(setting, looks)
    pieces = find_pieces(setting, seams, looks)
    heard = hear(setting, candidates, sight.depth)
    return Evidence(setting, tuple(candidates), tuple(seams), pieces, heard, real, fake, reference)


def _setting(
    graph: LineGraph, sight: Sight, options: SolveOptions, real: Bool, fake: Bool, facts: Sequence[ToldFact]
) -> tuple[Setting, int]:
    """Bodies of the lines as they were found; fitted again only where what a person said contradicts them inside.

    And the one that others are placed relative to.

    So a word about two bodies moves these, and what is far from them keeps its place.
    """
    log_depth = RobustFit(graph).depths()
    bodies = find_rigid_bodies(graph, log_depth, fits := resample(graph, options.seed, FITS))
    believed = replace(graph, informative=graph.informative & ~fake)
    if _contradicts(graph, log_depth, bodies, real, fake):
        believed = replace(believed, weight=np.where(real, CERTAIN, graph.weight))
        log_depth = RobustFit(believed).depths()
        bodies = find_rigid_bodies(believed, log_depth, fits := resample(believed, options.seed, FITS))
    cut = cut_bodies(bodies, believed, log_depth, facts)
    return Setting(believed, log_depth, cut, fits, sight), _reference(bodies, cut)


def _reference(bodies: RigidBodies, cut: RigidBodies) -> int:
    """The largest piece of the largest body: what a person says of a part of it does not move all others."""
    if not bodies.count:
        return 0
    largest = bodies.body == int(bodies.size.argmax())
    return int(np.bincount(cut.body[largest], minlength=cut.count).argmax())


def _contradicts(graph: LineGraph, log_depth: Float, bodies: RigidBodies, real: Bool, fake: Bool) -> bool:
    """Whether a crossing is called real whose lines do not meet in one body, or in none, or fake where they do."""
    own = bodies.body[graph.edges]
    apart = (own[:, 0] != own[:, 1]) & (own >= 0).all(axis=1)
    meets = graph.misfit(log_depth) <= np.maximum(graph.tolerance, LEAST_TOLERANCE)
    return bool((~apart & ((real & ~meets) | (fake & meets & graph.informative))).any())


def cut_bodies(bodies: RigidBodies, graph: LineGraph, log_depth: Float, facts: Sequence[ToldFact]) -> RigidBodies:
    """The bodies with those parted that hold both lines of a cut, where the least weight of crossings joins the two.

    Of crossings that agree at log depths (N,). The side of the second line becomes a body of its own. So does a part
    that was placed by itself: of its lines those that are of one body with the line that it was placed by.
    """
    body, count = bodies.body.copy(), bodies.count
    agrees = graph.informative & (graph.misfit(log_depth) <= np.maximum(graph.tolerance, LEAST_TOLERANCE))
    for told in facts:
        if told.part:
            own = part_of_body(body, told)
            if len(own):
                body[own] = count
                count += 1
        if not isinstance(told.fact, Cut):
            continue
        first, second = told.lines
        if body[first] < 0 or body[first] != body[second]:
            continue
        inside = agrees & (body[graph.edges] == body[first]).all(axis=1)
        body[_side_of(second, first, graph.edges[inside], graph.weight[inside])] = count
        count += 1
    return RigidBodies(body, count)


def part_of_body(body: Int, told: ToldFact) -> Int:
    """The lines of a part that was placed by itself, by the body (N,) of each; none where it is a whole body."""
    return side_of(body, told.lines[0], told.part)


def side_of(body: Int, line: int, lines: Sequence[int]) -> Int:
    """Of some lines those that are of one body with a line; none where that is all of the body, or there is none."""
    part, placed = np.array(lines, np.int64), body[line]
    own = np.unique(part[body[part] == placed])
    return own if placed >= 0 and len(own) < (body == placed).sum() else own[:0]


def _side_of(line: int, other: int, edges: Int, weight: Float) -> Int:
    """The lines on the side of one line when the least weight of edges (E, 2) that part it from another one is cut."""
    import networkx as nx

    flow = nx.Graph()
    flow.add_nodes_from([line, other])
    for (first, second), each in zip(edges.tolist(), weight.tolist(), strict=True):
        before = flow.get_edge_data(first, second, {"capacity": 0.0})["capacity"]
        flow.add_edge(first, second, capacity=before + each)
    _, (_, side) = nx.minimum_cut(flow, other, line)
    return np.array(sorted(side), np.int64)
