"""Evidence in which parts of bodies that a depth map has elsewhere are bodies of their own, which it places.

Who is right about a part, its body or the map, is decided once, at the places that all evidence gives
(`linecad.ties.depth_parts`); from then on a part is a body as any other, on the page too.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from linecad.arrays import Int
from linecad.corrections.corrected import ToldFact
from linecad.line_graph import LineGraph
from linecad.progress import StageReport, silent
from linecad.ties.bodies import RigidBodies
from linecad.ties.depth_parts import find_parts
from linecad.ties.depth_ties import DepthWitness
from linecad.ties.evidence import Evidence, find_evidence
from linecad.ties.pieces import Pieces
from linecad.ties.placing import place_bodies
from linecad.ties.setting import Sight
from linecad.ties.sides import moved_up
from solver.options import SolveOptions


def find_parted_evidence(
    graph: LineGraph,
    sight: Sight,
    options: SolveOptions,
    facts: Sequence[ToldFact] = (),
    on_stage: StageReport = silent,
) -> Evidence:
    """As `find_evidence`, with parts of bodies that a depth map places; what `facts` tell of is not parted."""
    return part_by_map(find_evidence(graph, sight, options, facts, on_stage), options, facts)


def part_by_map(evidence: Evidence, options: SolveOptions, facts: Sequence[ToldFact] = ()) -> Evidence:
    """The evidence with parts that a map has elsewhere, and likelier rightly, as bodies that it alone ties."""
    heard, setting = evidence.heard, evidence.setting
    if not isinstance(heard, DepthWitness):
        return evidence
    places = place_bodies(evidence, options, facts)
    assert places.mapped is not None
    held = np.zeros(setting.bodies.count, bool)
    own = setting.bodies.body[[line for fact in facts for line in fact.lines]] if facts else np.zeros(0, np.int64)
    held[own[own >= 0]] = True
    words, of_map = heard.lines, places.mapped.of_map
    parts = find_parts(setting, words, places.mapped.log_scale, of_map, places.probability, held)
    for part in parts:
        lines = np.union1d(part.lines, part.also)
        if part.is_moved(words.width) and _may_go(lines, evidence):
            evidence = _parted(evidence, lines, part.asked)
    return _with_reference(evidence)


def _may_go(lines: Int, evidence: Evidence) -> bool:
    """Whether no crossing that a person called real holds lines to their body."""
    body, edges = evidence.setting.bodies.body, evidence.setting.graph.edges[evidence.real]
    own = int(body[lines[0]])
    inside = np.isin(edges, lines)
    return not ((inside[:, 0] != inside[:, 1]) & (body[edges] == own).all(axis=1)).any()


def _with_reference(evidence: Evidence) -> Evidence:
    """The evidence, the largest body that not the map alone ties its reference, where the reference lost its lines."""
    heard, size = evidence.heard, evidence.setting.bodies.size
    assert isinstance(heard, DepthWitness)
    free = np.where(np.isin(np.arange(len(size)), list(heard.parts)), 0, size)
    return replace(evidence, reference=int(free.argmax())) if heard.parts and free.any() else evidence


def _parted(evidence: Evidence, lines: Int, asked: float) -> Evidence:
    """The evidence with lines of one body as a body that only the map ties, which asks it to grow by that log.

    It comes last, and all that ties the body ties the rest of it, unless it is the whole body.
    """
    setting, heard = evidence.setting, evidence.heard
    assert isinstance(heard, DepthWitness)
    own, new = int(setting.bodies.body[lines[0]]), setting.bodies.count
    if len(lines) == setting.bodies.size[own]:
        return replace(
            evidence,
            candidates=tuple(each for each in evidence.candidates if own not in each.bodies),
            pieces=_without(evidence.pieces, lines, own),
            heard=heard.placing(own, asked),
        )
    body = setting.bodies.body.copy()
    body[lines] = new
    return replace(
        evidence,
        setting=replace(setting, bodies=RigidBodies(body, new + 1)),
        candidates=tuple(moved_up(each, new) for each in evidence.candidates),
        pieces=_without(evidence.pieces, lines, new),
        heard=heard.with_part_of(own).placing(new, asked),
    )


def _without(pieces: Pieces, lines: Int, body: int) -> Pieces:
    """The pieces where lines are of a body of their own, and nothing ties those that are all of such lines."""
    inside = np.bincount(pieces.piece[lines], minlength=pieces.count)
    whole = inside == pieces.size
    of_piece, piece = np.where(whole, body, pieces.body), pieces.piece.copy()
    candidates = [each for each in pieces.candidates if not np.append(whole, False)[list(each.bodies)].any()]
    others = lines[~whole[piece[lines]]]
    if len(others):
        piece[others] = pieces.count
        of_piece = np.append(of_piece, body)
        candidates = [moved_up(each, pieces.count) for each in candidates]
    return Pieces(piece, of_piece, candidates)
