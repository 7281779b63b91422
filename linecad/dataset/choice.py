"""The rule by which a drawn scene is taken or drawn again, from its exact truth and without rendering."""

from dataclasses import dataclass

import numpy as np

from linecad.arrays import Bool, Float
from linecad.dataset.modelling import Model
from linecad.dataset.truth import NOTHING, Truth
from linecad.geometry import PhotoLength
from linecad.graph.build import build_line_graph
from linecad.graph.connectivity import components
from linecad.line_graph import ManhattanFrame, Segments
from linecad.scene import Camera

MOST_TRIES = 12  # drawings of one scene; the last one is taken as it is
LONG = PhotoLength(40.0)  # shorter pieces do not count
CROSSINGS = {
    "street": (3000, 6500),
    "courtyard": (1500, 9000),
    "room": (800, 6500),
    "town": (50, 6500),
    "garden": (50, 6500),
}
LEAST_REAL = {
    "street": 0.75,
    "courtyard": 0.75,
    "room": 0.58,
    "town": 0.5,
    "garden": 0.5,
}  # books and boards have more relief for their distance
SAME_DEPTH = 0.02  # by which the depths of two lines that meet may differ: the relief of a facade
BUILT = {
    "street": 0.40,
    "courtyard": 0.45,
    "room": 0.80,
    "town": 0.35,
    "garden": 0.3,
}  # least share of the photo that buildings fill
MOST_HIDDEN = 0.20  # of the photo, by cars, trees, lamp posts and signs
LARGEST_WALL = {
    "street": 0.2,
    "courtyard": 0.2,
    "room": 0.36,
    "town": 0.25,
    "garden": 0.3,
}  # of the photo; more is a bare wall before the camera
ALONG_AXIS = 1e-9  # m, that a Manhattan edge may leave its axis


@dataclass(frozen=True)
class Verdict:
    """What the rule looks at: the largest component of the line graph of visible edges, and shares of the photo."""

    lines: int
    crossings: int
    real: float  # share of the crossings whose lines agree within SAME_DEPTH
    built: float  # share of buildings and furniture
    hidden: float  # share of cars, trees and lamp posts
    largest_wall: float  # share of the quad of a building that fills most of the photo

    def accepts(self, kind: str) -> bool:
        """Whether a scene of this kind is taken."""
        low, high = CROSSINGS[kind]
        return (
            low <= self.crossings <= high
            and self.real >= LEAST_REAL[kind]
            and self.built >= BUILT[kind]
            and self.hidden <= MOST_HIDDEN
            and self.largest_wall <= LARGEST_WALL[kind]
        )


def judge(truth: Truth, model: Model) -> Verdict:
    """What the rule looks at in a scene of which `truth` was measured at any size."""
    shown = np.bincount(truth.ids[truth.ids != NOTHING], minlength=len(truth.quads)) / truth.ids.size
    kinds = np.array(model.kinds)[truth.body]
    lines, crossings, real = _largest_component(truth)
    return Verdict(
        lines=lines,
        crossings=crossings,
        real=real,
        built=float(shown[np.isin(kinds, ["building", "furniture"])].sum()),
        hidden=float(shown[np.isin(kinds, ["car", "tree", "lamp"])].sum()),
        largest_wall=float(shown[kinds == "building"].max(initial=0.0)),
    )


def _largest_component(truth: Truth) -> tuple[int, int, float]:
    """Lines, crossings and share of real crossings of the paper's graph of visible pieces of Manhattan edges."""
    length = np.linalg.norm(truth.pieces[:, 1] - truth.pieces[:, 0], axis=1)
    keep = manhattan(truth.edges)[truth.piece_edge] & (length >= LONG.px(truth.width))
    edges = truth.edges[truth.piece_edge[keep]]
    axis = np.abs(edges[:, 1] - edges[:, 0]).argmax(axis=1)
    camera = Camera(truth.width, truth.height, truth.matrix, "file")
    graph = build_line_graph(Segments(truth.pieces[keep], axis), camera, ManhattanFrame(truth.rotation, 0.0, 1.0))
    if len(graph.edges) == 0:
        return 0, 0, 0.0
    part = np.zeros(len(graph.segments), bool)
    part[components(graph)[0]] = True
    inside = part[graph.edges].all(axis=1)
    pairs, coordinate = graph.edges[inside], graph.coordinate[inside]
    first, second = (edges[pairs[:, side], 0][np.arange(len(pairs)), coordinate] for side in (0, 1))
    real = np.abs(first - second) <= SAME_DEPTH * np.maximum(np.abs(first), np.abs(second))
    return int(part.sum()), len(pairs), float(real.mean())


def manhattan(edges: Float) -> Bool:
    """Which edges (M, 2, 3) run along an axis of the world (M,)."""
    extent = np.sort(np.abs(edges[:, 1] - edges[:, 0]), axis=1)
    along: Bool = extent[:, 1] <= ALONG_AXIS
    return along
