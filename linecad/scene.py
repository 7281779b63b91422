"""The records that pass between the stages: frozen, with read-only arrays, NumPy and nothing else.

Frames of reference, the same everywhere:

- pixels: OpenCV's; the centre of the first pixel is (0, 0), x right, y down;
- camera: x right, y down, z forward;
- world: the Manhattan axes, z up, right-handed, origin at the camera centre. x is the horizontal axis that runs most
  left to right in the photo and points right, y points away from the camera. The unit is free until a length is known.

Words: a *segment* is in the image, a *line* is in space, an *edge* joins two nodes of the line graph, a *crossing* is
where two segments meet in the image, an *axis* is 0, 1 or 2 (x, y, z), a *depth* is the camera z of a point.
"""

from dataclasses import dataclass, field
from typing import Literal, get_args

import numpy as np

from linecad import arrays
from linecad.arrays import Bool, Float, Int, Text, check_lengths, check_not_negative, check_unique, check_words, freeze
from linecad.line_graph import EDGE_KINDS

AXES = "xyz"

CameraSource = Literal["file", "focal option", "exif", "vanishing points", "default"]
Confidence = Literal["proven", "supported", "weak"]
Quality = Literal["good", "doubtful", "poor"]
FaceKind = Literal["wall", "ground", "ceiling", "roof", "window", "door", "reveal", "other"]
Role = Literal["outline", "opening", "detail"]  # what a line is drawn for (linecad.model.clean.roles)
DepthKind = Literal["z", "distance", "inverse", "affine-inverse"]  # what a depth map measures (linecad.depth)
OpeningKind = Literal["window", "door"]
# Why a crossing is real or not (linecad.decide.decision, docs/reference/scene-file.md). Real: annotated, chosen.
Reason = Literal[
    "annotated", "chosen", "not chosen", "impossible", "uninformative",
    "unstable", "loose", "small group", "other group",
]  # fmt: skip

CAMERA_SOURCES: tuple[CameraSource, ...] = get_args(CameraSource)
CONFIDENCES: tuple[Confidence, ...] = get_args(Confidence)
REASONS: tuple[Reason, ...] = get_args(Reason)
FACE_KINDS: tuple[FaceKind, ...] = get_args(FaceKind)
ROLES: tuple[Role, ...] = get_args(Role)
OUTLINE, OPENING, DETAIL = ROLES
QUALITIES: tuple[Quality, ...] = get_args(Quality)
DEPTH_KINDS: tuple[DepthKind, ...] = get_args(DepthKind)
OPENING_KINDS: tuple[OpeningKind, ...] = get_args(OpeningKind)


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
    is_resampled: bool = False  # its pixels were not square; how they were made so, the camera file alone tells

    def __post_init__(self) -> None:
        freeze(self, "matrix", np.float64, (3, 3))
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
        freeze(self, "rotation", np.float64, (3,))
        if self.quality not in QUALITIES:
            raise ValueError(f"Certainty.quality is {self.quality!r}, expected {', '.join(QUALITIES)}")
        errors = [*self.rotation.tolist(), self.focal, *(self.center or ()), self.radial]
        if any(error is not None and not 0 <= error < np.inf for error in errors):
            raise ValueError(f"Certainty holds the standard errors {errors}, expected numbers from 0")


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
    # (N,) 0 to 1, that the depth relative to component 0 is right within 5 %; (0,) in scenes that do not tell
    probability: Float | tuple[()] = ()
    by_depth_map: Bool | tuple[()] = ()  # (N,) a depth map alone says where the line's body stands; left out: of none
    role: Text | tuple[()] = ()  # (N,) one of ROLES; left out: all are outlines
    # N: the segments (K, 2, 2) px that a line was joined from, (0, 2, 2) where it has one; left out: all have one
    pieces: tuple[Float, ...] = ()

    def __post_init__(self) -> None:
        for name in ("id", "axis", "component"):
            freeze(self, name, np.int64, (None,))
        freeze(self, "segment", np.float64, (None, 2, 2))
        freeze(self, "ends", np.float64, (None, 2, 3))
        freeze(self, "is_boundary", np.bool_, (None,))
        freeze(self, "confidence", np.str_, (None,))
        freeze(self, "probability", np.float64, (None,))
        if len(self.by_depth_map) == 0:
            object.__setattr__(self, "by_depth_map", np.zeros(len(self.id), bool))
        freeze(self, "by_depth_map", np.bool_, (None,))
        if len(self.role) == 0:
            object.__setattr__(self, "role", np.full(len(self.id), ROLES[0]))
        freeze(self, "role", np.str_, (None,))
        self._freeze_pieces()
        same = ["axis", "segment", "ends", "is_boundary", "component", "confidence", "by_depth_map", "role", "pieces"]
        check_lengths(self, len(self.id), same + ["probability"] * (len(self.probability) > 0))
        check_not_negative(self, ["id", "component"])
        check_words(self, "confidence", CONFIDENCES)
        check_words(self, "role", ROLES)
        check_unique("Lines", self.id.tolist())
        if not np.isin(self.axis, (0, 1, 2)).all():
            raise ValueError("Lines.axis holds a number outside 0, 1, 2")
        if len(self.probability) and not (min(self.probability) >= 0 and max(self.probability) <= 1):
            raise ValueError("Lines.probability holds a number outside 0 to 1")

    def _freeze_pieces(self) -> None:
        """Make the pieces read-only, and none where they are left out."""
        given = self.pieces or (np.zeros((0, 2, 2)),) * len(self.id)
        frozen = tuple(np.array(each, np.float64).reshape(-1, 2, 2) for each in given)
        for each in frozen:
            each.flags.writeable = False
        object.__setattr__(self, "pieces", frozen)

    def __len__(self) -> int:
        return len(self.id)

    def segments_of(self, row: int) -> Float:
        """The segments (K, 2, 2) px of the photo that show a line, one or its pieces."""
        return self.pieces[row] if len(self.pieces[row]) else self.segment[row : row + 1]


