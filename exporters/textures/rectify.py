"""The photo on the faces: each face as seen from the front, where the photo shows it.

A face is hidden where another one is nearer to the camera. What is hidden so or outside the photo keeps the plain
colour of faces without a texture: nothing of what stands before a face is painted on it. Where the scene tells that it
goes on, behind a tree, a car or a low wall, its own colours do with its grain, and a window looks like an equal one.
Along the borders of what is seen its colours go on for a few texels, so that no filter mixes them with anything else.
"""

import math

import cv2
import numpy as np
from numpy.typing import NDArray

from exporters.faces import FlatFace, signed_area
from exporters.model import Model
from exporters.textures.behind import OWN, PLAIN, cover_of, fill_behind
from exporters.textures.equal import fill_from_equal
from exporters.textures.layout import MARGIN, Layout, Patch, View, seen_part
from exporters.textures.nearest import Nearest, Shape, filled, nearest_of, shape_of
from exporters.textures.smear import streaks, without_streaks
from linecad.arrays import Bool, Float
from linecad.directions import MAIN

_ROUNDED = 0.75  # px by which the border of a face is off where it is filled pixel by pixel
_BLURRED = 1.5  # px, the width of an edge in a photo: so near to a border the colours are mixed
_MOST_BLURRED = MARGIN / 2  # texels
_NEARER = 1e-3  # relative; what differs less in depth touches
_WHOLLY_SEEN = 250  # of 255: less of a texel is mixed with what hides it

Pixels = NDArray[np.uint8]


def paint_pages(
    model: Model, layout: Layout, view: View, photo: Pixels, fill: str = OWN
) -> tuple[list[Pixels], list[float]]:
    """The pages of a layout, RGB, from the photo (H, W, 3), and for each face how many pixels of the photo show it.

    `fill`, one of FILLS, is what parts that the scene tells as hidden are painted with.
    """
    pages = [np.full((height, width, 3), PLAIN, np.uint8) for width, height in layout.pages]
    shapes = [shape_of(face, view) for face in model.faces]
    nearest = nearest_of(shapes, view)
    counts = np.bincount(nearest.owner[nearest.inverse_depth > 0], minlength=len(shapes)).tolist()
    hidden = (
        _pixels_hidden(face, number, shape, view, nearest)
        for number, (face, shape) in enumerate(zip(model.faces, shapes, strict=True))
    )
    shown = [float(count - behind) for count, behind in zip(counts, hidden, strict=True)]
    painted: dict[int, Pixels] = {}
    covers: dict[int, Pixels] = {}
    for face, shape, patch in zip(model.faces, shapes, layout.patches, strict=True):
        if shape.rings:
            painted[face.id], cover = _paint(face, shape, patch, view, nearest, photo, fill)
            if cover is not None:
                covers[face.id] = cover
    if fill == OWN:
        fill_from_equal(model, painted, covers, dict(zip((face.id for face in model.faces), shown, strict=True)))
    for face, patch in zip(model.faces, layout.patches, strict=True):
        if face.id in painted:
            left, top, colours = patch.left - MARGIN, patch.top - MARGIN, painted[face.id]
            pages[patch.page][top : top + colours.shape[0], left : left + colours.shape[1]] = colours
    return pages, shown


def _pixels_hidden(face: FlatFace, number: int, shape: Shape, view: View, nearest: Nearest) -> int:
    """How many pixels of the photo show what hides face `number`, where no other face is nearer."""
    if not (face.hidden and shape.rings):
        return 0
    left, top, right, bottom = shape.box
    here = np.s_[top:bottom, left:right]
    is_hidden = np.zeros((bottom - top, right - left), bool)
    for ring in face.hidden:
        seen = seen_part(ring, view)
        if len(seen):
            is_hidden |= filled([seen[:, :2] / seen[:, 2:]], (left, top), is_hidden.shape)
    return int((is_hidden & (nearest.owner[here] == number) & (nearest.inverse_depth[here] > 0)).sum())


def hidden_in_photo(shape: Shape, nearest: Nearest) -> Bool:
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


