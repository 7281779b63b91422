"""Faces as trimmed planes: one surface with an edge along each side of its outline and its holes.

rhino3dm trims a plane by an outline alone. But it knows extrusions with inner profiles, and the cap of one is the face
with its holes; so each face is pushed along z by 1 m, and its upper cap is laid into its place. Triangles are objects
of their own: `BrepFace.SetMesh` would hang them on the surface, but frees them twice and ends the process. Where a side
bends by less than a degree it is one edge, a polyline with a point at the bend.
"""

import numpy as np
import rhino3dm

from exporters.faces import FlatFace
from exporters.triangulation import checked_polygon, triangulate
from linecad.arrays import Float
from linecad.errors import OutputError

_HEIGHT = 1.0  # m, of the extrusion: a power of 2, so that the cap is at exactly that height
_STRAIGHT = 1e-9  # sine of an angle; a vector is along z where it is less far from it


def build_brep(face: FlatFace) -> rhino3dm.Brep:
    """The face as a trimmed plane that looks to its normal's side.

    Raises OutputError where the rings do not bound one piece of plane, or openNURBS takes them for less.
    """
    checked_polygon(face)
    origin, axes = face.rings[0][0], _axes(face.normal)
    outline, *holes = ((ring - origin) @ axes[:2].T for ring in face.rings)
    extrusion = rhino3dm.Extrusion.CreateWithPlane(_closed_curve(outline), rhino3dm.Plane.WorldXY(), _HEIGHT, True)
    if extrusion is None or not all(extrusion.AddInnerProfile(_closed_curve(hole)) for hole in holes):
        raise OutputError(f"{face.name} is too small or too thin for a surface of Rhino; correct it in the scene file")
    solid = extrusion.ToBrep(False)
    cap = solid.Faces[len(solid.Faces) - 1].DuplicateFace(False)
    cap.Transform(_into_place(axes, origin - _HEIGHT * face.normal))
    return cap


def _axes(normal: Float) -> Float:
    """(3, 3) unit vectors as rows: two in the plane, the first of them level, and its normal."""
    level = np.array([-normal[1], normal[0], 0.0])
    length = float(np.linalg.norm(level))
    first = level / length if length > _STRAIGHT else np.array([1.0, 0.0, 0.0])
    return np.stack([first, np.cross(normal, first), normal])


def _closed_curve(ring: Float) -> rhino3dm.PolylineCurve:
    points = rhino3dm.Polyline(len(ring) + 1)
    for x, y in [*ring.tolist(), ring[0].tolist()]:
        points.Add(x, y, 0.0)
    return points.ToPolylineCurve()


def _into_place(axes: Float, origin: Float) -> rhino3dm.Transform:
    """From the coordinates of a plane to the world; `axes` are the rows (3, 3), `origin` (3,) m."""
    move = rhino3dm.Transform(1.0)
    for row in range(3):
        for column, value in enumerate([*axes[:, row].tolist(), float(origin[row])]):
            setattr(move, f"M{row}{column}", value)
    return move


def build_mesh(face: FlatFace) -> rhino3dm.Mesh:
    """The face as triangles, for programs that cannot make any of a trimmed plane; raises OutputError likewise."""
    mesh = rhino3dm.Mesh()
    mesh.Vertices.UseDoublePrecisionVertices = True
    for point in face.vertices.tolist():
        mesh.Vertices.AddPoint3d(*point)  # `Add` rounds to 32 bits
    for corners in triangulate(face).tolist():
        mesh.Faces.AddFace(*corners)
    mesh.Normals.ComputeNormals()
    return mesh
