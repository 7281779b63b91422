"""A scene as planar parallelograms and triangles, straight edges and bodies, and the walls and boxes it is built of.

Building frame: metres, z up, the ground at 0, x to the right of the street, y along it. A *body* is one thing that
stands by itself: a building, a car, a tree. A *wall frame* has its own coordinates: `along` the wall, `up`, and `out`
of it towards whoever looks at it.
"""

from dataclasses import dataclass, field
from itertools import pairwise
from typing import Literal

import numpy as np

from linecad.arrays import Float, Int

Interval = tuple[float, float]
Point = tuple[float, float, float]
Pattern = Literal["plain", "brick", "panel", "ashlar", "slabs", "asphalt", "glass", "paint", "leaves", "tiles"]

BODY_KINDS = ("ground", "building", "car", "tree", "lamp", "furniture")
BodyKind = Literal["ground", "building", "car", "tree", "lamp", "furniture"]
SAME = 1e-6  # m; a piece shorter than that is none
X, Y, UP = np.eye(3)


@dataclass(frozen=True)
class Material:
    """How a surface looks: a pattern in one colour, sRGB from 0 to 1."""

    pattern: Pattern
    colour: Point


def tinted(colour: Point, shade: float, tint: Float) -> Point:
    """A colour that much lighter or darker, and with (3,) added, sRGB from 0 to 1."""
    red, green, blue = np.clip(np.array(colour) * shade + tint, 0.05, 0.95).round(3)
    return float(red), float(green), float(blue)


@dataclass(eq=False)
class Model:
    """Quads and edges in the order in which they were built."""

    corners: list[Float] = field(default_factory=list)  # each (3, 3): a corner and its two neighbours
    materials: list[Material] = field(default_factory=list)
    body: list[int] = field(default_factory=list)
    ends: list[Float] = field(default_factory=list)  # each (2, 3)
    edge_body: list[int] = field(default_factory=list)
    kinds: list[BodyKind] = field(default_factory=list)  # of the bodies
    openings: list[Float] = field(default_factory=list)  # windows and doors in walls, each (3, 3) as in `corners`
    opening_is_door: list[bool] = field(default_factory=list)
    opening_body: list[int] = field(default_factory=list)
    triangles: list[int] = field(default_factory=list)  # the quads that are but half a parallelogram
    has_frames: bool = False  # walls may stand at any angle; the truth then tells the frames
    rounding: float = 0.0  # m, by which corners may lie off their planes

    def start_body(self, kind: BodyKind) -> None:
        """What is added from here on belongs to a new body."""
        self.kinds.append(kind)

    def quad(self, corner: Float, first: Float, second: Float, material: Material) -> None:
        """Add the parallelogram of a corner and its two sides; it is seen from both."""
        self.corners.append(np.array([corner, corner + first, corner + second]))
        self.materials.append(material)
        self.body.append(len(self.kinds) - 1)

    def triangle(self, first: Float, second: Float, third: Float, material: Material) -> None:
        """Add the triangle of three points."""
        self.triangles.append(len(self.corners))
        self.quad(first, second - first, third - first, material)

    def edge(self, start: Float, end: Float) -> None:
        """Add a straight edge."""
        self.ends.append(np.array([start, end]))
        self.edge_body.append(len(self.kinds) - 1)

    def outline(self, corner: Float, first: Float, second: Float, material: Material) -> None:
        """Add a parallelogram with its four sides as edges."""
        self.quad(corner, first, second, material)
        for start, side in ((corner, first), (corner + second, first), (corner, second), (corner + first, second)):
            self.edge(start, start + side)

    def box(self, corner: Float, sides: tuple[Float, Float, Float], material: Material, skip: str = "") -> None:
        """Add a box of three sides a, b, c; `skip` names faces that nobody can see: "-a" is the one at the corner.

        An edge is left out where both its faces are.
        """
        missing = set(skip.split())
        for index, name in enumerate("abc"):
            side, first, second = sides[index], sides[index - 2], sides[index - 1]
            names = "abcabc"[index + 1 : index + 3]
            for end, place in (("-", corner), ("+", corner + side)):
                if end + name not in missing:
                    self.quad(place, first, second, material)
            for one in (0, 1):
                for other in (0, 1):
                    faces = {"-+"[one] + names[0], "-+"[other] + names[1]}
                    if not faces <= missing:
                        start = corner + one * first + other * second
                        self.edge(start, start + side)

    def sweep(self, profile: Float, side: Float, materials: list[Material]) -> None:
        """Add the surface that a line of points (N, 3) sweeps along `side`, one material for each of N - 1 pieces."""
        for start, end, material in zip(profile[:-1], profile[1:], materials, strict=True):
            self.quad(start, end - start, side, material)
            self.edge(start, end)
            self.edge(start + side, end + side)
        for point in profile:
            self.edge(point, point + side)

    def quads(self, eye: Float) -> Float:
        """(Q, 4, 3) corners in order around, m, counted from a point `eye` (3,) of the building frame."""
        corners = np.array(self.corners).reshape(-1, 3, 3) - eye
        return halved(parallelograms(corners), np.array(self.triangles, np.int64))

    def edges(self) -> tuple[Float, Int]:
        """Ends (M, 2, 3), m, and bodies (M,) of the different edges that are not points."""
        ends = np.array(self.ends).reshape(-1, 2, 3)
        bodies = np.array(self.edge_body, np.int64)
        keys = np.round(ends / SAME).astype(np.int64)
        backwards = [tuple(start) > tuple(end) for start, end in keys.tolist()]
        keys[backwards] = keys[backwards][:, ::-1]
        _, first = np.unique(keys.reshape(-1, 6), axis=0, return_index=True)
        kept = np.sort(first[(keys[first, 0] != keys[first, 1]).any(axis=1)])
        return ends[kept], bodies[kept]


