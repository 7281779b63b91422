"""The records that pass between the stages: frozen, with read-only arrays, NumPy and nothing else.

Frames of reference, the same everywhere:

- pixels: OpenCV's; the centre of the first pixel is (0, 0), x right, y down;
- camera: x right, y down, z forward;
- world: the Manhattan axes, z up, right-handed, origin at the camera centre. x is the horizontal axis that runs most
  left to right in the photo and points right, y points away from the camera. The unit is free until a length is known.

Words: a *segment* is in the image, a *line* is in space, an *edge* joins two nodes of the line graph, a *crossing* is
where two segments meet in the image, an *axis* is 0, 1 or 2 (x, y, z), a *depth* is the camera z of a point.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

Float = NDArray[np.float64]
Int = NDArray[np.int64]
Bool = NDArray[np.bool_]
Text = NDArray[np.str_]

AXES = "xyz"

CameraSource = Literal["file", "focal option", "exif", "vanishing points", "default"]
EdgeKind = Literal["L", "T", "X", "collinear"]
Confidence = Literal["proven", "supported", "weak"]
Quality = Literal["good", "doubtful", "poor"]
Formulation = Literal["gain", "paper"]
Status = Literal[
    "optimal", "time limit", "gap limit", "interrupted", "node limit", "memory limit", "heuristic", "robust fit"
]  # fmt: skip

CAMERA_SOURCES: tuple[CameraSource, ...] = get_args(CameraSource)
EDGE_KINDS: tuple[EdgeKind, ...] = get_args(EdgeKind)
CONFIDENCES: tuple[Confidence, ...] = get_args(Confidence)
QUALITIES: tuple[Quality, ...] = get_args(Quality)
STATUSES: tuple[Status, ...] = get_args(Status)


def _freeze(record: object, name: str, kind: Any, shape: tuple[int | None, ...]) -> None:
    """Store field `name` of a frozen record as a read-only array of dtype `kind`; None in `shape` is any length."""
    array: NDArray[Any] = np.array(getattr(record, name), dtype=kind)
    if array.size == 0 and len(array.shape) != len(shape):
        array = array.reshape([0 if length is None else length for length in shape])
    fits = array.ndim == len(shape) and all(
        want is None or have == want for have, want in zip(array.shape, shape, strict=True)
    )
    if not fits:
        wanted = "x".join("any" if length is None else str(length) for length in shape)
        found = "x".join(map(str, array.shape)) or "scalar"
        raise ValueError(f"{type(record).__name__}.{name} has shape {found}, expected {wanted}")
    if array.dtype.kind == "f" and not np.isfinite(array).all():
        raise ValueError(f"{type(record).__name__}.{name} holds a number that is not finite")
    array.flags.writeable = False
    object.__setattr__(record, name, array)


def _same_length(record: object, length: int, names: Iterable[str]) -> None:
    for name in names:
        found = len(getattr(record, name))
        if found != length:
            raise ValueError(f"{type(record).__name__}.{name} has {found} entries, expected {length}")


def _not_negative(record: object, names: Iterable[str]) -> None:
    for name in names:
        array = getattr(record, name)
        if len(array) and array.min() < 0:
            raise ValueError(f"{type(record).__name__}.{name} holds {array.min()}, expected 0 or more")


def _among(record: object, name: str, words: tuple[str, ...]) -> None:
    strange = sorted(set(getattr(record, name).tolist()) - set(words))
    if strange:
        raise ValueError(f"{type(record).__name__}.{name} holds {strange}, expected {', '.join(words)}")


def _unique(name: str, ids: list[int]) -> None:
    seen: set[int] = set()
    for number in ids:
        if number in seen:
            raise ValueError(f"{name}: the id {number} stands twice")
        seen.add(number)


@dataclass(frozen=True, eq=False)
class Camera:
    """A pinhole camera with square pixels: `pixel ~ matrix @ (x, y, z)` in the camera frame.

    The photo that everything is measured in has been undistorted and its pixels made square; `distortion` only
    records what was removed.
    """

    width: int  # px
    height: int  # px
    matrix: Float  # (3, 3) K, px; K[0, 0] == K[1, 1]
    source: CameraSource
    distortion: tuple[float, ...] = ()  # OpenCV's coefficients, as they were before the photo was undistorted

    def __post_init__(self) -> None:
        _freeze(self, "matrix", np.float64, (3, 3))
        if self.width < 1 or self.height < 1:
            raise ValueError(f"Camera is {self.width} x {self.height} px, expected positive sizes")
        if not (self.matrix[0, 0] > 0 and self.matrix[1, 1] > 0):
            raise ValueError(f"Camera has focal lengths {self.matrix[0, 0]} and {self.matrix[1, 1]}, expected positive")
        if self.matrix[2].tolist() != [0.0, 0.0, 1.0]:
            raise ValueError(f"Camera.matrix ends in {self.matrix[2].tolist()}, expected [0, 0, 1]")

    @property
    def focal(self) -> float:
        """Focal length in px."""
        return float(self.matrix[0, 0])

    @property
    def is_given(self) -> bool:
        """Whether the user gave the focal length, so that it is not estimated."""
        return self.source in ("file", "focal option")


@dataclass(frozen=True, eq=False)
class Segments:
    """Straight pieces of image, labelled by the axis of the line that they show."""

    ends: Float  # (N, 2, 2) px, both ends, x and y
    axis: Int  # (N,) 0, 1, 2 or -1 where it is not known

    def __post_init__(self) -> None:
        _freeze(self, "ends", np.float64, (None, 2, 2))
        _freeze(self, "axis", np.int64, (None,))
        _same_length(self, len(self.ends), ["axis"])
        if len(self.axis) and not (self.axis.min() >= -1 and self.axis.max() <= 2):
            raise ValueError("Segments.axis holds a number outside -1, 0, 1, 2")

    def __len__(self) -> int:
        return len(self.ends)

    @property
    def length(self) -> Float:
        """(N,) px."""
        length: Float = np.linalg.norm(self.ends[:, 1] - self.ends[:, 0], axis=1)
        return length

    def subset(self, keep: Bool | Int) -> "Segments":
        """The segments that a mask or an index array selects."""
        return Segments(self.ends[keep], self.axis[keep])

    def joined(self, others: "Segments") -> "Segments":
        """These segments and the others after them."""
        return Segments(np.concatenate([self.ends, others.ends]), np.concatenate([self.axis, others.axis]))


@dataclass(frozen=True, eq=False)
class ManhattanFrame:
    """How the three Manhattan axes stand before the camera."""

    rotation: Float  # (3, 3) world to camera; columns are the axes x, y, z in the camera frame, det +1
    residual: float  # root mean square angle between the segments and their vanishing points, rad
    explained: float  # share of the segment length that points to one of the three vanishing points, 0 to 1

    def __post_init__(self) -> None:
        _freeze(self, "rotation", np.float64, (3, 3))
        off = np.abs(self.rotation @ self.rotation.T - np.eye(3)).max()
        if off > 1e-6 or np.linalg.det(self.rotation) < 0:
            raise ValueError(f"ManhattanFrame.rotation is not a rotation (off by {off:.3g})")


@dataclass(frozen=True, eq=False)
class Certainty:
    """How sure a camera and its Manhattan frame are: standard errors, and what they mean in plain words.

    An error is None where the quantity was given and not estimated.
    """

    rotation: Float  # (3,) rad, of small turns about x, y and z of the camera
    focal: float | None  # px
    center: tuple[float, float] | None  # px, of the principal point
    radial: float | None  # of OpenCV's k1
    quality: Quality
    reason: str  # for the quality: one clause, without a full stop

    def __post_init__(self) -> None:
        _freeze(self, "rotation", np.float64, (3,))
        if self.quality not in QUALITIES:
            raise ValueError(f"Certainty.quality is {self.quality!r}, expected {', '.join(QUALITIES)}")
        errors = [*self.rotation.tolist(), self.focal, *(self.center or ()), self.radial]
        if any(error is not None and not 0 <= error < np.inf for error in errors):
            raise ValueError(f"Certainty holds the standard errors {errors}, expected numbers from 0")


@dataclass(frozen=True, eq=False)
class LineGraph:
    """The paper's line graph: nodes are segments, edges are crossings that may be real.

    A line of known axis through a known segment has one unknown, the depth s_i of the segment's middle. Lines i and j
    of different axes meet in space exactly when they agree in the third coordinate, s_i d_i = s_j d_j with d the ray's
    component in that coordinate: log s_i - log s_j = log_ratio, within `tolerance` (design: one depth per line).
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
    coordinate: Int  # (E,) axis in which the two lines must agree, the paper's alpha
    log_ratio: Float  # (E,) c_ij: log s_i - log s_j of two lines that meet; 0 where not possible
    tolerance: Float  # (E,) half width of the interval about log_ratio that pixel noise explains
    possible: Bool  # (E,) False where the two lines lie on opposite sides of the camera in `coordinate`
    informative: Bool  # (E,) False where the tolerance is so wide that the crossing says nothing about depth

    def __post_init__(self) -> None:
        _freeze(self, "rays", np.float64, (None, 3))
        _freeze(self, "end_rays", np.float64, (None, 2, 3))
        _freeze(self, "edges", np.int64, (None, 2))
        _freeze(self, "crossing", np.float64, (None, 2))
        _freeze(self, "gap", np.float64, (None, 2))
        for name in ("weight", "log_ratio", "tolerance"):
            _freeze(self, name, np.float64, (None,))
        for name in ("corner", "possible", "informative"):
            _freeze(self, name, np.bool_, (None,))
        _freeze(self, "kind", np.str_, (None,))
        _freeze(self, "coordinate", np.int64, (None,))
        _same_length(self, len(self.segments), ["rays", "end_rays"])
        _same_length(self, len(self.edges), _EDGE_FIELDS)
        if len(self.edges):
            if self.edges.min() < 0 or self.edges.max() >= len(self.segments):
                raise ValueError(f"LineGraph.edges name segment {self.edges.max()} of {len(self.segments)}")
            if not (self.edges[:, 0] < self.edges[:, 1]).all():
                raise ValueError("LineGraph.edges must name the smaller segment first")
            _among(self, "kind", EDGE_KINDS)

    @property
    def axis(self) -> Int:
        """(N,) axis of each line."""
        return self.segments.axis

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
    formulation: Formulation
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
        _freeze(self, "connected", np.bool_, (None,))
        _freeze(self, "is_boundary", np.bool_, (None,))
        _freeze(self, "planar_pairs", np.int64, (None, 3))
        _freeze(self, "log_depth", np.float64, (None,))
        _same_length(self, len(self.is_boundary), ["log_depth"])


