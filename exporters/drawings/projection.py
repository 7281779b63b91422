"""From the scene to a drawing: a parallel projection, and what of each line no nearer face hides."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely

from exporters.faces import FlatFace
from exporters.textures.layout import cut_ring
from linecad.arrays import Float

EDGE_ON = 1e-6  # of the normal that points to the viewer: a face with less is seen from its edge
_TINY = 1e-150  # m; from 1e-307 on shapely loses crossings
_SHORTEST = 1e-9  # of the diagonal of the box: what is shorter is a point

Box = tuple[float, float, float, float]


@dataclass(frozen=True, eq=False)
class Projection:
    """A view along parallel rays; right, up and toward the viewer are unit vectors at right angles."""

    right: Float  # (3,)
    up: Float  # (3,)
    toward: Float  # (3,) to the viewer
    origin: Float  # (3,) m: the point that is 0, 0 in the drawing and of height 0

    def __call__(self, points: Float) -> Float:
        """(..., 3) drawing metres x and y, and the height above the plane of the origin, of points (..., 3) in m."""
        return (points - self.origin) @ np.stack([self.right, self.up, self.toward], axis=1)

    def to_space(self, flat: Float) -> Float:
        """(..., 3) m, of drawing metres with height (..., 3)."""
        back: Float = flat @ np.stack([self.right, self.up, self.toward]) + self.origin
        return back


@dataclass(frozen=True, eq=False)
class Shown:
    """A face that is not seen from its edge, as far as it lies behind the section."""

    face: FlatFace
    rings: tuple[Float, ...]  # outline first; each (V, 3) drawing metres and height
    height: Float  # (3,): the height at x, y is its product with (x, y, 1)

    @cached_property
    def polygon(self) -> shapely.Geometry:
        """What it covers in the drawing."""
        outline, *holes = (_without_tiny(ring[:, :2]) for ring in self.rings)
        polygon = shapely.Polygon(outline, holes)
        return polygon if polygon.is_valid else shapely.make_valid(polygon)  # the section may cut it to touching pieces

    def heights(self, points: Float) -> Float:
        """(...) drawing metres at points (..., 2)."""
        above: Float = points @ self.height[:2] + self.height[2]
        return above


def shown_faces(faces: Iterable[FlatFace], projection: Projection, section: float) -> list[Shown]:
    """The faces that the viewer sees from a side, as far as they are not above the height `section`."""
    found = []
    for face in faces:
        facing = float(face.normal @ projection.toward)
        if abs(facing) <= EDGE_ON:
            continue
        rings = [projection(ring) for ring in face.rings]
        if max(float(ring[:, 2].max()) for ring in rings) > section:
            rings = [cut_ring(ring, section - ring[:, 2]) for ring in rings]
        rings = [ring for ring in rings if len(ring) > 2]
        if rings:
            slope = -np.array([face.normal @ projection.right, face.normal @ projection.up]) / facing
            base = rings[0][0]
            found.append(Shown(face, tuple(rings), np.array([*slope, base[2] - slope @ base[:2]])))
    return found


def visible_parts(
    lines: Float, shown: Sequence[Shown], box: Box, section: float, touching: float
) -> list[tuple[int, Float]]:
    """Of each line (N, 2, 3), its row and the parts (2, 3) of it in the box and below the section that nothing hides.

    A face hides what is lower by more than `touching`. Parts of one line come in its order.
    """
    polygons = [each.polygon for each in shown]
    for polygon in polygons:
        shapely.prepare(polygon)
    tree = shapely.STRtree(polygons)
    shortest = _SHORTEST * float(np.hypot(box[2] - box[0], box[3] - box[1]))
    found: list[tuple[int, Float]] = []
    for row, line in enumerate(lines):
        start, along = line[0], line[1] - line[0]
        if np.hypot(*along[:2]) <= shortest:
            continue
        begin, end = _within(start, along, box, section)
        if begin >= end:
            continue
        hidden: list[tuple[float, float]] = []
        for number in np.sort(tree.query(shapely.LineString(line[:, :2]))).tolist():
            hidden += _hidden(line, (begin, end), shown[number], touching)
        for a, b in _left(begin, end, hidden):
            if (b - a) * np.hypot(*along[:2]) > shortest:
                found.append((row, start + np.array([[a], [b]]) * along))
    return found


def _within(start: Float, along: Float, box: Box, section: float) -> tuple[float, float]:
    """From where to where on a line, 0 to 1, it lies in the box and below the section; 1 to 0 where it does not."""
    part, end = (0.0, 1.0), start + along
    limits = ((0, box[0], 1), (0, box[2], -1), (1, box[1], 1), (1, box[3], -1), (2, section, -1))
    for axis, limit, sign in limits:
        part = _not_negative(sign * float(start[axis] - limit), sign * float(end[axis] - limit), part)
    return part


def _not_negative(first: float, last: float, part: tuple[float, float]) -> tuple[float, float]:
    """Where in a part of a line, 0 to 1, a function that is linear along it is not negative; 1 to 0 where nowhere.

    It is given at both ends of the line, so that nothing is divided by a small change.
    """
    begin, end = part
    if first < 0 and last < 0:
        return 1.0, 0.0
    if first < 0 or last < 0:
        crossing = first / (first - last)
        begin, end = (max(begin, crossing), end) if first < 0 else (begin, min(end, crossing))
    return (begin, end) if begin < end else (1.0, 0.0)


def _hidden(line: Float, part: tuple[float, float], shown: Shown, touching: float) -> list[tuple[float, float]]:
    """The intervals of a line, 0 to 1, that lie behind a face."""
    flat = line[:, :2]
    first, last = (shown.heights(flat) - line[:, 2] - touching).tolist()  # linear along the line
    if first <= 0 and last <= 0:
        return []
    begin, end = _not_negative(first, last, part)
    if begin >= end:
        return []
    along = flat[1] - flat[0]
    ends = _without_tiny(flat[0] + np.array([[begin], [end]]) * along)
    covered = shapely.intersection(shapely.LineString(ends), shown.polygon)
    intervals = []
    for piece in shapely.get_parts(covered):
        if piece.geom_type == "LineString" and not piece.is_empty:
            at = (shapely.get_coordinates(piece) - flat[0]) @ along / (along @ along)
            intervals.append((float(at.min()), float(at.max())))
    return intervals


def _without_tiny(points: Float) -> Float:
    """The points (V, 2), with 0 for coordinates so small that what is crossed beside them gets lost."""
    return np.where(np.abs(points) < _TINY, 0.0, points)


def _left(begin: float, end: float, hidden: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """What remains of an interval without others."""
    left = []
    for a, b in sorted(hidden):
        if a > begin:
            left.append((begin, min(a, end)))
        begin = max(begin, b)
        if begin >= end:
            return left
    return [*left, (begin, end)]
