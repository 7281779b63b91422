"""Lengths in a photo, rays, projection, image lines and rotations: the mathematics that several stages share.

Frames are those of `linecad.scene`. `K` is the camera matrix in px, `R` takes world to camera, so that
`pixel ~ K R P` and the world ray of a pixel is `d = R^-1 K^-1 pixel` (paper, equations 1 and 2).
"""

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import permutations

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.directions import across

REFERENCE_WIDTH = 3840.0  # px, the paper's photos; lengths in px are meant there and scaled with the photo's width
DIAGONAL_35MM = 43.27  # mm, of the 36 x 24 mm frame that a "35 mm equivalent" refers to


@dataclass(frozen=True)
class PhotoLength:
    """A length in a photo that grows with the photo's width, but is never less than a floor."""

    at_reference: float  # px in a photo of REFERENCE_WIDTH
    floor: float = 0.0  # px in any photo

    def px(self, width: float) -> float:
        """The length in a photo of `width` px."""
        return max(self.at_reference * (width / REFERENCE_WIDTH), self.floor)


def homogeneous(points: Float) -> Float:
    """(..., 2) points as (..., 3) with a one appended."""
    return np.concatenate([points, np.ones((*points.shape[:-1], 1))], axis=-1)


def central_camera(focal: float, width: int, height: int) -> Float:
    """Camera matrix (3, 3) with the principal point in the middle of a photo of `width` x `height` px."""
    return np.array([[focal, 0.0, (width - 1) / 2], [0.0, focal, (height - 1) / 2], [0.0, 0.0, 1.0]])


def resized_camera(matrix: Float, scale: Float) -> Float:
    """The camera matrix (3, 3) of a picture that was resized by `scale` (2,), across and down."""
    resized = matrix.copy()
    resized[:2] *= scale[:, None]
    resized[:2, 2] += (scale - 1) / 2  # pixels are counted by their middles
    return resized


def world_rays(pixels: Float, K: Float, R: Float) -> Float:
    """World rays (..., 3) of pixels (..., 2), scaled so that their camera depth is 1."""
    rays: Float = homogeneous(pixels) @ np.linalg.inv(K).T @ R
    return rays


def depths_beside(rays: Float, points: Float, axis: Int) -> Float:
    """Camera depths (M,) at which rays pass nearest to lines, measured across these.

    The rays (M, K) have camera depth 1; the lines run along `axis` (M,) through points (M, K). Both are told by their
    components along all directions (`linecad.directions`), in one frame by their coordinates.
    """
    sides = across(axis)
    ray, fixed = (np.take_along_axis(places, sides, axis=1) for places in (rays, points))
    depths: Float = (ray * fixed).sum(axis=1) / (ray**2).sum(axis=1)
    return depths


def project(points: Float, K: Float, R: Float) -> Float:
    """Pixels (..., 2) of world points (..., 3); the points must lie before the camera."""
    image = points @ (K @ R).T
    pixels: Float = image[..., :2] / image[..., 2:]
    return pixels


def vanishing_points(K: Float, R: Float) -> Float:
    """Homogeneous vanishing points (M, 3) of the axes in the columns of R (3, M), one a row."""
    points: Float = (K @ R).T
    return points


def lengths(vectors: Float) -> Float:
    """Lengths (...) of vectors (..., 2)."""
    # x and y apart, here and below: sums over pairs of numbers would take NumPy several times as long.
    x, y = vectors[..., 0], vectors[..., 1]
    found: Float = np.sqrt(x * x + y * y)
    return found


def unit_normals(vectors: Float) -> Float:
    """Unit vectors (N, 2) a quarter turn from vectors (N, 2), and 0 for those of no length."""
    turned = np.column_stack([-vectors[:, 1], vectors[:, 0]])
    normals: Float = turned / np.maximum(lengths(vectors), np.finfo(float).tiny)[:, None]
    return normals


def middles(ends: Float) -> Float:
    """Middles (N, 2) of segments (N, 2, 2)."""
    found: Float = (ends[:, 0] + ends[:, 1]) / 2
    return found


def directions_to(points: Float, vanishing: Float) -> Float:
    """Unit image directions (..., 2) from points (..., 2) px towards homogeneous vanishing points (..., 3).

    Written so that a vanishing point at infinity needs no special case. The sign is that of the homogeneous point.
    """
    towards = vanishing[..., :2] - points * vanishing[..., 2:]
    directions: Float = towards / np.maximum(lengths(towards), np.finfo(float).tiny)[..., None]
    return directions


def angles_to(ends: Float, vanishing: Float) -> Float:
    """Sine of the angle (V, N) between segments (N, 2, 2) and the lines from their middles to points (V, 3)."""
    middle, along = middles(ends), ends[:, 1] - ends[:, 0]
    along = along / lengths(along)[:, None]
    x = vanishing[:, :1] - middle[:, 0] * vanishing[:, 2:]
    y = vanishing[:, 1:2] - middle[:, 1] * vanishing[:, 2:]
    length = np.maximum(np.sqrt(x * x + y * y), np.finfo(float).tiny)
    sines: Float = np.abs(x / length * along[:, 1] - y / length * along[:, 0])
    return sines


