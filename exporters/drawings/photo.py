"""The photo beneath a drawing: each face in its place, from straight before it, as far as the photo shows it.

The facade is rectified in its plane, and every other face of the view in its own, so that windows that are set back
and walls behind lie under their lines too. A face hides what is behind it in the drawing, and in the photo. What the
photo does not show stays white.
"""

import math
from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from exporters.drawings.projection import Projection, Shown
from exporters.drawings.records import Picture, View
from exporters.model import Model
from exporters.textures.layout import view_of
from exporters.textures.nearest import SHIFT, Nearest, Shape, filled, nearest_of, shape_of
from exporters.textures.rectify import Pixels, hidden_in_photo, in_front, reduced
from linecad.arrays import Bool, Float
from linecad.errors import OutputError

INCH = 25.4  # mm
_WHOLLY_SEEN = 250  # of 255, of a pixel
MOST_PIXELS = 100_000_000
_WHITE = 255


def build_picture(
    model: Model, shown: Sequence[Shown], projection: Projection, view: View, dpi: int, photo: Pixels
) -> Picture:
    """The picture of the faces of a view, at `dpi` on its paper, from the photo (H, W, 3) of the model's camera.

    Raises OutputError where it would have more than MOST_PIXELS.
    """
    step = INCH / dpi / view.scale
    x0, y0, x1, y1 = view.box
    columns, rows = math.ceil((x1 - x0) / step - 1e-6), math.ceil((y1 - y0) / step - 1e-6)
    if columns * rows > MOST_PIXELS:
        fits = int(dpi * math.sqrt(MOST_PIXELS / (columns * rows)))
        raise OutputError(f"at {dpi} dpi the photo has {columns} x {rows} px, too many; --option dpi={fits} does")
    # From column, row and 1 of a pixel to x, y and 1 of its centre.
    to_drawing = np.array([[step, 0.0, x0 + step / 2], [0.0, -step, y1 - step / 2], [0.0, 0.0, 1.0]])
    pixels = np.full((rows, columns, 3), _WHITE, np.uint8)
    owner = _owners(shown, to_drawing, (rows, columns))
    camera = view_of(model.scene)
    shapes = {face.id: shape_of(face.moved(-model.eye), camera) for face in model.faces}
    nearest = nearest_of(list(shapes.values()), camera)
    for number, each in enumerate(shown):
        shape = shapes[each.face.id]
        if shape.rings:
            in_space = _to_space(projection, each) @ to_drawing
            in_space[:, 2] -= model.eye
            _paint(pixels, owner == number, camera.projection @ in_space, (shape, nearest), photo)
    return Picture(pixels, x0, y1, step, float(dpi))


def _to_space(projection: Projection, shown: Shown) -> Float:
    """(3, 3) from drawing metres x, y and 1 to the point in space, m, that the face has there."""
    a, b, c = shown.height
    across, up = projection.right + a * projection.toward, projection.up + b * projection.toward
    return np.stack([across, up, projection.origin + c * projection.toward], axis=1)


def _owners(shown: Sequence[Shown], to_drawing: Float, size: tuple[int, int]) -> NDArray[np.int32]:
    """(rows, columns) the number of the face that is highest at each pixel; -1 where there is none."""
    owner = np.full(size, -1, np.int32)
    highest = np.full(size, -np.inf, np.float32)
    to_pixels = np.linalg.inv(to_drawing)
    for number, each in enumerate(shown):
        rings = [ring[:, :2] @ to_pixels[:2, :2].T + to_pixels[:2, 2] for ring in each.rings]
        left, top = np.clip(np.floor(rings[0].min(axis=0)).astype(int) - 1, 0, size[::-1]).tolist()
        right, bottom = np.clip(np.ceil(rings[0].max(axis=0)).astype(int) + 2, 0, size[::-1]).tolist()
        here = np.s_[top:bottom, left:right]
        if not owner[here].size:
            continue
        inside = filled([_clipped(ring) for ring in rings], (left, top), owner[here].shape)
        a, b, c = each.height @ to_drawing
        height = (a * np.arange(left, right) + c)[None, :] + (b * np.arange(top, bottom))[:, None]
        higher = inside & (height > highest[here])
        highest[here][higher] = height[higher]
        owner[here][higher] = number
    return owner


def _clipped(ring: Float) -> Float:
    """Pixels as far as the 32 bits of OpenCV reach; what lies beyond them is far outside the picture."""
    most = 2.0 ** (30 - SHIFT)
    return np.clip(ring, -most, most)


def _paint(pixels: Pixels, own: Bool, to_photo: Float, seen: tuple[Shape, Nearest], photo: Pixels) -> None:
    """Paint the pixels of a face, in place; `to_photo` (3, 3) takes column, row and 1 of them to px of the photo."""
    rows, columns = np.flatnonzero(own.any(axis=1)), np.flatnonzero(own.any(axis=0))
    if not len(rows):
        return
    here = np.s_[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
    size = (int(columns[-1] - columns[0]) + 1, int(rows[-1] - rows[0]) + 1)
    left, top, right, bottom = seen[0].box
    to_here = np.array([[1.0, 0.0, columns[0]], [0.0, 1.0, rows[0]], [0.0, 0.0, 1.0]])
    to_box = np.array([[1.0, 0.0, -left], [0.0, 1.0, -top], [0.0, 0.0, 1.0]]) @ to_photo @ to_here
    plain = np.where(hidden_in_photo(*seen), np.uint8(0), np.uint8(255))
    shown = cv2.warpPerspective(
        plain, to_box, size, flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP, borderMode=cv2.BORDER_CONSTANT
    )
    known = own[here] & (np.asarray(shown) >= _WHOLLY_SEEN) & in_front(to_box, size)
    colours, to_colours = reduced(photo[top:bottom, left:right], _step(to_box, known), to_box)
    warped = cv2.warpPerspective(
        colours, to_colours, size, flags=cv2.INTER_CUBIC | cv2.WARP_INVERSE_MAP, borderMode=cv2.BORDER_REPLICATE
    )
    pixels[here][known] = np.asarray(warped, np.uint8)[known]


def _step(to_box: Float, known: Bool) -> float:
    """Px of the photo for a pixel, in the middle of those that are painted; 1 where none is."""
    places = np.argwhere(known)
    if not len(places):
        return 1.0
    row, column = places[len(places) // 2].tolist()
    x, y, w = to_box @ np.array([column, row, 1.0])
    change = (to_box[:2, :2] - np.outer([x, y], to_box[2, :2]) / w) / w
    return float(np.sqrt(abs(np.linalg.det(change))))
