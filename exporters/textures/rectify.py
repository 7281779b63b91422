"""The photo on the faces: each face as seen from the front, where the photo shows it.

A face is hidden where another one is nearer to the camera. What is hidden or outside the photo keeps the plain colour
of faces without a texture: nothing is made up, and nothing of what stands before a face is painted on it. Along the
borders of what is seen its colours go on for a few texels, so that no filter mixes them with anything else.
"""

import math
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from exporters.colours import FACE
from exporters.model import FlatFace, Model, signed_area
from exporters.textures.layout import MARGIN, Layout, Patch, View, seen_part
from linecad.arrays import Bool, Float

PLAIN = tuple(round(255 * value) for value in FACE)  # sRGB, of texels that the photo says nothing about
_LEAST_AREA = 1e-3  # px^2; a face that is seen from its edge shows nothing
_SHIFT = 4  # bits after the point in OpenCV's coordinates
_BORDER = 3  # px about a face in the photo, which the interpolation reaches into
_ROUNDED = 0.75  # px by which the border of a face is off where it is filled pixel by pixel
_BLURRED = 1.5  # px, the width of an edge in a photo: so near to a border the colours are mixed
_MOST_BLURRED = MARGIN / 2  # texels
_NEARER = 1e-3  # relative; what differs less in depth touches
_WHOLLY_SEEN = 250  # of 255: less of a texel is mixed with what hides it

Pixels = NDArray[np.uint8]
_Float32 = NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class _Shape:
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
class _Nearest:
    """The nearest face at each pixel of the photo."""

    inverse_depth: _Float32  # (H, W) 1/m; 0 where there is none
    owner: NDArray[np.int32]  # (H, W) the number of the face; any where there is none
    slopes: _Float32  # (F, 2) 1/m a px, of the inverse depth of each face


def paint_pages(model: Model, layout: Layout, view: View, photo: Pixels) -> list[Pixels]:
    """The pages of a layout, RGB, from the photo (H, W, 3)."""
    pages = [np.full((height, width, 3), PLAIN, np.uint8) for width, height in layout.pages]
    shapes = [_shape(face, view) for face in model.faces]
    nearest = _nearest(shapes, view)
    for face, shape, patch in zip(model.faces, shapes, layout.patches, strict=True):
        if shape.rings:
            colours = _paint(face, shape, patch, view, nearest, photo)
            left, top = patch.left - MARGIN, patch.top - MARGIN
            pages[patch.page][top : top + colours.shape[0], left : left + colours.shape[1]] = colours
    return pages


def _shape(face: FlatFace, view: View) -> _Shape:
    seen = [seen_part(ring, view) for ring in face.rings]
    rings = [ring[:, :2] / ring[:, 2:] for ring in seen if len(ring)] if len(seen[0]) else []
    if not rings or face.offset == 0 or abs(signed_area(rings[0])) < _LEAST_AREA:
        return _Shape([], (0, 0, 0, 0), np.zeros(3))
    # World rays of camera depth 1 are linear in the pixel, and the plane cuts them at offset over their coordinate.
    inverse_depth = np.linalg.inv(view.projection)[face.axis] / face.offset
    left, top = np.maximum(np.floor(rings[0].min(axis=0)).astype(int) - _BORDER, 0).tolist()
    right, bottom = np.ceil(rings[0].max(axis=0)).astype(int) + _BORDER + 1
    return _Shape(rings, (left, top, min(int(right), view.width), min(int(bottom), view.height)), inverse_depth)


def _nearest(shapes: list[_Shape], view: View) -> _Nearest:
    inverse_depth = np.zeros((view.height, view.width), np.float32)
    owner = np.zeros((view.height, view.width), np.int32)
    for number, shape in enumerate(shapes):
        if shape.rings:
            left, top, right, bottom = shape.box
            here = np.s_[top:bottom, left:right]
            inverse = shape.inverse_depths()
            nearer = _filled(shape.rings, (left, top), inverse.shape) & (inverse > inverse_depth[here])
            inverse_depth[here][nearer] = inverse[nearer]
            owner[here][nearer] = number
    return _Nearest(inverse_depth, owner, np.array([shape.inverse_depth[:2] for shape in shapes], np.float32))


def _hidden(shape: _Shape, nearest: _Nearest) -> Bool:
    """Where in its box a face is behind another one.

    Not within _ROUNDED of the line where their planes meet: the difference of the inverse depths is linear in the
    pixel, so that it tells the distance from this line.
    """
    left, top, right, bottom = shape.box
    here = np.s_[top:bottom, left:right]
    slopes = np.linalg.norm(nearest.slopes - shape.inverse_depth[:2].astype(np.float32), axis=1)[nearest.owner[here]]
    own = shape.inverse_depths()
    hidden: Bool = nearest.inverse_depth[here] - own > _ROUNDED * slopes + _NEARER * np.abs(own)
    return hidden


