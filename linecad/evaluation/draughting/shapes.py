"""The faces of a scene laid flat, and which of them pixels show."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely

from linecad.arrays import Float, Int
from linecad.directions import MAIN, Turns, across, components, directions_of
from linecad.geometry import ring_sides, world_rays
from linecad.scene import Face, Plane, Scene

NO_FACE = -1
SAME_DIRECTION = 1e-9  # sine of the turn at a corner that is none


@dataclass(frozen=True, eq=False)
class Shape:
    """One face in the two coordinates of its plane."""

    plane: Plane
    face: Face
    depth: float  # median camera depth of its corners, in the scene's unit
    turns: Turns = ()  # of further frames

    def flat(self, ring: Float) -> Float:
        """World points (V, 3) of its plane in the two axes of the plane, ascending."""
        flat: Float = components(ring, self.turns)[:, np.sort(across(np.array(self.plane.axis)))]
        return flat

    def in_world(self, points: Float) -> Float:
        """Points (V, 2) of its plane in the world."""
        if self.plane.axis < MAIN:
            return np.insert(points, self.plane.axis, self.plane.offset, axis=1)
        vectors = directions_of(self.turns)
        sides = np.sort(across(np.array(self.plane.axis)))
        found: Float = points @ vectors[sides] + self.plane.offset * vectors[self.plane.axis]
        return found

    @property
    def is_upright(self) -> bool:
        """Whether it is part of a wall."""
        return self.plane.axis != 2

    @cached_property
    def polygon(self) -> shapely.Polygon:
        """The face with its holes, in its plane."""
        return shapely.Polygon(self.flat(self.face.outline), [self.flat(hole) for hole in self.face.holes])

    @cached_property
    def rings(self) -> tuple[Float, ...]:
        """(V, 2) corners of the outline and then of each hole, without points at which nothing turns."""
        return tuple(corners_of(self.flat(ring)) for ring in (self.face.outline, *self.face.holes))

    @cached_property
    def edges(self) -> Float:
        """(E, 2, 3) both ends of each side of all rings, in the world."""
        return ring_sides(self.in_world(ring) for ring in self.rings)

    @property
    def diagonal(self) -> float:
        """Of the box about its outline."""
        return float(np.linalg.norm(np.ptp(self.rings[0], axis=0)))


def shapes_of(scene: Scene) -> list[Shape]:
    """All faces of a scene, in ascending order of their ids."""
    return [
        Shape(plane, face, float(np.median(face.outline @ scene.rotation[2])), scene.turns)
        for plane, face in scene.faces
        if not plane.tilt
    ]


def corners_of(ring: Float) -> Float:
    """A ring (V, 2) without the points at which it does not turn."""
    before, after = ring - np.roll(ring, 1, axis=0), np.roll(ring, -1, axis=0) - ring
    turn = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    size = np.linalg.norm(before, axis=1) * np.linalg.norm(after, axis=1)
    kept: Float = ring[np.abs(turn) > SAME_DIRECTION * size]
    return kept if len(kept) >= 3 else ring


def nearest_faces(scene: Scene, pixels: Float, faces: list[tuple[Plane, Face]]) -> tuple[Int, Float]:
    """Which of `faces` is nearest on the ray of each pixel (M, 2), NO_FACE for none, and its camera depth (M,), NaN."""
    nearest, which = np.full(len(pixels), np.inf), np.full(len(pixels), NO_FACE)
    directions = world_rays(pixels, scene.camera.matrix, scene.rotation)
    rays = components(directions, scene.turns)
    for number, (plane, face) in enumerate(faces):
        flat = np.sort(across(np.array(plane.axis)))
        with np.errstate(divide="ignore", invalid="ignore"):
            depth = plane.offset / plane.along_normal(directions, scene.turns)
        points = rays[:, flat] * np.where(np.isfinite(depth), depth, 0.0)[:, None]
        shell, *holes = (components(ring, scene.turns)[:, flat] for ring in (face.outline, *face.holes))
        polygon = shapely.Polygon(shell, holes)
        shapely.prepare(polygon)
        hit = shapely.contains_xy(polygon, points) & (depth > 0) & (depth < nearest)
        nearest[hit], which[hit] = depth[hit], number
    return which, np.where(np.isfinite(nearest), nearest, np.nan)
