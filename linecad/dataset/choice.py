"""The rule by which a drawn scene is taken or drawn again, from its exact truth and without rendering."""

from dataclasses import dataclass

import numpy as np

from linecad.dataset.modelling import Model
from linecad.dataset.truth import NOTHING, Truth
from linecad.geometry import REFERENCE_WIDTH
from linecad.scene import Bool, Float

MOST_TRIES = 12  # drawings of one scene; the last one is taken as it is
LONG = 40.0  # px at the reference width; shorter pieces do not count
PIECES = {"street": (700, 3500), "courtyard": (500, 3500), "room": (150, 2500)}
BUILT = {"street": 0.40, "courtyard": 0.45, "room": 0.80}  # least share of the photo that buildings fill
MOST_HIDDEN = 0.20  # of the photo, by cars, trees, lamp posts and signs
LARGEST_QUAD = 0.30  # of the photo; more is a bare wall before the camera
ALONG_AXIS = 1e-9  # m, that a Manhattan edge may leave its axis


@dataclass(frozen=True)
class Verdict:
    """What the rule looks at; shares of the photo's pixels."""

    pieces: int  # visible pieces of Manhattan edges of LONG or more
    built: float  # buildings and furniture
    hidden: float  # cars, trees, lamp posts
    largest_wall: float  # the quad that fills most of the photo, the ground not counted
    accepted: bool


def judge(truth: Truth, model: Model, kind: str) -> Verdict:
    """Whether a scene has about as many lines as a photo of houses, and nothing before them that hides most."""
    scale = truth.width / REFERENCE_WIDTH
    length = np.linalg.norm(truth.pieces[:, 1] - truth.pieces[:, 0], axis=1)
    long_enough = manhattan(truth.edges)[truth.piece_edge] & (length >= LONG * scale)
    shown = np.bincount(truth.ids[truth.ids != NOTHING], minlength=len(truth.quads)) / truth.ids.size
    kinds = np.array(model.kinds)[truth.body]
    built = float(shown[(kinds == "building") | (kinds == "furniture")].sum())
    hidden = float(shown[np.isin(kinds, ["car", "tree", "lamp"])].sum())
    wall = float(shown[kinds == "building"].max(initial=0.0))
    pieces = int(long_enough.sum())
    low, high = PIECES[kind]
    accepted = low <= pieces <= high and built >= BUILT[kind] and hidden <= MOST_HIDDEN and wall <= LARGEST_QUAD
    return Verdict(pieces, built, hidden, wall, accepted)


def manhattan(edges: Float) -> Bool:
    """Which edges (M, 2, 3) run along an axis of the world (M,)."""
    extent = np.sort(np.abs(edges[:, 1] - edges[:, 0]), axis=1)
    along: Bool = extent[:, 1] <= ALONG_AXIS
    return along
