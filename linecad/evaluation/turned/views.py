"""Where a model is looked at from: the photo's camera, 30 degrees to its left and right, above, before a facade."""

from dataclasses import replace

import numpy as np

from linecad.arrays import Float
from linecad.evaluation.turned.glb import GlbModel, PhotoCamera
from linecad.evaluation.turned.raster import NOTHING, Drawn, View, draw_triangles
from linecad.geometry import resized_camera, rotation_about, world_rays

TURN = np.radians(30.0)  # to the left and to the right
FALL = np.radians(45.0)  # of the view from above
FAR = 40.0  # distances at which the view of the facade is taken: nearly parallel
ROOM = 0.94  # of a picture that what is looked at fills
OUTLIERS = (0.03, 0.97)  # quantiles of the seen points that a picture must hold
LEVEL = np.cos(np.radians(60.0))  # of the angle between the normal of a wall and the horizon
SAME_PLANE = 0.01  # of the distance, between triangles of one wall
UP = np.array([0.0, 1.0, 0.0])  # glTF's


def photo_view(camera: PhotoCamera, width: int, distance: float = 1.0) -> View:
    """The camera of the photo, its picture `width` px wide."""
    scale = width / camera.width
    height = max(1, round(camera.height * scale))
    matrix = resized_camera(camera.matrix, np.array([scale, height / camera.height]))
    return View("the photo's own view", matrix, camera.rotation, camera.position, distance, width, height)


def views_of(model: GlbModel, width: int) -> list[View]:
    """The five views of a model: the photo's, from the left, from the right, from above, before the main facade."""
    start = photo_view(model.camera, width, _reach(model))
    drawn = draw_triangles(model, start)
    points = seen_points(start, drawn)
    if len(points) == 0:
        points = _line_points(model, start)
    middle = np.median(points, axis=0)
    distance = float(np.linalg.norm(middle - start.position))
    start = replace(start, distance=distance)
    around = [
        _fitted(replace(_turned(start, middle, turn), name=name), points)
        for name, turn in (("30 degrees from the left", -TURN), ("30 degrees from the right", TURN))
    ]
    return [start, *around, _fitted(_above(start, middle), points), _fitted(_facade(model, start, drawn), points)]


def seen_points(view: View, drawn: Drawn) -> Float:
    """The points (M, 3) of the world that the pixels of a view show."""
    y, x = np.nonzero(drawn.triangle != NOTHING)
    pixels = np.column_stack([x, y]).astype(np.float64)
    rays = world_rays(pixels, view.matrix, view.rotation)
    return view.position + rays / drawn.inverse_depth[y, x][:, None]


def _reach(model: GlbModel) -> float:
    """How far the model is from its camera, before anything is drawn."""
    points = np.concatenate([model.triangles.reshape(-1, 3), model.lines.reshape(-1, 3)])
    return float(np.median(np.linalg.norm(points - model.camera.position, axis=1))) if len(points) else 1.0


def _line_points(model: GlbModel, view: View) -> Float:
    """What a model without a face before its camera shows: its lines, or a point where there is nothing at all."""
    points = model.lines.reshape(-1, 3)
    points = points[view.to_camera(points)[:, 2] > 0]
    return points if len(points) else view.position + view.rotation[2:3]


def _turned(view: View, about: Float, turn: float) -> View:
    """The view moved about a vertical axis through a point; to the camera's right where `turn` is positive."""
    rotation = rotation_about(turn * UP)
    return replace(view, position=about + rotation @ (view.position - about), rotation=view.rotation @ rotation.T)


def _above(view: View, about: Float) -> View:
    forward = view.rotation[2] - (view.rotation[2] @ UP) * UP
    forward = forward / max(float(np.linalg.norm(forward)), 1e-9)
    direction = np.cos(FALL) * forward - np.sin(FALL) * UP
    distance = 2.0 * view.distance
    return replace(
        view, name="from above, 45 degrees down", rotation=_looking(direction), position=about - distance * direction,
        distance=distance,
    )  # fmt: skip


def _facade(model: GlbModel, view: View, drawn: Drawn) -> View:
    """From far before the upright plane that fills most of the photo; in its own direction where there is none."""
    normal = np.cross(model.triangles[:, 1] - model.triangles[:, 0], model.triangles[:, 2] - model.triangles[:, 0])
    normal = normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-12)
    away = ((model.triangles[:, 0] - view.position) * normal).sum(axis=1)
    normal = np.where(away[:, None] < 0, -normal, normal)  # as the camera looks at it
    offset = np.abs(away)
    pixels = np.bincount(drawn.triangle[drawn.triangle != NOTHING], minlength=len(normal))
    direction, middle, most = view.rotation[2], None, 0
    for number in np.flatnonzero((pixels > 0) & (np.hypot(normal[:, 0], normal[:, 2]) > LEVEL)).tolist():
        same = (normal @ normal[number] > 0.999) & (np.abs(offset - offset[number]) < SAME_PLANE * view.distance)
        if pixels[same].sum() > most:
            most = int(pixels[same].sum())
            direction = normal[number]
            middle = np.average(model.triangles[same].mean(axis=1), axis=0, weights=pixels[same])
    if middle is None:
        middle = view.position + view.distance * direction
    distance = FAR * view.distance
    return replace(
        view, name="straight before the main facade", rotation=_looking(direction),
        position=middle - distance * direction, distance=distance,
    )  # fmt: skip


def _looking(direction: Float) -> Float:
    """World to camera (3, 3) of a camera without roll that looks along a unit vector (3,)."""
    right = np.cross(direction, UP)
    right = right / max(float(np.linalg.norm(right)), 1e-9)
    return np.array([right, np.cross(direction, right), direction])


def _fitted(view: View, points: Float) -> View:
    """The view with the focal length and the middle at which it holds the points (M, 3), but for outliers."""
    camera = view.to_camera(points)
    camera = camera[camera[:, 2] > 0.05 * view.distance]
    if len(camera) == 0:
        return view
    low, high = np.quantile(camera[:, :2] / camera[:, 2:], OUTLIERS, axis=0)
    size = np.array([view.width, view.height])
    focal = float((ROOM * size / np.maximum(high - low, 1e-6)).min())
    cx, cy = ((size - 1) / 2 - focal * (low + high) / 2).tolist()
    return replace(view, matrix=np.array([[focal, 0.0, cx], [0.0, focal, cy], [0.0, 0.0, 1.0]]))
