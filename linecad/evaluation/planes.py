"""Reconstructed planes against the true ones of a made photo (docs/reference/evaluation.md)."""

from dataclasses import dataclass

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.dataset.truth import NOTHING, Truth
from linecad.geometry import world_rays
from linecad.scene import Plane, Scene

PLANE_ANGLE = np.radians(2.0)  # between the normals of a found plane and a true one that it may be
PLANE_DEPTH = 0.02  # relative error of the depth
SAME_NORMAL = np.cos(np.radians(0.5))  # of quads in one true plane
SAME_OFFSET = 0.005  # m
LEAST_SHARE = 0.002  # of the photo's pixels that a true plane must fill to be looked for
MANHATTAN = np.cos(np.radians(1.0))  # of the angle between the normal of a true plane and an axis


@dataclass(frozen=True)
class PlaneScore:
    """Weights: lines for the found planes, pixels for the true ones."""

    right_lines: int  # lines in found planes that are true
    lines: int  # lines in found planes
    found_pixels: int  # pixels of true Manhattan planes that were found
    pixels: int  # pixels of true Manhattan planes


def score_planes(scene: Scene, truth: Truth, scale: float) -> PlaneScore:
    """Score the planes of component 0, `scale` being found over true depth.

    A found plane is a true one when their normals are within PLANE_ANGLE and, on the rays of the middles of the found
    plane's segments, the median difference of the two depths is below PLANE_DEPTH. Both planes are infinite.
    """
    normal, offset, area = _true_planes(truth)
    was_found = np.zeros(len(area), bool)
    own = set(scene.lines.id[scene.lines.component == 0].tolist())
    row = {number: index for index, number in enumerate(scene.lines.id.tolist())}
    right_lines = lines = 0
    for plane in scene.planes:
        members = np.array([row[number] for number in plane.lines if number in own], np.int64)
        if len(members) == 0:
            continue
        match = _matches(scene, truth, plane, plane.offset / scale, members, normal, offset)
        lines += len(members)
        right_lines += len(members) if match.any() else 0
        was_found |= match
    counted = (area >= LEAST_SHARE * truth.width * truth.height) & (np.abs(normal).max(axis=1) >= MANHATTAN)
    return PlaneScore(right_lines, lines, int(area[was_found & counted].sum()), int(area[counted].sum()))


def _true_planes(truth: Truth) -> tuple[Float, Float, Int]:
    """Normals (P, 3), offsets (P,), m, and pixels (P,) of the planes in the photo, quads of one plane joined."""
    normal, offset = truth.planes()
    shown = np.bincount(truth.ids[truth.ids != NOTHING].ravel(), minlength=len(offset))
    left = shown > 0
    normals, offsets, area = [], [], []
    for quad in np.argsort(-shown, kind="stable").tolist():
        if not left[quad]:
            continue
        turn = normal @ normal[quad]
        same = left & (np.abs(turn) > SAME_NORMAL) & (np.abs(offset * np.sign(turn) - offset[quad]) < SAME_OFFSET)
        same[quad] = True
        left &= ~same
        normals.append(normal[quad])
        offsets.append(offset[quad])
        area.append(int(shown[same].sum()))
    return np.array(normals).reshape(-1, 3), np.array(offsets), np.array(area, np.int64)


def _matches(scene: Scene, truth: Truth, plane: Plane, place: float, lines: Int, normal: Float, offset: Float) -> Bool:
    """Which true planes (P,) a found one is, its offset being in metres."""
    # The found normal in the truth's world: through the camera, which both share.
    turned = truth.rotation.T @ scene.rotation @ plane.normal(scene.turns)
    parallel = np.abs(normal @ turned) >= np.cos(PLANE_ANGLE)
    pixels = scene.lines.segment[lines].mean(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        rays = world_rays(pixels, scene.camera.matrix, scene.rotation)
        found = place / plane.along_normal(rays, scene.turns)
        true = offset[:, None] / (normal @ truth.rays(pixels).T)
        error = np.median(np.abs(found / true - 1), axis=1)
    matches: Bool = parallel & (error < PLANE_DEPTH)
    return matches
