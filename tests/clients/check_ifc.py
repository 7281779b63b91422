"""Check an IFC with ifcopenshell, its validator and its geometry: check_ifc.py FILE.ifc EXPECTATION.json"""

import argparse
import json
import math
import sys
import warnings
from pathlib import Path

import ifcopenshell
import ifcopenshell.geom
import ifcopenshell.validate

from shapes import check_lines, check_names, dot, normal_of
from verdict import run

TOLERANCE = 1e-6  # m
LEAST_THICKNESS = 0.3  # m
KINDS = {"IfcWall": "wall", "IfcWindow": "window", "IfcDoor": "door", "IfcGeographicElement": "ground"}


def check(findings, path, expected):
    """Note all problems of the file; returns a summary."""
    logger = ifcopenshell.validate.json_logger()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ResourceWarning)  # the validator does not close the module of its rules
        ifcopenshell.validate.validate(str(path), logger, express_rules=True)
    for statement in logger.statements:
        findings.need(False, f"the validator says: {' '.join(statement['message'].split())[:200]}")
    file = ifcopenshell.open(str(path))
    things = {face["thing"]: face["kind"] for face in expected["faces"] if face["opening"] is None}
    things |= {opening["label"]: opening["kind"] for opening in expected["openings"]}
    counts = []
    for name, kind in KINDS.items():
        found = [element.Name for element in file.by_type(name)]
        check_names(findings, f"{kind}s", found, [thing for thing, told in things.items() if told == kind])
        counts.append(f"{len(found)} {name}")
    faces = {face["name"]: face for face in expected["faces"]}
    for wall in file.by_type("IfcWall"):
        if wall.Tag in faces:
            check_wall(findings, wall, faces[wall.Tag])
    for filling in file.by_type("IfcWindow") + file.by_type("IfcDoor"):
        findings.need(filling.OverallWidth > 0 < filling.OverallHeight, f"{filling.Name} has no size")
    placed = check_lines(findings, expected, segments_of(file), TOLERANCE)
    return f"ifcopenshell {ifcopenshell.version}: {file.schema}, {len(placed)} lines, {', '.join(counts)}"


def check_wall(findings, wall, face):
    """Need a wall, with its openings cut out, of its face's area times the thickness that it tells."""
    told = {
        each.Name: each.NominalValue.wrappedValue
        for relation in wall.IsDefinedBy
        for each in relation.RelatingPropertyDefinition.HasProperties
        if each.is_a("IfcPropertySingleValue")
    }
    findings.need(told["Thickness"] >= LEAST_THICKNESS, f"{wall.Name} is {told['Thickness']} m thick")
    shape = ifcopenshell.geom.create_shape(ifcopenshell.geom.settings(), wall).geometry
    points = [shape.verts[number : number + 3] for number in range(0, len(shape.verts), 3)]
    volume = sum(
        dot(points[a], normal_of([0.0, 0.0, 0.0], points[b], points[c])) / 6
        for a, b, c in (shape.faces[number : number + 3] for number in range(0, len(shape.faces), 3))
    )
    wanted = face["area"] * told["Thickness"]
    same = math.isclose(volume, wanted, rel_tol=1e-6)
    findings.need(same, f"{wall.Name} has {volume} m3, expected {wanted}: are its openings cut out?")


def segments_of(file):
    """The lines of each annotation by its name."""
    return {
        annotation.Name: [
            tuple(point.Coordinates for point in curve.Points)
            for item in annotation.Representation.Representations[0].Items
            for curve in item.Elements
        ]
        for annotation in file.by_type("IfcAnnotation")
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("file", type=Path)
    parser.add_argument("expectation", type=Path)
    chosen = parser.parse_args()
    expected = json.loads(chosen.expectation.read_text(encoding="utf-8"))
    return run(lambda findings: check(findings, chosen.file, expected))


if __name__ == "__main__":
    sys.exit(main())
