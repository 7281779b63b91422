"""What every format writes of a scene: lines in groups by axis and kind, flat faces with holes, all in metres.

The axes are the scene's: right-handed, z up. The origin is at the camera, so that every coordinate is small enough for
the float32 of glTF and USD; or straight below it on the ground, where a length and the ground are known.
"""

from dataclasses import dataclass
from functools import cached_property
from itertools import product
from pathlib import Path

import numpy as np

from exporters.bands import BANDS, bands_of
from exporters.faces import FlatFace, Frame, build_faces
from exporters.openings import Fitting, build_fittings
from linecad.arrays import Float, Int, Text
from linecad.directions import axis_name, count_of, directions_of
from linecad.scene import ROLES, Scene, ground_of

SHORTEST_LINE = 1e-9  # m; shorter lines are points to every reader, and the STEP library refuses them

KNOWN_UNIT = "lengths are in metres"
FREE_UNIT = "the scale of the photo is not known: 1 unit of the scene is written as 1 metre"
ON_GROUND = "z = 0 is the ground"  # said behind the unit

ON_THE_GROUND, AT_THE_CAMERA = ORIGINS = ("ground", "camera")  # where the origin of a model is asked for


@dataclass(frozen=True, eq=False)
class LineGroup:
    """The lines, in ascending id, of an axis that are all boundaries or all not; maybe of one role, band, component."""

    axis: int  # number of a direction
    is_boundary: bool
    role: str  # one of ROLES; "" for lines of all roles
    ids: Int  # (N,)
    ends: Float  # (N, 2, 3) m
    band: str  # one of BANDS; "" for lines of all bands, or where the scene does not tell
    probability: Float  # (N,) that the depth is right; (0,) where the scene does not tell
    roles: Text  # (N,) what each line is drawn for: one of ROLES
    component: int  # of the scene; 0 also for lines of all components

    @property
    def name(self) -> str:
        """The group's name in every format, such as `lines_x_boundary` or `lines_x_boundary_detail_sure`."""
        return in_component(group_name(self.axis, self.is_boundary, self.role, self.band), self.component)


@dataclass(frozen=True)
class FlatPlane:
    """A plane of the scene in metres."""

    id: int
    axis: str  # name of the normal's direction
    offset: float  # m
    lines: tuple[int, ...]  # ids of the lines in it
    tilt: float  # rad, by which the normal of a sloped plane is turned from that direction towards the upright


@dataclass(frozen=True, eq=False)
class Model:
    """The geometry of a scene as the formats write it."""

    scene: Scene
    groups: tuple[LineGroup, ...]  # by component, x boundary, x nonboundary, y ..., by ROLES, then BANDS; none is empty
    faces: tuple[FlatFace, ...]  # in ascending id
    fittings: tuple[Fitting, ...]  # the same faces again, as far as they are of openings; in ascending id
    planes: tuple[FlatPlane, ...]  # all of the scene, also those without a face, in its order
    eye: Float  # (3,) m, where the camera stands
    photo: str  # name of the photo without its folder: one line of valid Unicode
    unit_note: str  # one ASCII phrase that says what a unit is

    @property
    def components(self) -> tuple[int, ...]:
        """Those of the scene that have lines or faces here, ascending; 0 alone where they are not parted."""
        return tuple(sorted({group.component for group in self.groups} | {face.component for face in self.faces}))

    @property
    def loose_faces(self) -> tuple[FlatFace, ...]:
        """The faces that are of no opening."""
        return tuple(face for face in self.faces if face.opening is None)

    @property
    def equal_fittings(self) -> tuple[tuple[Fitting, ...], ...]:
        """The fittings, all equal ones together."""
        equal: dict[int, list[Fitting]] = {}
        for fitting in self.fittings:
            equal.setdefault(fitting.model, []).append(fitting)
        return tuple(map(tuple, equal.values()))

    @cached_property
    def points(self) -> Float:
        """(M, 3) m, every line end and every vertex; M is 0 only for an empty scene."""
        ends = [group.ends.reshape(-1, 3) for group in self.groups]
        return np.concatenate([np.zeros((0, 3)), *ends, *(face.vertices for face in self.faces)])


