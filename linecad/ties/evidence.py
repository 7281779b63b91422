"""All that a photo tells of the places of its bodies, found once: what a person says of bodies needs no second look."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.corrections.corrected import ToldFact
from linecad.corrections.edits import Cut
from linecad.decide.stability import LEAST_TOLERANCE, Fits, resample
from linecad.line_graph import LineGraph
from linecad.progress import StageReport, silent
from linecad.ties.bodies import RigidBodies, agreeing, find_rigid_bodies, with_hanging
from linecad.ties.candidates import Candidate, find_candidates
from linecad.ties.depth_parts import MapPart, hear_lines, heard_again
from linecad.ties.depth_ties import DepthWitness, hear
from linecad.ties.facts import CERTAIN
from linecad.ties.looks import Looks
from linecad.ties.pieces import Pieces, find_pieces
from linecad.ties.seams import Seam
from linecad.ties.setting import Setting, Sight
from linecad.ties.two_grounds import Parted, part_by_feet
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
    parts: tuple[MapPart, ...] = ()  # each of one of these bodies, from which it is still to be parted off

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
    parts: Sequence[MapPart] = (),
    new: Sequence[int] = (),
) -> Evidence:
    """What a photo tells of the bodies of a graph's lines; of `facts` about its nodes only cuts matter here.

    Keeps to the crossings that `options` call real or fake. Who says so, or tells facts, sees `parts` of bodies as
    bodies, though here they are of those that they were decided on; of lines that are `new` since then, those are of a
    part that hang on it. Raises SolverError, ContradictionError, or DepthMapError where nothing tells what the photo's
    depth map measures.
    """
    real, fake = read_annotations(graph, options)
    if real.any():
        ratios = end_ratios(graph)
        check_annotations(graph, find_families(graph, frozenset(FAMILIES)), options, real, ratios)
    on_stage("fitting depths, with and without some of the lines")
    looks, parted, setting, reference, of_parts = _setting(graph, sight, options, (real, fake), facts, parts, new)
    on_stage(f"finding what ties {setting.bodies.count} bodies")
    candidates = parted.keep_apart(find_candidates(setting, looks), setting.bodies.body)
    seams = parted.seams_of(setting, looks)
    pieces = parted.keep_pieces_apart(find_pieces(setting, seams, looks))
    heard = hear(setting, candidates, sight.depth)
    found = Evidence(setting, tuple(candidates), tuple(seams), pieces, heard, real, fake, reference)
    if not parts or sight.depth is None:
        return found
    if isinstance(heard, str):  # and what a person says cannot be of parts that are none any more
        return find_evidence(graph, sight, options, facts, on_stage)
    asked = hear_lines(setting, sight.depth, heard.reading)
    return replace(found, parts=tuple(heard_again(part, lines, asked) for part, lines in of_parts))


def _setting(
    graph: LineGraph,
    sight: Sight,
    options: SolveOptions,
    called: tuple[Bool, Bool],
    facts: Sequence[ToldFact],
    parts: Sequence[MapPart],
    new: Sequence[int],
) -> tuple[Looks, Parted, Setting, int, list[tuple[MapPart, Int]]]:
    """Bodies of the lines as they were found; fitted again only where what a person said contradicts them inside.

    Looks at the photo; where feet part bodies; the setting with the bodies as they are; the one that others are placed
    relative to; and the lines that each part has in one of the bodies, or in one of those that a person made of it.
    `called` are the crossings (E,) that are called real, and fake.

    So a word about two bodies moves these, and what is far from them keeps its place.
    """
    real, fake = called
    log_depth = RobustFit(graph).depths()
    looks, parted = _look(graph, log_depth, fits := resample(graph, options.seed, FITS), sight, real)
    bodies = parted.bodies
    believed = replace(graph, informative=graph.informative & ~fake)
    known = _with_new(parts, new, bodies, believed, log_depth)
    if _contradicts(graph, log_depth, _parted(bodies, known), real, fake):
        believed = replace(believed, weight=np.where(real, CERTAIN, graph.weight))
        log_depth = RobustFit(believed).depths()
        looks, parted = _look(believed, log_depth, fits := resample(believed, options.seed, FITS), sight, real)
        bodies = parted.bodies
        known = _with_new(parts, new, bodies, believed, log_depth)
    told = cut_bodies(_parted(bodies, known), believed, log_depth, facts)
    of_parts = [(part, lines) for part in known for lines in _by_body(part, told.body)]
    cut = _together(told, bodies, known)
    return looks, parted, Setting(believed, log_depth, cut, fits, sight), _reference(bodies, cut), of_parts


def _look(graph: LineGraph, log_depth: Float, fits: Fits, sight: Sight, real: Bool) -> tuple[Looks, Parted]:
    """Looks at the photo, and bodies of the lines that stand on one ground each, or are held by `real` crossings."""
    rigid = Setting(graph, log_depth, find_rigid_bodies(graph, log_depth, fits), fits, sight)
    looks = Looks(rigid)
    return looks, part_by_feet(rigid, looks, graph.edges[real])


def _parted(bodies: RigidBodies, parts: Sequence[MapPart]) -> RigidBodies:
    """The bodies where what parts have of each is a body of its own, unless it is all that is left of it."""
    body, count = bodies.body.copy(), bodies.count
    for part in parts:
        for lines in _by_body(part, body):
            if len(lines) < (body == body[lines[0]]).sum():
                body[lines] = count
                count += 1
    return RigidBodies(body, count)


def _by_body(part: MapPart, body: Int) -> list[Int]:
    """The lines of a part by the body (N,) that they are of."""
    own = body[part.lines]
    return [part.lines[own == number] for number in np.unique(own[own >= 0])]


def _with_new(
    parts: Sequence[MapPart], new: Sequence[int], bodies: RigidBodies, graph: LineGraph, log_depth: Float
) -> Sequence[MapPart]:
    """The parts with those new lines that crossings which agree tie to one more than to what is left of its body.

    What a person draws on a wall stands with it, also where the map has the wall.
    """
    if not parts or not len(new):
        return parts
    lines = np.array(new, np.int64)
    apart = _parted(bodies, parts).body
    own = bodies.body[graph.edges]
    inside = agreeing(graph, log_depth) & (own[:, 0] == own[:, 1]) & (own[:, 0] >= 0)
    loose = apart.copy()
    loose[lines] = -1
    hung = with_hanging(loose, graph.edges[inside], graph.weight[inside])[lines]
    return [part.joined(lines[np.isin(hung, apart[part.lines]) & (hung >= 0)]) for part in parts]


def _together(told: RigidBodies, bodies: RigidBodies, parts: Sequence[MapPart]) -> RigidBodies:
    """The bodies that a person made of bodies and parts, with the parts in what keeps the number of their body.

    What ties a body was found with all lines that seem of it.
    """
    if not parts:
        return told
    lines, body = np.concatenate([part.lines for part in parts]), told.body.copy()
    body[lines] = bodies.body[lines]
    number, own = np.unique(body[body >= 0], return_inverse=True)
    body[body >= 0] = own
    return RigidBodies(body, len(number))


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
    agrees = agreeing(graph, log_depth)
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
