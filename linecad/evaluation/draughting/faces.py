"""Faces in pieces, jagged, tiny, or joined to nothing. Lengths are shares of the depth at the place."""

from dataclasses import dataclass

import numpy as np
import shapely
from scipy.sparse.csgraph import connected_components

from linecad.arrays import Bool, Float
from linecad.directions import across, components
from linecad.evaluation.draughting.shapes import NO_FACE, Shape, nearest_faces
from linecad.geometry import project
from linecad.scene import Scene

ONE_WALL = 0.02  # between the offsets of two faces that may be pieces of one wall
ONE_WALL_GAP = 0.03  # between their outlines, in the plane
STEP = 0.05  # of a face's diagonal; a shorter edge between a left and a right turn is a step of a staircase
SLIVER_AREA = 1e-3  # of the largest face
SLIVER_SHAPE = 30.0  # length squared over area
SMALL_AREA = 1e-2  # of the largest face
SAME_EDGE = 1e-3  # between edges that two faces share
LEAST_SHARED = 0.01  # how far they must run together
BESIDE_LINE = 0.003  # between an edge and a line that it follows
RECESS = 0.1  # a face farther behind a hole is not what is in the recess
HOLE_SAMPLES = 6  # points across a hole, each way


@dataclass(frozen=True)
class FaceCounts:
    """Counts over all faces of a scene."""

    faces: int
    of_openings: int  # panes and what is beside them, which are small, thin and near a wall by right
    too_many: int  # pieces that a larger face could be: one wall in one plane, and near each other
    alone: int  # that share no edge with another face that is not of an opening
    steps: int  # of staircases, in outlines and holes
    steps_without_line: int  # of them, those with no line along the step
    slivers: int
    small: int  # below SMALL_AREA of the largest
    holes: int
    recesses: int  # holes in which a parallel face stands, a little behind


def count_faces(scene: Scene, shapes: list[Shape], of_openings: Bool) -> FaceCounts:
    """What a draughtsman would draw otherwise; faces `of_openings` (F,) are neither pieces, slivers nor small."""
    area = np.array([shape.polygon.area for shape in shapes])
    largest = _largest(shapes, area)
    shape_number = np.array([_longest(shape) ** 2 for shape in shapes]) / np.maximum(area, np.finfo(float).tiny)
    odd = (area < SLIVER_AREA * largest) | (shape_number > SLIVER_SHAPE)
    walls = [shape for shape, is_part in zip(shapes, of_openings.tolist(), strict=True) if not is_part]
    parts = [shape.face for shape, is_part in zip(shapes, of_openings.tolist(), strict=True) if is_part]
    corners = {tuple(corner) for part in parts for corner in part.outline.tolist()}
    # A door that stands on the foot of its wall is a step of it, but nobody drew it jagged.
    steps = [
        step for shape in walls for step in steps_of(shape) if not all(tuple(end) in corners for end in step.tolist())
    ]
    return FaceCounts(
        faces=len(shapes),
        of_openings=int(of_openings.sum()),
        too_many=_too_many(walls),
        alone=_alone(walls),
        steps=len(steps),
        steps_without_line=sum(not _follows_line(scene, step) for step in steps),
        slivers=int((odd & ~of_openings).sum()),
        small=int(((area < SMALL_AREA * largest) & ~of_openings).sum()),
        holes=sum(len(shape.face.holes) for shape in shapes),
        recesses=_recesses(scene, shapes),
    )


def _largest(shapes: list[Shape], area: Float) -> float:
    """The area of the largest wall, since ground reaches as far as one likes; of the largest face without walls."""
    upright = np.array([shape.is_upright for shape in shapes], bool)
    return float(area[upright].max() if upright.any() else area.max(initial=0.0))


def _longest(shape: Shape) -> float:
    """The largest distance between two corners of an outline."""
    ring = shape.rings[0]
    return float(np.linalg.norm(ring[:, None] - ring[None], axis=2).max())


def _too_many(shapes: list[Shape]) -> int:
    linked = np.zeros((len(shapes), len(shapes)), bool)
    for i, one in enumerate(shapes):
        for j, other in enumerate(shapes[:i]):
            near = min(one.depth, other.depth)
            linked[i, j] = (
                one.plane.axis == other.plane.axis
                and abs(one.plane.offset - other.plane.offset) < ONE_WALL * near
                and shapely.dwithin(one.polygon, other.polygon, ONE_WALL_GAP * near)
            )
    return len(shapes) - int(connected_components(linked, directed=False)[0]) if shapes else 0


