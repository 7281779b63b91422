"""What a tree, a car or a low wall hides of a face: the face's own colours go on there, with its grain.

The colours are medians of what is in plain view, the nearer the more it counts. A mean, or what continues the colours
from the border on, would spread every dark window and every leaf beside the border over all that is hidden.
"""

import cv2
import numpy as np
from numpy.typing import NDArray

from exporters.colours import FACE
from exporters.faces import FlatFace
from exporters.textures.grain import add_grain
from exporters.textures.layout import View, seen_part
from exporters.textures.nearest import SHIFT, Shape
from linecad.arrays import Bool, Float, Int

OWN, GREY = FILLS = ("own", "grey")  # what is painted where something hides a face
PLAIN = tuple(round(255 * value) for value in FACE)  # sRGB, of texels that the photo says nothing about
_GROWN = 0.0075  # of the photo's width, by which hidden parts grow: their rings are about as far off
_LEAST_GROWN = 2.0  # px; the width of an edge in a photo
_THIN = 5  # px, from which what is left of a part beside nearer faces is more than the rounding of their borders
_FADED = 2 / 3  # of what they grow by: the width of the way from the photo's colours to the filled ones
_SAMPLES = 48  # a side of the small copy whose colours count
_TEXELS = 4  # at most, down and across, whose mean is one of its colours
_LEAST_CLEAR = 0.25  # of a sample; with less of it in plain view it does not count, unless none has more
_FILLED = 8  # the sides of the still smaller picture of the colours that are filled in
_REACH = 0.2  # of the patch: the distance at which a colour counts less by a factor of 0.6

_Pixels = NDArray[np.uint8]


def cover_of(
    face: FlatFace, shape: Shape, behind: Bool, view: View, to_photo: Float, size: tuple[int, int]
) -> _Pixels | None:
    """(rows, columns) of a patch: 255 where a hidden part of it is, else 0; None if none does.

    `behind` (B, C) tells where in its box the face is behind another one, `to_photo` (3, 3) takes column, row and 1 of
    a texel to that box; `size` is columns, rows.
    """
    seen = _cover_in_photo(face, shape, behind, view)
    if not seen.any():
        return None
    half = ((size[0] + 1) // 2, (size[1] + 1) // 2)  # a quarter of the time; the borders of a cover are wide
    x, y = size[0] / half[0], size[1] / half[1]
    grow = np.array([[x, 0.0, (x - 1) / 2], [0.0, y, (y - 1) / 2], [0.0, 0.0, 1.0]])  # about the middles of texels
    cover = cv2.warpPerspective(seen, to_photo @ grow, half, flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP)
    return np.asarray(cv2.resize(cover, size), np.uint8)


def _cover_in_photo(face: FlatFace, shape: Shape, behind: Bool, view: View) -> _Pixels:
    left, top, right, bottom = shape.box
    cover = np.zeros((bottom - top, right - left), np.uint8)
    by_faces = np.zeros_like(cover)
    grown = max(_GROWN * view.width, _LEAST_GROWN)
    for ring in face.hidden:
        seen = seen_part(ring, view)
        if len(seen):
            points = np.round((seen[:, :2] / seen[:, 2:] - [left, top]) * 2**SHIFT).astype(np.int32)
            inside = np.zeros_like(cover)
            cv2.fillPoly(inside, [points], (255,), cv2.LINE_8, SHIFT)
            by_faces[behind] |= inside[behind]
            cv2.max(cover, _grown(inside, points, behind, grown), cover)
    width = 2 * round(_FADED * grown / 2) + 1
    cover = np.asarray(cv2.blur(cover, (width, width), borderType=cv2.BORDER_REPLICATE), np.uint8)
    if face.opening is not None:  # of a pane its wall hides a strip, whose ring is exact, and what is beside it is seen
        return cover
    # Up to their border: what is painted there in the photo is the other face.
    return np.asarray(cv2.max(cover, cv2.dilate(by_faces, np.ones((_THIN, _THIN), np.uint8))), np.uint8)


def _grown(inside: _Pixels, ring: NDArray[np.int32], behind: Bool, grown: float) -> _Pixels:
    """What is `inside` a ring (V, 2), in the fixed point of SHIFT, and `grown` px about it, not `behind` a face."""
    if inside[behind].any():
        inside = np.where(behind, np.uint8(0), inside)
        inside = np.asarray(cv2.morphologyEx(inside, cv2.MORPH_OPEN, np.ones((_THIN, _THIN), np.uint8)), np.uint8)
        side = 2 * round(grown) + 1
        return np.asarray(cv2.dilate(inside, cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (side, side))), np.uint8)
    return np.asarray(cv2.polylines(inside, [ring], True, (255,), round(2 * grown), cv2.LINE_8, SHIFT), np.uint8)


