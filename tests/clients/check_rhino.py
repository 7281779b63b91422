"""Open a 3DM with rhino3dm, which is Rhino's own library: check_rhino.py FILE.3dm EXPECTATION.json"""

import argparse
import json
import sys
from pathlib import Path

import rhino3dm

from shapes import apart, check_face, check_lines, check_names
from verdict import run

TOLERANCE = 1e-6  # m


def check(findings, path, expected):
    """Note all problems of the file; returns a summary."""
    file = rhino3dm.File3dm.Read(str(path))
    if not findings.need(file is not None, "Rhino's library cannot read it"):
        return ""
    unit = file.Settings.ModelUnitSystem
    findings.need(unit == rhino3dm.UnitSystem.Meters, f"the unit is {unit}, expected metres")
    segments, breps, meshes = {}, {}, {}
    for item in file.Objects:
        shape, words = item.Geometry, dict(item.Attributes.GetUserStrings())
        valid, said = shape.IsValidWithLog
        findings.need(valid, f"{item.Attributes.Name} is invalid: {said}")
        if shape.ObjectType == rhino3dm.ObjectType.Curve:
            layer = file.Layers[item.Attributes.LayerIndex].Name
            segments.setdefault(layer, []).append((place(shape.PointAtStart), place(shape.PointAtEnd)))
        elif shape.ObjectType == rhino3dm.ObjectType.Brep:
            breps.setdefault(words["linecad face"], []).append(shape)
        elif shape.ObjectType == rhino3dm.ObjectType.Mesh:
            meshes.setdefault(words["linecad face"], []).append(shape)
    placed = check_lines(findings, expected, segments, TOLERANCE)
    for kind, found in (("surfaces", breps), ("meshes", meshes)):
        names = [name for name, shapes in found.items() for _ in shapes]
        check_names(findings, kind, names, [face["name"] for face in expected["faces"]])
    for face in expected["faces"]:
        for brep in breps.get(face["name"], []):
            check_brep(findings, brep, face)
        for mesh in meshes.get(face["name"], []):
            points = [place(mesh.Vertices.Point3dAt(number)) for number in range(len(mesh.Vertices))]
            triangles = [mesh.Faces[number][:3] for number in range(len(mesh.Faces))]
            check_face(findings, face, points, triangles, TOLERANCE)
    counts = f"{len(placed)} lines, {len(breps)} trimmed planes, {len(meshes)} meshes, {len(file.Layers)} layers"
    return f"rhino3dm {rhino3dm.__version__}: 3DM {rhino3dm.File3dm.ReadArchiveVersion(str(path))}, {counts}"


def check_brep(findings, brep, face):
    """Need one plane with a loop for each ring, and the corners of the rings along its edges and nowhere else."""
    name = face["name"]
    if not findings.need(len(brep.Faces) == 1, f"{name} has {len(brep.Faces)} surfaces"):
        return
    (surface,) = brep.Faces
    findings.need(surface.IsPlanar(TOLERANCE), f"{name} is not flat")
    loops, rings = len(surface.Loops), len(face["rings"])
    findings.need(loops == rings, f"{name}: {loops} loops, expected {rings}")
    curves = [brep.Edges[number].ToNurbsCurve().Points for number in range(len(brep.Edges))]
    found = [place(curve[number]) for curve in curves for number in range(len(curve))]
    for points, others, what in ((found, face["corners"], "of it are not expected"), (face["corners"], found, "miss")):
        lost = sum(min(apart(point, other) for other in others) > TOLERANCE for point in points)
        findings.need(not lost, f"{name}: {lost} corners {what}")
    side = -1.0 if surface.OrientationIsReversed else 1.0  # the normal is that of the plane
    normal = [side * value for value in place(surface.NormalAt(0.5, 0.5))]
    findings.need(apart(normal, face["normal"]) < TOLERANCE, f"{name} looks along {normal}")


def place(point):
    return (point.X, point.Y, point.Z)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("file", type=Path)
    parser.add_argument("expectation", type=Path)
    chosen = parser.parse_args()
    expected = json.loads(chosen.expectation.read_text(encoding="utf-8"))
    return run(lambda findings: check(findings, chosen.file, expected))


if __name__ == "__main__":
    sys.exit(main())
