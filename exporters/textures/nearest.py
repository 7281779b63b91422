"""Which face each pixel of the photo shows, and how deep it is there."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from exporters.faces import FlatFace, signed_area
from exporters.textures.layout import View, seen_part
from linecad.arrays import Bool, Float

_LEAST_AREA = 1e-3  # px^2; a face that is seen from its edge shows nothing
SHIFT = 4  # bits after the point in OpenCV's coordinates
_BORDER = 3  # px about a face in the photo, which the interpolation reaches into

_Float32 = NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class Shape:
    """A face in the photo."""

    rings: list[Float]  # (C, 2) px, what of the face lies in the photo; none where nothing does
    box: tuple[int, int, int, int]  # px: left, top, right, bottom; the last two are outside
    inverse_depth: Float  # (3,) 1/m: the inverse of the depth is its product with (x, y, 1)

    def inverse_depths(self) -> _Float32:
        """1/m, of the face's whole plane at every pixel of the box."""
        left, top, right, bottom = self.box
        a, b, c = self.inverse_depth
        across, down = a * np.arange(left, right), b * np.arange(top, bottom) + c
        inverse: _Float32 = across.astype(np.float32)[None, :] + down.astype(np.float32)[:, None]
        return inverse


@dataclass(frozen=True, eq=False)
class Nearest:
    """The nearest face at each pixel of the photo."""

    inverse_depth: _Float32  # (H, W) 1/m; 0 where there is none
    owner: NDArray[np.int32]  # (H, W) the number of the face; any where there is none
    slopes: _Float32  # (F, 2) 1/m a px, of the inverse depth of each face


def shape_of(face: FlatFace, view: View) -> Shape:
    """A face in the photo; without rings where the photo shows nothing of it."""
    seen = [seen_part(ring, view) for ring in face.rings]
    rings = [ring[:, :2] / ring[:, 2:] for ring in seen if len(ring)] if len(seen[0]) else []
    if not rings or face.offset == 0 or abs(signed_area(rings[0])) < _LEAST_AREA:
        return Shape([], (0, 0, 0, 0), np.zeros(3))
    # World rays of camera depth 1 are linear in the pixel, and the plane cuts them at offset over their coordinate.
    inverse_depth = face.direction @ np.linalg.inv(view.projection) / face.offset
    left, top = np.maximum(np.floor(rings[0].min(axis=0)).astype(int) - _BORDER, 0).tolist()
    right, bottom = np.ceil(rings[0].max(axis=0)).astype(int) + _BORDER + 1
    return Shape(rings, (left, top, min(int(right), view.width), min(int(bottom), view.height)), inverse_depth)


def nearest_of(shapes: list[Shape], view: View) -> Nearest:
    """The nearest of faces at each pixel."""
    inverse_depth = np.zeros((view.height, view.width), np.float32)
    owner = np.zeros((view.height, view.width), np.int32)
    for number, shape in enumerate(shapes):
        if shape.rings:
            left, top, right, bottom = shape.box
            here = np.s_[top:bottom, left:right]
            inverse = shape.inverse_depths()
            nearer = filled(shape.rings, (left, top), inverse.shape) & (inverse > inverse_depth[here])
            inverse_depth[here][nearer] = inverse[nearer]
            owner[here][nearer] = number
    return Nearest(inverse_depth, owner, np.array([shape.inverse_depth[:2] for shape in shapes], np.float32))


def filled(rings: list[Float], corner: tuple[int, int], shape: tuple[int, ...]) -> Bool:
    """Where a picture that begins at `corner` lies in a polygon with holes or on its border; rings (C, 2) in px."""
    inside = np.zeros(shape, np.uint8)
    fixed = [np.round((ring - corner) * 2**SHIFT).astype(np.int32) for ring in rings]
    cv2.fillPoly(inside, fixed, (1,), cv2.LINE_8, SHIFT)
    return inside.astype(np.bool_)
