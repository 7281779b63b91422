"""Measures of a reconstruction against ground truth (design of the measures: the paper's and depth against surveys)."""

from dataclasses import dataclass
from itertools import permutations

import numpy as np

from linecad.geometry import angles_to, world_rays
from linecad.scene import Bool, Float, Int, Scene

REACH = 4.0  # px between a surveyed point and the line that is taken to show it


@dataclass(frozen=True)
class DepthScore:
    """Depth of lines against surveyed points, after one scale for the whole photo; shares from 0 to 1."""

    points: int  # surveyed points on Manhattan segments
    with_depth: int  # of them, those within REACH of a reconstructed line
    recall_2: float  # share of all points with a depth within 2 %
    recall_5: float
    precision_2: float  # the same share of the points that got a depth
    precision_5: float


def score_depth(scene: Scene, pixels: Float, depth: Float, lines: Bool | None = None) -> DepthScore:
    """Score the lines of a scene (or the masked ones) against points at `pixels` (M, 2) with camera depths (M,).

    The pixels are those of the scene's photo: undistorted, square. The free scale is the median ratio of depths.
    """
    found = line_depths(scene, pixels, np.ones(len(scene.lines), bool) if lines is None else lines)
    has = np.isfinite(found) & (found > 0)
    if not has.any():
        return DepthScore(len(pixels), 0, 0.0, 0.0, 0.0, 0.0)
    ratio = found[has] / depth[has]
    error = np.abs(ratio / np.median(ratio) - 1)
    good_2, good_5 = int((error < 0.02).sum()), int((error < 0.05).sum())
    total, count = len(pixels), int(has.sum())
    return DepthScore(total, count, good_2 / total, good_5 / total, good_2 / count, good_5 / count)


def line_depths(scene: Scene, pixels: Float, lines: Bool) -> Float:
    """Camera depth (M,) at pixels (M, 2) of the nearest of `lines` (N,) within REACH, else NaN."""
    nearest = np.full(len(pixels), REACH)
    found = np.full(len(pixels), np.nan)
    rays = world_rays(pixels, scene.camera.matrix, scene.rotation)
    for line in np.flatnonzero(lines):
        start, end = scene.lines.segment[line]
        length = float(np.linalg.norm(end - start))
        along = (end - start) / length
        position = (pixels - start) @ along
        distance = np.abs((pixels - start) @ np.array([-along[1], along[0]]))
        hit = (position >= 0) & (position <= length) & (distance < nearest)
        if not hit.any():
            continue
        across = np.delete(np.arange(3), scene.lines.axis[line])
        fixed = scene.lines.ends[line, 0, across]
        ray = rays[hit][:, across]
        found[hit] = (ray @ fixed) / (ray**2).sum(axis=1)
        nearest[hit] = distance[hit]
    return found


def rotation_error(found: Float, true: Float) -> tuple[float, tuple[int, int, int]]:
    """Angle, rad, between two frames (3, 3) whose columns are axes of free name and sign; and which axis is which.

    The second value names, for each true axis, the found one.
    """
    best: tuple[float, tuple[int, int, int]] = (np.inf, (0, 1, 2))
    for names in permutations(range(3)):
        signs = np.sign((found[:, list(names)] * true).sum(axis=0))
        turn = (found[:, list(names)] * signs).T @ true
        angle = float(np.arccos(np.clip((np.trace(turn) - 1) / 2, -1, 1)))
        if angle < best[0]:
            best = (angle, (names[0], names[1], names[2]))
    return best


def nearest_axes(ends: Float, K: Float, rotation: Float) -> Int:
    """Axis (N,) whose vanishing point each segment (N, 2, 2) points to best."""
    axes: Int = angles_to(ends, (K @ rotation).T).argmin(axis=0)
    return axes
