"""Parts: what a person may take out of a body and place by itself, and the evidence where one stands alone at once.

A body that is two things is weak between them, so its parts are the sides of its seams (`linecad.ties.seams`). What
ties a part to other bodies is known already: what was found between the pieces that it has (`linecad.ties.pieces`).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from linecad.arrays import Float, Int
from linecad.ties.bodies import RigidBodies
from linecad.ties.candidates import SAME_RATIO, Candidate
from linecad.ties.depth_ties import DepthWitness
from linecad.ties.evidence import Evidence
from linecad.ties.pieces import Pieces, as_of_bodies, distinct
from linecad.ties.seams import Seam
from linecad.ties.weights import above_chance


@dataclass(frozen=True, eq=False)
class Part:
    """One side of a seam."""

    lines: Int
    probability: float  # that it stands to the rest of its body as it does there


def parts_of(evidence: Evidence, seams: Sequence[Seam], body: int) -> list[Part]:
    """The parts of a body, the most doubtful first; of the reference none with most of its lines, for it stays.

    `seams` are those of the evidence with all that tells of them (`BodyPlaces.seams`).
    """
    setting = evidence.setting
    size, found = int(setting.bodies.size[body]), dict[bytes, Part]()
    for seam in seams:
        for lines in (seam.smaller, seam.larger):
            own = np.sort(lines)
            is_part = (setting.bodies.body[own] == body).all() and len(own) < size
            if not is_part or (body == evidence.reference and 2 * len(own) > size):
                continue
            found.setdefault(own.tobytes(), Part(own, seam.probability))
    return sorted(found.values(), key=lambda part: (part.probability, -len(part.lines), int(part.lines[0])))


def part_off(evidence: Evidence, lines: Int) -> Evidence:
    """The same where lines of one body are a body of their own, which comes last; others keep their numbers.

    Seams are as before, and the larger side of what was the reference is that again. Of what is found anew in the photo
    for such a body, nothing is known here: a scene is not built of this.
    """
    setting, pieces = evidence.setting, evidence.pieces
    own, new = int(setting.bodies.body[lines[0]]), setting.bodies.count
    body = setting.bodies.body.copy()
    body[lines] = new
    of_piece = pieces.body.copy()
    inside = np.bincount(pieces.piece[lines], minlength=pieces.count)
    of_piece[2 * inside > pieces.size] = new
    parted = replace(setting, bodies=RigidBodies(body, new + 1))
    kept = [
        moved_up(each, new)
        for each in evidence.candidates
        if own not in each.bodies or not _is_of_part(each, pieces, of_piece, new)
    ]
    moved = replace(pieces, body=of_piece)
    between = _between(moved, new)
    heard = evidence.heard
    if isinstance(heard, DepthWitness):
        heard = heard.with_part_of(own)
    is_most = own == evidence.reference and 2 * len(lines) > int(setting.bodies.size[own])
    return replace(
        evidence,
        setting=parted,
        candidates=(*kept, *between),
        pieces=moved,
        heard=heard,
        reference=new if is_most else evidence.reference,
    )


def moved_up(candidate: Candidate, ground: int) -> Candidate:
    """The candidate where the ground has the next number."""
    first, second = candidate.bodies
    return replace(candidate, bodies=(first, second + 1)) if second == ground else candidate


def _is_of_part(candidate: Candidate, pieces: Pieces, of_piece: Int, part: int) -> bool:
    """Whether a candidate of a body is, as far as pieces tell, one of a part of it: the rest keeps all others.

    By the most telling one between pieces of the same two bodies that asks for the same.
    """
    ground, body = pieces.count, pieces.body_with_ground(part)  # among the bodies before
    best, weight = ground, -np.inf
    for each in pieces.candidates:
        told = as_of_bodies(each, body)
        if told is None or told.bodies != candidate.bodies or abs(told.log_ratio - candidate.log_ratio) >= SAME_RATIO:
            continue
        if (found := above_chance(each)) > weight:
            weight = found
            best = next((piece for piece in each.bodies if piece < ground and of_piece[piece] == part), ground)
    return best < ground


def _between(pieces: Pieces, part: int) -> list[Candidate]:
    """The candidates of a part, as found between pieces; the best of those that ask for one ratio."""
    body = pieces.body_with_ground(part + 1)
    best_first = sorted(pieces.candidates, key=lambda each: -above_chance(each))
    told = [each for candidate in best_first if (each := as_of_bodies(candidate, body)) and part in each.bodies]
    return sorted((told[number] for number in distinct(told)), key=lambda each: each.bodies)


def extended(log_scale: Float, before: RigidBodies, evidence: Evidence) -> Float:
    """Log scales of bodies, ground and map as they were `before`, for bodies that were parted since, or not any more.

    What is one body again stands where that stood which was left of it.
    """
    left = [int(before.body[lines].min()) for lines in evidence.setting.lines]
    return np.concatenate([log_scale[left], log_scale[before.count :]])


def parted_off(evidence: Evidence, parts: Sequence[Int]) -> Evidence:
    """The same where each of some parts is a body of its own."""
    for lines in parts:
        if len(lines):
            evidence = part_off(evidence, lines)
    return evidence
