"""Depths of a reconstruction against true ones: of lines at points on edges, of lines and faces anywhere."""

from dataclasses import dataclass

import numpy as np
import shapely

from linecad.arrays import Bool, Float
from linecad.geometry import segment_coordinates, world_rays
from linecad.scene import Face, Plane, Scene

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
    scale: float = 1.0  # found over true depth, the median


def score_depth(scene: Scene, pixels: Float, depth: Float, lines: Bool | None = None) -> DepthScore:
    """Score the lines of a scene (or the masked ones) against points at `pixels` (M, 2) with camera depths (M,).

    The pixels are those of the scene's photo: undistorted, square. The free scale is the median ratio of depths.
    """
    found = line_depths(scene, pixels, np.ones(len(scene.lines), bool) if lines is None else lines)
    return score(found, depth)


def score(found: Float, depth: Float, scale: float | None = None) -> DepthScore:
    """Score found depths (M,), NaN for none, against true ones (M,); the scale is the median ratio, or given."""
    has = np.isfinite(found) & (found > 0)
    if not has.any():
        return DepthScore(len(found), 0, 0.0, 0.0, 0.0, 0.0, 1.0 if scale is None else scale)
    ratio = found[has] / depth[has]
    scale = float(np.median(ratio)) if scale is None else scale
    error = np.abs(ratio / scale - 1)
    good_2, good_5 = int((error < 0.02).sum()), int((error < 0.05).sum())
    total, count = len(found), int(has.sum())
    return DepthScore(total, count, good_2 / total, good_5 / total, good_2 / count, good_5 / count, scale)


def score_dense(scene: Scene, pixels: Float, depth: Float, scale: float) -> DepthScore:
    """Score lines and faces together at any pixels (M, 2): a line within REACH, else the nearest face on the ray.

    Only component 0 counts, since the others have no scale; `scale` is that of its lines.
    """
    own = scene.lines.component == 0
    found = line_depths(scene, pixels, own)
    bare = ~np.isfinite(found)
    ids = set(scene.lines.id[own].tolist())
    found[bare] = face_depths(scene, pixels[bare], [pair for pair in scene.faces if ids & set(pair[0].lines)])
    return score(found, depth, scale)


def face_depths(scene: Scene, pixels: Float, faces: list[tuple[Plane, Face]]) -> Float:
    """Camera depth (M,) of the nearest face on the ray of each pixel (M, 2), NaN where there is none."""
    nearest = np.full(len(pixels), np.inf)
    rays = world_rays(pixels, scene.camera.matrix, scene.rotation)
    for plane, face in faces:
        flat = np.delete(np.arange(3), plane.axis)
        with np.errstate(divide="ignore", invalid="ignore"):
            depth = plane.offset / rays[:, plane.axis]
        points = rays[:, flat] * np.where(np.isfinite(depth), depth, 0.0)[:, None]
        polygon = shapely.Polygon(face.outline[:, flat], [hole[:, flat] for hole in face.holes])
        hit = shapely.contains_xy(polygon, points) & (depth > 0) & (depth < nearest)
        nearest[hit] = depth[hit]
    return np.where(np.isfinite(nearest), nearest, np.nan)


def line_depths(scene: Scene, pixels: Float, lines: Bool) -> Float:
    """Camera depth (M,) at pixels (M, 2) of the nearest of `lines` (N,) within REACH, else NaN."""
    nearest = np.full(len(pixels), REACH)
    found = np.full(len(pixels), np.nan)
    rays = world_rays(pixels, scene.camera.matrix, scene.rotation)
    for line in np.flatnonzero(lines):
        start, end = segment = scene.lines.segment[line]
        place, beside = segment_coordinates(pixels, segment)
        distance = np.abs(beside)
        hit = (place >= 0) & (place <= np.linalg.norm(end - start)) & (distance < nearest)
        if not hit.any():
            continue
        across = np.delete(np.arange(3), scene.lines.axis[line])
        fixed = scene.lines.ends[line, 0, across]
        ray = rays[hit][:, across]
        found[hit] = (ray @ fixed) / (ray**2).sum(axis=1)
        nearest[hit] = distance[hit]
    return found
