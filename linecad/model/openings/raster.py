"""A wall seen straight on: what the photo shows of it, and where it has edges along its two directions.

Columns of the raster are as far apart as pixels of the photo are along the wall, so that near and far parts get what
they show; rows are evenly spaced. Edges are those of the photo, looked up at the points of the raster.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from linecad.arrays import Bool, Float
from linecad.model.openings.walls import GRAZING, Wall

Single = NDArray[np.float32]

WIDEST = 1280  # px; larger photos are made smaller first, smaller ones larger
MOST_ENLARGED = 2.0  # times: windows five px wide have sides to tell apart then
MARGIN = 0.05  # of a wall's extent, beyond its outermost lines
MOST_ROWS, MOST_COLUMNS = 480, 1000
LEAST_EXTENT = 24  # columns and rows of a raster worth looking at
SMOOTH = 0.8  # px, standard deviation, before the gradient
SCHARR = 32.0  # what the operator makes of one level a px
EDGE = (1.8, 4.0)  # grey levels a px, from which a gradient is an edge: on plain walls, on rough ones
TEXTURE = 1.5  # times the median gradient of a wall, between the two
CHROMA = 2.0  # grey levels for a step of OpenCV's a* or b*; 2.55 would suit the eye
ALONG = float(np.cos(np.radians(12.0)))  # of the angle between a gradient and the normal of the side
TRIM = 1.0  # per cent of the lines' ends at either side that do not count for the extent
NEAREST = 0.05  # of the wall's distance: what is nearer along the view is not looked at


@dataclass(frozen=True, eq=False)
class Sight:
    """The photo, small enough to be looked at often and large enough for small windows."""

    colours: NDArray[np.uint8]  # (H, W, 3) Lab
    # (H, W, 2) grey levels a px, x and y, of lightness or colour, whichever changes more; a px of the photo where this
    # is larger
    gradient: Single
    scale: float  # px of it over px of the photo


@dataclass(frozen=True, eq=False)
class Raster:
    """R x C points of a wall."""

    u: Float  # (C,) ascending
    v: Float  # (R,) ascending
    colours: NDArray[np.uint8]  # (R, C, 3) Lab
    inside: Bool  # (R, C) in the photo
    upright: Bool  # (R, C) an edge along v is here
    level: Bool  # (R, C) an edge along u is here


def look(pixels: NDArray[np.uint8]) -> Sight:
    """A photo (H, W, 3) with its gradients, at most WIDEST px wide."""
    scale = min(MOST_ENLARGED, WIDEST / pixels.shape[1])
    enlarged = max(scale, 1.0)
    sized = pixels
    if scale != 1:
        size = (round(pixels.shape[1] * scale), round(pixels.shape[0] * scale))
        way = cv2.INTER_AREA if scale < 1 else cv2.INTER_CUBIC
        sized = np.asarray(cv2.resize(pixels, size, interpolation=way), np.uint8)
    colours = np.asarray(cv2.cvtColor(sized, cv2.COLOR_RGB2LAB), np.uint8)
    along_x, along_y = _gradient(np.asarray(cv2.cvtColor(sized, cv2.COLOR_RGB2GRAY), np.uint8), 1.0, enlarged)
    for channel in cv2.split(colours)[1:]:
        other_x, other_y = _gradient(np.asarray(channel, np.uint8), CHROMA, enlarged)
        steeper = other_x * other_x + other_y * other_y > along_x * along_x + along_y * along_y
        along_x, along_y = np.where(steeper, other_x, along_x), np.where(steeper, other_y, along_y)
    return Sight(colours, np.dstack([along_x, along_y]), scale)


def _gradient(channel: NDArray[np.uint8], levels: float, enlarged: float) -> tuple[Single, Single]:
    """The gradient (H, W) along x and y of a channel (H, W), of which a step counts as so many grey levels.

    A px is what it was before the channel was `enlarged` so many times.
    """
    smooth = cv2.GaussianBlur(channel.astype(np.float32), (0, 0), SMOOTH * enlarged)
    along_x, along_y = (
        np.asarray(cv2.Scharr(smooth, cv2.CV_32F, dx, 1 - dx, scale=levels * enlarged / SCHARR), np.float32)
        for dx in (1, 0)
    )
    return along_x, along_y


def build_raster(wall: Wall, sight: Sight) -> Raster | None:
    """The raster of the part of a wall in which its lines lie; None where the photo shows too little of it."""
    u, v = _extent(wall, sight)
    if len(u) < LEAST_EXTENT or len(v) < LEAST_EXTENT:
        return None
    matrix = wall.homography()
    # Each image coordinate is a sum of one number a column and one a row.
    x, y, depth = (
        ((matrix[k, 0] * u + matrix[k, 2])[None] + (matrix[k, 1] * v)[:, None]).astype(np.float32) for k in range(3)
    )
    at_x, at_y = ((way / depth + np.float32(0.5)) * np.float32(sight.scale) - np.float32(0.5) for way in (x, y))
    height, width = sight.gradient.shape[:2]
    inside = (at_x >= 1) & (at_y >= 1) & (at_x <= width - 2) & (at_y <= height - 2)
    gradient = cv2.remap(sight.gradient, at_x, at_y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT)
    along_x, along_y = cv2.split(gradient)
    strength = np.asarray(cv2.magnitude(along_x, along_y), np.float32)
    edges = []
    for column in range(2):
        # The image direction of u or v; the edge runs along it and the gradient across.
        towards_x = np.float32(matrix[0, column]) * depth - x * np.float32(matrix[2, column])
        towards_y = np.float32(matrix[1, column]) * depth - y * np.float32(matrix[2, column])
        across = np.abs(along_x * towards_y - along_y * towards_x) / cv2.magnitude(towards_x, towards_y)
        edges.append(np.where(inside & (across >= np.float32(ALONG) * strength), across, np.float32(0)))
    colours = np.asarray(cv2.remap(sight.colours, at_x, at_y, cv2.INTER_LINEAR), np.uint8)
    least = least_edge(strength[inside])
    return Raster(u, v, colours, inside, _thin(edges[1], 1, least), _thin(edges[0], 0, least))


def least_edge(strength: Single) -> np.float32:
    """From which gradient on an edge is one, of the gradients (P,) of a wall: plain walls have fainter ones."""
    usual = float(np.median(strength)) if len(strength) else 0.0
    return np.float32(np.clip(TEXTURE * usual, *EDGE))


def _thin(strength: Single, across: int, least: np.float32) -> Bool:
    """Where an edge is the strongest of three across, and at least so strong."""
    beyond = np.pad(strength, [(int(axis == across),) * 2 for axis in range(2)])
    before, after = (beyond[:-2], beyond[2:]) if across == 0 else (beyond[:, :-2], beyond[:, 2:])
    return np.asarray((strength >= least) & (strength >= before) & (strength >= after))


def _extent(wall: Wall, sight: Sight) -> tuple[Float, Float]:
    """The coordinates of columns and rows."""
    nothing = np.zeros(0), np.zeros(0)
    ends_u = np.concatenate([wall.level.ends.ravel(), wall.upright.at])
    ends_v = np.concatenate([wall.upright.ends.ravel(), wall.level.at])
    low_u, high_u = np.percentile(ends_u, [TRIM, 100 - TRIM])
    low_v, high_v = np.percentile(ends_v, [TRIM, 100 - TRIM])
    add = MARGIN * (high_v - low_v)
    v = np.array([low_v - add, high_v + add])
    fine = np.linspace(low_u - MARGIN * (high_u - low_u), high_u + MARGIN * (high_u - low_u), 2001)
    along = np.column_stack([fine, np.full(len(fine), np.median(ends_v))])
    points = wall.points(along)
    facing = np.abs(points[:, wall.plane.axis]) / np.linalg.norm(points, axis=1)
    depth = wall.points(np.stack(np.meshgrid(fine, v), axis=-1)) @ wall.rotation[2]
    along = along[(facing >= GRAZING) & (depth > NEAREST * abs(wall.plane.offset)).all(axis=0)]
    if len(along) < 2:
        return nothing
    middle = wall.pixels(along) * sight.scale
    seen = (middle[:, 0] >= 0) & (middle[:, 0] <= sight.gradient.shape[1])
    if seen.sum() < 2:
        return nothing
    along, middle = along[seen], middle[seen]
    run = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(middle, axis=0), axis=1))])
    columns = max(int(min(run[-1], MOST_COLUMNS)), 2)
    u = np.interp(np.linspace(0, run[-1], columns), run, along[:, 0])
    uprights = wall.pixels(np.stack(np.meshgrid(u, v), axis=-1)) * sight.scale
    tall = np.percentile(np.linalg.norm(uprights[1] - uprights[0], axis=1), 75)
    return u, np.linspace(v[0], v[1], max(int(min(tall, MOST_ROWS)), 2))
