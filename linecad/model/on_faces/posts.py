"""Uprights whose lower end the photo shows on the ground: lamp posts, trunks, cars. They stand there.

Crossings often join such a line to the wall behind it. There its lower end would be below the ground.
"""

import numpy as np

from linecad.arrays import Float, Int
from linecad.directions import UP
from linecad.geometry import world_rays
from linecad.model.on_faces.seen import NO_FACE, SeenFaces
from linecad.scene import Lines

BURIED = 1.03  # times the depth of the ground at its lower end, beyond which a line would be below the ground
FURTHEST = 4.0  # times that; what is further off belongs to something else
INSIDE = 0.04  # of its length above its lower end, where both sides of a line are looked at


def standing(lines: Lines, seen: SeenFaces) -> tuple[Float, Int]:
    """By which factor (N,) lines in the world are nearer that would be buried, and the ground's face (N,) below each.

    1 and NO_FACE for all others. A line at another distance along its rays looks the same.
    """
    factor, ground = np.ones(len(lines)), np.full(len(lines), NO_FACE)
    if not seen.face:
        return factor, ground
    rows = np.flatnonzero(lines.axis == UP)
    segment = lines.segment[rows]
    height = world_rays(segment, seen.camera.matrix, seen.axes)[..., UP]
    pick = np.arange(len(rows)), height.argmin(axis=1)
    foot, top = segment[pick], segment[pick[0], 1 - pick[1]]
    first, second = seen.beside(foot + INSIDE * (top - foot), top - foot)
    is_ground = np.array([face.kind == "ground" for face in seen.face] + [False])
    depth = seen.depths(first, foot)
    own = _depths(lines.ends[rows], foot, seen)
    with np.errstate(invalid="ignore"):
        ratio = own / depth
        buried = is_ground[first] & is_ground[second] & (ratio > BURIED) & (ratio < FURTHEST)
    factor[rows[buried]], ground[rows[buried]] = 1 / ratio[buried], first[buried]
    return factor, ground


def _depths(ends: Float, pixels: Float, seen: SeenFaces) -> Float:
    """Camera depths (M,) at pixels (M, 2) of uprights with such ends (M, 2, 3): where they pass nearest to the rays."""
    rays = world_rays(pixels, seen.camera.matrix, seen.axes)[:, :2]
    return np.asarray((rays * ends[:, 0, :2]).sum(axis=1) / (rays**2).sum(axis=1))
