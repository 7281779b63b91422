"""Bodies that stand on two grounds: two houses of a row, one set back, whose lines meet at the corner between them.

The courses of the farther house end at a corner of the nearer in a dozen crossings, all of which ask for one plane, and
no other crossing speaks against them. But where the feet of both are seen, that of the farther one stands higher in
the photo. So a body is parted at a seam where feet of its two sides are clearly apart, and what seems to join both
sides there, a bundle of crossings or a plane, ties them no more.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from linecad.arrays import Float, Int
from linecad.ties.bodies import RigidBodies, agreeing, with_hanging
from linecad.ties.candidates import CONNECTING, Candidate, find_ground
from linecad.ties.looks import Looks
from linecad.ties.pieces import Pieces, chances_of_feet, on_one_ground, part_bodies
from linecad.ties.seams import Seam, find_seams, without_feet
from linecad.ties.setting import Setting

APART = 0.12  # log ratio between feet: a kerb or a plinth is lower
JOINT = APART / 2  # log ratio of what seems to join both sides where they were one body
MOST_SURE = 0.98  # probability of a seam without what feet say, from which on these do not part it
MOST_THROUGH = 1  # lines of a side that pass through lines of the other; one may be a wire or a post before both
CLEAR = 0.08  # square of the chance that both of two feet are right, less that of two which agree


@dataclass(frozen=True, eq=False)
class Parted:
    """Bodies parted where they stand on two grounds."""

    bodies: RigidBodies
    at: tuple[Seam, ...]  # the seams that were parted
    whole: Setting | None = None  # before that
    seams: tuple[Seam, ...] = ()  # of its bodies

    def seams_of(self, setting: Setting, looks: Looks) -> list[Seam]:
        """The seams of a setting: those that were looked at, unless its bodies or crossings are others by now."""
        known = self.whole
        if known is None or not np.array_equal(known.bodies.body, setting.bodies.body):
            return find_seams(setting, looks)
        if not np.array_equal(known.graph.informative, setting.graph.informative):
            return find_seams(setting, looks)
        return list(self.seams)

    def keep_apart(self, candidates: Sequence[Candidate], body: Int) -> list[Candidate]:
        """The candidates between nodes with lines by `body` (N,), but for what joins the sides of a parted seam."""
        pairs = {
            (min(one, other), max(one, other))
            for seam in self.at
            for one in np.unique(body[seam.larger]).tolist()
            for other in np.unique(body[seam.smaller]).tolist()
        }
        return [
            each
            for each in candidates
            if each.kind not in CONNECTING or abs(each.log_ratio) >= JOINT or each.bodies not in pairs
        ]

    def keep_pieces_apart(self, pieces: Pieces) -> Pieces:
        """The same of pieces."""
        return replace(pieces, candidates=self.keep_apart(pieces.candidates, pieces.piece))


def part_by_feet(setting: Setting, looks: Looks, real: Int) -> Parted:
    """The bodies of a setting, parted at seams whose sides clearly stand on two grounds and are not one wall.

    `looks` are those at the photo; `real` (K, 2) are the lines of crossings that a person calls real, which hold both
    sides together. Other lines of a body go with the side that crossings tie them to.
    """
    seams = find_seams(setting, looks)
    piece, of_piece = part_bodies(setting.bodies, seams)
    pieces = Pieces(piece, of_piece, find_ground(replace(setting, bodies=RigidBodies(piece, len(of_piece))), looks))
    feet = chances_of_feet(pieces)
    through = setting.graph.edges[agreeing(setting.graph, setting.log_depth) & (setting.graph.kind == "X")]
    body, count, at = setting.bodies.body.copy(), setting.bodies.count, []
    for seam in seams:  # of a body and its parts that of the body comes first
        whole = np.unique(body[np.concatenate([seam.larger, seam.smaller])])
        larger, smaller = (feet[np.isin(feet[:, 0], pieces.of(side))] for side in (seam.larger, seam.smaller))
        if len(whole) > 1 or clearly_apart(larger, smaller) <= CLEAR:
            continue
        if without_feet(seam) > MOST_SURE or len(_between(seam, real)) or _passing(seam, through) > MOST_THROUGH:
            continue
        others = np.setdiff1d(np.flatnonzero(body == whole[0]), np.concatenate([seam.larger, seam.smaller]))
        body[seam.smaller] = count
        body[others] = _sides_of(others, body, (int(whole[0]), count), setting)
        count += 1
        at.append(seam)
    return Parted(RigidBodies(body, count), tuple(at), setting, tuple(seams))


def _between(seam: Seam, crossings: Int) -> Int:
    """Those of the crossings (K, 2) that join both sides."""
    one, other = (np.isin(crossings, side).any(axis=1) for side in (seam.larger, seam.smaller))
    return crossings[one & other]


def _passing(seam: Seam, through: Int) -> int:
    """How many lines of either side pass through lines of the other, of the side with fewer; both of `through` (X, 2).

    Neither line ends there. Of two walls one behind the other, only the nearer is seen where they cross.
    """
    lines = _between(seam, through)
    return min(len(np.intersect1d(lines, side)) for side in (seam.larger, seam.smaller))


def _sides_of(others: Int, body: Int, sides: tuple[int, int], setting: Setting) -> Int:
    """The side that crossings tie each of the other lines of a parted body to, by the bodies (N,); else its body.

    What these lines seem to meet in bodies that were parted off before does not tie them there again.
    """
    graph, loose = setting.graph, np.full(len(body), -1)
    own = np.isin(body, sides)
    inside = agreeing(graph, setting.log_depth) & own[graph.edges].all(axis=1)
    known = np.setdiff1d(np.flatnonzero(own), others)
    loose[known] = body[known]
    hung = with_hanging(loose, graph.edges[inside], graph.weight[inside])[others]
    return np.where(hung >= 0, hung, body[others])


def clearly_apart(one: Float, other: Float) -> float:
    """How clearly feet (M, 3) of two sides, as `chances_of_feet` gives them, stand on two grounds, from -1 to 1."""
    return -on_one_ground(one, other, APART)
