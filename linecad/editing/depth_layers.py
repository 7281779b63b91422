"""What the page lays over the photo where it has a depth map: the map itself, and where it and the model differ.

Both are PNGs of the photo's shape, transparent where nothing is known. Colours run evenly from one of RAMP or DIVERGING
to the next; the legend in the page's style sheet has the same ones.
"""

from functools import lru_cache

import cv2
import numpy as np

from exporters.model import build_model, metres_per_unit
from exporters.textures.layout import View
from exporters.textures.nearest import nearest_of, shape_of
from linecad.arrays import Float
from linecad.depth.depth_map import DepthMap, Kind, camera_depths
from linecad.editing.state import Now
from linecad.geometry import homogeneous, resized_camera
from linecad.scene import Camera, Scene

MOST_SIDE = 1600  # px of a picture; networks write no more, and the browser scales it to the photo
RAMP = ("#fff4c2", "#9bd68d", "#2f9e95", "#27608f", "#2d1b52")  # sRGB, near to far
EXTREME = (0.01, 0.99)  # shares of the map's depths that the ramp begins and ends at
DIVERGING = ("#4b1d91", "#a58ecb", "#f6f5f3", "#f2a65a", "#b34700")  # sRGB: the map nearer than the model, to farther
FULL = 0.2  # log of the map's depth over the model's at which the colour is the last one
BESIDE = 0.006  # of the width: so far from a line the map is asked, for networks blur edges
WIDTH = 0.004  # of the width: that of a line in the picture
PIECE = 4.0  # px along a line that have one colour


def layer_of(name: str, depth: DepthMap, now: Now) -> bytes | None:
    """The PNG of the layer `depth` or `difference` in a state of the page; None where it has no such layer."""
    scene = None if now.model is None else now.model.scene
    if name == "depth":
        report = None if scene is None else scene.depth_map
        if report is None or report.kind is None or report.shift is None:
            return picture_of_map(depth, now.found.camera, depth.kind or "z", 0.0)  # nothing better is known of it
        return picture_of_map(depth, now.found.camera, report.kind, report.shift)
    return picture_of_difference(depth, scene) if name == "difference" and scene is not None else None


def document_of_layers(depth: DepthMap, now: Now) -> dict[str, object]:
    """What the state tells of the map: a line for people, and for each layer a number that changes when it does.

    The number is None where there is no such layer.
    """
    report = None if now.model is None else now.model.scene.depth_map
    solved = 0 if now.model is None else now.model.version
    return {
        "text": f"depth map {depth.name}" if report is None else report.text,
        "depth": solved,
        "difference": None if report is None or report.left_out else solved,
    }


@lru_cache(maxsize=2)
def picture_of_map(depth: DepthMap, camera: Camera, kind: Kind, shift: float) -> bytes:
    """The log depth of a map on the photo's pixels, its numbers read as of that kind and shift, as PNG."""
    depths = _depths_of_map(depth, _view_of(camera, np.eye(3)), kind, shift)
    log_depth = np.log(depths)
    known = np.isfinite(log_depth)
    low, high = np.quantile(log_depth[known], EXTREME) if known.any() else (0.0, 0.0)
    return _png((log_depth - low) / max(float(high - low), np.finfo(float).tiny), RAMP)


@lru_cache(maxsize=2)
def picture_of_difference(depth: DepthMap, scene: Scene) -> bytes | None:
    """Where a map and the model of a scene differ, as PNG; None where the scene does not say how to read the map."""
    ratio = log_ratio(depth, scene)
    return None if ratio is None else _png(ratio / (2 * FULL) + 0.5, DIVERGING)


def log_ratio(depth: DepthMap, scene: Scene) -> Float | None:
    """(h, w) log of the map's depth over the model's; NaN where that has neither face nor line, or the map no depth.

    None where the scene does not say how to read the map. A line is compared beside itself, on the side that agrees
    better: beyond the edge of a wall the map shows what stands behind it.
    """
    report = scene.depth_map
    if report is None or report.kind is None or report.shift is None or report.scale is None:
        return None
    view = _view_of(scene.camera, scene.rotation)
    log_depth = np.log(_depths_of_map(depth, view, report.kind, report.shift) / report.scale)
    nearest = nearest_of([shape_of(face, view) for face in build_model(scene).faces], view)
    inverse = np.where(nearest.inverse_depth > 0, nearest.inverse_depth * metres_per_unit(scene), np.nan)
    ratio: Float = log_depth + np.log(inverse)
    _draw_lines(ratio, log_depth, scene, view)
    return ratio


