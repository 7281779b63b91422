"""The ground that a depth map shows: the level surface below the camera that fills most of the photo.

Feet of walls are told by pixels one wall at a time, and some are wrong; a map sees the whole ground at once.
"""

import numpy as np

from linecad.arrays import Bool, Float
from linecad.depth.depth_map import DepthMap, Kind, camera_depths
from linecad.geometry import world_rays
from linecad.ties.setting import Sight

COLUMNS = 160  # of the grid of pixels that are looked at
BESIDE = 1.5  # steps of the grid, to pixels that lie on the same surface
FLAT = 0.02  # log height by which these may differ
LEVEL = 1 / 3  # of what the log height of an upright wall differs by there
LEAST_SHARE = 0.02  # of the pixels, that are level
BIN, SPREAD = 0.004, 0.012  # log height: between the heights that are tried, and of the pixels of one surface
KERB = (0.03, 0.15)  # log height by which a pavement lies above its road
LEAST_PAVEMENT = 0.015  # of the level pixels, that the peak of a pavement counts
VALLEY = 0.5  # of that peak, which the fewest between it and the road have at most


def ground_of_map(depth: DepthMap, kind: Kind, shift: float, sight: Sight) -> float | None:
    """Log height of the camera above the ground in the map's unit; None where the map shows no level surface.

    Where a road and its pavement are seen, it is the pavement, for walls stand on that.
    """
    heights = _level_heights(depth, kind, shift, sight)
    if heights is None:
        return None
    places = np.arange(heights.min() - SPREAD, heights.max() + SPREAD, BIN)
    filled = np.bincount(np.rint((heights - places[0]) / BIN).astype(np.int64), minlength=len(places))
    reach = int(np.ceil(4 * SPREAD / BIN))
    bell = np.exp(-0.5 * (np.arange(-reach, reach + 1) * BIN / SPREAD) ** 2)
    count = np.convolve(filled, bell)[reach : reach + len(places)]
    best = int(count.argmax())
    inner = (count[1:-1] >= count[:-2]) & (count[1:-1] >= count[2:]) & (count[1:-1] > LEAST_PAVEMENT * len(heights))
    above = places[best] - places[1:-1]
    peaks = 1 + np.flatnonzero(inner & (above > KERB[0]) & (above < KERB[1]))
    pavements = [peak for peak in peaks.tolist() if count[peak:best].min() < VALLEY * count[peak]]
    return float(places[max(pavements, key=lambda peak: float(count[peak]), default=best)])


def _level_heights(depth: DepthMap, kind: Kind, shift: float, sight: Sight) -> Float | None:
    """Log heights (P,) of the camera above the pixels of a grid about which the map is level; None of too few."""
    step = depth.width / COLUMNS
    x, y = np.meshgrid(np.arange(step / 2, depth.width, step), np.arange(step / 2, depth.height, step))
    pixels = np.column_stack([x.ravel(), y.ravel()])
    beside = BESIDE * step * np.array([[0.0, 1.0], [0.0, -1.0], [1.0, 0.0], [-1.0, 0.0]])
    heights, down = _log_heights(pixels, depth, kind, shift, sight)
    others = [_log_heights(pixels + off, depth, kind, shift, sight) for off in beside]
    is_level: Bool = np.ones(len(pixels), bool)
    with np.errstate(invalid="ignore"):
        for number, (height, other_down) in enumerate(others):
            differs = np.abs(height - heights)
            is_level &= differs < FLAT
            if number < 2:  # above and below, where the height of a wall follows its ray
                is_level &= differs < LEVEL * np.abs(other_down - down)
    return heights[is_level] if is_level.mean() >= LEAST_SHARE else None


def _log_heights(pixels: Float, depth: DepthMap, kind: Kind, shift: float, sight: Sight) -> tuple[Float, Float]:
    """Logs (P,) of the camera's height above what the map shows at pixels (P, 2), and of how steep their rays go down.

    NaN above the camera and where the map has no depth.
    """
    column, row = np.rint(pixels).astype(np.int64).T
    inside = (column >= 0) & (column < depth.width) & (row >= 0) & (row < depth.height)
    column, row = np.where(inside, column, 0), np.where(inside, row, 0)
    rays = world_rays(pixels, sight.matrix, sight.rotation)
    slant = np.linalg.norm(rays[:, :3], axis=1)
    height = -rays[:, 2] * camera_depths(depth.values[row, column].astype(np.float64), slant, kind, shift)
    known = inside & depth.valid[row, column] & (height > 0)
    return np.log(np.where(known, height, np.nan)), np.log(np.where(known, -rays[:, 2], np.nan))
