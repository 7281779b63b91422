"""A small ray caster for axis-aligned faces: what is seen, where the sun shines, how bright it looks.

Rays are scaled so that their camera depth is 1; the parameter of a hit then is its depth.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from modelling import PLANE_AXES, Face, Float, Hits
from surfaces import sky, surroundings

Mask = NDArray[np.bool_]
NEAR = 0.05  # m, nothing is closer to the camera
TOUCHING = 1e-4  # m, closer than this a face does not shade a point


@dataclass(frozen=True, eq=False)
class View:
    """A camera with square pixels and OpenCV's distortion k1 k2 p1 p2."""

    width: int  # px
    height: int  # px
    matrix: Float  # (3, 3)
    rotation: Float  # (3, 3) world to camera
    position: Float  # (3,) world, m
    distortion: tuple[float, ...] = ()

    @property
    def focal(self) -> float:
        """px."""
        return float(self.matrix[0, 0])

    def to_camera(self, points: Float) -> Float:
        """World points (N, 3) in the camera frame."""
        return (points - self.position) @ self.rotation.T

    def rays(self, pixels: Float) -> Float:
        """World rays (N, 3) of undistorted pixels (N, 2), camera depth 1."""
        homogeneous = np.column_stack([pixels, np.ones(len(pixels))])
        rays: Float = homogeneous @ np.linalg.inv(self.matrix).T @ self.rotation
        return rays

    def straighten(self, pixels: Float) -> Float:
        """Undistorted pixels (N, 2) of pixels as the camera takes them."""
        if not self.distortion:
            return pixels
        k1, k2, p1, p2 = self.distortion
        centre = self.matrix[:2, 2]
        target = (pixels - centre) / self.focal
        x, y = target.T
        for _ in range(12):  # fixed point; every round gains a digit at the mild distortion of a photo lens
            r2 = x * x + y * y
            radial = 1 + k1 * r2 + k2 * r2 * r2
            shift_x = 2 * p1 * x * y + p2 * (r2 + 2 * x * x)
            shift_y = p1 * (r2 + 2 * y * y) + 2 * p2 * x * y
            x, y = (target[:, 0] - shift_x) / radial, (target[:, 1] - shift_y) / radial
        return np.column_stack([x, y]) * self.focal + centre


def first_hits(faces: list[Face], origin: Float, rays: Float) -> tuple[Float, NDArray[np.int64]]:
    """Depth (N,) and face index (N,) of what each ray (N, 3) meets first; infinity and -1 for the sky."""
    depth = np.full(len(rays), np.inf)
    index = np.full(len(rays), -1)
    for number, face in enumerate(faces):
        if (origin[face.axis] - face.offset) * face.sign <= 0:
            continue
        hit, where = _meet(face, origin, rays, depth)
        index[hit] = number
        depth[hit] = where
    return depth, index


def _meet(face: Face, origin: Float, rays: Float, depth: Float) -> tuple[Mask, Float]:
    """Which rays meet a face before `depth`, and the depths (of those) where they do."""
    with np.errstate(divide="ignore", invalid="ignore"):
        t = (face.offset - origin[face.axis]) / rays[:, face.axis]
        first, second = PLANE_AXES[face.axis]
        u, v = origin[first] + t * rays[:, first], origin[second] + t * rays[:, second]
        hit = (t > NEAR) & (t < depth) & face.covers(u, v)
    return hit, t[hit]


