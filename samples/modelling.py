"""Scenes made of axis-aligned rectangles: faces with holes, boxes, and walls with windows and doors.

World frame, metres: x right, y away, z up. A *face* is a rectangle that is seen from one side; its plane coordinates
are the two other world axes in ascending order, so that the second one of a vertical face is always z. A *wall frame*
has its own coordinates: `along` the wall, `up`, and `out` of it towards whoever looks at it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Float = NDArray[np.float64]
Interval = tuple[float, float]
PLANE_AXES = {0: (1, 2), 1: (0, 2), 2: (0, 1)}


@dataclass(frozen=True, eq=False)
class Hits:
    """Where rays meet one face."""

    u: Float  # (N,) first plane coordinate, m
    v: Float  # (N,) second plane coordinate, m
    rays: Float  # (N, 3) world direction of the rays that came here, camera depth 1
    footprint: Float  # (N,) size of a pixel on the face, m


@dataclass(frozen=True, eq=False)
class Surface:
    """How a face looks."""

    albedo: Callable[[Hits], Float]  # to (N, 3) linear RGB, 0 to 1
    mirror: float = 0.0  # share of the surroundings that it mirrors
    glow: float = 0.0  # radiance of its own in units of its albedo
    casts: bool = True  # whether it throws shadows


@dataclass(frozen=True, eq=False)
class Face:
    """An axis-aligned rectangle, seen from the side to which its normal points."""

    axis: int  # of the normal
    sign: int  # of the normal
    offset: float  # m, the coordinate `axis` of all its points
    low: tuple[float, float]  # m, plane coordinates
    high: tuple[float, float]  # m
    surface: Surface
    holes: tuple[tuple[float, float, float, float], ...] = ()  # low u, low v, high u, high v

    def corners(self, rectangle: tuple[float, float, float, float] | None = None) -> Float:
        """(4, 3) world corners, in order around the face or around one of its holes."""
        u0, v0, u1, v1 = rectangle or (*self.low, *self.high)
        corners = np.empty((4, 3))
        corners[:, self.axis] = self.offset
        corners[:, PLANE_AXES[self.axis][0]] = (u0, u1, u1, u0)
        corners[:, PLANE_AXES[self.axis][1]] = (v0, v0, v1, v1)
        return corners

    def covers(self, u: Float, v: Float) -> NDArray[np.bool_]:
        """Whether plane points lie on the face; its border belongs to it."""
        inside = (u >= self.low[0]) & (u <= self.high[0]) & (v >= self.low[1]) & (v <= self.high[1])
        for u0, v0, u1, v1 in self.holes:
            inside &= ~((u > u0) & (u < u1) & (v > v0) & (v < v1))
        return inside

    @property
    def area(self) -> float:
        """m^2, holes not taken off."""
        return (self.high[0] - self.low[0]) * (self.high[1] - self.low[1])


@dataclass(eq=False)
class Model:
    """Faces in the order in which they were built."""

    faces: list[Face] = field(default_factory=list)

    def face(
        self,
        axis: int,
        sign: int,
        offset: float,
        u: Interval,
        v: Interval,
        surface: Surface,
        holes: Iterable[tuple[float, float, float, float]] = (),
    ) -> None:
        """Add one face."""
        self.faces.append(Face(axis, sign, offset, (u[0], v[0]), (u[1], v[1]), surface, tuple(holes)))

    def box(self, x: Interval, y: Interval, z: Interval, surface: Surface, skip: str = "") -> None:
        """Add a box; `skip` names faces that touch something and are never seen: "-x", "+z" ..."""
        spans = (x, y, z)
        for axis in range(3):
            u, v = (spans[other] for other in PLANE_AXES[axis])
            for sign, offset in ((-1, spans[axis][0]), (1, spans[axis][1])):
                if f"{'+' if sign > 0 else '-'}{'xyz'[axis]}" not in skip:
                    self.face(axis, sign, offset, u, v, surface)

    def edges(self) -> tuple[Float, NDArray[np.int64]]:
        """Ends (N, 2, 3) of the different borders of all faces and holes, and the axis (N,) of each."""
        found: dict[tuple[float, ...], int] = {}
        for face in self.faces:
            for rectangle in (None, *face.holes):
                corners = face.corners(rectangle)
                for first, second in zip(corners, np.roll(corners, -1, axis=0), strict=True):
                    ends = np.sort(np.stack([first, second]), axis=0)
                    key = tuple(float(value) + 0.0 for value in ends.round(6).ravel())
                    found[key] = int(np.argmax(ends[1] - ends[0]))
        return np.array(list(found)).reshape(-1, 2, 3), np.array(list(found.values()), np.int64)


class WallFrame:
    """A vertical wall whose parts are placed along it, up it and out of it."""

    def __init__(self, model: Model, axis: int, sign: int, offset: float) -> None:
        self.model, self.axis, self.sign, self.offset = model, axis, sign, offset
        self.holes: list[tuple[float, float, float, float]] = []

    def box(self, along: Interval, up: Interval, out: Interval, surface: Surface, skip_back: bool = True) -> None:
        """Add a box; its back touches the wall, or what lies behind, unless told otherwise."""
        near, far = (self.offset + self.sign * distance for distance in out)
        depth = (min(near, far), max(near, far))
        back = ("-" if self.sign > 0 else "+") + "xy"[self.axis]
        x, y = (depth, along) if self.axis == 0 else (along, depth)
        self.model.box(x, y, up, surface, back if skip_back else "")

    def hole(self, along: Interval, up: Interval, deep: float, reveal: Surface, sill: bool = True) -> None:
        """Cut a hole into the wall (before `wall` is called) and line its sides with `reveal`."""
        self.holes.append((along[0], up[0], along[1], up[1]))
        bottom = sorted((self.offset, self.offset - self.sign * deep))
        depth = (bottom[0], bottom[1])
        other = 1 - self.axis
        for sign, offset in ((1, along[0]), (-1, along[1])):
            self.model.face(other, sign, offset, depth, up, reveal)
        u, v = (depth, along) if self.axis == 0 else (along, depth)
        self.model.face(2, -1, up[1], u, v, reveal)
        if sill:
            self.model.face(2, 1, up[0], u, v, reveal)

    def panel(self, along: Interval, up: Interval, out: float, surface: Surface) -> None:
        """Add a face parallel to the wall."""
        self.model.face(self.axis, self.sign, self.offset + self.sign * out, along, up, surface)

    def wall(self, along: Interval, up: Interval, surface: Surface) -> None:
        """Add the wall itself, with all holes cut so far inside it."""
        inside = [hole for hole in self.holes if along[0] <= hole[0] < along[1] and up[0] <= hole[1] < up[1]]
        self.model.face(self.axis, self.sign, self.offset, along, up, surface, inside)

    def window(
        self,
        along: Interval,
        up: Interval,
        reveal: Surface,
        frame: Surface,
        glass: Surface,
        panes: tuple[int, int] = (2, 2),
        deep: float = 0.18,
        bar: float = 0.06,
    ) -> None:
        """Add a recessed window of `panes` (columns, rows)."""
        self.hole(along, up, deep, reveal)
        self.panel(along, up, -deep, glass)
        out = (-deep, -deep + 0.05)
        columns, rows = panes
        for index in range(columns + 1):
            width = bar if index in (0, columns) else 0.7 * bar
            middle = along[0] + (along[1] - along[0]) * index / columns
            start = min(max(middle - width / 2, along[0]), along[1] - width)
            self.box((start, start + width), up, out, frame)
        for index in range(rows + 1):
            width = bar if index in (0, rows) else 0.7 * bar
            middle = up[0] + (up[1] - up[0]) * index / rows
            start = min(max(middle - width / 2, up[0]), up[1] - width)
            self.box(along, (start, start + width), (out[0], out[1] - 0.004), frame)

    def sill(self, along: Interval, top: float, surface: Surface, over: float = 0.08, out: float = 0.13) -> None:
        """Add a sill below a window."""
        self.box((along[0] - over, along[1] + over), (top - 0.09, top), (0, out), surface)

    def surround(self, along: Interval, up: Interval, surface: Surface, width: float = 0.16, out: float = 0.04) -> None:
        """Add a flat frame on the wall around an opening: two posts and a lintel."""
        self.box((along[0] - width, along[0]), up, (0, out), surface)
        self.box((along[1], along[1] + width), up, (0, out), surface)
        self.box((along[0] - 1.4 * width, along[1] + 1.4 * width), (up[1], up[1] + width), (0, 1.5 * out), surface)
