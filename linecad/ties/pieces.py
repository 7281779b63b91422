"""Pieces: the bodies of a photo, parted at all of their seams, and the evidence between these.

What other bodies and the ground say of either side of a seam, the body as a whole cannot hear. So every body is parted,
candidates are looked for between the pieces, and the scene program's local search may move them: a seam whose sides it
moves apart is doubtful.
"""

from dataclasses import dataclass, replace

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.ties.bodies import RigidBodies
from linecad.ties.candidates import Candidate, find_candidates
from linecad.ties.looks import Looks
from linecad.ties.seams import Seam
from linecad.ties.setting import Setting
from linecad.ties.weights import weigh_candidates
from solver.bodies.local_search import climb

SAME_PLACE = 0.03  # log scale within which pieces are still where they stood to each other


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


def with_stays(seams: list[Seam], pieces: Pieces, log_scale: Float) -> list[Seam]:
    """The seams with one more feature: the share of pairs of lines across them that the local search leaves as is.

    `log_scale` (B + 1,) are the places of the bodies and, last, of the ground, from which the search of pieces begins.
    """
    ties = weigh_candidates(pieces.candidates, pieces.size)
    start = np.append(log_scale[pieces.body], log_scale[-1])
    moved = climb(ties, start)[0] - start if len(ties) else np.zeros(len(start))
    return [
        replace(seam, features={**seam.features, "stays": _share_that_stays(seam, pieces, moved)}) for seam in seams
    ]


def _share_that_stays(seam: Seam, pieces: Pieces, moved: Float) -> float:
    larger, smaller = pieces.piece[seam.larger], pieces.piece[seam.smaller]
    same: Bool = np.abs(moved[larger][:, None] - moved[smaller]) < SAME_PLACE
    return float(same.mean())