@dataclass(frozen=True, eq=False)
class Lines:
    """The lines in space of a scene, with the segments that show them."""

    id: Int  # (N,) unique, not negative
    axis: Int  # (N,) 0, 1, 2
    segment: Float  # (N, 2, 2) px
    ends: Float  # (N, 2, 3) world, in the scene's unit
    is_boundary: Bool  # (N,) at the meeting of two planes
    component: Int  # (N,) 0 is the largest; each component has its own scale
    confidence: Text  # (N,) proven, supported, weak

    def __post_init__(self) -> None:
        for name in ("id", "axis", "component"):
            _freeze(self, name, np.int64, (None,))
        _freeze(self, "segment", np.float64, (None, 2, 2))
        _freeze(self, "ends", np.float64, (None, 2, 3))
        _freeze(self, "is_boundary", np.bool_, (None,))
        _freeze(self, "confidence", np.str_, (None,))
        _same_length(self, len(self.id), ["axis", "segment", "ends", "is_boundary", "component", "confidence"])
        _not_negative(self, ["id", "component"])
        _among(self, "confidence", CONFIDENCES)
        _unique("Lines", self.id.tolist())
        if len(self.axis) and not (self.axis.min() >= 0 and self.axis.max() <= 2):
            raise ValueError("Lines.axis holds a number outside 0, 1, 2")

    def __len__(self) -> int:
        return len(self.id)