def see(faces: list[Face], view: View, pixels: Float) -> tuple[Float, Float, NDArray[np.int64]]:
    """World rays (H, W, 3), depths (H, W) and face indices (H, W) of a grid of pixels (H, W, 2) as taken."""
    height, width = pixels.shape[:2]
    straight = view.straighten(pixels.reshape(-1, 2))
    rays = view.rays(straight).reshape(height, width, 3)
    straight = straight.reshape(height, width, 2)
    depth = np.full((height, width), np.inf)
    index = np.full((height, width), -1)
    columns, rows = straight[height // 2, :, 0], straight[:, width // 2, 1]
    slack = 2 + 0.04 * width * bool(view.distortion)  # px by which distortion may move things
    for number, face in enumerate(faces):
        if (view.position[face.axis] - face.offset) * face.sign <= 0:
            continue
        box = _image_box(face, view)
        if box is None:
            continue
        left, right = np.searchsorted(columns, (box[0] - slack, box[2] + slack))
        top, bottom = np.searchsorted(rows, (box[1] - slack, box[3] + slack))
        if left >= right or top >= bottom:
            continue
        part = (slice(top, bottom), slice(left, right))
        hit, where = _meet(face, view.position, rays[part].reshape(-1, 3), depth[part].ravel())
        shape = depth[part].shape
        depth[part][hit.reshape(shape)] = where
        index[part][hit.reshape(shape)] = number
    return rays, depth, index


def _image_box(face: Face, view: View) -> tuple[float, float, float, float] | None:
    """Left, top, right and bottom (px) of the part of a face that lies before the camera."""
    corners = view.to_camera(face.corners())
    kept = []
    for first, second in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        if first[2] > NEAR:
            kept.append(first)
        if (first[2] > NEAR) != (second[2] > NEAR):
            kept.append(first + (second - first) * (NEAR - first[2]) / (second[2] - first[2]))
    if not kept:
        return None
    image = np.array(kept) @ view.matrix.T
    image = image[:, :2] / image[:, 2:]
    (left, top), (right, bottom) = image.min(axis=0), image.max(axis=0)
    return left, top, right, bottom


def blocked(faces: list[Face], points: Float, directions: Float, reach: float) -> Mask:
    """Whether anything stands within `reach` times the directions (N, 3) or (3,) from the points (N, 3)."""
    directions = np.broadcast_to(directions, points.shape)
    found = np.zeros(len(points), bool)
    for face in faces:
        with np.errstate(divide="ignore", invalid="ignore"):
            t = (face.offset - points[:, face.axis]) / directions[:, face.axis]
        # A cheap test first: most rays do not even reach the plane.
        near = np.flatnonzero((t > TOUCHING) & (t < reach) & ~found)
        if len(near):
            first, second = PLANE_AXES[face.axis]
            u = points[near, first] + t[near] * directions[near, first]
            v = points[near, second] + t[near] * directions[near, second]
            found[near] = face.covers(u, v)
    return found


class Sun:
    """Parallel light with hard shadows."""

    def __init__(self, faces: list[Face], direction: Float, light: Float) -> None:
        self.casting = [face for face in faces if face.surface.casts]
        self.corners = np.stack([face.corners() for face in self.casting])  # (F, 4, 3)
        self.direction = direction / np.linalg.norm(direction)  # towards the sun
        self.light = light  # (3,) irradiance / pi at right angles

    def on(self, face: Face, points: Float) -> Float:
        """Light (N, 3) of the sun on points (N, 3) of a face."""
        slope = face.sign * self.direction[face.axis]
        if slope <= 0:
            return np.zeros((len(points), 3))
        # Only faces whose shadow on this plane meets the points' bounding box can matter.
        along = (self.corners[..., face.axis] - face.offset) / self.direction[face.axis]
        shadows = self.corners - along[..., None] * self.direction
        meets = along.max(axis=1) > TOUCHING
        for axis in PLANE_AXES[face.axis]:
            meets &= shadows[..., axis].min(axis=1) <= points[:, axis].max()
            meets &= shadows[..., axis].max(axis=1) >= points[:, axis].min()
        relevant = [self.casting[number] for number in np.flatnonzero(meets)]
        lit = ~blocked(relevant, points, self.direction, np.inf)
        light: Float = lit[:, None] * (slope * self.light)
        return light


class SoftLight(Protocol):
    """Light on a face that does not come straight from the sun."""

    def at(self, u: Float, v: Float) -> Float:
        """Irradiance / pi (N, 3) at plane points."""


def shade(
    faces: list[Face],
    view: View,
    rays: Float,
    depth: Float,
    index: NDArray[np.int64],
    maps: Mapping[int, SoftLight],
    sun: Sun,
) -> Float:
    """Radiance (N, 3) along rays (N, 3) that meet faces `index` (N,) at `depth` (N,)."""
    radiance = np.empty((len(rays), 3))
    order = np.argsort(index, kind="stable")
    numbers, starts = np.unique(index[order], return_index=True)
    for number, chosen in zip(numbers, np.split(order, starts[1:]), strict=True):
        if number < 0:
            radiance[chosen] = sky(rays[chosen])
            continue
        face = faces[number]
        here = rays[chosen]
        points = view.position + depth[chosen, None] * here
        slope = np.abs(here[:, face.axis]) / np.linalg.norm(here, axis=1)
        first, second = PLANE_AXES[face.axis]
        hits = Hits(points[:, first], points[:, second], here, depth[chosen] / view.focal / np.maximum(slope, 0.08))
        albedo = face.surface.albedo(hits)
        light = maps[int(number)].at(hits.u, hits.v) + sun.on(face, points)
        radiance[chosen] = albedo * (light + face.surface.glow)
        if face.surface.mirror:
            mirrored = here.copy()
            mirrored[:, face.axis] *= -1
            # Grazing views mirror more (Schlick's approximation of Fresnel's law).
            share = face.surface.mirror * (0.3 + 0.7 * (1 - slope) ** 3)
            radiance[chosen] += surroundings(mirrored) * share[:, None]
    return radiance
