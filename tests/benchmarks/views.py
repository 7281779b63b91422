"""Other photos of known scenes: the same one mirrored, by a camera that was turned, smaller, darker; used by crops.py.

What a program finds in a mirrored photo should be as good as what it finds in the photo. Where it is not, something was
chosen while looking at that photo, or was right by luck. Like parts (parts.py), they say nothing about other buildings.
"""

from dataclasses import dataclass, replace
from typing import Any

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
CLOSER = 1.22  # times the focal length of a turned camera, so that it sees nothing that the photo does not show
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
    is_turned = bool(view.right or view.up)
    if is_turned:
        matrix[:2, :2] *= CLOSER
    pixels, size = _pixels(photo, view, matrix @ turn @ back if is_turned else None)
    if view.is_mirrored:
        matrix[0, 2] = photo.width - 1 - matrix[0, 2]
        turn = MIRROR @ turn
    scale = np.array(size) / [photo.width, photo.height]

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


def _pixels(photo: Photo, view: View, warp: Float | None) -> tuple[NDArray[np.uint8], tuple[int, int]]:
    """The pixels of a view, and their width and height; `warp` (3, 3) from pixels of the photo, None for the same."""
    pixels: NDArray[Any] = photo.pixels
    if warp is not None:
        size = photo.width, photo.height
        pixels = cv2.warpPerspective(pixels, warp, size, flags=cv2.INTER_CUBIC, borderMode=cv2.BORDER_REPLICATE)
    if view.is_mirrored:
        pixels = np.ascontiguousarray(pixels[:, ::-1])
    size = round(photo.width * view.scale), round(photo.height * view.scale)
    if view.scale != 1:
        pixels = cv2.resize(pixels, size, interpolation=cv2.INTER_AREA)
    if view.is_dim:
        noise = np.random.default_rng(0).normal(0, NOISE, pixels.shape)
        darker = np.clip((pixels / 255.0) ** GAMMA * 255 * DIMMER + noise, 0, 255).astype(np.uint8)
        written = cv2.imencode(".jpg", darker, [cv2.IMWRITE_JPEG_QUALITY, QUALITY])[1]
        pixels = np.asarray(cv2.imdecode(written, cv2.IMREAD_COLOR))
    return np.asarray(pixels, np.uint8), size
