"""Where the faces lie in the pictures that texture them: upright rectangles of texels, packed into few pages.

A *texel* is a pixel of a texture, a *page* one picture of them, a *patch* the rectangle of one face on a page. Texels
count from the corner of the page, x right, y down.

A patch is its face as seen straight from the front, so that a plane's texture is an affine function of the place on
it: three numbers a corner say all of it, and no triangle bends it. Its texels are as dense along either direction as
the pixels of the photo are where they are densest on the face.
"""

from dataclasses import dataclass

import numpy as np

from exporters.faces import FlatFace, signed_area
from exporters.model import Model
from linecad.arrays import Float
from linecad.scene import Scene

MARGIN = 8  # texels about each patch that continue its colours: three halvings of a page mix no two patches
TEXELS_PER_PIXEL = 4.0  # for a pixel that the face covers; a floor seen at a flat angle would ask for hundreds
TOTAL_PER_PIXEL = 8.0  # texels of all patches for a pixel of the photo, where faces lie behind each other
_NEAREST = 1e-6  # of the farthest depth of a face; nearer parts, and those behind the camera, are not in the photo


@dataclass(frozen=True, eq=False)
class View:
    """The photo's camera, at the origin of the model."""

    projection: Float  # (3, 3): pixel ~ projection @ point, in px from the centre of the first, scaled by the depth
    width: int  # px
    height: int  # px


def view_of(scene: Scene) -> View:
    """The camera of a scene."""
    return View(scene.camera.matrix @ scene.rotation, scene.camera.width, scene.camera.height)


@dataclass(frozen=True, eq=False)
class Patch:
    """The texels of one face."""

    page: int
    left: int  # texels from the corner of the page to the face's own texels, the margin left out
    top: int
    columns: int
    rows: int
    right: Float  # (3,) unit, the direction in space of increasing x
    up: Float  # (3,) unit, of decreasing y
    corner: Float  # (2,) m: where the texels begin, along `right` and `up`
    density: Float  # (2,) texels/m along `right` and `up`

    def texels(self, points: Float) -> Float:
        """(M, 2) texels from the corner of the page, of points (M, 3) of the face in m."""
        along = np.stack([points @ self.right - self.corner[0], self.corner[1] - points @ self.up], axis=-1)
        return np.array([self.left, self.top]) + along * self.density


@dataclass(frozen=True, eq=False)
class Layout:
    """The patches of all faces, in the order of the faces, and the size of each page in texels."""

    patches: tuple[Patch, ...]
    pages: tuple[tuple[int, int], ...]  # width, height


@dataclass(frozen=True, eq=False)
class _Wish:
    """A face before it has its place."""

    right: Float
    up: Float
    corner: Float
    size: Float  # (2,) m
    density: Float  # (2,) texels/m


def build_layout(model: Model, view: View, largest: int) -> Layout:
    """Places for all faces on pages of at most `largest` texels a side."""
    wishes = [_wish(face, view) for face in model.faces]
    total = sum(float(np.prod(np.maximum(wish.size * wish.density, 1.0))) for wish in wishes)
    shrink = min(1.0, np.sqrt(TOTAL_PER_PIXEL * view.width * view.height / max(total, 1.0)))
    room = largest - 2 * MARGIN
    sizes = []
    for wish in wishes:
        wanted = wish.size * wish.density * shrink
        wanted *= min(1.0, room / wanted.max(initial=1.0))
        sizes.append(np.clip(np.ceil(wanted - 1e-6).astype(np.int64), 1, room))
    places, pages = _pack([(int(width), int(height)) for width, height in sizes], largest)
    patches = [
        Patch(page, left, top, int(size[0]), int(size[1]), wish.right, wish.up, wish.corner, size / wish.size)
        for wish, size, (page, left, top) in zip(wishes, sizes, places, strict=True)
    ]
    return Layout(tuple(patches), pages)