@dataclass(frozen=True, eq=False)
class Intersections:
    """The crossings of a scene that were candidates, with the decision about each."""

    lines: Int  # (E, 2) ids of the two lines
    kind: Text  # (E,) L, T, X, collinear
    pixel: Float  # (E, 2) px
    real: Bool  # (E,)
    in_tree: Bool  # (E,) in the minimum spanning tree of the real ones
    weight: Float  # (E,)
    reason: Text | tuple[()] = ()  # (E,) one of REASONS; "" in scenes that do not tell, as when it is left out

    def __post_init__(self) -> None:
        freeze(self, "lines", np.int64, (None, 2))
        freeze(self, "kind", np.str_, (None,))
        freeze(self, "pixel", np.float64, (None, 2))
        for name in ("real", "in_tree"):
            freeze(self, name, np.bool_, (None,))
        freeze(self, "weight", np.float64, (None,))
        if len(self.reason) == 0:
            object.__setattr__(self, "reason", np.full(len(self.lines), ""))
        freeze(self, "reason", np.str_, (None,))
        check_lengths(self, len(self.lines), ["kind", "pixel", "real", "in_tree", "weight", "reason"])
        check_words(self, "kind", EDGE_KINDS)
        check_words(self, "reason", (*REASONS, ""))

    def __len__(self) -> int:
        return len(self.lines)


@dataclass(frozen=True, eq=False)
class Face:
    """A polygon with holes in a plane; every point lies in the plane exactly."""

    id: int  # unique in the scene
    outline: Float  # (V, 3) world, not closed
    holes: tuple[Float, ...] = ()  # each (H, 3) world, not closed
    kind: FaceKind = "other"
    hidden: tuple[Float, ...] = ()  # each (H, 3) world, not closed: parts of it that something hides in the photo
    opening: int | None = None  # id of the opening that a pane or a reveal is of

    def __post_init__(self) -> None:
        freeze(self, "outline", np.float64, (None, 3))
        arrays.read_only_rings(f"Face {self.id}", [self.outline])
        for name in ("holes", "hidden"):
            object.__setattr__(self, name, arrays.read_only_rings(f"Face {self.id}", getattr(self, name)))
        if self.kind not in FACE_KINDS:
            raise ValueError(f"Face {self.id} is a {self.kind!r}, expected one of {', '.join(FACE_KINDS)}")


@dataclass(frozen=True, eq=False)
class Plane:
    """A Manhattan plane: all points whose coordinate `axis` is `offset`."""

    id: int  # unique in the scene
    axis: int  # 0, 1, 2: the normal
    offset: float  # world, in the scene's unit
    lines: tuple[int, ...]  # ids of the lines in it
    faces: tuple[Face, ...] = ()

    def __post_init__(self) -> None:
        if self.axis not in (0, 1, 2) or not np.isfinite(self.offset):
            found = f"axis {self.axis} and offset {self.offset}"
            raise ValueError(f"Plane {self.id} has {found}, expected 0, 1 or 2 and a finite number")


