"""The ground of a scene, and whether walls end on it. Lengths are shares of the depth at the place."""

from dataclasses import dataclass

import numpy as np
import shapely

from linecad.arrays import Float, Int
from linecad.evaluation.draughting.shapes import Shape, nearest_faces
from linecad.geometry import project
from linecad.scene import Scene

SAME_LEVEL = 0.02  # of the camera's height, between faces of one ground
LARGE = 0.05  # of the largest wall; smaller ones need not reach the ground
ENDS = 0.01  # between the foot of a wall and the ground
BORDER = 0.01  # of the photo's width; a wall that the photo's border cuts has no foot in it
SAMPLES = 9  # points on each edge of a foot


@dataclass(frozen=True)
class GroundCounts:
    """The level below the camera that fills most of the photo, and the walls that stand on it."""

    faces: int  # of the ground; 1 is right where any is seen
    walls: int  # large ones whose feet neither the photo's border cuts nor another face hides
    walls_on_ground: int  # of them, those whose foot is on a face of the ground, or of a pavement beside it


def ground_rows(shapes: list[Shape], seen: Int) -> list[int]:
    """The faces of the ground: level, below the camera, at the height that most of the `seen` pixels (F,) have."""
    level = [row for row, shape in enumerate(shapes) if not shape.is_upright and shape.plane.offset < 0]
    best: list[int] = []
    for row in level:
        height = shapes[row].plane.offset
        same = [each for each in level if abs(shapes[each].plane.offset - height) < SAME_LEVEL * abs(height)]
        if not best or seen[same].sum() > seen[best].sum():
            best = same
    return best


def count_ground(scene: Scene, shapes: list[Shape], seen: Int) -> GroundCounts:
    """The ground and the feet of the walls; `seen` (F,) counts the pixels of a grid that show each face."""
    ground = [shapes[row] for row in ground_rows(shapes, seen)]
    to_stand_on = ground + [shape for shape in shapes if shape.face.kind == "ground" and shape not in ground]
    largest = max((shape.polygon.area for shape in shapes if shape.is_upright), default=0.0)
    feet = [
        (shape, foot)
        for shape in shapes
        if shape.is_upright and shape.polygon.area >= LARGE * largest
        if len(foot := _visible_foot(scene, shape))
    ]
    on = sum(_stands(foot, shape.depth, to_stand_on) for shape, foot in feet)
    return GroundCounts(len(ground), len(feet), on)


def _visible_foot(scene: Scene, shape: Shape) -> Float:
    """Points (M, 3) of the lowest edges of a wall that the photo shows; none where it shows less than half of them."""
    edges = shape.edges
    low = edges[:, :, 2].min()
    foot = edges[(edges[:, :, 2] < low + ENDS * shape.depth).all(axis=1)]
    share = ((np.arange(SAMPLES) + 0.5) / SAMPLES)[None, :, None]
    points: Float = (foot[:, :1] + share * (foot[:, 1:] - foot[:, :1])).reshape(-1, 3)
    below = points - [0.0, 0.0, ENDS * shape.depth]  # what the photo shows there hides the foot if it is nearer
    depth = below @ scene.rotation[2]
    points, below, depth = points[depth > 0], below[depth > 0], depth[depth > 0]
    if len(points) == 0:
        return points
    pixels = project(below, scene.camera.matrix, scene.rotation)
    margin = BORDER * scene.camera.width
    inner = np.array([scene.camera.width, scene.camera.height]) - 1 - margin
    shown = ((pixels > margin) & (pixels < inner)).all(axis=1)
    # The ground before the foot hides only what is below it.
    _, before = nearest_faces(scene, pixels, [(plane, face) for plane, face in scene.faces if plane.axis != 2])
    shown &= ~(before < (1 - 2 * ENDS) * depth)
    kept: Float = points[shown if shown.mean() >= 0.5 else np.zeros(len(points), bool)]
    return kept


def _stands(foot: Float, depth: float, ground: list[Shape]) -> bool:
    """Whether most points (M, 3) of a foot are on a face of the ground."""
    on = np.zeros(len(foot), bool)
    for face in ground:
        at_level = np.abs(foot[:, 2] - face.plane.offset) < ENDS * depth
        on |= at_level & (shapely.distance(face.polygon, shapely.points(foot[:, :2])) < ENDS * depth)
    return bool(on.mean() > 0.5)
