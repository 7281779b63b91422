"""The records of the line graph: segments with their axes, the graph that goes into a solver, what comes out.

Words: a *segment* is in the image, a *line* is in space, an *edge* joins two nodes of the line graph, a *crossing* is
where two segments meet in the image, an *axis* is the number of a direction (`linecad.directions`): 0, 1, 2 for x, y,
z, 3 and more for the level axes of further frames, a *depth* is the camera z of a point. Frames of reference are those
of `linecad.scene`.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal, get_args

import numpy as np

from linecad.arrays import Bool, Float, Int, Text, check_lengths, check_not_negative, check_words, freeze
from linecad.directions import UP, Turns, common_frame, components, directions_of, frame_of

EdgeKind = Literal["L", "T", "X", "collinear"]
Formulation = Literal["gain", "paper"]  # the programs over all crossings
Program = Literal["bodies", "gain", "paper"]
Status = Literal[
    "optimal", "time limit", "gap limit", "interrupted", "node limit", "memory limit", "heuristic", "robust fit"
]  # fmt: skip

EDGE_KINDS: tuple[EdgeKind, ...] = get_args(EdgeKind)
STATUSES: tuple[Status, ...] = get_args(Status)


@dataclass(frozen=True, eq=False)
class Segments:
    """Straight pieces of image, labelled by the axis of the line that they show."""

    ends: Float  # (N, 2, 2) px, both ends, x and y
    axis: Int  # (N,) or -1 where it is not known

    def __post_init__(self) -> None:
        freeze(self, "ends", np.float64, (None, 2, 2))
        freeze(self, "axis", np.int64, (None,))
        check_lengths(self, len(self.ends), ["axis"])
        if len(self.axis) and self.axis.min() < -1:
            raise ValueError(f"Segments.axis holds {self.axis.min()}, expected -1 or the number of a direction")

    def __len__(self) -> int:
        return len(self.ends)

    @classmethod
    def none(cls) -> "Segments":
        """No segment at all."""
        return cls(np.zeros((0, 2, 2)), np.zeros(0, np.int64))

    @property
    def length(self) -> Float:
        """(N,) px."""
        length: Float = np.linalg.norm(self.ends[:, 1] - self.ends[:, 0], axis=1)
        return length

    def subset(self, keep: Bool | Int) -> "Segments":
        """The segments that a mask or an index array selects."""
        return Segments(self.ends[keep], self.axis[keep])

    def is_like(self, other: "Segments") -> bool:
        """Whether these are the same to the last digit."""
        return np.array_equal(self.axis, other.axis) and np.array_equal(self.ends, other.ends)

    def rows(self, taken: "Segments") -> Int:
        """(M,) the row here of each of M segments that were taken from these, to the last digit; -1 for others."""
        row = {look: number for number, look in enumerate(self._looks())}
        return np.array([row.get(look, -1) for look in taken._looks()], np.int64)

    def _looks(self) -> Iterator[tuple[int, bytes]]:
        return ((axis, ends.tobytes()) for axis, ends in zip(self.axis.tolist(), self.ends, strict=True))

    def joined(self, others: "Segments") -> "Segments":
        """These segments and the others after them."""
        return Segments(np.concatenate([self.ends, others.ends]), np.concatenate([self.axis, others.axis]))


@dataclass(frozen=True, eq=False)
class ManhattanFrame:
    """How the three Manhattan axes stand before the camera."""

    rotation: Float  # (3, 3) world to camera; columns are the axes x, y, z in the camera frame, det +1
    residual: float  # root mean square angle between the segments and their vanishing points, rad
    explained: float  # share of the segment length that points to one of the three vanishing points, 0 to 1
    turns: Turns = ()  # of the further frames that lines may run along, against this one

    def __post_init__(self) -> None:
        freeze(self, "rotation", np.float64, (3, 3))
        off = np.abs(self.rotation @ self.rotation.T - np.eye(3)).max()
        if off > 1e-6 or np.linalg.det(self.rotation) < 0:
            raise ValueError(f"ManhattanFrame.rotation is not a rotation (off by {off:.3g})")

    @property
    def axes(self) -> Float:
        """(3, K) every direction in the camera frame, one a column: the rotation, then those of further frames."""
        return self.rotation if not self.turns else self.rotation @ directions_of(self.turns).T


@dataclass(frozen=True, eq=False)
class LineDepths:
    """Unary evidence: depths that something other than crossings tells of M lines, in one common scale."""

    line: Int  # (M,) node of the line graph; a line may stand more than once
    log_depth: Float  # (M,) log of the depth of its segment's middle
    sigma: Float  # (M,) standard error of log_depth, positive
    may_be_outlier: Bool  # (M,) True: far off it costs a constant and pulls no more; False: it pulls however far off

    def __post_init__(self) -> None:
        freeze(self, "line", np.int64, (None,))
        freeze(self, "log_depth", np.float64, (None,))
        freeze(self, "sigma", np.float64, (None,))
        freeze(self, "may_be_outlier", np.bool_, (None,))
        check_lengths(self, len(self.line), ["log_depth", "sigma", "may_be_outlier"])
        check_not_negative(self, ["line"])
        if len(self.sigma) and not self.sigma.min() > 0:
            raise ValueError(f"LineDepths.sigma holds {self.sigma.min()}, expected positive numbers")

    @classmethod
    def joined(cls, parts: Sequence["LineDepths"]) -> "LineDepths":
        """What several sources tell."""
        names = ("line", "log_depth", "sigma", "may_be_outlier")
        return cls(*(np.concatenate([getattr(part, name) for part in parts]) for name in names))

    @classmethod
    def none(cls) -> "LineDepths":
        """No depth at all."""
        return cls(np.zeros(0, np.int64), np.zeros(0), np.zeros(0), np.zeros(0, bool))

    def chosen(self, which: Bool) -> "LineDepths":
        """Those that a mask (M,) selects."""
        return LineDepths(self.line[which], self.log_depth[which], self.sigma[which], self.may_be_outlier[which])

    def subset(self, new: Int) -> "LineDepths":
        """Those of lines that stay, with the new number (N,) of each line, -1 where it goes."""
        stay = self.chosen(new[self.line] >= 0)
        return LineDepths(new[stay.line], stay.log_depth, stay.sigma, stay.may_be_outlier)


@dataclass(frozen=True, eq=False)
class LineGraph:
    """The paper's line graph: nodes are segments, edges are crossings that may be real.

    A line of known axis through a known segment has one unknown, the depth s_i of the segment's middle. Lines i and j
    of different axes meet in space exactly when they agree in the component along the normal of the plane that they
    span, s_i d_i = s_j d_j with d that component of the ray: log s_i - log s_j = log_ratio, within `tolerance` (design:
    one depth per line). In one frame that is the third coordinate.
    """

    segments: Segments  # N; each passes exactly through the vanishing point of its axis
    rays: Float  # (N, 3) world ray of the segment's middle, camera depth 1
    end_rays: Float  # (N, 2, 3) world rays of the two ends, the paper's d_i1 and d_i2, camera depth 1
    edges: Int  # (E, 2) indices of the two segments, smaller first
    crossing: Float  # (E, 2) px
    gap: Float  # (E, 2) px by which each segment falls short of the crossing; 0 inside the segment
    kind: Text  # (E,) L, T, X, collinear
    corner: Bool  # (E,) a line of the third axis passes too (a Y or W junction)
    weight: Float  # (E,) the paper's w_ij, positive
    coordinate: Int  # (E,) axis along which the two lines must agree, the paper's alpha
    log_ratio: Float  # (E,) c_ij: log s_i - log s_j of two lines that meet; 0 where not possible
    tolerance: Float  # (E,) half width of the interval about log_ratio that pixel noise explains
    possible: Bool  # (E,) False where the two lines lie on opposite sides of the camera in `coordinate`
    informative: Bool  # (E,) False where the tolerance is so wide that the crossing says nothing about depth
    depths: LineDepths | None = None  # what unary cues tell
    turns: Turns = ()  # of further frames

    def __post_init__(self) -> None:
        freeze(self, "rays", np.float64, (None, 3))
        freeze(self, "end_rays", np.float64, (None, 2, 3))
        freeze(self, "edges", np.int64, (None, 2))
        freeze(self, "crossing", np.float64, (None, 2))
        freeze(self, "gap", np.float64, (None, 2))
        for name in ("weight", "log_ratio", "tolerance"):
            freeze(self, name, np.float64, (None,))
        for name in ("corner", "possible", "informative"):
            freeze(self, name, np.bool_, (None,))
        freeze(self, "kind", np.str_, (None,))
        freeze(self, "coordinate", np.int64, (None,))
        check_lengths(self, len(self.segments), ["rays", "end_rays"])
        check_lengths(self, len(self.edges), _EDGE_FIELDS)
        if len(self.edges):
            if self.edges.min() < 0 or self.edges.max() >= len(self.segments):
                raise ValueError(f"LineGraph.edges name segment {self.edges.max()} of {len(self.segments)}")
            if not (self.edges[:, 0] < self.edges[:, 1]).all():
                raise ValueError("LineGraph.edges must name the smaller segment first")
            check_words(self, "kind", EDGE_KINDS)
        if self.depths is not None and len(self.depths.line) and self.depths.line.max() >= len(self.segments):
            raise ValueError(f"LineGraph.depths name segment {self.depths.line.max()} of {len(self.segments)}")

    @property
    def axis(self) -> Int:
        """(N,) axis of each line."""
        return self.segments.axis

    @cached_property
    def components(self) -> Float:
        """(N, K) of `rays` along every direction."""
        return components(self.rays, self.turns)

    @cached_property
    def end_components(self) -> Float:
        """(N, 2, K) of `end_rays` along every direction."""
        return components(self.end_rays, self.turns)

    @cached_property
    def home(self) -> Int:
        """(N,) the frame of each line, of an upright one that which most of its crossings are in, the first of equals.

        What is known of three axes at right angles holds for lines of one home.
        """
        if not self.turns:
            return np.zeros(len(self.segments), np.int64)
        axis = self.axis[self.edges]
        frame = common_frame(*axis.T)
        count = np.zeros((len(self.segments), len(self.turns) + 1), np.int64)
        crosses = (frame >= 0) & (axis[:, 0] != axis[:, 1])
        for side in range(2):
            np.add.at(count, (self.edges[crosses, side], frame[crosses]), 1)
        return np.where(self.axis == UP, count.argmax(axis=1), frame_of(self.axis))

    @property
    def in_one_frame(self) -> Bool:
        """(E,) whether both lines of a crossing are of one home."""
        own = self.home[self.edges]
        return np.asarray(own[:, 0] == own[:, 1])

    def misfit(self, log_depth: Float) -> Float:
        """By how much log depths (N,) miss the ratio that each crossing asks for (E,): |log s_i - log s_j - c_ij|."""
        first, second = self.edges.T
        misfit: Float = np.abs(log_depth[first] - log_depth[second] - self.log_ratio)
        return misfit

    def subset(self, keep: Int) -> "LineGraph":
        """The graph on the nodes `keep` (ascending indices), renumbered, with the edges among them."""
        new = np.full(len(self.segments), -1, np.int64)
        new[keep] = np.arange(len(keep))
        inside = (new[self.edges] >= 0).all(axis=1) if len(self.edges) else np.zeros(0, bool)
        fields = {name: getattr(self, name)[inside] for name in _EDGE_FIELDS}
        return LineGraph(
            segments=self.segments.subset(keep),
            rays=self.rays[keep],
            end_rays=self.end_rays[keep],
            edges=new[self.edges[inside]],
            depths=None if self.depths is None else self.depths.subset(new),
            turns=self.turns,
            **fields,
        )


_EDGE_FIELDS = (
    "crossing", "gap", "kind", "corner", "weight", "coordinate", "log_ratio", "tolerance", "possible", "informative",
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class Solution:
    """What a solver found for a line graph of N lines and E edges."""

    status: Status
    solver: str  # name and version
    formulation: Program
    objective: float
    bound: float  # proven upper bound of the objective, infinite where nothing was proven
    gap: float  # (bound - objective) / max(|objective|, 1e-9)
    seconds: float
    nodes: int  # branch-and-bound nodes
    connected: Bool  # (E,) the paper's b_ij: this crossing is real
    is_boundary: Bool  # (N,) the paper's B_i
    planar_pairs: Int  # (P, 3) two parallel lines and the other axis of the plane they lie in, the paper's pi
    log_depth: Float  # (N,) log of the depth of each segment's middle, consistent with `connected`
    cuts: int = 0  # rows that were added while solving

    def __post_init__(self) -> None:
        freeze(self, "connected", np.bool_, (None,))
        freeze(self, "is_boundary", np.bool_, (None,))
        freeze(self, "planar_pairs", np.int64, (None, 3))
        freeze(self, "log_depth", np.float64, (None,))
        check_lengths(self, len(self.is_boundary), ["log_depth"])