def _paint(
    face: FlatFace, shape: Shape, patch: Patch, view: View, nearest: Nearest, photo: Pixels, fill: str
) -> tuple[Pixels, Pixels | None]:
    """RGB of a patch with its margin, and where the scene tells it as hidden, 255; None where it is not."""
    left, top, right, bottom = shape.box
    here = np.s_[top:bottom, left:right]
    behind = hidden_in_photo(shape, nearest)
    shown = np.where(behind, np.uint8(0), np.uint8(255))
    to_box = np.array([[1.0, 0.0, -left], [0.0, 1.0, -top], [0.0, 0.0, 1.0]])
    to_photo = to_box @ view.projection @ _to_space(face, patch)
    size = (patch.columns + 2 * MARGIN, patch.rows + 2 * MARGIN)
    seen = cv2.warpPerspective(
        shown, to_photo, size, flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP, borderMode=cv2.BORDER_CONSTANT
    )
    corner = (patch.left - MARGIN, patch.top - MARGIN)
    rings = [patch.texels(ring) - 0.5 for ring in face.rings]
    within = filled(rings, corner, size[::-1]) & in_front(to_photo, size)
    known = (seen >= _WHOLLY_SEEN) & within

    texels = abs(signed_area(rings[0]))
    step = math.sqrt(abs(signed_area(shape.rings[0])) / texels)  # px a texel, in the mean
    colours, to_colours = reduced(photo[here], step, to_photo)
    warped = cv2.warpPerspective(
        colours, to_colours, size, flags=cv2.INTER_CUBIC | cv2.WARP_INVERSE_MAP, borderMode=cv2.BORDER_REPLICATE
    )
    blurred = min(max(_BLURRED / step, 1.0), _MOST_BLURRED)
    pure, painted = _pure(known, blurred), np.asarray(warped, np.uint8)
    cover = cover_of(face, shape, behind, view, to_photo, size) if face.hidden else None
    clear = pure if cover is None else pure & (cover == 0)
    without_streaks(painted, clear, streaks(to_photo, size))
    if cover is not None:
        # Where it goes on behind another face; a pane has no colours of its own behind its wall.
        unseen = within & ~known & (cover > 0) & (face.opening is None)
        cover[unseen] = 255
        fill_behind(painted, cover, pure, fill)
        pure |= unseen
    reach = MARGIN + blurred + 1 if face.opening is None else max(size)  # the jamb before a pane hides more of the same
    return _continued(painted, pure, reach), cover


def _to_space(face: FlatFace, patch: Patch) -> Float:
    """(3, 3) from column, row and 1 of a texel of the patch with its margin to the point of the plane at its centre."""
    across, down = patch.right / patch.density[0], -patch.up / patch.density[1]
    start = patch.right * patch.corner[0] + patch.up * patch.corner[1] + (0.5 - MARGIN) * (across + down)
    if face.axis < MAIN and not face.tilt:  # exactly; a sum of products would round
        start[face.axis] = face.offset
    else:
        start += (face.offset - face.direction @ start) * face.direction
    return np.stack([across, down, start], axis=1)


def in_front(to_photo: Float, size: tuple[int, int]) -> Bool:
    """(rows, columns) where the plane is before the camera: behind it, too, the mathematics finds a pixel."""
    a, b, c = to_photo[2]
    before: Bool = (a * np.arange(size[0]))[None, :] > -(b * np.arange(size[1]) + c)[:, None]
    return before


def reduced(colours: Pixels, step: float, to_photo: Float) -> tuple[Pixels, Float]:
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
    if known.all():
        return colours
    painted = np.full_like(colours, PLAIN)
    places = np.flatnonzero(known)
    if len(places) == 0:
        return painted
    distance, label = cv2.distanceTransformWithLabels(
        _bytes(~known), cv2.DIST_L2, cv2.DIST_MASK_5, labelType=cv2.DIST_LABEL_PIXEL
    )
    source = np.zeros(int(label.max()) + 1, np.int64)
    source[label.ravel()[places]] = places
    cv2.copyTo(colours, _bytes(known), painted)
    beside = np.flatnonzero((distance <= reach) & ~known)
    painted.reshape(-1, 3)[beside] = colours.reshape(-1, 3)[source[label.ravel()[beside]]]
    return painted


def _bytes(mask: Bool) -> Pixels:
    return mask.astype(np.uint8)