def _paint(face: FlatFace, shape: _Shape, patch: Patch, view: View, nearest: _Nearest, photo: Pixels) -> Pixels:
    """RGB of a patch with its margin."""
    left, top, right, bottom = shape.box
    here = np.s_[top:bottom, left:right]
    shown = np.where(_hidden(shape, nearest), np.uint8(0), np.uint8(255))
    to_box = np.array([[1.0, 0.0, -left], [0.0, 1.0, -top], [0.0, 0.0, 1.0]])
    to_photo = to_box @ view.projection @ _to_space(face, patch)
    size = (patch.columns + 2 * MARGIN, patch.rows + 2 * MARGIN)
    seen = cv2.warpPerspective(
        shown, to_photo, size, flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP, borderMode=cv2.BORDER_CONSTANT
    )
    corner = (patch.left - MARGIN, patch.top - MARGIN)
    rings = [patch.texels(ring) - 0.5 for ring in face.rings]
    known = (seen >= _WHOLLY_SEEN) & _filled(rings, corner, size[::-1]) & _in_front(to_photo, size)

    texels = abs(signed_area(rings[0]))
    step = math.sqrt(abs(signed_area(shape.rings[0])) / texels)  # px a texel, in the mean
    colours, to_colours = _reduced(photo[here], step, to_photo)
    warped = cv2.warpPerspective(
        colours, to_colours, size, flags=cv2.INTER_CUBIC | cv2.WARP_INVERSE_MAP, borderMode=cv2.BORDER_REPLICATE
    )
    blurred = min(max(_BLURRED / step, 1.0), _MOST_BLURRED)
    return _continued(np.asarray(warped, np.uint8), _pure(known, blurred), MARGIN + blurred + 1)


def _to_space(face: FlatFace, patch: Patch) -> Float:
    """(3, 3) from column, row and 1 of a texel of the patch with its margin to the point of the plane at its centre."""
    across, down = patch.right / patch.density[0], -patch.up / patch.density[1]
    start = patch.right * patch.corner[0] + patch.up * patch.corner[1] + (0.5 - MARGIN) * (across + down)
    start[face.axis] = face.offset
    return np.stack([across, down, start], axis=1)


def _filled(rings: list[Float], corner: tuple[int, int], shape: tuple[int, ...]) -> Bool:
    """Where a picture that begins at `corner` lies in a polygon with holes or on its border; rings (C, 2) in px."""
    inside = np.zeros(shape, np.uint8)
    fixed = [np.round((ring - corner) * 2**_SHIFT).astype(np.int32) for ring in rings]
    cv2.fillPoly(inside, fixed, (1,), cv2.LINE_8, _SHIFT)
    return inside.astype(np.bool_)


def _in_front(to_photo: Float, size: tuple[int, int]) -> Bool:
    """(rows, columns) where the plane is before the camera: behind it, too, the mathematics finds a pixel."""
    a, b, c = to_photo[2]
    before: Bool = (a * np.arange(size[0]))[None, :] > -(b * np.arange(size[1]) + c)[:, None]
    return before


def _reduced(colours: Pixels, step: float, to_photo: Float) -> tuple[Pixels, Float]:
    """The photo in about the resolution of a patch, so that no pixel is skipped, and the way from texels to it."""
    factor = 2 ** max(0, round(math.log2(step)))
    if factor == 1:
        return colours, to_photo
    height, width = colours.shape[:2]
    small = cv2.resize(colours, (-(-width // factor), -(-height // factor)), interpolation=cv2.INTER_AREA)
    x, y = small.shape[1] / width, small.shape[0] / height
    shrink = np.array([[x, 0.0, (x - 1) / 2], [0.0, y, (y - 1) / 2], [0.0, 0.0, 1.0]])  # about pixel centres
    return np.asarray(small, np.uint8), shrink @ to_photo


def _pure(known: Bool, blurred: float) -> Bool:
    """Where a texel is known and has nothing of what lies beyond the border, which is `blurred` texels wide.

    Parts so thin that they are border alone stay: a mixed colour is better than none.
    """
    core = cv2.distanceTransform(_bytes(known), cv2.DIST_L2, cv2.DIST_MASK_5) > blurred
    from_core = cv2.distanceTransform(_bytes(~core), cv2.DIST_L2, cv2.DIST_MASK_5)
    pure: Bool = core | (known & (from_core > 2 * blurred + 1)) if core.any() else known
    return pure


def _continued(colours: Pixels, known: Bool, reach: float) -> Pixels:
    """The colours where they are known, those of the nearest known texel up to `reach` texels away, else PLAIN."""
    painted = np.full_like(colours, PLAIN)
    if not known.any():
        return painted
    distance, label = cv2.distanceTransformWithLabels(
        _bytes(~known), cv2.DIST_L2, cv2.DIST_MASK_5, labelType=cv2.DIST_LABEL_PIXEL
    )
    source = np.zeros(int(label.max()) + 1, np.int64)
    source[label[known]] = np.flatnonzero(known)
    near = distance <= reach
    painted[near] = colours.reshape(-1, 3)[source[label[near]]]
    return painted


def _bytes(mask: Bool) -> Pixels:
    return mask.astype(np.uint8)
