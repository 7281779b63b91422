"""The faces of a scene laid flat, and what a grid of pixels shows of them."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely

from linecad.arrays import Float, Int
from linecad.evaluation.depth import nearest_faces
from linecad.scene import Face, Plane, Scene

SAME_DIRECTION = 1e-9  # sine of the turn at a corner that is none


@dataclass(frozen=True, eq=False)
class Shape:
    """One face in the two coordinates of its plane."""

    plane: Plane
    face: Face
    depth: float  # median camera depth of its corners, in the scene's unit

    @property
    def flat(self) -> tuple[int, int]:
        """The two axes in its plane, ascending."""
        first, second = (axis for axis in range(3) if axis != self.plane.axis)
        return first, second

    @property
    def is_upright(self) -> bool:
        """Whether it is part of a wall."""
        return self.plane.axis != 2

    @cached_property
    def polygon(self) -> shapely.Polygon:
        """The face with its holes, in its plane."""
        return shapely.Polygon(self.face.outline[:, self.flat], [hole[:, self.flat] for hole in self.face.holes])

    @cached_property
    def rings(self) -> tuple[Float, ...]:
        """(V, 2) corners of the outline and then of each hole, without points at which nothing turns."""
        return tuple(corners_of(ring[:, self.flat]) for ring in (self.face.outline, *self.face.holes))

    @cached_property
    def edges(self) -> Float:
        """(E, 2, 3) both ends of each side of all rings, in the world."""
        found = []
        for ring in self.rings:
            world = np.insert(ring, self.plane.axis, self.plane.offset, axis=1)
            found.append(np.stack([world, np.roll(world, -1, axis=0)], axis=1))
        return np.concatenate(found)

    @property
    def diagonal(self) -> float:
        """Of the box about its outline."""
        return float(np.linalg.norm(np.ptp(self.rings[0], axis=0)))


def shapes_of(scene: Scene) -> list[Shape]:
    """All faces of a scene, in ascending order of their ids."""
    return [Shape(plane, face, float(np.median(face.outline @ scene.rotation[2]))) for plane, face in scene.faces]


def corners_of(ring: Float) -> Float:
    """A ring (V, 2) without the points at which it does not turn."""
    before, after = ring - np.roll(ring, 1, axis=0), np.roll(ring, -1, axis=0) - ring
    turn = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    size = np.linalg.norm(before, axis=1) * np.linalg.norm(after, axis=1)
    kept: Float = ring[np.abs(turn) > SAME_DIRECTION * size]
    return kept if len(kept) >= 3 else ring


def seen_faces(scene: Scene, pixels: Float) -> tuple[Int, Float]:
    """Which face, by its place in `scene.faces`, each pixel (M, 2) shows (NO_FACE for none), and its depth (M,)."""
    return nearest_faces(scene, pixels, scene.faces)
