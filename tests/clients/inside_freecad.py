"""Run by FreeCAD itself, as check_freecad.py starts it: open a STEP, DXF or IFC and compare what came in.

FreeCAD imports this file instead of running it, so everything happens at the end of the module.
"""

import json
import math
import os
from pathlib import Path

import FreeCAD
import Part

from inside_freecad_ifc import check_ifc, open_ifc
from shapes import apart, check_colour, check_lines, check_names, dot
from verdict import judge

MILLIMETRES = 1000.0  # per metre
TOLERANCE = 1e-6  # m
ANGLE_TOLERANCE = 1e-6  # degrees
COLOUR_TOLERANCE = 5e-3  # FreeCAD keeps a channel in 8 bits


def check(findings):
    """Note all problems of the file that the environment names; returns a summary."""
    path = Path(os.environ["CHECK_FILE"])
    expected = json.loads(Path(os.environ["CHECK_EXPECTATION"]).read_text(encoding="utf-8"))
    gui = bool(os.environ["CHECK_GUI"])
    if gui:
        import FreeCADGui

        FreeCADGui.showMainWindow()
    document = FreeCAD.newDocument("check")
    if path.suffix == ".step":
        open_step(path, document, gui)
        count = check_step(findings, path, document, expected, gui)
    elif path.suffix == ".ifc":
        open_ifc(path, document)
        count = check_ifc(findings, document, expected, edges_of)
    else:
        open_dxf(path, document)
        count = check_dxf(findings, document, expected)
    version = ".".join(FreeCAD.Version()[:3])
    return f"FreeCAD {version}{' with its window' * gui}: {len(document.Objects)} objects, {count}"


def open_step(path, document, gui):
    # While it is on, FreeCAD makes one object without names of the whole file, as docs/guide/freecad.md says.
    settings = FreeCAD.ParamGet("User parameter:BaseApp/Preferences/Mod/Import/hSTEP")
    settings.SetBool("ReadShapeCompoundMode", False)
    if gui:
        import ImportGui as Importer  # the one that brings colours
    else:
        import Import as Importer
    Importer.insert(str(path), document.Name)


def open_dxf(path, document):
    settings = FreeCAD.ParamGet("User parameter:BaseApp/Preferences/Mod/Draft")
    settings.SetBool("dxfUseLegacyImporter", False)  # it would have to be downloaded
    settings.SetBool("groupLayers", True)  # a layer becomes one object
    import Import

    Import.readDXF(str(path), document.Name)


def check_step(findings, path, document, expected, gui):
    parts = {item.Label: item for item in document.Objects if item.TypeId == "Part::Feature"}
    faces = {face["name"]: face for face in expected["faces"]}
    wanted = [*expected["groups"], *faces, "camera"]
    named = [item.Label for item in document.Objects if item.TypeId == "Part::Feature"]
    check_names(findings, "parts", named, wanted)
    openings = [each["label"] for each in expected["openings"] if len(each["faces"]) > 1]  # a pane alone is a part
    groups = [item.Label for item in document.Objects if item.TypeId == "App::LinkGroup"]
    check_names(findings, "assemblies", groups, ["linecad", "lines"] + ["faces"] * bool(faces) + openings)
    segments = {name: edges_of(findings, parts[name]) for name in expected["groups"] if name in parts}
    placed = check_lines(findings, expected, segments, TOLERANCE)
    for name in faces:
        if name in parts:
            check_face(findings, parts[name].Shape, faces[name])
    if expected["turns"]:
        check_angles(findings, parts, expected)
    if "camera" in parts:
        corners = [metres(vertex) for vertex in parts["camera"].Shape.Vertexes]
        eye = expected["camera"]["eye"]
        right = len(corners) == 1 and apart(corners[0], eye) <= TOLERANCE
        findings.need(right, f"the camera stands at {corners}, expected {eye}")
    if gui:
        check_colours(findings, parts, expected)
    whole = Part.Shape()
    whole.read(str(path))
    valid = whole.isValid() and len(whole.Faces) == len(faces)
    findings.need(valid, f"read as one shape it has {len(whole.Faces)} faces, valid: {whole.isValid()}")
    return f"{len(placed)} lines, {len(whole.Faces)} faces"


def check_dxf(findings, document, expected):
    layers = {item.Label: item for item in document.Objects}
    wanted = [name.upper() for name in expected["groups"]] + ["FACE_OUTLINES"] * bool(expected["faces"])
    check_names(findings, "layers", [item.Label for item in document.Objects], wanted)
    segments = {name: edges_of(findings, layers[name.upper()]) for name in expected["groups"] if name.upper() in layers}
    placed = check_lines(findings, expected, segments, TOLERANCE)
    outlines = edges_of(findings, layers["FACE_OUTLINES"]) if "FACE_OUTLINES" in layers else []
    check_edges(findings, "FACE_OUTLINES", outlines, [edge for face in expected["faces"] for edge in edges(face)])
    return f"{len(placed)} lines, {len(outlines)} edges of faces"


