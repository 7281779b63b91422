"""Polygons with holes as triangles that use every vertex of their rings and add none.

Constrained Delaunay, because ear clipping may skip a vertex in the middle of a straight edge; a neighbour that has a
corner there would then be torn off by a crack.
"""

import numpy as np
import shapely

from exporters.faces import FlatFace
from linecad.arrays import Int
from linecad.errors import OutputError


def checked_polygon(face: FlatFace) -> shapely.Polygon:
    """The face in the two axes of its plane; OutputError where its rings do not bound one piece of plane."""
    rings = [ring[:, face.in_plane] for ring in face.rings]
    polygon = shapely.Polygon(rings[0], rings[1:])
    if not polygon.is_valid:
        reason = shapely.is_valid_reason(polygon).split("[")[0].strip().lower()
        raise OutputError(f"{face.name} is not a polygon with holes ({reason}); correct it in the scene file")
    return polygon


def triangulate(face: FlatFace) -> Int:
    """(T, 3) indices into `face.vertices`, each triangle counter-clockwise as seen from the camera.

    T is V + 2 H - 2 for V vertices and H holes that do not touch each other or the outline; each touching vertex
    saves two. Raises OutputError where the rings do not bound one piece of plane.
    """
    pieces = shapely.constrained_delaunay_triangles(checked_polygon(face)).geoms
    corners = shapely.get_coordinates(list(pieces)).reshape(-1, 4, 2)[:, :3]
    flat = face.vertices[:, face.in_plane]
    index = {point: number for number, point in reversed(list(enumerate(map(tuple, flat.tolist()))))}
    triangles = np.array([[index[tuple(point)] for point in piece] for piece in corners.tolist()], np.int64)
    a, b, c = (flat[triangles[:, corner]] for corner in range(3))
    clockwise = (b - a)[:, 0] * (c - a)[:, 1] < (b - a)[:, 1] * (c - a)[:, 0]
    triangles[clockwise] = triangles[clockwise][:, ::-1]
    return _in_fixed_order(triangles)


def _in_fixed_order(triangles: Int) -> Int:
    """The same triangles, each from its smallest index on, in ascending order: a file is the same every time."""
    first = triangles.argmin(axis=1)[:, None]
    turned = np.take_along_axis(triangles, (first + np.arange(3)) % 3, axis=1)
    return turned[np.lexsort(turned.T[::-1])]
