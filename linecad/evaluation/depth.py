"""Depths of a reconstruction against true ones: of lines at points on edges, of lines and faces anywhere."""

from dataclasses import dataclass

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.directions import components
from linecad.evaluation.draughting.shapes import nearest_faces
from linecad.geometry import depths_beside, segment_coordinates, world_rays
from linecad.scene import Face, Plane, Scene

REACH = 4.0  # px between a surveyed point and the line that is taken to show it
LEAST_POINTS = 3  # for a median to be a scale: one point, or two, would always be right by their own
NO_LINE = -1


@dataclass(frozen=True)
class DepthScore:
    """Depths against surveyed points, after one scale for the whole photo; shares from 0 to 1."""

    points: int  # surveyed ones
    with_depth: int  # of them, those that got a depth
    recall_2: float  # share of all points with a depth within 2 %
    recall_5: float
    precision_2: float  # the same share of the points that got a depth
    precision_5: float
    scale: float | None  # found over true depth; None where nothing tells it, and then nothing counts as right


def score_depth(scene: Scene, pixels: Float, depth: Float, lines: Bool | None = None) -> DepthScore:
    """Score the lines of a scene (or the masked ones) against points at `pixels` (M, 2) with camera depths (M,).

    The pixels are those of the scene's photo: undistorted, square. The free scale is the median ratio of depths.
    """
    found = line_depths(scene, pixels, np.ones(len(scene.lines), bool) if lines is None else lines)
    return score(found, depth)


def score(found: Float, depth: Float, scale: float | None = None) -> DepthScore:
    """Score found depths (M,), NaN for none, against true ones (M,); the scale is the median ratio, or given."""
    has = np.isfinite(found) & (found > 0)
    total, count = len(found), int(has.sum())
    ratio = found[has] / depth[has]
    if scale is None and count >= LEAST_POINTS:
        scale = float(np.median(ratio))
    if scale is None or count == 0:
        return DepthScore(total, count, 0.0, 0.0, 0.0, 0.0, scale)
    error = np.abs(ratio / scale - 1)
    good_2, good_5 = int((error < 0.02).sum()), int((error < 0.05).sum())
    return DepthScore(total, count, good_2 / total, good_5 / total, good_2 / count, good_5 / count, scale)


def dense_depths(scene: Scene, pixels: Float, lines: Bool | None = None) -> Float:
    """Camera depth (M,) at pixels (M, 2) of a line within REACH, else of the nearest face on the ray, else NaN.

    With `lines` (N,) only those count, and the faces of planes that hold one of them.
    """
    found = line_depths(scene, pixels, np.ones(len(scene.lines), bool) if lines is None else lines)
    faces = scene.faces
    if lines is not None:
        ids = set(scene.lines.id[lines].tolist())
        faces = [pair for pair in faces if ids & set(pair[0].lines)]
    bare = ~np.isfinite(found)
    found[bare] = face_depths(scene, pixels[bare], faces)
    return found


def face_depths(scene: Scene, pixels: Float, faces: list[tuple[Plane, Face]]) -> Float:
    """Camera depth (M,) of the nearest face on the ray of each pixel (M, 2), NaN where there is none."""
    return nearest_faces(scene, pixels, faces)[1]


def line_depths(scene: Scene, pixels: Float, lines: Bool) -> Float:
    """Camera depth (M,) at pixels (M, 2) of the nearest of `lines` (N,) within REACH, else NaN."""
    return depths_of(scene, pixels, nearest_lines(scene, pixels, lines))


def nearest_lines(scene: Scene, pixels: Float, lines: Bool) -> Int:
    """Which of `lines` (N,) is nearest to each pixel (M, 2) within REACH: its row (M,), NO_LINE for none.

    A line that was joined from pieces is where they are, for its segment also covers what lies between them.
    """
    nearest = np.full(len(pixels), REACH)
    which = np.full(len(pixels), NO_LINE)
    for line in np.flatnonzero(lines).tolist():
        for segment in scene.lines.segments_of(line):
            place, beside = segment_coordinates(pixels, segment)
            distance = np.abs(beside)
            hit = (place >= 0) & (place <= np.linalg.norm(segment[1] - segment[0])) & (distance < nearest)
            which[hit] = line
            nearest[hit] = distance[hit]
    return which


def depths_of(scene: Scene, pixels: Float, which: Int) -> Float:
    """Camera depth (M,) at which the ray of each pixel (M, 2) passes nearest to line `which` (M,); NaN for NO_LINE."""
    has = which != NO_LINE
    line = which[has]
    rays = components(world_rays(pixels[has], scene.camera.matrix, scene.rotation), scene.turns)
    found = np.full(len(pixels), np.nan)
    found[has] = depths_beside(rays, components(scene.lines.ends[line, 0], scene.turns), scene.lines.axis[line])
    return found