@dataclass(frozen=True, eq=False)
class Intersections:
    """The crossings of a scene that were candidates, with the decision about each."""

    lines: Int  # (E, 2) ids of the two lines
    kind: Text  # (E,) L, T, X, collinear
    pixel: Float  # (E, 2) px
    real: Bool  # (E,)
    in_tree: Bool  # (E,) in the minimum spanning tree of the real ones
    weight: Float  # (E,)

    def __post_init__(self) -> None:
        _freeze(self, "lines", np.int64, (None, 2))
        _freeze(self, "kind", np.str_, (None,))
        _freeze(self, "pixel", np.float64, (None, 2))
        for name in ("real", "in_tree"):
            _freeze(self, name, np.bool_, (None,))
        _freeze(self, "weight", np.float64, (None,))
        _same_length(self, len(self.lines), ["kind", "pixel", "real", "in_tree", "weight"])
        _among(self, "kind", EDGE_KINDS)

    def __len__(self) -> int:
        return len(self.lines)


@dataclass(frozen=True, eq=False)
class Face:
    """A polygon with holes in a plane; every point lies in the plane exactly."""

    id: int  # unique in the scene
    outline: Float  # (V, 3) world, not closed
    holes: tuple[Float, ...] = ()  # each (H, 3) world, not closed

    def __post_init__(self) -> None:
        _freeze(self, "outline", np.float64, (None, 3))
        rings = [np.array(hole, np.float64) for hole in self.holes]
        for ring in (self.outline, *rings):
            if ring.ndim != 2 or ring.shape[1] != 3 or len(ring) < 3:
                raise ValueError(f"Face {self.id} has a ring of shape {ring.shape}, expected at least 3 points")
            if not np.isfinite(ring).all():
                raise ValueError(f"Face {self.id} holds a number that is not finite")
            ring.flags.writeable = False
        object.__setattr__(self, "holes", tuple(rings))


