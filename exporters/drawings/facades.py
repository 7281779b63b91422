"""Which facades a scene has: its upright planes with a wall, the largest first."""

from dataclasses import dataclass

import numpy as np

from exporters.faces import FlatFace, signed_area
from exporters.model import Model
from linecad.arrays import Float
from linecad.directions import UP
from linecad.errors import OutputError

_FEW = 12  # facades that a message names
_OF_WALLS = ("wall", "other")  # kinds of faces that make a facade; all are `other` in files of earlier versions


@dataclass(frozen=True, eq=False)
class Facade:
    """An upright plane with its walls."""

    number: int  # 0 is the largest
    plane: int  # id
    normal: Float  # (3,) unit, level, to the side of the camera
    faces: tuple[FlatFace, ...]  # its walls, without what lies in openings

    @property
    def right(self) -> Float:
        """(3,) unit: to the right for who stands before it."""
        turned: Float = np.cross(np.eye(3)[UP], self.normal) + 0.0  # no minus before a zero
        return turned

    @property
    def area(self) -> float:
        """m^2 within the outlines of its walls, with their openings."""
        return sum(_area(face) for face in self.faces)


def _area(face: FlatFace) -> float:
    return abs(signed_area(face.rings[0][:, face.in_plane])) / float(np.abs(face.normal).max())


def facades_of(model: Model) -> list[Facade]:
    """All facades, the largest first; equal ones by the ids of their planes."""
    walls: dict[int, list[FlatFace]] = {}
    for face in model.faces:
        if face.axis != UP and not face.tilt and face.kind in _OF_WALLS:
            walls.setdefault(face.plane, []).append(face)
    found = [Facade(0, plane, faces[0].normal, tuple(faces)) for plane, faces in walls.items()]
    found.sort(key=lambda each: (-each.area, each.plane))
    return [Facade(number, each.plane, each.normal, each.faces) for number, each in enumerate(found)]


def facade_at(model: Model, number: int) -> Facade:
    """A facade by its number; OutputError where the scene has none or not so many."""
    facades = facades_of(model)
    if not facades:
        raise OutputError("a drawing shows walls and the scene has no upright face; export .dxf for its lines")
    if number >= len(facades):
        raise OutputError(f"there is no facade {number}; {_listed(facades)}")
    return facades[number]


def number_of_plane(model: Model, plane: int) -> int:
    """The number of the facade that a plane is; OutputError where it is none."""
    facades = facades_of(model)
    for facade in facades:
        if facade.plane == plane:
            return facade.number
    if not facades:
        return facade_at(model, 0).number  # says that there is none
    known = any(each.id == plane for each in model.planes)
    found = f"plane {plane} has no upright wall" if known else f"there is no plane {plane}"
    raise OutputError(f"{found}; {_listed(facades)}")


def _listed(facades: list[Facade]) -> str:
    shown = ", ".join(f"{each.number} (plane {each.plane})" for each in facades[:_FEW])
    more = len(facades) - _FEW
    return f"the facades are {shown}" + (f" and {more} more" if more > 0 else "")
