"""Other photos of known scenes: the same one mirrored, by a camera that was turned, smaller, darker; used by crops.py.

What a program finds in a mirrored photo should be as good as what it finds in the photo. Where it is not, something was
chosen while looking at that photo, or was right by luck. Like parts (parts.py), they say nothing about other buildings.
"""

from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray
from parts import CROPS, PARTS, part_of

from linecad.arrays import Float
from linecad.camera.photo import Photo
from linecad.evaluation.references import Points, Reference
from linecad.geometry import homogeneous, resized_camera, rotation_about
from linecad.scene import Camera

MIRROR = np.diag([-1.0, 1.0, 1.0])
CLOSER = 1.22  # times the focal length of a turned camera, so that less of what it sees is cut off
GAMMA, DIMMER, NOISE, QUALITY = 1.5, 0.9, 4.0, 70  # of a dim photo: noise in values of 255, quality of its JPEG


@dataclass(frozen=True)
class View:
    """How a view differs from its photo; angles in degrees, to the right and up."""

    right: float = 0.0
    up: float = 0.0
    scale: float = 1.0
    is_mirrored: bool = False
    is_dim: bool = False


VIEWS = {
    "mirrored": View(is_mirrored=True),
    "smaller and mirrored": View(scale=0.8, is_mirrored=True),
    "turned right": View(right=9.0),
    "turned left": View(right=-9.0),
    "turned up": View(up=7.0),
    "turned down": View(up=-6.0),
    "turned right and mirrored": View(right=9.0, is_mirrored=True),
    "turned left and mirrored": View(right=-9.0, is_mirrored=True),
    "turned up and mirrored": View(up=7.0, is_mirrored=True),
    "dim": View(is_dim=True),
}


def changed(photo: Photo, reference: Reference, name: str) -> tuple[Photo, Reference]:
    """One of PARTS, CROPS or VIEWS of a photo, with the points of known depth that it shows."""
    return part_of(photo, reference, name) if name in PARTS | CROPS else view_of(photo, reference, VIEWS[name])


def view_of(photo: Photo, reference: Reference, view: View) -> tuple[Photo, Reference]:
    """A view of a photo, with the points of known depth that it shows; no more is known about it."""
    assert photo.camera is not None
    back, matrix = np.linalg.inv(photo.camera.matrix), photo.camera.matrix.copy()
    turn = rotation_about(np.radians([-view.up, 0.0, 0.0])) @ rotation_about(np.radians([0.0, -view.right, 0.0]))
    pixels = photo.pixels
    if view.right or view.up:
        matrix[:2, :2] *= CLOSER
        warp = matrix @ turn @ back
        left, upper, right, lower = _seen_of(photo, warp)
        pixels = np.asarray(cv2.warpPerspective(pixels, warp, (right, lower), flags=cv2.INTER_CUBIC), np.uint8)
        pixels = pixels[upper:, left:]
        matrix[:2, 2] -= left, upper
    if view.is_mirrored:
        matrix[0, 2] = pixels.shape[1] - 1 - matrix[0, 2]
        turn = MIRROR @ turn
    whole = pixels.shape[1::-1]
    pixels = _taken(pixels, view)
    size = pixels.shape[1], pixels.shape[0]
    scale = np.array(size) / whole

    def shown(points: Points | None) -> Points | None:
        if points is None:
            return None
        rays = homogeneous(points.pixels) @ back.T @ turn.T
        at = rays @ matrix.T
        at = (at[:, :2] / at[:, 2:] + 0.5) * scale - 0.5
        inside = ((at > 0) & (at < np.array(size) - 1)).all(axis=1)
        return Points(at[inside], (points.depth * rays[:, 2])[inside])

    camera = Camera(*size, resized_camera(matrix, np.full(2, view.scale)), photo.camera.source)
    known = Reference(edges=shown(reference.edges), dense=shown(reference.dense))
    return replace(photo, pixels=pixels, camera=camera), known


def _seen_of(photo: Photo, warp: Float) -> tuple[int, int, int, int]:
    """The largest upright part of a view that shows the photo alone: left, upper, right, lower in px, the latter out.

    `warp` (3, 3) is from pixels of the photo. What lies beyond its border would be streaks or a wedge, whose lines are
    stronger than those of the scene.
    """
    width, height = photo.width, photo.height
    corners = homogeneous(np.array([[0, 0], [width - 1, 0], [0, height - 1], [width - 1, height - 1]], np.float64))
    at = corners @ warp.T
    (a, b, c, d) = at[:, :2] / at[:, 2:]
    left, upper = np.ceil(np.maximum([max(a[0], c[0]), max(a[1], b[1])], 0)).astype(int).tolist()
    last = np.floor(np.minimum([min(b[0], d[0]), min(c[1], d[1])], [width - 1, height - 1])).astype(int)
    right, lower = (last + 1).tolist()
    return left, upper, right, lower


def _taken(pixels: NDArray[np.uint8], view: View) -> NDArray[np.uint8]:
    """The pixels of a view, once it is turned: mirrored, smaller, dim."""
    if view.is_mirrored:
        pixels = np.ascontiguousarray(pixels[:, ::-1])
    if view.scale != 1:
        size = round(pixels.shape[1] * view.scale), round(pixels.shape[0] * view.scale)
        pixels = np.asarray(cv2.resize(pixels, size, interpolation=cv2.INTER_AREA), np.uint8)
    if view.is_dim:
        noise = np.random.default_rng(0).normal(0, NOISE, pixels.shape)
        darker = np.clip((pixels / 255.0) ** GAMMA * 255 * DIMMER + noise, 0, 255).astype(np.uint8)
        written = cv2.imencode(".jpg", darker, [cv2.IMWRITE_JPEG_QUALITY, QUALITY])[1]
        pixels = np.asarray(cv2.imdecode(written, cv2.IMREAD_COLOR), np.uint8)
    return pixels
