"""Along what the photo may be cut: its lines, the meets of its surfaces, edges that are no lines of the scene."""

from dataclasses import dataclass
from itertools import combinations
from typing import Any

import cv2
import numpy as np
import shapely

from linecad.arrays import Float, Int
from linecad.directions import MAIN, Turns, components, directions_of, partner
from linecad.geometry import angles_to, directions_to, project, unit_normals, vanishing_points
from linecad.model.regions.raster import COLUMNS, Picture, Raster
from linecad.model.regions.surfaces import Surface, box_of
from linecad.scene import Camera, Lines

LEAST_LENGTH = 0.02  # of the photo's width, of a line of the scene
LEAST_EDGE = 0.03  # the same of an edge that is none
STRAIGHT = np.sin(np.radians(3.0))  # of the angle to a vanishing point that an edge is turned to
MOST_WALLS = 14  # that are met with each other
BEYOND = 0.25  # of a wall's length, by which a corner may be outside its lines
FOOT_BEYOND = 0.1  # the same for the line in which it meets ground or ceiling
NEAR = 0.05  # of the depth of a line's further end; what is nearer to the camera is cut off
DETECTED = 2 * COLUMNS  # px, the width at which edges are looked for
FURTHEST = 1.3  # times the depth of nearly all lines, where the ground ends
NEARLY_ALL = 0.98
CONTRAST = 25.0  # CIE L*a*b* distance across a line
MOST_CONTRAST = 1.5
PLAIN = 0.25  # what a line without contrast counts
OFF = 4.0  # samples to either side, at which contrast is seen
GUESSED = 0.8  # what edges count that are no lines of the scene


@dataclass(frozen=True, eq=False)
class View:
    """The camera of a photo, and the photo."""

    camera: Camera
    rotation: Float  # (3, 3) world to camera
    photo: Picture | None  # (H, W, 3) RGB, as straight as the lines; None where there is none to look at
    turns: Turns = ()  # of further frames


@dataclass(frozen=True, eq=False)
class Meets:
    """Lines in which two surfaces meet, as far as the photo shows them."""

    ends: Float  # (M, 2, 2) px
    surfaces: Int  # (M, 2)


def find_segments(lines: Lines, surfaces: list[Surface], raster: Raster, view: View) -> Float:
    """Segments (N, 2, 2) px of the photo to cut it along, the strongest first."""
    camera = view.camera
    of_scene = project(lines.ends, camera.matrix, view.rotation)
    meets = find_meets(lines, surfaces, view).ends
    edges = _edges(view)
    limit = _limit_of_ground(raster, surfaces, camera, view.rotation)
    found = np.concatenate([of_scene, meets, edges, limit])
    length = np.linalg.norm(found[:, 1] - found[:, 0], axis=1)
    weight = PLAIN + np.minimum(_contrast(found, raster) / CONTRAST, MOST_CONTRAST)
    first, last = len(of_scene), len(of_scene) + len(meets)
    weight[first:last], weight[last + len(edges) :] = 1.0, 1.0
    weight[last : last + len(edges)] *= GUESSED
    long_enough = length >= LEAST_LENGTH * camera.width
    order = np.argsort(-np.where(long_enough, length * weight, 0), kind="stable")
    ordered: Float = found[order[: int(long_enough.sum())]]
    return ordered


def _contrast(segments: Float, raster: Raster) -> Float:
    """How far (N,) the colours on both sides of segments differ."""
    colour = cv2.GaussianBlur(raster.colour, (0, 0), 1.5).astype(np.float64)
    places = raster.samples_of(
        segments[:, :1] + np.linspace(0.1, 0.9, 9)[None, :, None] * (segments[:, 1:] - segments[:, :1])
    )
    off = OFF * unit_normals(segments[:, 1] - segments[:, 0])[:, None]
    height, width = raster.shape
    sides = []
    for side in (places + off, places - off):
        column, row = np.rint(side).astype(np.int64).transpose(2, 0, 1)
        sides.append(colour[np.clip(row, 0, height - 1), np.clip(column, 0, width - 1)])
    difference: Float = np.linalg.norm(np.median(sides[0] - sides[1], axis=1), axis=1)
    return difference


def _edges(view: View) -> Float:
    """Straight edges (N, 2, 2) px of the photo, turned to a vanishing point that they nearly point to."""
    photo, camera = view.photo, view.camera
    if photo is None:
        return np.zeros((0, 2, 2))
    scale = min(1.0, DETECTED / camera.width)
    small = cv2.resize(photo, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA) if scale < 1 else photo
    detected: Any = cv2.createLineSegmentDetector().detect(cv2.cvtColor(small, cv2.COLOR_RGB2GRAY))[0]
    if detected is None:
        return np.zeros((0, 2, 2))
    ends: Float = (np.asarray(detected, np.float64).reshape(-1, 2, 2) + 0.5) / scale - 0.5
    ends = ends[np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1) >= LEAST_EDGE * camera.width]
    if len(ends) == 0:
        return ends
    points = vanishing_points(camera.matrix, components(view.rotation, view.turns))
    sines = angles_to(ends, points)
    middle, half = ends.mean(axis=1), np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1) / 2
    straight = directions_to(middle, points[sines.argmin(axis=0)]) * half[:, None]
    turned = np.stack([middle - straight, middle + straight], axis=1)
    return np.where((sines.min(axis=0) < STRAIGHT)[:, None, None], turned, ends)