def _view_of(camera: Camera, rotation: Float) -> View:
    """The camera as if the photo were as small as the pictures are."""
    share = min(1.0, MOST_SIDE / max(camera.width, camera.height))
    size = np.maximum(np.rint(np.array([camera.width, camera.height]) * share), 1)
    scale = size / (camera.width, camera.height)
    return View(resized_camera(camera.matrix, scale) @ rotation, int(size[0]), int(size[1]))


def _depths_of_map(depth: DepthMap, view: View, kind: Kind, shift: float) -> Float:
    """(h, w) camera depth in units of the map where it has one, else NaN."""
    x, y = np.arange(view.width), np.arange(view.height)
    column, row = (
        ((places + 0.5) * own / len(places)).astype(np.int64) for places, own in ((x, depth.width), (y, depth.height))
    )
    values = np.where(depth.valid, depth.values, np.nan)[np.ix_(row, column)].astype(np.float64)
    rays = homogeneous(np.stack(np.meshgrid(x, y), axis=-1)) @ np.linalg.inv(view.projection).T
    return camera_depths(values, np.linalg.norm(rays, axis=-1), kind, shift)


def _draw_lines(ratio: Float, log_depth: Float, scene: Scene, view: View) -> None:
    """Lay the lines over `ratio` (h, w), from the map's `log_depth` (h, w) in the scene's unit."""
    size = np.array([view.width, view.height])
    segments = (scene.lines.segment + 0.5) * (size / (scene.camera.width, scene.camera.height)) - 0.5
    for segment, ends in zip(segments, scene.lines.ends @ view.projection.T, strict=True):
        along = segment[1] - segment[0]
        length = float(np.linalg.norm(along))
        if length == 0 or (ends[:, 2] <= 0).any():
            continue
        share = np.linspace(0, 1, int(np.ceil(length / PIECE)) + 1)
        corners = segment[0] + share[:, None] * along
        middles = (corners[1:] + corners[:-1]) / 2
        aside = BESIDE * view.width / length * np.array([-along[1], along[0]])
        sides = np.stack([_at(log_depth, middles + aside), _at(log_depth, middles - aside)])
        off = sides + np.log(_inverse_depths(middles, ends))
        better = np.where(np.abs(off[0]) <= np.abs(off[1]), off[0], off[1])
        told = np.where(np.isfinite(off).all(axis=0), better, np.where(np.isfinite(off[0]), off[0], off[1]))
        for value, start, end in zip(told.tolist(), corners[:-1], corners[1:], strict=True):
            if np.isfinite(value):
                places = [tuple(np.rint(place).astype(int).tolist()) for place in (start, end)]
                cv2.line(ratio, places[0], places[1], (value,), max(round(WIDTH * view.width), 1))


def _at(image: Float, pixels: Float) -> Float:
    """The values of an image at pixels (M, 2), NaN outside."""
    column, row = np.rint(pixels).astype(np.int64).T
    inside = (column >= 0) & (column < image.shape[1]) & (row >= 0) & (row < image.shape[0])
    values = np.full(len(pixels), np.nan)
    values[inside] = image[row[inside], column[inside]]
    return values


def _inverse_depths(pixels: Float, ends: Float) -> Float:
    """1 over the depth (M,) at pixels (M, 2) of a line with homogeneous ends (2, 3); NaN where it is not in front.

    It is linear along the line in the photo.
    """
    (start, end), (near, far) = ends[:, :2] / ends[:, 2:], 1 / ends[:, 2]
    along = end - start
    share = (pixels - start) @ along / max(float(along @ along), np.finfo(float).tiny)
    inverse = near + share * (far - near)
    return np.where(inverse > 0, inverse, np.nan)


def _png(share: Float, stops: tuple[str, ...]) -> bytes:
    """A PNG with the colours of shares (h, w) from 0 to 1 of the way along some stops; NaN is transparent."""
    levels = np.linspace(0, len(stops) - 1, 256)
    channels = np.array([[int(stop[at : at + 2], 16) for at in (5, 3, 1)] for stop in stops]).T  # blue, green, red
    opaque = np.full(256, 255)
    table = np.column_stack([*(np.interp(levels, range(len(stops)), channel) for channel in channels), opaque])
    known = np.isfinite(share)
    index = np.rint(np.clip(np.where(known, share, 0), 0, 1) * 255).astype(np.int64)
    pixels = np.rint(table).astype(np.uint8)[index]
    pixels[~known] = 0
    _, data = cv2.imencode(".png", pixels)
    return data.tobytes()
