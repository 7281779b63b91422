"""The faces of a scene as the formats write them: flat, with holes, turned to whoever looks at them, named for people.

A *thing* is what a person counts: an opening, with its pane and its reveals, or a face that is of no opening.
"""

from collections import Counter
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from linecad.arrays import Float
from linecad.directions import Turns
from linecad.scene import Face, FaceKind, Opening, Plane, Scene


@dataclass(frozen=True, eq=False)
class Frame:
    """From the scene's frame to that of the formats."""

    metres: float  # per unit of the scene
    eye: Float  # (3,) m, where the camera stands
    directions: Float  # (K, 3) unit vectors that lines and normals run along
    turns: Turns = ()  # of further frames

    def __call__(self, points: Float) -> Float:
        """Points (..., 3) of the scene in metres."""
        scaled: Float = points * self.metres
        return scaled + self.eye if self.eye.any() else scaled  # a sum with 0 would turn -0.0 around

    def offset(self, plane: Plane) -> float:
        """Where a plane cuts its axis, in metres."""
        offset = plane.offset * self.metres
        return offset + float(self.direction(plane) @ self.eye) if self.eye.any() else offset

    def direction(self, plane: Plane) -> Float:
        """(3,) the unit vector along which a plane's offset is measured."""
        return plane.normal(self.turns) if plane.tilt else self.directions[plane.axis]


@dataclass(frozen=True, eq=False)
class FlatFace:
    """A face with its rings turned to the side that is looked at: the outline counter-clockwise, holes clockwise.

    That is the side of the camera, but of a reveal the inside of its opening.
    """

    id: int
    kind: FaceKind
    thing: str  # for people, what it is or belongs to: a kind, with a number where there are several, such as `wall 3`
    plane: int  # id of its plane
    axis: int  # number of the direction that is the plane's normal, or that a sloped plane's is turned from
    tilt: float  # rad, by which it is turned towards the upright; 0 of all but sloped planes
    direction: Float  # (3,) unit vector along it
    offset: float  # m
    normal: Float  # (3,) unit, from the plane to the side that is looked at
    # Two coordinates (u, v) of the world for which u x v is on the side of the normal: the two in the plane, and in one
    # of a further frame those in which it looks widest.
    in_plane: tuple[int, int]
    rings: tuple[Float, ...]  # outline first, then holes; each (V, 3) m, not closed
    hidden: tuple[Float, ...]  # each (H, 3) m, not closed: parts of it that something hides in the photo
    opening: int | None  # id of the opening that it is the pane or a reveal of
    component: int  # of the scene, where these are parted; else 0

    @property
    def name(self) -> str:
        """The face's name in every format, such as `face_0007`."""
        return f"face_{self.id:04d}"

    @property
    def label(self) -> str:
        """What it is called for people, such as `wall 3`, `window 12` or `reveal of window 12`."""
        return self.thing if self.kind != "reveal" or self.opening is None else f"reveal of {self.thing}"

    @cached_property
    def vertices(self) -> Float:
        """(V, 3) m, the points of all rings in their order."""
        return np.concatenate(self.rings)

    @property
    def foot(self) -> Float:
        """(3,) m, where the face stands: the middle of the box around it, at its lowest."""
        low, high = self.vertices.min(axis=0), self.vertices.max(axis=0)
        return np.array([(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, low[2]])

    def moved(self, by: Float) -> "FlatFace":
        """The same face elsewhere; `by` is (3,) m."""
        rings, hidden = (tuple(ring + by for ring in each) for each in (self.rings, self.hidden))
        return replace(self, offset=self.offset + float(self.direction @ by), rings=rings, hidden=hidden)


def build_faces(scene: Scene, frame: Frame, by_component: bool = False) -> tuple[FlatFace, ...]:
    """All faces of a scene, in ascending id; they tell their components where that is asked for."""
    components = scene.components_of_faces if by_component else {}
    openings = {opening.id: opening for opening in scene.openings}
    things = _things(scene, openings)
    made = []
    for plane, face in scene.faces:
        opening = None if face.opening is None else openings[face.opening]
        flat = _flat_face(plane, face, opening, things[_key(face)], frame)
        made.append(replace(flat, component=components.get(face.id, 0)))
    return tuple(made)


def _key(face: Face) -> tuple[bool, int]:
    """What tells a thing from others: whether it is an opening, and the id of the opening or of the face."""
    return (False, face.id) if face.opening is None else (True, face.opening)


def _things(scene: Scene, openings: dict[int, Opening]) -> dict[tuple[bool, int], str]:
    """What each thing is called, by its key.

    Things of a kind count from 1 in the order of their first faces, but the only one of its kind has no number.
    """
    kinds = {_key(face): face.kind if face.opening is None else openings[face.opening].kind for _, face in scene.faces}
    total, counted, names = Counter(kinds.values()), Counter[str](), {}
    for key, kind in kinds.items():
        counted[kind] += 1
        names[key] = kind if total[kind] == 1 else f"{kind} {counted[kind]}"
    return names


def _flat_face(plane: Plane, face: Face, opening: Opening | None, thing: str, frame: Frame) -> FlatFace:
    side = _side(plane, face, opening)
    direction = frame.direction(plane)
    normal = np.where(direction == 0, 0.0, side * direction)
    steepest = int(np.abs(normal).argmax())
    u, v = (steepest + 1) % 3, (steepest + 2) % 3
    in_plane = (u, v) if normal[steepest] > 0 else (v, u)
    outline = _turned(frame(face.outline), in_plane, counter_clockwise=True)
    holes = [_turned(frame(hole), in_plane, counter_clockwise=False) for hole in face.holes]
    rings, hidden = (outline, *holes), tuple(frame(part) for part in face.hidden)
    return FlatFace(
        id=face.id,
        kind=face.kind,
        thing=thing,
        plane=plane.id,
        axis=plane.axis,
        tilt=plane.tilt,
        direction=direction,
        offset=frame.offset(plane),
        normal=normal,
        in_plane=in_plane,
        rings=rings,
        hidden=hidden,
        opening=face.opening,
        component=0,
    )


def _side(plane: Plane, face: Face, opening: Opening | None) -> float:
    """1 where a face looks along its axis, -1 where against it."""
    if opening is not None and face.kind == "reveal":
        # Not the camera's side: a jamb that hides its inside would look into its wall, and no two windows be equal.
        low, high = (opening.v0, opening.v1) if plane.axis == 2 else (opening.u0, opening.u1)
        return 1.0 if plane.offset < (low + high) / 2 else -1.0
    # The camera is the world's origin: it lies on the side of the plane that the offset points away from.
    return -1.0 if plane.offset > 0 else 1.0


def _turned(ring: Float, in_plane: tuple[int, int], counter_clockwise: bool) -> Float:
    return ring if (signed_area(ring[:, in_plane]) > 0) == counter_clockwise else ring[::-1]


def signed_area(ring: Float) -> float:
    """The area of a ring (V, 2), positive where it runs counter-clockwise."""
    x, y = (ring - ring[0]).T  # about its first point, so that distance from the origin costs no digits
    return float(0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))
