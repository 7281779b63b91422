"""The part of inside_freecad.py that opens an IFC: walls, windows and doors as many as the scene has, and its lines."""

import math
from collections import Counter

from shapes import apart, check_lines, check_names

MILLIMETRES = 1000.0  # per metre
TOLERANCE = 1e-6  # m
LEAST_THICKNESS = 0.3  # m, of a wall where no option says another
KINDS = {"Wall": "wall", "Window": "window", "Door": "door"}


def open_ifc(path, document):
    """Import a file."""
    import old_ifcopenshell

    old_ifcopenshell.install()
    import importIFC

    importIFC.insert(str(path), document.Name)


def check_ifc(findings, document, expected, edges_of):
    """Compare what came in; `edges_of` is that of inside_freecad.py. Returns a summary."""
    found = {kind: [] for kind in KINDS}
    for item in document.Objects:
        if getattr(item, "IfcType", None) in found:
            found[item.IfcType].append(item)
    things = {face["thing"]: face["kind"] for face in expected["faces"] if face["opening"] is None}
    things |= {opening["label"]: opening["kind"] for opening in expected["openings"]}
    for kind, items in found.items():
        wanted = [thing for thing, told in things.items() if told == KINDS[kind]]
        check_names(findings, KINDS[kind] + "s", [item.Label for item in items], wanted)
    faces = {face["thing"]: face for face in expected["faces"] if face["kind"] in KINDS.values()}
    for item in found["Wall"]:
        if item.Label in faces:
            check_wall(findings, item, faces[item.Label])
    for item in found["Window"] + found["Door"]:
        if item.Label in faces:
            check_pane(findings, item, faces[item.Label])
    prefix = "Annotation_"
    segments = {
        item.Label[len(prefix) :]: edges_of(findings, item)
        for item in document.Objects
        if item.Label.startswith(prefix) and hasattr(item, "Shape")
    }
    placed = check_lines(findings, expected, segments, TOLERANCE)
    counts = Counter({kind: len(items) for kind, items in found.items()})
    return f"{len(placed)} lines, {counts['Wall']} walls, {counts['Window']} windows, {counts['Door']} doors"


def check_wall(findings, item, face):
    """Need a wall of the area of its face, which has no openings, times the thickness that the file tells."""
    told = {key.split(";;")[0]: text.split(";;")[1] for key, text in item.IfcProperties.items()}
    thickness = float(told.get("Thickness", "nan"))
    findings.need(thickness >= LEAST_THICKNESS, f"{item.Label} is {thickness} m thick")
    solid = len(item.Shape.Solids) >= 1 and item.Shape.isValid()
    findings.need(solid, f"{item.Label} is no solid, or an invalid one")
    volume, wanted = item.Shape.Volume / MILLIMETRES**3, face["area"] * thickness
    same = math.isclose(volume, wanted, rel_tol=1e-6)
    findings.need(same, f"{item.Label} has {volume} m3, expected {wanted}: are its openings cut out?")
    check_corners(findings, item, face)


def check_pane(findings, item, face):
    """Need a window or door where its pane is."""
    findings.need(len(item.Shape.Solids) == 1, f"{item.Label} has {len(item.Shape.Solids)} solids")
    check_corners(findings, item, face)


def check_corners(findings, item, face):
    """Need a corner of the shape at each corner of the face but those in a straight side, where there are none."""
    have = [[value / MILLIMETRES for value in (corner.X, corner.Y, corner.Z)] for corner in item.Shape.Vertexes]
    missing = 0
    for ring in face["rings"]:
        corners = [face["corners"][number] for number in ring]
        for before, corner, after in zip(corners[-1:] + corners[:-1], corners, corners[1:] + corners[:1], strict=True):
            straight = math.dist(before, corner) + math.dist(corner, after) - math.dist(before, after) < TOLERANCE
            missing += not straight and min(apart(corner, each) for each in have) > TOLERANCE
    findings.need(not missing, f"{item.Label}: {missing} corners of its face are not in their place")