def fill_behind(colours: _Pixels, cover: _Pixels, known: Bool, fill: str = OWN) -> None:
    """Change colours (H, W, 3), in place, to others where `cover` (H, W) is 255, and mix them where it is less.

    With `fill` OWN the others follow from the known texels (H, W) without any cover; without such texels, and with
    GREY, they are PLAIN.
    """
    rows = np.flatnonzero(cover.max(axis=1))
    if not len(rows):
        return
    if fill == OWN:
        filling = np.asarray(cv2.resize(_filling(colours, cover, known), cover.shape[::-1]), np.uint8)
        add_grain(filling, colours, known & (cover == 0), cover > 0)
    else:
        filling = np.full_like(colours, PLAIN)
    here = np.s_[rows[0] : rows[-1] + 1]
    mix(colours[here], filling[here], cover[here])


def mix(colours: _Pixels, others: _Pixels, cover: _Pixels) -> None:
    """Change colours (H, W, 3), in place, to others where `cover` (H, W) is 255, and mix them where it is less."""
    border = np.nonzero(cv2.inRange(cover, 1, 254))
    share = cover[border][:, None] / np.float32(255)
    mixed = np.rint(colours[border] * (1 - share) + others[border] * share)
    cv2.copyTo(others, cover, colours)
    colours[border] = mixed.astype(np.uint8)


def _filling(colours: _Pixels, cover: _Pixels, known: Bool) -> _Pixels:
    """(_FILLED, _FILLED, 3) the colours to fill in all over a patch, from its known texels without any cover."""
    sides = np.array(cover.shape)
    down, across = np.maximum(sides // (_SAMPLES * _TEXELS), 1).tolist()
    few = np.s_[down // 2 :: down, across // 2 :: across]
    clear = (known[few] & (cover[few] == 0)).astype(np.float32)
    rows, columns = (max(side // _TEXELS, 1) for side in clear.shape)
    weight = cv2.resize(clear, (columns, rows), interpolation=cv2.INTER_AREA)
    summed = cv2.resize(colours[few] * clear[..., None], (columns, rows), interpolation=cv2.INTER_AREA)
    counted = (weight > 0) & (weight >= min(_LEAST_CLEAR, weight.max()))
    if not counted.any():
        return np.full((_FILLED, _FILLED, 3), PLAIN, np.uint8)
    samples = summed[counted] / weight[counted][:, None]
    apart = _middles((_FILLED, _FILLED), sides).reshape(-1, 1, 2) - _middles((rows, columns), sides)[counted]
    reach = _REACH * max(cover.shape)
    counts = np.exp(-0.5 * np.sum((apart / reach) ** 2, axis=2))
    medians = [_weighted_median(samples[:, channel], counts) for channel in range(3)]
    return np.rint(np.stack(medians, axis=1)).astype(np.uint8).reshape(_FILLED, _FILLED, 3)


def _middles(parts: tuple[int, int], sides: Int) -> Float:
    """(*parts, 2) the middles of equal parts of a picture whose sides are given, down and across."""
    return (np.moveaxis(np.indices(parts), 0, -1) + 0.5) * (sides / parts)


def _weighted_median(values: Float, weights: Float) -> Float:
    """(M,) medians of values (N,) under M sets of weights (M, N)."""
    order = np.argsort(values, kind="stable")
    below = np.cumsum(weights[:, order], axis=1)
    middle: Float = values[order][(below < below[:, -1:] / 2).sum(axis=1)]
    return middle
