"""A depth buffer for triangles with pictures on them, and for lines: exact in double precision, no graphics library.

Over a triangle the inverse depth, and each coordinate of the picture over the depth, are linear in the image. So a
triangle is three rows of three numbers for all its pixels, whatever part of it is clipped. A pixel shows the nearest
triangle at its centre, from the front or from the back; its colour is read from the halving of the picture whose
texels are about as large as the pixel.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from linecad.arrays import Bool, Float, Int
from linecad.dataset.rasteriser import clip_near, project_edges
from linecad.evaluation.turned.glb import GlbModel, Material, is_front

NOTHING = -1
BACKGROUND = (0.93, 0.94, 0.96)  # sRGB
NEAREST = 1e-3  # of the distance that a view looks at; what is nearer is cut away
LINE_BIAS = 1e-3  # of the depth; a face does not hide the lines in it
AMBIENT = 0.4  # of the light on a lit face that the lamp does not shine on
TO_LAMP = np.array([-0.3, -0.5, -1.0])  # from what is lit, in the frame of the camera: over its left shoulder
TINY = 1e-12


@dataclass(frozen=True, eq=False)
class View:
    """A camera that a picture is drawn from."""

    name: str
    matrix: Float  # (3, 3) px
    rotation: Float  # (3, 3) world to camera: x right, y down, z forward
    position: Float  # (3,)
    distance: float  # of what it looks at, in the world's unit
    width: int  # px
    height: int

    def to_camera(self, points: Float) -> Float:
        """Points (..., 3) of the world in the frame of the camera."""
        seen: Float = (points - self.position) @ self.rotation.T
        return seen


@dataclass(frozen=True, eq=False)
class Drawn:
    """What each pixel of a view shows."""

    triangle: Int  # (H, W), or NOTHING
    inverse_depth: Float  # (H, W), 0 for nothing
    rows: Float  # (T, 3, 3) u / z, v / z and 1 / z of each triangle, linear in (x, y, 1) px


def draw_triangles(model: GlbModel, view: View) -> Drawn:
    """The nearest triangle at the centre of each pixel; backs of materials with one side are left out."""
    camera = view.to_camera(model.triangles)
    rows, is_flat = _linear_rows(camera, model.texels, view.matrix)
    double = np.array([each.is_double_sided for each in model.materials], bool)
    shown = is_flat & (double[model.material] | is_front(model.triangles, view.position))
    inverse = np.zeros(view.width * view.height)
    triangle = np.full(len(inverse), NOTHING)
    near = NEAREST * view.distance
    for number in np.flatnonzero(shown & (camera[:, :, 2] > near).any(axis=1)).tolist():
        outline = clip_near(camera[number], near)
        image = outline @ view.matrix.T
        pixel = _covered(image[:, :2] / image[:, 2:], view.width, view.height)
        y, x = np.divmod(pixel, view.width)
        value = rows[number, 2] @ np.stack([x, y, np.ones(len(pixel))])
        is_nearer = value > inverse[pixel]
        inverse[pixel[is_nearer]] = value[is_nearer]
        triangle[pixel[is_nearer]] = number
    shape = view.height, view.width
    return Drawn(triangle.reshape(shape), inverse.reshape(shape), rows)


def _linear_rows(camera: Float, texels: Float, matrix: Float) -> tuple[Float, Bool]:
    """The rows (T, 3, 3) of `Drawn`, and which triangles (T,) are not seen edge on."""
    # On the plane through the corners u, v and 1 are linear in the point; over its depth, in the pixel.
    size = np.abs(camera).max(axis=(1, 2), initial=TINY)
    is_flat: Bool = np.abs(np.linalg.det(camera / size[:, None, None])) > TINY
    values = np.concatenate([texels, np.ones((*texels.shape[:2], 1))], axis=2)
    rows = np.zeros_like(camera)
    rows[is_flat] = np.linalg.solve(camera[is_flat], values[is_flat]).transpose(0, 2, 1) @ np.linalg.inv(matrix)
    return rows, is_flat


def _covered(outline: Float, width: int, height: int) -> Int:
    """Flat indices of the pixels whose centres a convex polygon (N, 2) px holds, none of them twice for neighbours."""
    low, high = outline.min(axis=0), outline.max(axis=0)
    top, bottom = max(0, int(np.ceil(max(low[1], 0)))), int(np.ceil(min(high[1], height)))
    if top >= bottom or high[0] < 0 or low[0] > width:
        return np.zeros(0, np.int64)
    y = np.arange(top, bottom)
    start, end = outline, np.roll(outline, -1, axis=0)
    # From the upper end, so that two triangles compute their common edge alike to the last digit.
    turned = (start[:, 1] > end[:, 1])[:, None]
    start, end = np.where(turned, end, start), np.where(turned, start, end)
    with np.errstate(divide="ignore", invalid="ignore"):
        share = (y[:, None] - start[:, 1]) / (end[:, 1] - start[:, 1])
        at = start[:, 0] + share * (end[:, 0] - start[:, 0])
    # Half open, so that a corner counts once.
    crossed = (start[:, 1] <= y[:, None]) & (y[:, None] < end[:, 1])
    left = np.clip(np.where(crossed, at, np.inf).min(axis=1), 0, width)
    right = np.clip(np.where(crossed, at, -np.inf).max(axis=1), 0, width)
    first = np.ceil(left).astype(np.int64)
    count = np.maximum(np.ceil(right).astype(np.int64) - first, 0)
    begin = np.cumsum(count) - count
    return np.repeat(y * width + first - begin, count) + np.arange(int(count.sum()))


def paint(model: GlbModel, view: View, drawn: Drawn) -> NDArray[np.uint8]:
    """The picture (H, W, 3) RGB of the triangles."""
    colours = np.full((view.height, view.width, 3), np.array(BACKGROUND) * 255, np.float32)
    shown = drawn.triangle != NOTHING
    material = np.where(shown, model.material[drawn.triangle], NOTHING) if len(model.material) else drawn.triangle
    for number in np.unique(material[shown]).tolist():
        own = material == number
        look = model.materials[number]
        if look.picture is not None and not look.is_lit and (look.colour == 1).all():
            colours[own] = _texels(look.halvings, drawn, own)  # through linear light and back it would be the same
            continue
        shade = _shade(model, view, drawn.triangle[own]) if look.is_lit else np.ones(int(own.sum()))
        light = shade[:, None] * look.colour
        if look.picture is not None:
            light = light * _linear_light(_texels(look.halvings, drawn, own) / 255)
        colours[own] = 255 * _srgb(light)
    return np.asarray(np.round(np.clip(colours, 0, 255)), np.uint8)


def _texels(halvings: list[NDArray[np.uint8]], drawn: Drawn, own: Bool) -> Float:
    """The colours (M, 3) of a picture at the masked pixels, each from the halving that fits."""
    y, x = np.nonzero(own)
    rows = drawn.rows[drawn.triangle[own]]
    u, v, w = (rows[:, each, 0] * x + rows[:, each, 1] * y + rows[:, each, 2] for each in range(3))
    u, v = u / w, v / w
    steps = [(rows[:, each, axis] - at * rows[:, 2, axis]) / w for each, at in ((0, u), (1, v)) for axis in (0, 1)]
    # Texels a pixel: the mean of both directions, since one alone blurs or tears what is seen at a flat angle.
    area = np.abs(steps[0] * steps[3] - steps[1] * steps[2]) * halvings[0].shape[0] * halvings[0].shape[1]
    level = np.minimum(np.round(np.log2(np.maximum(area, 1.0)) / 2).astype(np.int64), len(halvings) - 1)
    found = np.zeros((len(x), 3))
    for step, picture in enumerate(halvings):
        which = np.flatnonzero(level == step)
        if len(which):
            found[which] = _sampled(picture, u[which], v[which])
    return found


def _sampled(picture: NDArray[np.uint8], u: Float, v: Float) -> Float:
    """The colours (M, 3) between the texels, clamped to the picture's edge."""
    side = int(np.ceil(np.sqrt(len(u))))  # cv2 takes maps of limited length only
    places = np.zeros((2, side * side), np.float32)
    places[0, : len(u)] = u * picture.shape[1] - 0.5
    places[1, : len(u)] = v * picture.shape[0] - 0.5
    maps = places.reshape(2, side, side)
    read = cv2.remap(picture, maps[0], maps[1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    return np.asarray(read.reshape(-1, 3)[: len(u)], np.float64)


def _shade(model: GlbModel, view: View, triangle: Int) -> Float:
    """The light (M,) on lit triangles (M,) of a lamp far behind the camera, the same on all of one plane."""
    corners = model.triangles
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lamp = TO_LAMP @ view.rotation / np.linalg.norm(TO_LAMP)
    light: Float = AMBIENT + (1 - AMBIENT) * np.abs(normal @ lamp) / np.maximum(np.linalg.norm(normal, axis=1), TINY)
    return light[triangle]


def _linear_light(srgb: Float) -> Float:
    light: Float = np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
    return light


def _srgb(light: Float) -> Float:
    light = np.clip(light, 0.0, 1.0)
    srgb: Float = np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)
    return srgb


def visible_lines(lines: Float, view: View, drawn: Drawn) -> tuple[Float, Int]:
    """The pieces (P, 2, 2), px, of lines (L, 2, 3) that no triangle hides, and the line (P,) of each."""
    near = NEAREST * view.distance
    image, depth, owner = project_edges(view.to_camera(lines), view.matrix, view.width, view.height, near)
    counts = np.ceil(np.linalg.norm(image[:, 1] - image[:, 0], axis=1)).astype(np.int64) + 2
    line = np.repeat(np.arange(len(owner)), counts)
    first = np.repeat(np.cumsum(counts) - counts, counts)
    share = (np.arange(len(line)) - first) / (counts[line] - 1)
    pixels = image[line, 0] + share[:, None] * (image[line, 1] - image[line, 0])
    inverse = (1 - share) / depth[line, 0] + share / depth[line, 1]
    seen = np.zeros(len(line), bool)
    corner = np.floor(pixels).astype(np.int64)
    for right in (0, 1):
        for down in (0, 1):
            column = np.clip(corner[:, 0] + right, 0, view.width - 1)
            row = np.clip(corner[:, 1] + down, 0, view.height - 1)
            triangle = drawn.triangle[row, column]
            plane = drawn.rows[triangle, 2] if len(drawn.rows) else np.zeros((len(row), 3))
            before = plane[:, 0] * pixels[:, 0] + plane[:, 1] * pixels[:, 1] + plane[:, 2]
            seen |= (triangle == NOTHING) | (inverse >= before * (1 - LINE_BIAS))
    # A run starts where a seen point follows a hidden one or another line's.
    same = np.r_[False, line[1:] == line[:-1]]
    starts = np.flatnonzero(seen & ~(same & np.r_[False, seen[:-1]]))
    ends = np.flatnonzero(seen & ~np.r_[same[1:] & seen[1:], False])
    return np.stack([pixels[starts], pixels[ends]], axis=1), owner[line[starts]]


def colour_of(material: Material) -> tuple[int, int, int]:
    """The sRGB colour of a material without a picture, 0 to 255."""
    red, green, blue = np.round(255 * _srgb(material.colour)).astype(int).tolist()
    return red, green, blue