def seen_part(points: Float, view: View) -> Float:
    """(C, 3) the part of a ring (V, 3) that lies in the photo, as homogeneous pixels whose last number is the depth.

    C is 0 where nothing does. A part that falls into pieces has edges along the border of the photo between them.
    """
    ring: Float = points @ view.projection.T
    edges = np.array(  # of the photo, as planes through the camera: what is inside has a positive product with each
        [[1, 0, 0.5], [-1, 0, view.width - 0.5], [0, 1, 0.5], [0, -1, view.height - 0.5]]
    )
    ring = cut_ring(ring, ring[:, 2] - _NEAREST * np.abs(ring[:, 2]).max())
    for edge in edges:
        ring = cut_ring(ring, ring @ edge)
    return ring


def cut_ring(ring: Float, inside: Float) -> Float:
    """The part of a ring (V, 3) where a linear function, given at its corners (V,), is not negative."""
    following, after = np.roll(ring, -1, axis=0), np.roll(inside, -1)
    rows: list[Float] = []
    for a, b, here, there in zip(ring, following, inside.tolist(), after.tolist(), strict=True):
        if here >= 0:
            rows.append(a)
        if (here >= 0) != (there >= 0):
            rows.append(a + (b - a) * (here / (here - there)))
    return np.array(rows).reshape(-1, 3)


def _wish(face: FlatFace, view: View) -> _Wish:
    # Walls stand upright; the far end of a floor is up and that of a ceiling down, as they are in the photo.
    up = np.array([0.0, 0.0, 1.0]) if face.axis != 2 else np.array([0.0, face.normal[2], 0.0])
    if face.tilt:  # up along the slope
        up = up - face.normal[2] * face.normal
        up /= np.linalg.norm(up)
    right = np.cross(up, face.normal)
    along, high = face.rings[0] @ right, face.rings[0] @ up
    corner = np.array([along.min(), high.max()])
    size = np.array([np.ptp(along), np.ptp(high)])
    return _Wish(right, up, corner, size, _density(face, np.stack([right, up]), size, view))


def _density(face: FlatFace, directions: Float, size: Float, view: View) -> Float:
    """(2,) texels/m along two directions (2, 3): the densest pixels that the face has, but not too many texels."""
    seen = seen_part(face.rings[0], view)
    if not len(seen):
        return 1.0 / size
    pixels, depth = seen[:, :2] / seen[:, 2:], seen[:, 2:]
    steps = directions @ view.projection.T
    per_metre = [np.linalg.norm(step[:2] - pixels * step[2], axis=1) / depth[:, 0] for step in steps]
    density = np.array([lengths.max() for lengths in per_metre])
    area = max(abs(signed_area(pixels)), 1.0)
    too_many = max(1.0, float(np.prod(size * density)) / (TEXELS_PER_PIXEL * area))
    enough: Float = density / np.sqrt(too_many)
    return enough


def _pack(sizes: list[tuple[int, int]], largest: int) -> tuple[list[tuple[int, int, int]], tuple[tuple[int, int], ...]]:
    """Page, left and top of each rectangle, in rows of descending height, and the sizes of the pages."""
    outer = [(width + 2 * MARGIN, height + 2 * MARGIN) for width, height in sizes]
    # About as wide as high, for all that goes on one page.
    width = max([int(np.ceil(np.sqrt(sum(w * h for w, h in outer)))), *(w for w, _ in outer)], default=1)
    width = min(width, largest)
    places: dict[int, tuple[int, int, int]] = {}
    used: list[list[int]] = []  # width and height of each page so far
    left = top = height = 0
    for index in sorted(range(len(outer)), key=lambda each: (-outer[each][1], each)):
        w, h = outer[index]
        if left + w > width:  # the next row
            left, top, height = 0, top + height, 0
        if not used or top + h > largest:  # the next page
            left, top, height = 0, 0, 0
            used.append([0, 0])
        places[index] = (len(used) - 1, left + MARGIN, top + MARGIN)
        used[-1] = [max(used[-1][0], left + w), max(used[-1][1], top + h)]
        left, height = left + w, max(height, h)
    return [places[index] for index in range(len(outer))], tuple((w, h) for w, h in used)
