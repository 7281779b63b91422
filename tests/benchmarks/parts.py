"""Parts of real photos, and whole ones at smaller sizes: more photos of known depth where few are; used by ties.py.

Another crop or size has other lines, other bodies and other candidates of the same scene, so that one body of one photo
moves the means less. They say nothing about other buildings: all of a dataset stays one scene.
"""

from dataclasses import replace

import cv2
import numpy as np

from linecad.camera.photo import Photo
from linecad.evaluation.references import Points, Reference
from linecad.geometry import resized_camera
from linecad.scene import Camera

# Left, upper, right and lower border as shares of the photo, and the scale.
PARTS: dict[str, tuple[float, float, float, float, float]] = {
    "smaller": (0.0, 0.0, 1.0, 1.0, 0.8),
    "small": (0.0, 0.0, 1.0, 1.0, 0.62),
    "left": (0.0, 0.0, 0.74, 1.0, 0.9),
    "right": (0.26, 0.0, 1.0, 1.0, 0.9),
    "middle": (0.1, 0.06, 0.94, 0.97, 0.93),
}
# Others, which no fit has seen: what crops.py measures.
CROPS: dict[str, tuple[float, float, float, float, float]] = {
    "tiny": (0.0, 0.0, 1.0, 1.0, 0.34),
    "far left": (0.0, 0.0, 0.6, 1.0, 0.9),
    "far right": (0.4, 0.0, 1.0, 1.0, 0.9),
    "lower": (0.0, 0.25, 1.0, 1.0, 0.8),
    "inner": (0.2, 0.15, 0.8, 0.85, 1.0),
}


def part_of(photo: Photo, reference: Reference, name: str) -> tuple[Photo, Reference]:
    """One of PARTS or CROPS of a photo, with the points of known depth that it shows; no more is known about it."""
    height, width = photo.pixels.shape[:2]
    *borders, resized = (PARTS | CROPS)[name]
    left, upper, right, lower = np.rint(np.array(borders) * [width, height, width, height]).astype(int).tolist()
    cut = photo.pixels[upper:lower, left:right]
    size = round(cut.shape[1] * resized), round(cut.shape[0] * resized)
    scale = np.array(size) / [cut.shape[1], cut.shape[0]]
    assert photo.camera is not None
    matrix = photo.camera.matrix.copy()
    matrix[:2, 2] -= left, upper
    camera = Camera(*size, resized_camera(matrix, np.full(2, resized)), photo.camera.source)
    pixels = np.asarray(cv2.resize(cut, size, interpolation=cv2.INTER_AREA), np.uint8)

    def shown(points: Points | None) -> Points | None:
        if points is None:
            return None
        at = (points.pixels - [left, upper] + 0.5) * scale - 0.5
        inside = ((at > 0) & (at < np.array(size) - 1)).all(axis=1)
        return Points(at[inside], points.depth[inside])

    known = Reference(rotation=reference.rotation, edges=shown(reference.edges), dense=shown(reference.dense))
    return replace(photo, pixels=pixels, camera=camera), known