def find_meets(lines: Lines, surfaces: list[Surface], view: View) -> Meets:
    """Where walls meet each other, the ground and the ceiling."""
    walls = [index for index, surface in enumerate(surfaces) if surface.kind == "wall"][:MOST_WALLS]
    levels = [index for index, surface in enumerate(surfaces) if surface.kind in ("ground", "ceiling")]
    ends = components(lines.ends, view.turns)
    boxes = {index: box_of(surfaces[index], ends) for index in walls}
    found: list[tuple[Float, tuple[int, int]]] = []
    for index in walls:
        low, high = boxes[index]
        for level in levels:
            side = FOOT_BEYOND * (high - low)
            wall, along = surfaces[index], int(partner(surfaces[index].axis))
            reach = np.array([low - side, high + side])[:, along]
            meet = _in_world(wall.axis, wall.offset, along, reach, np.full(2, surfaces[level].offset), view.turns)
            found.append((meet, (index, level)))
    bottom = min([surfaces[level].offset for level in levels], default=np.inf)
    for one, other in combinations(walls, 2):
        if surfaces[one].axis == surfaces[other].axis:
            continue
        meet = np.empty((2, 3))
        meet[:, :2] = _corner(surfaces[one], surfaces[other], view.turns)
        meet[:, 2] = (
            min(bottom, boxes[one][0, 2], boxes[other][0, 2]), max(boxes[one][1, 2], boxes[other][1, 2])
        )  # fmt: skip
        at = components(meet[0], view.turns)
        sides = {index: int(partner(surfaces[index].axis)) for index in (one, other)}
        if all(_within(float(at[side]), boxes[index][:, side]) for index, side in sides.items()):
            found.append((meet, (one, other)))
    shown = [
        (pixels, pair) for meet, pair in found
        if (pixels := _in_photo(meet, view.camera, view.rotation)) is not None
    ]  # fmt: skip
    return Meets(
        np.array([pixels for pixels, _ in shown]).reshape(-1, 2, 2),
        np.array([pair for _, pair in shown], np.int64).reshape(-1, 2),
    )


def _in_world(normal: int, offset: float, along: int, reach: Float, height: Float, turns: Turns) -> Float:
    """World points (2, 3) of a wall at places and heights (2,)."""
    sides = {normal: np.full(2, offset), along: reach}
    if normal < MAIN:
        return np.column_stack([sides[0], sides[1], height])
    vectors = directions_of(turns)
    level: Float = sum(place[:, None] * vectors[axis] for axis, place in sides.items())
    return np.column_stack([level[:, :2], height])


def _corner(one: Surface, other: Surface, turns: Turns) -> Float:
    """x and y (2,) where two walls of different normals meet."""
    if max(one.axis, other.axis) < MAIN:
        return np.array([one.offset, other.offset] if one.axis == 0 else [other.offset, one.offset])
    normals = directions_of(turns)[[one.axis, other.axis], :2]
    return np.asarray(np.linalg.solve(normals, np.array([one.offset, other.offset])))


def _within(value: float, span: Float) -> bool:
    reach = BEYOND * (span[1] - span[0])
    return bool(span[0] - reach < value < span[1] + reach)


def _in_photo(line: Float, camera: Camera, rotation: Float) -> Float | None:
    """The part (2, 2) px of a line (2, 3) in space that the photo shows; None where it does not."""
    depth = line @ rotation[2]
    near = NEAR * depth.max()
    if near <= 0:
        return None
    nearer = int(depth.argmin())
    if depth[nearer] < near:
        share = (near - depth[nearer]) / (depth[1 - nearer] - depth[nearer])
        line = line.copy()
        line[nearer] += share * (line[1 - nearer] - line[nearer])
    frame = shapely.box(-0.5, -0.5, camera.width - 0.5, camera.height - 0.5)
    pixels = shapely.LineString(project(line, camera.matrix, rotation))
    shown = shapely.get_coordinates(shapely.intersection(pixels, frame))
    return shown if len(shown) == 2 else None


def _limit_of_ground(raster: Raster, surfaces: list[Surface], camera: Camera, rotation: Float) -> Float:
    """The image lines (N, 2, 2) px in which ground and ceiling end, behind nearly all lines of the scene.

    Points of a level that have one depth lie on one image line, parallel to the horizon.
    """
    depth = limit_of_depth(raster)
    found = []
    for surface in surfaces:
        upright = rotation[1, 2]  # how much a step down in the camera's frame rises
        if surface.kind in ("ground", "ceiling") and upright != 0 and np.isfinite(depth):
            x = np.array([-1.0, 1.0]) * depth * camera.width / camera.focal
            y = (surface.offset - rotation[2, 2] * depth - rotation[0, 2] * x) / upright
            shown = _in_photo(np.column_stack([x, y, np.full(2, depth)]) @ rotation, camera, rotation)
            found += [] if shown is None else [shown]
    return np.array(found).reshape(-1, 2, 2)


def limit_of_depth(raster: Raster) -> float:
    """The depth at which ground and ceiling end: that of nearly all lines, and some more."""
    if len(raster.line_depth) == 0:
        return np.inf
    return FURTHEST * float(np.quantile(raster.line_depth, NEARLY_ALL))
