"""Simulated depth maps: true depth with the errors of a network that saw one photo.

Errors are one Cauchy draw per wall in log depth, a smooth warp, edges that bleed, a sky at one far value, a wrong scale
and, in maps of disparity, a shift. The best networks have Cauchy widths of 1 % (rooms) to 3.5 % (streets).
"""

from typing import Any, Literal

import cv2
import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from linecad.arrays import Bool, Float, Int
from linecad.dataset.truth import NOTHING, Truth
from linecad.dataset.walls import walls_of_quads
from linecad.depth.depth_map import SMALLEST_SIDE, Single
from linecad.geometry import resized_camera

MapKind = Literal["z", "affine-inverse"]
LONGEST_SIDE = 768  # px, as networks work in; larger photos get smaller maps
NARROWEST, WIDEST = 0.001, 0.2  # widths of the walls' errors in log depth that can be asked for
LARGEST_ERROR = np.log(2)  # of a wall, in log depth; a Cauchy draw has no limit
LARGEST_SCALE = 2.0  # factor by which the scale is wrong, at most
WARP = 0.3  # of the width, the root of the mean square of the warp
WAVES = 3  # half waves of the warp along a side, less one
RAMP = (3.0, 10.0)  # px of the map over which an edge bleeds
SKY = 1.25  # times the farthest depth, where the sky is put
LARGEST_SHIFT = 0.9  # of the smallest inverse depth, up or down: all of it would put the farthest wall at infinity


def corrupted_depth(depth: Float, walls: Int, width: float, rng: Generator, kind: MapKind = "z") -> Single:
    """What a network of that error width would write for true z depth (H, W): a map (H, W) of that `kind`, in no unit.

    `walls` (H, W) says which surface each pixel shows, by any number from 0 on, or NOTHING for the sky; all that shows
    one number has one error. Depth is above 0, or NaN on a wall where nobody knows it; there the map is NaN too. The
    sky is the farthest value of z, and 0 in disparity, but where walls bleed into it. Nothing is resized: `map_pixels`
    says where a map of a network's size samples a photo. Raises ValueError where no wall has depth.
    """
    is_sky = walls == NOTHING
    is_wall = ~is_sky & np.isfinite(depth)
    if not is_wall.any():
        raise ValueError("no pixel shows a wall with a depth")
    # All is drawn whatever the kind, so that maps of both kinds have the same errors.
    log_scale = rng.uniform(-1, 1) * np.log(LARGEST_SCALE)
    shift = rng.uniform(-LARGEST_SHIFT, LARGEST_SHIFT)
    ramp = rng.uniform(*RAMP)
    off = log_scale + _warp(depth.shape, WARP * width, rng) + _wall_errors(walls, width, rng)
    inverse = np.zeros(depth.shape)
    inverse[is_wall] = np.exp(-off[is_wall]) / depth[is_wall]
    smallest = inverse[is_wall].min()
    if kind == "affine-inverse":
        inverse[is_wall] += shift * smallest
    else:
        inverse[is_sky] = smallest / SKY
    inverse = _bled(inverse, walls, is_wall | is_sky, ramp)
    found = inverse if kind == "affine-inverse" else 1 / inverse
    return found.astype(np.float32)


def map_pixels(height: int, width: int) -> tuple[Int, Int]:
    """Rows (h,) and columns (w,) of a photo that the middles of the pixels of its map lie in."""
    shrink = min(1.0, LONGEST_SIDE / max(height, width))
    return _middles(height, shrink), _middles(width, shrink)


def _middles(side: int, shrink: float) -> Int:
    own = max(SMALLEST_SIDE, round(side * shrink))
    return ((np.arange(own) + 0.5) * side / own).astype(np.int64)


def map_arrays(found: Single, kind: MapKind, matrix: Float, width: int, height: int) -> dict[str, NDArray[Any]]:
    """The arrays of an .npz that holds a map (h, w), by the names under which networks write them.

    `depth` (h, w) with `intrinsics` (3, 3), K in px of the map, tells that it is z; `disparity` (h, w) alone that it is
    affine-inverse. `matrix` is K of the photo of `width` x `height` px.
    """
    if kind == "affine-inverse":
        return {"disparity": found}
    scale = np.array([found.shape[1] / width, found.shape[0] / height])
    return {"depth": found, "intrinsics": resized_camera(matrix, scale)}


def draw_depth_map(truth: Truth, width: float, kind: MapKind, rng: Generator) -> dict[str, NDArray[Any]]:
    """The arrays of a simulated map of a made photo, of a network's size and that error width."""
    rows, columns = map_pixels(truth.height, truth.width)
    quads = truth.ids[np.ix_(rows, columns)]
    x, y = np.meshgrid(columns, rows)
    depth = truth.quad_depth(np.column_stack([x.ravel(), y.ravel()]).astype(np.float64), quads.ravel())
    walls = np.append(walls_of_quads(truth.quads, truth.body), NOTHING)[quads]
    found = corrupted_depth(depth.reshape(quads.shape), walls, width, rng, kind)
    return map_arrays(found, kind, truth.matrix, truth.width, truth.height)


def _wall_errors(walls: Int, width: float, rng: Generator) -> Float:
    """The error (H, W) in log depth, one number for all pixels of a wall."""
    _, index = np.unique(walls, return_inverse=True)
    drawn = width * rng.standard_cauchy(int(index.max()) + 1)
    errors: Float = np.clip(drawn, -LARGEST_ERROR, LARGEST_ERROR)[index.reshape(walls.shape)]
    return errors


def _warp(shape: tuple[int, ...], size: float, rng: Generator) -> Float:
    """A smooth field (H, W) of mean 0 and that size, the root of its mean square."""
    down, across = (np.cos(np.pi * np.outer((np.arange(side) + 0.5) / side, np.arange(WAVES))) for side in shape)
    strength = rng.standard_normal((WAVES, WAVES))
    strength[0, 0] = 0.0
    field = down @ strength @ across.T
    warp: Float = size / np.sqrt((field**2).mean()) * field
    return warp


def _bled(inverse: Float, walls: Int, is_known: Bool, ramp: float) -> Float:
    """Inverse depth (H, W) of which edges are ramps of so many px, and NaN where it is not known.

    They are means of inverse depth, in which planes are linear: a wall without relief stays what it is.
    """
    half = int(np.ceil((ramp - 1) / 2))
    weights = np.clip((ramp + 1) / 2 - np.abs(np.arange(-half, half + 1)), 0, 1)
    known = is_known.astype(np.float64)
    total = cv2.sepFilter2D(np.where(is_known, inverse, 0.0), -1, weights, weights)
    weight = cv2.sepFilter2D(known, -1, weights, weights)
    mean = total / np.where(is_known, weight, np.nan)
    window = np.ones((len(weights), len(weights)), np.uint8)
    labels = walls.astype(np.float64)
    is_one = cv2.dilate(labels, window) == cv2.erode(labels, window)
    # Cut off by the border of the map or by what is not known, a window has its middle elsewhere: planes would bend.
    is_cut = cv2.erode(known, window, borderType=cv2.BORDER_CONSTANT, borderValue=0.0) == 0
    return np.where(is_known, np.where(is_one & is_cut, inverse, mean), np.nan)
