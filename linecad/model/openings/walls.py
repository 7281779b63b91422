"""The lines around each wall, as they stand in its plane: what windows and doors are looked for in.

A *wall* here is a vertical plane and what stands a little before or behind it: frames, panes, sills. Its lines are seen
in the plane of the wall, on the rays of the photo; so are a frame behind it and the wall around it where the photo has
them, whatever their depths.
"""

from dataclasses import dataclass

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.geometry import PhotoLength, project, world_rays
from linecad.scene import Camera, Lines, Plane

BEHIND, BEFORE = 0.05, 0.02  # of its distance: how far the lines of a wall may stand off it
FEWEST = 3  # lines along each direction
ACROSS = PhotoLength(4.0, floor=1.0)  # between lines that are one side
GRAZING = 0.06  # cosine between the ray and the wall's normal, below which a wall is not looked at
UP = 2  # the vertical axis
NONE = -1


@dataclass(frozen=True, eq=False)
class Rods:
    """The lines of a wall along one of its directions, on its plane."""

    row: Int  # (M,) in Lines
    at: Float  # (M,) coordinate in the other direction
    ends: Float  # (M, 2) in their own direction, ascending
    reach: Float  # (M,) by how much `at` may err
    plane: Int  # (M,) place of the line's own plane among those of the wall, or NONE


@dataclass(frozen=True, eq=False)
class Wall:
    """A vertical plane with the lines about it."""

    planes: tuple[Plane, ...]  # the one it is looked at in first, then those a little before and behind it
    camera: Camera
    rotation: Float  # (3, 3) world to camera
    level: Rods  # along u
    upright: Rods  # along v

    @property
    def plane(self) -> Plane:
        """The plane that the wall is looked at in."""
        return self.planes[0]

    @property
    def axis_u(self) -> int:
        """The horizontal axis that lies in the wall."""
        return 1 - self.plane.axis

    def points(self, flat: Float) -> Float:
        """World points (..., 3) of points (..., 2) u, v."""
        points = np.full((*flat.shape[:-1], 3), self.plane.offset)
        points[..., self.axis_u] = flat[..., 0]
        points[..., UP] = flat[..., 1]
        return points

    def pixels(self, flat: Float) -> Float:
        """Pixels (..., 2) of points (..., 2) u, v before the camera."""
        return project(self.points(flat), self.camera.matrix, self.rotation)

    def homography(self) -> Float:
        """Matrix (3, 3) from (u, v, 1) to homogeneous pixels."""
        onto = np.zeros((3, 3))
        onto[self.axis_u, 0] = onto[UP, 1] = 1.0
        onto[self.plane.axis, 2] = self.plane.offset
        matrix: Float = self.camera.matrix @ self.rotation @ onto
        return matrix


def find_walls(planes: tuple[Plane, ...], lines: Lines, camera: Camera, rotation: Float) -> list[Wall]:
    """The walls among the planes, those with the most lines first; planes that stand about one are part of it."""
    rays = world_rays(lines.segment, camera.matrix, rotation)
    taken: list[Plane] = []
    walls = []
    for plane in sorted(planes, key=lambda plane: (-len(plane.lines), plane.id)):
        if plane.axis == UP or plane.offset == 0:
            continue
        if any(_is_about(np.array(plane.offset), other.offset) for other in taken if other.axis == plane.axis):
            continue
        taken.append(plane)
        about = [
            other for other in planes
            if other.axis == plane.axis and other is not plane and _is_about(np.array(other.offset), plane.offset)
        ]  # fmt: skip
        wall = _wall((plane, *about), lines, rays, camera, rotation)
        if wall is not None:
            walls.append(wall)
    return walls


def _is_about(place: Float, offset: float) -> Bool:
    """Which coordinates along the normal are at a wall's or a little before or behind it."""
    ratio = place / offset
    return np.asarray((ratio >= 1 - BEFORE) & (ratio <= 1 + BEHIND))


def _wall(planes: tuple[Plane, ...], lines: Lines, rays: Float, camera: Camera, rotation: Float) -> Wall | None:
    plane = planes[0]
    plane_of = {line: number for number, other in enumerate(planes) for line in other.lines}
    own = np.flatnonzero((lines.axis != plane.axis) & _is_about(lines.ends[:, 0, plane.axis], plane.offset))
    along_normal = rays[own, :, plane.axis] / np.linalg.norm(rays[own], axis=2) * np.sign(plane.offset)
    own = own[along_normal.min(axis=1) >= GRAZING]
    points = rays[own] * (plane.offset / rays[own, :, plane.axis])[..., None]
    axis_u = 1 - plane.axis
    speed = _speeds(points, camera, rotation)
    across = ACROSS.px(camera.width)
    found = []
    for along, other in ((axis_u, UP), (UP, axis_u)):
        rods = lines.axis[own] == along
        if rods.sum() < FEWEST:
            return None
        found.append(
            Rods(
                row=own[rods],
                at=points[rods][:, :, other].mean(axis=1),
                ends=np.sort(points[rods][:, :, along], axis=1),
                reach=across / speed[rods][:, other],
                plane=np.array([plane_of.get(line, NONE) for line in lines.id[own[rods]].tolist()], np.int64),
            )
        )
    return Wall(planes, camera, rotation, found[0], found[1])


def _speeds(points: Float, camera: Camera, rotation: Float) -> Float:
    """Px (M, 3) by which the middles of pairs of points (M, 2, 3) move in the photo for each unit along an axis."""
    matrix = camera.matrix @ rotation
    image = points.mean(axis=1) @ matrix.T
    pixels = image[:, :2] / image[:, 2:]
    moved = matrix[None, :2, :] - pixels[:, :, None] * matrix[None, 2:, :]
    speeds: Float = np.linalg.norm(moved, axis=1) / image[:, 2:]
    return np.maximum(speeds, np.finfo(float).tiny)
