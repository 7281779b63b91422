"""What is flat in a scene: planes, their faces, and the openings in walls."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from linecad.arrays import Float, freeze, read_only_rings
from linecad.directions import UP, Turns, components, directions_of
from linecad.scene.words import FACE_KINDS, OPENING_KINDS, FaceKind, OpeningKind


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
        read_only_rings(f"Face {self.id}", [self.outline])
        for name in ("holes", "hidden"):
            object.__setattr__(self, name, read_only_rings(f"Face {self.id}", getattr(self, name)))
        if self.kind not in FACE_KINDS:
            raise ValueError(f"Face {self.id} is a {self.kind!r}, expected one of {', '.join(FACE_KINDS)}")


@dataclass(frozen=True, eq=False)
class Plane:
    """A plane: all points whose component along its normal is `offset`.

    The normal is the direction `axis`; that of a sloped plane is a level one, turned by `tilt` towards the upright.
    """

    id: int  # unique in the scene
    axis: int  # number of a direction: the normal, or what it is turned from
    offset: float  # world, in the scene's unit
    lines: tuple[int, ...]  # ids of the lines in it
    faces: tuple[Face, ...] = ()
    tilt: float = 0.0  # rad, between 0 and pi; 0 of planes along the directions, else of a roof
    # The median probability of all its lines, where `keep_drawn` left some out; None elsewhere, and in no file.
    told: float | None = None

    def __post_init__(self) -> None:
        if not 0 <= self.tilt < np.pi or (self.tilt and self.axis == UP):
            raise ValueError(
                f"Plane {self.id} has axis {self.axis} and tilt {self.tilt}, expected less than pi, 0 of z"
            )
        if self.axis < 0 or not np.isfinite(self.offset):
            found = f"axis {self.axis} and offset {self.offset}"
            raise ValueError(f"Plane {self.id} has {found}, expected 0 or more and a finite number")

    def normal(self, turns: Turns) -> Float:
        """(3,) unit vector in the world, in a scene whose further frames have such turns."""
        level: Float = directions_of(turns)[self.axis]
        if not self.tilt:
            return level
        tilted: Float = np.cos(self.tilt) * level + np.sin(self.tilt) * np.eye(3)[UP]
        return tilted

    def along_normal(self, points: Float, turns: Turns) -> Float:
        """(...) components of world points (..., 3) along the normal: `offset` for those in the plane."""
        along: Float = points @ self.normal(turns) if self.tilt else components(points, turns)[..., self.axis]
        return along

    @property
    def shows_ground(self) -> bool:
        """Whether it is a horizontal plane below the camera with a face of the ground."""
        return self.axis == 2 and self.offset < 0 and any(face.kind == "ground" for face in self.faces)


def ground_of(planes: Iterable[Plane]) -> Plane | None:
    """The plane that counts as the ground: the lowest that shows it; None where none does."""
    return min((plane for plane in planes if plane.shows_ground), key=lambda plane: plane.offset, default=None)


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