def _alone(shapes: list[Shape]) -> int:
    count = 0
    for shape in shapes:
        others = [other.edges for other in shapes if other is not shape]
        count += not (others and shares_edge(shape.edges, np.concatenate(others), shape.depth))
    return count


def shares_edge(edges: Float, others: Float, depth: float) -> bool:
    """Whether an edge (E, 2, 3) runs along one of others (F, 2, 3), by the tolerances of a place at `depth`."""
    length = np.linalg.norm(edges[:, 1] - edges[:, 0], axis=1)
    unit = (edges[:, 1] - edges[:, 0]) / np.maximum(length, np.finfo(float).tiny)[:, None]
    away = others[None] - edges[:, :1, None]  # (E, F, 2, 3)
    place = (away * unit[:, None, None]).sum(axis=3)  # (E, F, 2)
    beside = np.linalg.norm(away - place[..., None] * unit[:, None, None], axis=3)
    shared = np.minimum(place.max(axis=2), length[:, None]) - np.maximum(place.min(axis=2), 0.0)
    return bool(((beside.max(axis=2) < SAME_EDGE * depth) & (shared > LEAST_SHARED * depth)).any())


def steps_of(shape: Shape) -> list[Float]:
    """Each step as the edge (2, 3) between its two corners, which turn against each other."""
    found = []
    for ring in shape.rings:
        along = np.roll(ring, -1, axis=0) - ring  # of the edge after each corner
        before = np.roll(along, 1, axis=0)
        turn = np.sign(before[:, 0] * along[:, 1] - before[:, 1] * along[:, 0])
        short = np.linalg.norm(along, axis=1) < STEP * shape.diagonal
        for corner in np.flatnonzero((turn * np.roll(turn, -1) < 0) & short).tolist():
            ends = ring[[corner, (corner + 1) % len(ring)]]
            found.append(shape.in_world(ends))
    return found


def _follows_line(scene: Scene, edge: Float) -> bool:
    """Whether a line runs along an edge (2, 3) over half of it."""
    turned, ends = components(edge, scene.turns), components(scene.lines.ends, scene.turns)
    axis = int(np.abs(turned[1] - turned[0]).argmax())
    sides = np.sort(across(np.array(axis)))
    depth = max(float((edge @ scene.rotation[2]).mean()), 0.0)
    own = ends[scene.lines.axis == axis]
    near = np.linalg.norm(own[:, 0][:, sides] - turned.mean(axis=0)[sides], axis=1) < BESIDE_LINE * depth
    low, high = np.sort(turned[:, axis])
    shared = np.minimum(own[:, :, axis].max(axis=1), high) - np.maximum(own[:, :, axis].min(axis=1), low)
    return bool((near & (shared >= 0.5 * (high - low))).any())


def _recesses(scene: Scene, shapes: list[Shape]) -> int:
    """Holes through most of which a parallel face is seen, behind and not far."""
    count = 0
    for shape in shapes:
        parallel = [(each.plane, each.face) for each in shapes if each.plane.axis == shape.plane.axis]
        for hole in shape.rings[1:]:
            points = shape.in_world(_inside(hole))
            own = points @ scene.rotation[2]
            pixels = project(points[own > 0], scene.camera.matrix, scene.rotation)
            which, depth = nearest_faces(scene, pixels, parallel)
            behind = depth[which != NO_FACE] / own[own > 0][which != NO_FACE] - 1
            count += int(((behind > SAME_EDGE) & (behind < RECESS)).sum()) > len(points) / 2
    return count


def _inside(ring: Float) -> Float:
    """Points (M, 2) spread over a polygon (V, 2), one at least."""
    polygon = shapely.Polygon(ring)
    share = (np.arange(HOLE_SAMPLES) + 0.5) / HOLE_SAMPLES
    low, high = ring.min(axis=0), ring.max(axis=0)
    points = np.stack(np.meshgrid(share, share), axis=-1).reshape(-1, 2) * (high - low) + low
    inside: Float = points[shapely.contains_xy(polygon, points)]
    return inside if len(inside) else np.array(polygon.representative_point().coords)
