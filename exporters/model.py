"""What every format writes of a scene: lines in groups by axis and kind, flat faces with holes, all in metres.

The frame is the scene's: right-handed, z up, origin at the camera. So every coordinate is small enough for the
float32 of glTF and USD.
"""

from collections import Counter
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from pathlib import Path

import numpy as np

from exporters.bands import BANDS, bands_of
from linecad.arrays import Float, Int, Text
from linecad.scene import AXES, ROLES, Face, FaceKind, Plane, Scene

SHORTEST_LINE = 1e-9  # m; shorter lines are points to every reader, and the STEP library refuses them

KNOWN_UNIT = "lengths are in metres"
FREE_UNIT = "the scale of the photo is not known: 1 unit of the scene is written as 1 metre"


@dataclass(frozen=True, eq=False)
class LineGroup:
    """The lines, in ascending id, of one axis that are all boundaries, or all not, and may be of one role and band."""

    axis: int  # 0, 1, 2
    is_boundary: bool
    role: str  # one of ROLES; "" for lines of all roles
    ids: Int  # (N,)
    ends: Float  # (N, 2, 3) m
    band: str  # one of BANDS; "" for lines of all bands, or where the scene does not tell
    probability: Float  # (N,) that the depth is right; (0,) where the scene does not tell
    roles: Text  # (N,) what each line is drawn for: one of ROLES

    @property
    def name(self) -> str:
        """The group's name in every format, such as `lines_x_boundary` or `lines_x_boundary_detail_sure`."""
        return group_name(self.axis, self.is_boundary, self.role, self.band)


@dataclass(frozen=True, eq=False)
class FlatFace:
    """A face with its rings turned towards the camera: the outline counter-clockwise from there, holes clockwise."""

    id: int
    kind: FaceKind
    label: str  # for people: its kind, with a number where there are several, such as `wall 3`
    plane: int  # id of its plane
    axis: int  # 0, 1, 2: the plane's normal
    offset: float  # m
    normal: Float  # (3,) unit, from the plane towards the camera
    in_plane: tuple[int, int]  # the two axes (u, v) in the plane for which u x v is the normal
    rings: tuple[Float, ...]  # outline first, then holes; each (V, 3) m, not closed
    hidden: tuple[Float, ...]  # each (H, 3) m, not closed: parts of it that a thing without a face hides in the photo

    @property
    def name(self) -> str:
        """The face's name in every format, such as `face_0007`."""
        return f"face_{self.id:04d}"

    @cached_property
    def vertices(self) -> Float:
        """(V, 3) m, the points of all rings in their order."""
        return np.concatenate(self.rings)


@dataclass(frozen=True, eq=False)
class Model:
    """The geometry of a scene as the formats write it."""

    groups: tuple[LineGroup, ...]  # x boundary, x nonboundary, y ..., each by ROLES, then BANDS; none is empty
    faces: tuple[FlatFace, ...]  # in ascending id
    photo: str  # name of the photo without its folder: one line of valid Unicode
    unit_note: str  # one ASCII phrase that says what a unit is

    @cached_property
    def points(self) -> Float:
        """(M, 3) m, every line end and every vertex; M is 0 only for an empty scene."""
        ends = [group.ends.reshape(-1, 3) for group in self.groups]
        return np.concatenate([np.zeros((0, 3)), *ends, *(face.vertices for face in self.faces)])


def group_name(axis: int, is_boundary: bool, role: str, band: str) -> str:
    """The name of the group of these lines; role and band may be empty. Outlines are what a name without a role has."""
    kind = "boundary" if is_boundary else "nonboundary"
    return "_".join(["lines", AXES[axis], kind, *(word for word in (role, band) if word not in ("", ROLES[0]))])


def build_model(scene: Scene, by_band: bool = False, by_role: bool = False) -> Model:
    """The groups and faces of a scene in metres; lines shorter than SHORTEST_LINE are left out.

    `by_role` gives the lines of each role a group of their own, `by_band` those of each band, where the scene tells
    probabilities.
    """
    scale = metres_per_unit(scene)
    labels = _labels([face for _, face in scene.faces])
    return Model(
        groups=_line_groups(scene, scale, bands_of(scene.lines) if by_band else None, by_role),
        faces=tuple(_flat_face(plane, face, labels[face.id], scale) for plane, face in scene.faces),
        photo=photo_name(scene),
        unit_note=FREE_UNIT if scene.metres_per_unit is None else KNOWN_UNIT,
    )


def metres_per_unit(scene: Scene) -> float:
    """The factor from the scene's unit to metres; 1 where no length is known."""
    return 1.0 if scene.metres_per_unit is None else scene.metres_per_unit


def photo_name(scene: Scene) -> str:
    """The photo's name without folder, line ends and bytes that are no UTF-8, which would break a file quoting it."""
    return " ".join(Path(scene.photo).name.encode(errors="replace").decode().split())


def _line_groups(scene: Scene, scale: float, bands: Text | None, by_role: bool) -> tuple[LineGroup, ...]:
    lines = scene.lines
    order = np.argsort(lines.id)
    ends = lines.ends * scale
    long_enough = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1) > SHORTEST_LINE
    probability = np.asarray(lines.probability)
    groups = []
    words = (ROLES if by_role else ("",), ("",) if bands is None else BANDS)
    for axis, is_boundary, role, band in product(range(3), (True, False), *words):
        wanted = long_enough & (lines.axis == axis) & (lines.is_boundary == is_boundary)
        if by_role:
            wanted &= lines.role == role
        if bands is not None:
            wanted &= bands == band
        chosen = order[wanted[order]]
        if len(chosen):
            told = probability[chosen] if len(probability) else probability
            drawn_for = np.asarray(lines.role)[chosen]
            groups.append(LineGroup(axis, is_boundary, role, lines.id[chosen], ends[chosen], band, told, drawn_for))
    return tuple(groups)


def _labels(faces: list[Face]) -> dict[int, str]:
    """The label of each face by its id: faces of a kind count from 1, but the only one of its kind has no number."""
    total = Counter(face.kind for face in faces)
    counted: Counter[str] = Counter()
    labels = {}
    for face in faces:
        counted[face.kind] += 1
        labels[face.id] = face.kind if total[face.kind] == 1 else f"{face.kind} {counted[face.kind]}"
    return labels


def _flat_face(plane: Plane, face: Face, label: str, scale: float) -> FlatFace:
    # The camera is the world's origin: it lies on the side of the plane that the offset points away from.
    side = -1.0 if plane.offset > 0 else 1.0
    normal = np.zeros(3)
    normal[plane.axis] = side
    u, v = (plane.axis + 1) % 3, (plane.axis + 2) % 3
    in_plane = (u, v) if side > 0 else (v, u)
    outline = _turned(face.outline * scale, in_plane, counter_clockwise=True)
    holes = [_turned(hole * scale, in_plane, counter_clockwise=False) for hole in face.holes]
    offset, rings, hidden = plane.offset * scale, (outline, *holes), tuple(part * scale for part in face.hidden)
    return FlatFace(face.id, face.kind, label, plane.id, plane.axis, offset, normal, in_plane, rings, hidden)


def _turned(ring: Float, in_plane: tuple[int, int], counter_clockwise: bool) -> Float:
    return ring if (signed_area(ring[:, in_plane]) > 0) == counter_clockwise else ring[::-1]


def signed_area(ring: Float) -> float:
    """The area of a ring (V, 2), positive where it runs counter-clockwise."""
    x, y = (ring - ring[0]).T  # about its first point, so that distance from the origin costs no digits
    return float(0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))