def parallelograms(corners: Float) -> Float:
    """(Q, 4, 3) corners in order around of parallelograms given by a corner and its two neighbours (Q, 3, 3)."""
    origin, first, second = corners[:, 0], corners[:, 1], corners[:, 2]
    quads: Float = np.stack([origin, first, first + second - origin, second], axis=1)
    return quads


def halved(quads: Float, triangles: Int) -> Float:
    """The quads (Q, 4, 3) of which those in `triangles` (T,) end at the diagonal: their third corner is its middle."""
    quads[triangles, 2] = (quads[triangles, 1] + quads[triangles, 3]) / 2
    return quads


@dataclass(eq=False)
class Wall:
    """The frame of a vertical wall, in which openings are cut and things are put."""

    model: Model
    origin: Float  # (3,) the foot of its start, m
    along: Float  # (3,) unit vector
    out: Float  # (3,) unit vector, towards whoever looks at it
    openings: list[tuple[Interval, Interval]] = field(default_factory=list)  # along and up, m

    def at(self, along: float, up: float, out: float = 0.0) -> Float:
        """The point of these coordinates."""
        point: Float = self.origin + along * self.along + up * UP + out * self.out
        return point

    def box(self, along: Interval, up: Interval, out: Interval, material: Material, skip: str = "-c") -> None:
        """Add a box; its sides a, b, c run along, up and out, and its back is left out unless told otherwise."""
        sides = ((along[1] - along[0]) * self.along, (up[1] - up[0]) * UP, (out[1] - out[0]) * self.out)
        self.model.box(self.at(along[0], up[0], out[0]), sides, material, skip)

    def panel(self, along: Interval, up: Interval, out: float, material: Material) -> None:
        """Add a parallelogram parallel to the wall, without edges."""
        corner = self.at(along[0], up[0], out)
        self.model.quad(corner, (along[1] - along[0]) * self.along, (up[1] - up[0]) * UP, material)

    def name_opening(self, along: Interval, up: Interval, is_door: bool = False) -> None:
        """Say that a window or a door is here; nothing is cut or added."""
        self.model.openings.append(
            np.array([self.at(along[0], up[0]), self.at(along[1], up[0]), self.at(along[0], up[1])])
        )
        self.model.opening_is_door.append(is_door)
        self.model.opening_body.append(len(self.model.kinds) - 1)

    def opening(self, along: Interval, up: Interval, deep: float, reveal: Material, is_door: bool = False) -> None:
        """Cut a hole (before `build` is called) and line it."""
        self.openings.append((along, up))
        self.name_opening(along, up, is_door)
        self.box(along, up, (-deep, 0.0), reveal, "-c +c")

    def build(self, along: Interval, up: Interval, material: Material) -> None:
        """Add the wall itself around the openings that lie in it, in as few strips as their rows allow."""
        inside = [(sides, rows) for sides, rows in self.openings if up[0] - SAME < rows[0] and rows[1] < up[1] + SAME]
        cuts = sorted({up[0], up[1], *(end for _, rows in inside for end in rows)})
        bands: list[tuple[Interval, list[Interval]]] = []
        for low, high in pairwise(cuts):
            if high - low < SAME:
                continue
            holes = sorted(sides for sides, rows in inside if rows[0] < high - SAME and rows[1] > low + SAME)
            if bands and bands[-1][1] == holes:
                bands[-1] = ((bands[-1][0][0], high), holes)
            else:
                bands.append(((low, high), holes))
        for band, holes in bands:
            starts = [along[0], *(hole[1] for hole in holes)]
            ends = [*(hole[0] for hole in holes), along[1]]
            for start, end in zip(starts, ends, strict=True):
                if end - start > SAME:
                    self.panel((start, end), band, 0.0, material)
