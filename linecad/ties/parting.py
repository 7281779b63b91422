"""Evidence in which parts of bodies that a depth map has elsewhere are bodies of their own, which it places.

Who is right about a part, its body or the map, is decided once, at the places that crossings and the map give to a
photo of which nobody has said anything (`linecad.ties.depth_parts`). From then on a part is a body as any other, on the
page too: what a person says is of it, and moves it, and a crossing called real ties it to its body again.
"""

from dataclasses import dataclass, replace

import numpy as np

from linecad.arrays import Int
from linecad.line_graph import Segments
from linecad.progress import StageReport, silent
from linecad.ties.bodies import RigidBodies
from linecad.ties.depth_parts import WIDEST, MapPart, find_parts, hear_lines
from linecad.ties.depth_ties import DepthWitness
from linecad.ties.evidence import Evidence
from linecad.ties.pieces import Pieces
from linecad.ties.placing import place_bodies
from linecad.ties.sides import moved_up
from solver.options import SolveOptions

NODES = 100  # of the search that tells where bodies stand before any is parted


@dataclass(frozen=True, eq=False)
class DecidedParts:
    """The parts of a photo as it is: what a person says later makes none of them and takes none away."""

    segments: Segments  # of the graph that they were decided on
    parts: tuple[MapPart, ...]  # by its nodes

    def now(self, as_found: Segments) -> tuple[tuple[MapPart, ...], Int]:
        """The same by the lines (N,) of a graph that were found as such segments, and the lines that are new there.

        Lines that are gone are left out.
        """
        row, found = self.segments.rows(as_found), []
        for part in self.parts:
            lines = np.flatnonzero(np.isin(row, part.lines))
            if len(lines):
                heard = part.heard[np.searchsorted(part.lines, row[lines])]
                found.append(MapPart(lines, heard, part.asked))
        return tuple(found), np.flatnonzero(row < 0)


def decide_parts(evidence: Evidence, options: SolveOptions, on_stage: StageReport = silent) -> DecidedParts:
    """The parts that a map has elsewhere, and likelier rightly; of a photo of which a person has said nothing.

    Raises SolverError.
    """
    heard, setting = evidence.heard, evidence.setting
    segments = setting.graph.segments
    if not isinstance(heard, DepthWitness) or heard.width_of_parts >= WIDEST:
        return DecidedParts(segments, ())
    # Bounded by nodes and by no clock: which parts there are must not depend on how fast a machine is.
    soon = replace(options.within_nodes(NODES), time_limit_s=None)
    places, depth = place_bodies(evidence, soon, on_stage=on_stage), setting.sight.depth
    while places.placement.status == "interrupted":  # who stops a solve stops no decision that others build on
        places = place_bodies(evidence, soon, on_stage=on_stage)
    assert places.mapped is not None
    assert depth is not None
    asked = hear_lines(setting, depth, heard.reading)
    parts = []
    for found in find_parts(setting, asked, places.mapped.log_scale, places.mapped.of_map, places.probability):
        if found.is_moved(heard.width_of_parts):
            lines = np.union1d(found.lines, found.also)
            part = MapPart(lines, asked[lines], found.asked)
            parted = _parted(evidence, part)
            if _anchors(parted).any():
                evidence = parted
                parts.append(part)
    return DecidedParts(segments, tuple(parts))


def part_by_map(evidence: Evidence) -> Evidence:
    """The evidence with its parts as bodies that the map alone ties, but for such as leave nothing to lay it on."""
    if not isinstance(evidence.heard, DepthWitness):
        return evidence
    found = replace(evidence, parts=())
    for part in evidence.parts:
        parted = _parted(found, part)
        found = parted if _anchors(parted).any() else found
    return _with_reference(found, int(evidence.setting.bodies.size[evidence.reference]))


def _anchors(evidence: Evidence) -> Int:
    """(B,) lines of the bodies that lay the map on the scene: it tells of them, and not it alone places them."""
    heard, size = evidence.heard, evidence.setting.bodies.size
    assert isinstance(heard, DepthWitness)
    is_part = np.isin(np.arange(len(size)), list(heard.parts))
    return np.where(is_part | ~np.isfinite(heard.words.log_scale), 0, size)


def _with_reference(evidence: Evidence, size: int) -> Evidence:
    """The evidence with the largest body that lays the map as reference, where most lines of the one before are gone.

    That had so many lines.
    """
    left = _anchors(evidence)
    return evidence if 2 * left[evidence.reference] >= size else replace(evidence, reference=int(left.argmax()))


def _parted(evidence: Evidence, part: MapPart) -> Evidence:
    """The evidence with a part of one body as a body that only the map ties, where that has it.

    It comes last, and all that ties the body ties the rest of it, unless it is the whole body.
    """
    setting, heard, lines = evidence.setting, evidence.heard, part.lines
    assert isinstance(heard, DepthWitness)
    own, new = int(setting.bodies.body[lines[0]]), setting.bodies.count
    if len(lines) == setting.bodies.size[own]:
        return replace(
            evidence,
            candidates=tuple(each for each in evidence.candidates if own not in each.bodies),
            pieces=_without(evidence.pieces, lines, own),
            heard=heard.placing(own, part.asked),
        )
    body = setting.bodies.body.copy()
    body[lines] = new
    return replace(
        evidence,
        setting=replace(setting, bodies=RigidBodies(body, new + 1)),
        candidates=tuple(moved_up(each, new) for each in evidence.candidates),
        pieces=_without(evidence.pieces, lines, new),
        heard=heard.with_part_of(own).placing(new, part.asked),
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
