"""Pieces: the bodies of a photo, parted at all of their seams, and the evidence between these.

What other bodies and the ground say of either side of a seam, the body as a whole cannot hear. So every body is parted,
and candidates are looked for between the pieces. They are a second look at where the bodies stand; and the scene
program's local search may move the pieces: a seam whose sides it moves apart is doubtful. So is one whose sides stand
on two grounds by their feet.
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import expit

from linecad.arrays import Bool, Float, Int
from linecad.ties.bodies import RigidBodies
from linecad.ties.candidates import SAME_RATIO, Candidate, Features, find_candidates
from linecad.ties.looks import Looks
from linecad.ties.seams import Seam
from linecad.ties.setting import Setting
from linecad.ties.weights import log_odds_of, weigh_candidates, worth_a_tie
from solver.bodies.local_search import climb
from solver.bodies.ties import Ties

SAME_PLACE = 0.03  # log scale within which pieces are still where they stood to each other
SAME_GROUND, OTHER_GROUND = 0.03, 0.045  # log ratio below which two feet are on one ground, and from which on two


@dataclass(frozen=True, eq=False)
class Pieces:
    """The Q pieces of the bodies of N lines."""

    piece: Int  # (N,) -1 for lines of no body
    body: Int  # (Q,) that each is of
    candidates: list[Candidate]  # between pieces; the ground is piece Q

    @property
    def count(self) -> int:
        """Q."""
        return len(self.body)

    @property
    def size(self) -> Int:
        """(Q,) lines of each."""
        return np.bincount(self.piece[self.piece >= 0], minlength=self.count)

    def body_with_ground(self, bodies: int) -> Int:
        """(Q + 1,) the body of each, and last the number of the ground, which is that of bodies: some have no piece."""
        return np.append(self.body, bodies)

    def of(self, lines: Int) -> Int:
        """The pieces that some lines are in."""
        return np.unique(self.piece[lines])


def part_bodies(bodies: RigidBodies, seams: list[Seam]) -> tuple[Int, Int]:
    """The piece (N,) of each line, -1 for lines of no body, and the body (Q,) of each piece."""
    side = np.zeros((len(bodies.body), len(seams)), np.int64)
    for number, seam in enumerate(seams):
        side[seam.larger, number], side[seam.smaller, number] = 1, 2
    piece = np.full(len(bodies.body), -1)
    own = bodies.body >= 0
    sides, of_lines = np.unique(np.column_stack([bodies.body, side])[own], axis=0, return_inverse=True)
    piece[own] = of_lines.ravel()
    return piece, sides[:, 0]


def find_pieces(setting: Setting, seams: list[Seam], looks: Looks) -> Pieces:
    """The pieces of all bodies, and what ties them; `looks` are those at the photo."""
    piece, body = part_bodies(setting.bodies, seams)
    return Pieces(piece, body, find_candidates(replace(setting, bodies=RigidBodies(piece, len(body))), looks))


def as_of_bodies(candidate: Candidate, body: Int) -> Candidate | None:
    """A candidate of two pieces as one of their bodies (Q + 1,), the ground's last; None of pieces of one body."""
    first, second = (int(body[piece]) for piece in candidate.bodies)
    if first == second:
        return None
    if first < second:
        return replace(candidate, bodies=(first, second))
    return replace(candidate, bodies=(second, first), log_ratio=-candidate.log_ratio)


def distinct(candidates: Iterable[Candidate | None]) -> list[int]:
    """The places of those candidates that are the first of their two bodies to ask for their ratio.

    As in one look at bodies, only planes with other normals may repeat a ratio.
    """
    chosen: dict[tuple[int, int], list[tuple[int, Candidate]]] = {}
    for number, candidate in enumerate(candidates):
        if candidate is not None:
            of_pair = chosen.setdefault(candidate.bodies, [])
            if not any(_asks_for_the_same(candidate, other) for _, other in of_pair):
                of_pair.append((number, candidate))
    return sorted(number for of_pair in chosen.values() for number, _ in of_pair)


def _asks_for_the_same(one: Candidate, other: Candidate) -> bool:
    two_planes = one.kind == other.kind == "plane" and one.normal != other.normal
    return abs(one.log_ratio - other.log_ratio) < SAME_RATIO and not two_planes


def ties_between_bodies(pieces: Pieces, count: int) -> tuple[Ties, list[Candidate]]:
    """What ties pieces of different bodies, as ties of the `count` bodies, and the candidate that each is of.

    Where several pieces of two bodies ask for one ratio they see one thing, and the heaviest of their ties is it.
    """
    ties, body = weigh_candidates(pieces.candidates, pieces.size), pieces.body_with_ground(count)
    heaviest = np.argsort(-ties.weight, kind="stable")
    worth = worth_a_tie(pieces.candidates)
    told = [as_of_bodies(worth[number], body) for number in heaviest.tolist()]
    chosen = distinct(told)
    candidates = [candidate for number in chosen if (candidate := told[number]) is not None]
    own = ties.subset(heaviest[chosen])
    bodies = np.array([candidate.bodies for candidate in candidates], np.int64).reshape(-1, 2)
    return replace(own, bodies=bodies, log_ratio=np.array([each.log_ratio for each in candidates])), candidates


def with_pieces_heard(seams: list[Seam], pieces: Pieces, log_scale: Float) -> list[Seam]:
    """The seams with what their pieces say: whether both sides stay where they are, and stand on one ground.

    "stays" is the share of pairs of lines across a seam that the local search leaves as is; `log_scale` (B + 1,) are
    the places of the bodies and, last, of the ground, from which the search of pieces begins.
    """
    ties, feet = weigh_candidates(pieces.candidates, pieces.size), chances_of_feet(pieces)
    start = np.append(log_scale[pieces.body], log_scale[-1])
    moved = climb(ties, start)[0] - start if len(ties) else np.zeros(len(start))
    return [replace(seam, features=seam.features | _by_pieces(seam, pieces, moved, feet)) for seam in seams]


def _by_pieces(seam: Seam, pieces: Pieces, moved: Float, feet: Float) -> Features:
    larger, smaller = (feet[np.isin(feet[:, 0], pieces.of(side))] for side in (seam.larger, seam.smaller))
    return {"stays": _share_that_stays(seam, pieces, moved), "one ground": on_one_ground(larger, smaller, OTHER_GROUND)}


def _share_that_stays(seam: Seam, pieces: Pieces, moved: Float) -> float:
    larger, smaller = pieces.piece[seam.larger], pieces.piece[seam.smaller]
    same: Bool = np.abs(moved[larger][:, None] - moved[smaller]) < SAME_PLACE
    return float(same.mean())


def chances_of_feet(pieces: Pieces) -> Float:
    """(M, 3) of the feet of pieces: the piece, the log ratio to the ground, and how likely that is right."""
    feet = [each for each in pieces.candidates if each.kind == "ground"]
    return np.array([(foot.bodies[0], foot.log_ratio, expit(log_odds_of(foot))) for foot in feet]).reshape(-1, 3)


def on_one_ground(one: Float, other: Float, from_apart: float) -> float:
    """How clearly feet (M, 3) of both sides of a seam stand on one ground, from -1, on two, to 1.

    Those are on two that are `from_apart` of the log ratio apart, or more.
    By the clearest two of either kind. Squares, since on made scenes two feet of 0.6 tell nothing yet.
    """
    apart = np.abs(one[:, None, 1] - other[None, :, 1])
    both = (one[:, None, 2] * other[None, :, 2]) ** 2
    return float(both[apart < SAME_GROUND].max(initial=0.0) - both[apart >= from_apart].max(initial=0.0))
