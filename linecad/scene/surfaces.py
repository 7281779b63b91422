"""What is flat in a scene: planes, their faces, and the openings in walls."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from linecad.arrays import Float, freeze, read_only_rings
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
    """A Manhattan plane: all points whose component along the direction `axis` is `offset`."""

    id: int  # unique in the scene
    axis: int  # number of a direction: the normal
    offset: float  # world, in the scene's unit
    lines: tuple[int, ...]  # ids of the lines in it
    faces: tuple[Face, ...] = ()

    def __post_init__(self) -> None:
        if self.axis < 0 or not np.isfinite(self.offset):
            found = f"axis {self.axis} and offset {self.offset}"
            raise ValueError(f"Plane {self.id} has {found}, expected 0 or more and a finite number")

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