def reach_across(ends: Float, vanishing: Float) -> Bool:
    """Which segments (N, 2, 2) have points (V, 3) between their ends, or at one, (V, N)."""
    away = ends[None] * vanishing[:, None, None, 2:] - vanishing[:, None, None, :2]
    across: Bool = np.asarray((away[:, :, 0] * away[:, :, 1]).sum(axis=2) <= 0)
    return across


def plane_normals(ends: Float, K: Float) -> Float:
    """Unit normals (N, 3), in the camera frame, of the planes through the camera centre and segments (N, 2, 2)."""
    rays = homogeneous(ends) @ np.linalg.inv(K).T
    normals = np.cross(rays[:, 0], rays[:, 1])
    unit: Float = normals / np.linalg.norm(normals, axis=1, keepdims=True)
    return unit


def rotation_about(vector: Float) -> Float:
    """Rotation matrix (3, 3) of a rotation vector (3,), rad (Rodrigues' formula)."""
    angle = float(np.sqrt(vector @ vector))
    if angle < 1e-15:
        return np.eye(3)
    x, y, z = (vector / angle).tolist()
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    rotation: Float = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    return rotation


def angle_between_frames(found: Float, true: Float) -> tuple[float, tuple[int, int, int]]:
    """Smallest angle, rad, between two frames (3, 3) whose columns are axes of free name and sign; which axis is which.

    The second value names, for each axis of `true`, the axis of `found`. Either frame may be left-handed.
    """
    cosines = np.abs(found.T @ true)

    def trace(names: tuple[int, ...]) -> float:
        """Of the turn with the best signs."""
        return float(sum(cosines[name, axis] for axis, name in enumerate(names)))

    first, second, third = max(permutations(range(3)), key=trace)
    angle = np.arccos(np.clip((trace((first, second, third)) - 1) / 2, -1, 1))
    return float(angle), (first, second, third)


def segment_coordinates(points: Float, ends: Float) -> tuple[Float, Float]:
    """Place of points (..., 2) along segments (..., 2, 2), from the first end on, and how far beside them, signed; px.

    Points and segments are broadcast against each other; `beside` is positive to the right of a segment in the photo
    (x right, y down). A segment without length has no direction: both values are 0.
    """
    start, along = ends[..., 0, :], ends[..., 1, :] - ends[..., 0, :]
    # Written out by coordinates: sums over an axis of two take several times as long.
    length = np.maximum(lengths(along), np.finfo(float).tiny)
    along_x, along_y = along[..., 0] / length, along[..., 1] / length
    off_x, off_y = points[..., 0] - start[..., 0], points[..., 1] - start[..., 1]
    place: Float = off_x * along_x + off_y * along_y
    beside: Float = along_x * off_y - along_y * off_x
    return place, beside


def ring_sides(rings: Iterable[Float]) -> Float:
    """Both ends (E, 2, 3) of each side of closed rings (V, 3), ring by ring; (0, 2, 3) for none."""
    sides = [np.stack([ring, np.roll(ring, -1, axis=0)], axis=1) for ring in rings]
    return np.concatenate([np.zeros((0, 2, 3)), *sides])


def distances_to(points: Float, segments: Float) -> Float:
    """How far (M, S) points (M, 3) are from segments (S, 2, 3)."""
    start, along = segments[:, 0], segments[:, 1] - segments[:, 0]
    off = points[:, None] - start
    share = (off * along).sum(axis=2) / np.maximum((along**2).sum(axis=1), np.finfo(float).tiny)
    away: Float = np.linalg.norm(off - np.clip(share, 0, 1)[..., None] * along, axis=2)
    return away


def gaps_between(segment: Float, others: Float) -> Float:
    """How far (S,) a segment (2, 3) is from others (S, 2, 3) where it is nearest to each."""
    ends = np.minimum(
        distances_to(segment, others).min(axis=0),
        distances_to(others.reshape(-1, 3), segment[None])[:, 0].reshape(-1, 2).min(axis=1),
    )
    along, beside = segment[1] - segment[0], others[:, 1] - others[:, 0]
    across = np.cross(along, beside)
    square = (across**2).sum(axis=1)
    off = others[:, 0] - segment[0]
    with np.errstate(divide="ignore", invalid="ignore"):  # parallel ones are nearest at an end
        share = (np.cross(off, beside) * across).sum(axis=1) / square
        other = (np.cross(off, along) * across).sum(axis=1) / square
        apart = np.abs((off * across).sum(axis=1)) / np.sqrt(square)
    inside = (share >= 0) & (share <= 1) & (other >= 0) & (other <= 1)
    gaps: Float = np.where(inside, np.minimum(apart, ends), ends)
    return gaps