def group_name(axis: int, is_boundary: bool, role: str, band: str) -> str:
    """The name of the group of these lines; role and band may be empty. Outlines are what a name without a role has."""
    kind = "boundary" if is_boundary else "nonboundary"
    return "_".join(["lines", axis_name(axis), kind, *(word for word in (role, band) if word not in ("", ROLES[0]))])


def in_component(name: str, component: int) -> str:
    """The name of what is of a component; that of component 0 is the plain one."""
    return f"{name}_component_{component}" if component else name


def build_model(
    scene: Scene,
    by_band: bool = False,
    by_role: bool = False,
    origin: str = AT_THE_CAMERA,
    by_component: bool = False,
) -> Model:
    """The groups and faces of a scene in metres; lines shorter than SHORTEST_LINE are left out.

    `by_role` gives the lines of each role a group of their own, `by_band` those of each band, where the scene tells
    probabilities; `by_component` parts lines and faces by the components of the scene. `origin` is
    one of ORIGINS: the ground is z = 0 where the scene has it and its scale is known.
    """
    ground = _ground_height(scene) if origin == ON_THE_GROUND else None
    eye = np.array([0.0, 0.0, 0.0 if ground is None else -ground])
    frame = Frame(metres_per_unit(scene), eye, directions_of(scene.turns), scene.turns)
    faces = build_faces(scene, frame, by_component)
    unit = FREE_UNIT if scene.metres_per_unit is None else KNOWN_UNIT
    return Model(
        scene=scene,
        groups=_line_groups(scene, frame, bands_of(scene.lines) if by_band else None, by_role, by_component),
        faces=faces,
        fittings=build_fittings(scene.openings, faces),
        planes=tuple(
            FlatPlane(each.id, axis_name(each.axis), frame.offset(each), each.lines, each.tilt) for each in scene.planes
        ),
        eye=frame.eye,
        photo=photo_name(scene),
        unit_note=unit if ground is None else f"{unit}; {ON_GROUND}",
    )


def _ground_height(scene: Scene) -> float | None:
    """m from the camera up to the ground, so negative; None where the scene tells no scale or no ground below it.

    Of several planes with faces of the ground the lowest counts, as where a camera's height is measured from.
    """
    ground = ground_of(scene.planes)
    return None if ground is None or scene.metres_per_unit is None else ground.offset * scene.metres_per_unit


def metres_per_unit(scene: Scene) -> float:
    """The factor from the scene's unit to metres; 1 where no length is known."""
    return 1.0 if scene.metres_per_unit is None else scene.metres_per_unit


def photo_name(scene: Scene) -> str:
    """The photo's name without folder, line ends and bytes that are no UTF-8, which would break a file quoting it."""
    return " ".join(Path(scene.photo).name.encode(errors="replace").decode().split())


def _line_groups(
    scene: Scene, frame: Frame, bands: Text | None, by_role: bool, by_component: bool
) -> tuple[LineGroup, ...]:
    lines, directions = scene.lines, count_of(scene.turns)
    order = np.argsort(lines.id)
    ends = frame(lines.ends)
    long_enough = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1) > SHORTEST_LINE
    probability = np.asarray(lines.probability)
    groups = []
    component = lines.component if by_component else np.zeros(len(lines), np.int64)
    words = (ROLES if by_role else ("",), ("",) if bands is None else BANDS)
    for own, axis, is_boundary, role, band in product(
        np.unique(component).tolist(), range(directions), (True, False), *words
    ):
        wanted = long_enough & (component == own) & (lines.axis == axis) & (lines.is_boundary == is_boundary)
        if by_role:
            wanted &= lines.role == role
        if bands is not None:
            wanted &= bands == band
        chosen = order[wanted[order]]
        if len(chosen):
            told = probability[chosen] if len(probability) else probability
            drawn_for = np.asarray(lines.role)[chosen]
            groups.append(
                LineGroup(axis, is_boundary, role, lines.id[chosen], ends[chosen], band, told, drawn_for, own)
            )
    return tuple(groups)