def check_face(findings, shape, face):
    name = face["name"]
    if not findings.need(shape.isValid() and len(shape.Faces) == 1, f"{name} is {len(shape.Faces)} faces, or invalid"):
        return
    (only,) = shape.Faces
    findings.need(isinstance(only.Surface, Part.Plane), f"{name} lies in a {type(only.Surface).__name__}")
    sizes = [len(wire.Edges) for wire in only.Wires]
    rings = [len(ring) for ring in face["rings"]]
    outer = len(only.OuterWire.Edges)
    findings.need(outer == rings[0], f"{name}: its outline has {outer} edges, expected {rings[0]}")
    findings.need(sorted(sizes) == sorted(rings), f"{name}: rings of {sizes} edges, expected {rings}")
    area = only.Area / MILLIMETRES**2
    findings.need(math.isclose(area, face["area"], rel_tol=1e-6), f"{name}: area {area} m2, expected {face['area']}")
    found = [tuple(map(metres, edge.Vertexes)) for edge in only.Edges]
    check_edges(findings, name, found, edges(face))
    normal = only.normalAt(0, 0)
    findings.need(dot(normal, face["normal"]) > 0.999, f"{name} looks along {normal}")


def check_angles(findings, parts, expected):
    """Need walls of two frames to stand at the angle between these about z, or at right angles to that."""
    walls = {}
    for face in expected["faces"]:
        if face["frame"] is not None and face["name"] in parts:
            walls.setdefault(face["frame"], parts[face["name"]].Shape.Faces[0].normalAt(0, 0))
    turns = [0.0, *expected["turns"]]
    findings.need(len(walls) == len(turns), f"walls of the frames {sorted(walls)}, expected those of {len(turns)}")
    for frame, normal in walls.items():
        for other, beside in walls.items():
            cross, along = normal.x * beside.y - normal.y * beside.x, normal.x * beside.x + normal.y * beside.y
            angle = math.degrees(math.atan2(cross, along))
            wanted = math.degrees(turns[other] - turns[frame])
            findings.need(
                abs((angle - wanted + 45.0) % 90.0 - 45.0) <= ANGLE_TOLERANCE,
                f"walls of the frames {frame} and {other} are at {angle:.6f} degrees, expected {wanted:.6f}",
            )


def check_edges(findings, name, found, wanted):
    """Need the wanted edges, each as often as wanted, in any order and direction."""
    left, missing = list(found), 0
    for start, end in wanted:
        for number, (a, b) in enumerate(left):
            if min(max(apart(start, a), apart(end, b)), max(apart(start, b), apart(end, a))) <= TOLERANCE:
                del left[number]
                break
        else:
            missing += 1
    findings.need(not missing, f"{name}: {missing} of {len(wanted)} edges are not in their place")
    findings.need(not left, f"{name}: {len(left)} edges are not expected")


def edges(face):
    return [
        (face["corners"][a], face["corners"][b])
        for ring in face["rings"]
        for a, b in zip(ring, ring[1:] + ring[:1], strict=True)
    ]


def edges_of(findings, item):
    """The ends of all straight edges of an object, in metres."""
    kinds = {type(edge.Curve).__name__ for edge in item.Shape.Edges}
    findings.need(kinds <= {"Line", "LineSegment"}, f"{item.Label}: edges are {kinds}, expected straight ones")
    return [tuple(map(metres, edge.Vertexes)) for edge in item.Shape.Edges]


def metres(vertex):
    return tuple(value / MILLIMETRES for value in (vertex.X, vertex.Y, vertex.Z))


def check_colours(findings, parts, expected):
    """FreeCAD keeps a colour an edge and a colour a face."""
    wanted = {name: ("LineColorArray", group["srgb"]) for name, group in expected["groups"].items()}
    wanted |= {face["name"]: ("DiffuseColor", face["srgb"]) for face in expected["faces"]}
    for name, (kind, colour) in wanted.items():
        shown = set(map(tuple, getattr(parts[name].ViewObject, kind))) if name in parts else {()}
        findings.need(len(shown) == 1, f"{name} has {len(shown)} colours")
        for each in shown:
            check_colour(findings, name, each, colour, COLOUR_TOLERANCE)


Path(os.environ["CHECK_REPORT"]).write_text("\n".join(judge(check)), encoding="utf-8")
os._exit(0)  # the report tells the rest; FreeCAD's own end may crash where it was started without a screen