@dataclass(frozen=True)
class Opening:
    """A window or a door: a rectangle in the vertical plane of its wall.

    `u` runs along the horizontal axis of the plane, `v` along z; lengths are in the scene's unit.
    """

    id: int  # unique in the scene
    plane: int  # id of the wall's plane
    u0: float  # world, from
    u1: float  # to
    v0: float  # the sill
    v1: float  # the head
    kind: OpeningKind
    recess: float | None = None  # of the pane behind the wall; None where nothing tells it
    panel: float | None = None  # offset of the pane's plane; None as `recess` is
    is_completed: bool = False  # not seen: the rows and columns of its facade have it
    shape: int = 0  # the same for all openings of one size, exactly

    def __post_init__(self) -> None:
        numbers = [self.u0, self.u1, self.v0, self.v1, self.recess or 0.0, self.panel or 0.0]
        if not (np.isfinite(numbers).all() and self.u0 < self.u1 and self.v0 < self.v1):
            raise ValueError(f"Opening {self.id} has no area, expected finite numbers, u0 < u1 and v0 < v1")
        if self.kind not in OPENING_KINDS:
            raise ValueError(f"Opening {self.id} is a {self.kind!r}, expected {' or '.join(OPENING_KINDS)}")
        if (self.recess is None) != (self.panel is None) or (self.recess is not None and self.recess <= 0):
            raise ValueError(f"Opening {self.id} has recess {self.recess} and panel {self.panel}")


@dataclass(frozen=True)
class SolveReport:
    """How the answer was found, as it stands in the scene file."""

    solver: str
    formulation: str
    status: str
    objective: float
    bound: float
    gap: float
    cuts: int = 0  # rows added while solving
    nodes: int = 0  # branch-and-bound nodes


@dataclass(frozen=True)
class DepthMapReport:
    """What became of a depth map that was given with the photo."""

    file: str  # name, without its folder
    left_out: str  # why: one clause, without a full stop; "" where it was used, and then the rest is known
    kind: DepthKind | None = None
    shift: float | None = None  # added to the map's numbers, of kind affine-inverse
    scale: float | None = None  # depth by the map (1 over its number, shifted, if inverse) over depth in the scene
    width: float | None = None  # of the Cauchy error of its bodies, log depth

    def __post_init__(self) -> None:
        told = [self.kind, self.shift, self.scale, self.width]
        if told.count(None) != (len(told) if self.left_out else 0):
            raise ValueError("DepthMapReport must say either why the map was left out, or all about it")
        if self.kind is not None and self.kind not in DEPTH_KINDS:
            raise ValueError(f"DepthMapReport.kind is {self.kind!r}, expected one of {', '.join(DEPTH_KINDS)}")

    @property
    def text(self) -> str:
        """One line for people: the file, and its kind and width or why it was left out."""
        if self.width is None:
            return f"depth map {self.file} left out: {self.left_out}"
        return f"depth map {self.file}: {self.kind}, width of its errors {100 * self.width:.2g} %"


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
    scale_source: str = ""  # what told metres_per_unit: one clause, without a full stop; "" where that is not known
    notes: tuple[str, ...] = field(default=())
    certainty: Certainty | None = None  # of camera and rotation; None in scenes that do not tell
    depth_map: DepthMapReport | None = None  # None where none was given
    openings: tuple[Opening, ...] = ()

    def __post_init__(self) -> None:
        freeze(self, "rotation", np.float64, (3, 3))
        known = set(self.lines.id.tolist())
        for name, ids in [("Intersections.lines", set(self.intersections.lines.ravel().tolist()))] + [
            (f"Plane {plane.id}", set(plane.lines)) for plane in self.planes
        ]:
            if not ids <= known:
                raise ValueError(f"{name} names line {min(ids - known)}, which the scene does not have")
        check_unique("Scene.planes", [plane.id for plane in self.planes])
        check_unique("Scene.openings", [opening.id for opening in self.openings])
        walls, openings = {plane.id for plane in self.planes if plane.axis != 2}, {each.id for each in self.openings}
        for opening in self.openings:
            if opening.plane not in walls:
                raise ValueError(f"Opening {opening.id} is in plane {opening.plane}, which is no wall of the scene")
        for _, face in self.faces:
            if face.opening is not None and face.opening not in openings:
                raise ValueError(f"Face {face.id} is of opening {face.opening}, which the scene does not have")
        check_unique("Scene.faces", [face.id for _, face in self.faces])
        if self.metres_per_unit is not None and not 0 < self.metres_per_unit < np.inf:
            raise ValueError(f"Scene.metres_per_unit is {self.metres_per_unit}, expected a positive number")

    @property
    def remarks(self) -> tuple[str, ...]:
        """What a reader of the scene should know: the notes, and where the scale came from."""
        return (*self.notes, *([f"scale: {self.scale_source}"] if self.scale_source else []))

    @property
    def faces(self) -> list[tuple[Plane, Face]]:
        """Every face with its plane, in ascending order of face id."""
        pairs = [(plane, face) for plane in self.planes for face in plane.faces]
        return sorted(pairs, key=lambda pair: pair[1].id)