@dataclass(frozen=True, eq=False)
class Plane:
    """A Manhattan plane: all points whose coordinate `axis` is `offset`."""

    id: int  # unique in the scene
    axis: int  # 0, 1, 2: the normal
    offset: float  # world, in the scene's unit
    lines: tuple[int, ...]  # ids of the lines in it
    faces: tuple[Face, ...] = ()

    def __post_init__(self) -> None:
        if self.axis not in (0, 1, 2):
            raise ValueError(f"Plane {self.id} has axis {self.axis}, expected 0, 1 or 2")
        if not np.isfinite(self.offset):
            raise ValueError(f"Plane {self.id} has offset {self.offset}, expected a finite number")


@dataclass(frozen=True)
class SolveReport:
    """How the answer was found, as it stands in the scene file."""

    solver: str
    formulation: str
    status: str
    objective: float
    bound: float
    gap: float
    seconds: float
    cuts: int = 0  # rows added while solving
    nodes: int = 0  # branch-and-bound nodes


@dataclass(frozen=True, eq=False)
class Scene:
    """The reconstruction of one photo: what the scene file says."""

    photo: str  # file name, as given
    camera: Camera
    rotation: Float  # (3, 3) world to camera
    lines: Lines
    intersections: Intersections
    planes: tuple[Plane, ...]
    solve: SolveReport
    metres_per_unit: float | None = None
    notes: tuple[str, ...] = field(default=())
    certainty: Certainty | None = None  # of camera and rotation; None in scenes that do not tell

    def __post_init__(self) -> None:
        _freeze(self, "rotation", np.float64, (3, 3))
        known = set(self.lines.id.tolist())
        for name, ids in [("Intersections.lines", set(self.intersections.lines.ravel().tolist()))] + [
            (f"Plane {plane.id}", set(plane.lines)) for plane in self.planes
        ]:
            if not ids <= known:
                raise ValueError(f"{name} names line {min(ids - known)}, which the scene does not have")
        _unique("Scene.planes", [plane.id for plane in self.planes])
        _unique("Scene.faces", [face.id for plane in self.planes for face in plane.faces])
        if self.metres_per_unit is not None and not 0 < self.metres_per_unit < np.inf:
            raise ValueError(f"Scene.metres_per_unit is {self.metres_per_unit}, expected a positive number")

    @property
    def faces(self) -> list[tuple[Plane, Face]]:
        """Every face with its plane, in ascending order of face id."""
        pairs = [(plane, face) for plane in self.planes for face in plane.faces]
        return sorted(pairs, key=lambda pair: pair[1].id)
