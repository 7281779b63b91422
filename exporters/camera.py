"""The photo's camera in the terms of glTF and USD, which look along -z with y up and count pixels from the corner."""

import math
from dataclasses import dataclass

import numpy as np

from exporters.model import Model
from linecad.arrays import Float
from linecad.scene import Camera

_MARGIN = 2.0  # the clipping planes lie this factor nearer and farther than anything in the model
_WIDTH_SHARE = {True: 0.0020, False: 0.0010}  # width of drawn lines over the middle depth of the model, by boundary
_FLATTEST = 1e-9  # sine of the angle to the image plane; a flatter axis is drawn as if it had this one
_NEAREST_SHARE = 1e-6  # of the far plane, for a model that reaches to the camera or behind it


@dataclass(frozen=True)
class PaddedFrame:
    """The smallest frame of even size about the principal point that holds the photo, in px.

    A glTF camera always looks through the middle of its picture. Where the principal point is elsewhere, the photo
    is a part of a larger picture: `left` and `top` say how far its corner lies inside.
    """

    width: int
    height: int
    left: float
    top: float


def camera_to_world(rotation: Float, eye: Float) -> Float:
    """(4, 4) the pose of a camera that looks along -z with y up, as M @ column.

    `rotation` (3, 3) is the scene's, from world to camera; `eye` (3,) is where the camera stands.
    """
    pose = np.eye(4)
    pose[:3, :3] = rotation.T @ np.diag([1.0, -1.0, -1.0])
    pose[:3, 3] = eye
    return pose


def principal_point(camera: Camera) -> tuple[float, float]:
    """px from the corner of the photo: half a pixel more than the scene says, which counts from pixel centres."""
    return float(camera.matrix[0, 2]) + 0.5, float(camera.matrix[1, 2]) + 0.5


def vanishing_points(camera: Camera, rotation: Float) -> Float:
    """(3, 2) px from the photo's corner, where the three axes vanish; finite, if very far, for one in the image plane.

    Each is the vanishing point of the axis's end before the camera; `rotation` (3, 3) takes world to camera.
    """
    depth = np.where(rotation[2] >= 0, 1.0, -1.0) * np.maximum(np.abs(rotation[2]), _FLATTEST)
    points: Float = (camera.focal * rotation[:2] / depth).T + principal_point(camera)
    return points


def padded_frame(camera: Camera) -> PaddedFrame:
    """The frame about the principal point that holds the whole photo."""
    cx, cy = principal_point(camera)
    width = 2 * math.ceil(max(cx, camera.width - cx))
    height = 2 * math.ceil(max(cy, camera.height - cy))
    return PaddedFrame(width, height, width / 2 - cx, height / 2 - cy)


def clipping_range(model: Model) -> tuple[float, float]:
    """Distances in m of a near and a far plane with everything in front of the camera between them."""
    points = model.points - model.eye
    depth = points @ model.scene.rotation[2]
    distance = np.linalg.norm(points, axis=1)
    far = _MARGIN * float(distance.max(initial=0.0)) or 1.0
    seen = depth[depth > 0]
    near = float(seen.min()) / _MARGIN if len(seen) else far
    return max(min(near, far / _MARGIN), far * _NEAREST_SHARE), far


def line_width(model: Model, is_boundary: bool) -> float:
    """How thick lines are drawn that have a body, in m: thin as seen from the camera, whatever the scene's scale."""
    return _WIDTH_SHARE[is_boundary] * float(np.median(np.abs((model.points - model.eye) @ model.scene.rotation[2])))
