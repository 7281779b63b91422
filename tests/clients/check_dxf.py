"""Open a DXF with ezdxf, strictly and with its auditor: check_dxf.py FILE.dxf EXPECTATION.json"""

import argparse
import json
import sys
from pathlib import Path

import ezdxf
from ezdxf import colors, units

from shapes import AXES, apart, check_face, check_lines, check_names, ring_edges
from verdict import run

RELEASES = {"AC1024": "R2010", "AC1032": "R2018"}
BY_LAYER = 256
STRING, INTEGER_16 = 1000, 1070  # group codes of extended data
TOLERANCE = 1e-6  # m; DXF holds doubles as text


def check(findings, path, expected):
    """Note all problems of the file; returns a summary."""
    document = ezdxf.readfile(path, errors="strict")
    auditor = document.audit()
    for entry in (*auditor.errors, *auditor.fixes):
        findings.need(False, f"the auditor says: {entry.message}")
    space = document.modelspace()
    findings.need(document.dxfversion in RELEASES, f"version {document.dxfversion}, expected one of {list(RELEASES)}")
    unit = document.header.get("$INSUNITS")
    findings.need(unit == units.M, f"$INSUNITS is {unit}, expected {units.M}, metres")
    findings.need(document.header.get("$MEASUREMENT") == 1, "$MEASUREMENT is not 1, metric")
    check_layers(findings, document, expected)
    check_line_entities(findings, space, expected)
    for face in expected["faces"]:
        check_triangles(findings, space, face)
        check_outlines(findings, space, face)
    named = {told(entity)["name"] for entity in space.query("3DFACE POLYLINE")}
    check_names(findings, "faces", named, [face["name"] for face in expected["faces"]])
    check_header(findings, document, expected)
    counts = ", ".join(f"{len(space.query(kind))} {kind}" for kind in ("LINE", "3DFACE", "POLYLINE"))
    return f"ezdxf {ezdxf.__version__}: {RELEASES.get(document.dxfversion)}, {units.decode(unit)}, {counts}"


def told(entity):
    """What the extended data of an entity says: kind, id, number (a 16-bit one), name, and the words after it."""
    if not entity.has_xdata("LINECAD"):
        raise ValueError(f"a {entity.dxftype()} has no extended data of LINECAD")
    kind, number, *more = [(tag.code, tag.value) for tag in entity.get_xdata("LINECAD")]
    name, *words = [value for code, value in more if code == STRING]
    # What 32 bits do not hold is text.
    return {
        "kind": kind[1], "id": int(number[1]), "number": dict(more).get(INTEGER_16), "name": name, "words": words,
    }  # fmt: skip


def check_layers(findings, document, expected):
    names = [layer.dxf.name for layer in document.layers]
    findings.need(all(name.isascii() for name in names), f"layers {names}: FreeCAD wants ASCII")
    kinds = {"LINE", "3DFACE", "POLYLINE"}
    for entity in document.modelspace():
        kind, layer = entity.dxftype(), entity.dxf.layer
        findings.need(kind in kinds, f"an entity of kind {kind}, expected {sorted(kinds)}")
        findings.need(layer in names, f"a {kind} is on the layer {layer}, which is not defined")
        findings.need(entity.dxf.color == BY_LAYER, f"a {kind} on {layer} has a colour of its own")
    colour = {}
    for name, group in expected["groups"].items():
        layer = name.upper()
        if findings.need(layer in names, f"there is no layer {layer}"):
            colour[name] = colors.aci2rgb(document.layers.get(layer).dxf.color)
            if group["axis"] not in AXES:
                continue  # of a further frame, whose colours are mixed
            strongest = AXES[max(range(3), key=colour[name].__getitem__)]
            axis = {"x": "red", "y": "green", "z": "blue"}[group["axis"]]
            findings.need(strongest == group["axis"], f"layer {layer} has the colour {colour[name]}, expected a {axis}")
    for name, strong in colour.items():
        pale = colour.get(name.replace("_boundary", "_nonboundary"))
        if "_boundary" in name and pale:
            findings.need(min(pale) > min(strong), f"{name}: {pale}, of other lines, is not paler than {strong}")


def check_line_entities(findings, space, expected):
    segments, place = {}, {}
    roles = {line["id"]: line["role"] for line in expected["lines"]}
    for entity in space.query("LINE"):
        said, group = told(entity), entity.dxf.layer.lower()
        ends = tuple(entity.dxf.start), tuple(entity.dxf.end)
        segments.setdefault(group, []).append(ends)
        findings.need(said["kind"] == "line", f"a LINE says that it is a {said['kind']}")
        findings.need(said["id"] not in place, f"two lines have the id {said['id']}")
        place[said["id"]] = ends
        kind = expected["groups"].get(group, {})
        same = (said["name"], said["number"]) == (kind.get("axis"), kind.get("boundary"))
        findings.need(same, f"line {said['id']} on {entity.dxf.layer} says axis {said['name']}, {said['number']}")
        role = roles.get(said["id"])
        findings.need(said["words"] == [role], f"line {said['id']} says {said['words']}, expected the role {role}")
    check_names(findings, "ids of lines", place, [line["id"] for line in expected["lines"]])
    for number, ends in check_lines(findings, expected, segments, TOLERANCE).items():
        findings.need(set(place.get(number, ())) == set(ends), f"the line with the id {number} is another one")


def check_triangles(findings, space, face):
    """The 3DFACEs of a face, whose hidden edges must be those that are no edges of its rings."""
    points, triangles, wrong = [], [], 0
    rings = {frozenset(edge) for edge in ring_edges(face)}
    corner = {tuple(point): number for number, point in enumerate(face["corners"])}
    for entity in space.query("3DFACE"):
        if told(entity)["name"] != face["name"]:
            continue
        findings.need(entity.dxf.layer == "FACES", f"{face['name']}: a 3DFACE is on {entity.dxf.layer}")
        check_words(findings, told(entity), face)
        vertices = [tuple(vertex) for vertex in entity.wcs_vertices()][:3]
        numbers = [corner.get(vertex, -1) for vertex in vertices]
        for edge, pair in enumerate(zip(numbers, numbers[1:] + numbers[:1], strict=True)):
            shown = not entity.dxf.invisible_edges & (1, 2, 8)[edge]  # 4: between the equal third and fourth corner
            wrong += shown != (frozenset(pair) in rings)
        triangles.append(range(len(points), len(points) + 3))
        points += vertices
    findings.need(not wrong, f"{face['name']}: {wrong} edges of triangles are shown or hidden wrongly")
    check_face(findings, face, points, triangles, TOLERANCE)


def check_outlines(findings, space, face):
    """The closed polylines of a face, one a ring, which may start at any corner and run either way."""
    found = []
    for entity in space.query("POLYLINE"):
        said = told(entity)
        if said["name"] != face["name"]:
            continue
        right = entity.is_3d_polyline and entity.is_closed and entity.dxf.layer == "FACE_OUTLINES"
        findings.need(right, f"{face['name']}: an outline is no closed 3D polyline on FACE_OUTLINES")
        findings.need(said["id"] == face["id"], f"{face['name']}: an outline has the id {said['id']}")
        check_words(findings, said, face)
        found.append([tuple(vertex.dxf.location) for vertex in entity.vertices])
    rings = [[tuple(face["corners"][number]) for number in ring] for ring in face["rings"]]
    same = sorted(map(turned, found)) == sorted(map(turned, rings))
    findings.need(same, f"{face['name']}: its {len(found)} outlines are not its {len(rings)} rings")


def check_words(findings, said, face):
    """Need the kind of a face and its label behind its name."""
    wanted = [face["kind"], face["label"]]
    findings.need(said["words"] == wanted, f"{face['name']} says {said['words']}, expected {wanted}")


def turned(ring):
    """A ring from its smallest point on, in the direction of the smaller neighbour."""
    first = ring.index(min(ring))
    forward = ring[first:] + ring[:first]
    return min(forward, [forward[0], *forward[:0:-1]])


def check_header(findings, document, expected):
    """The extents and the first view, and the camera among the properties of the document."""
    low, high = document.header.get("$EXTMIN"), document.header.get("$EXTMAX")
    same = max(apart(low, expected["box"][0]), apart(high, expected["box"][1])) <= TOLERANCE
    findings.need(same, f"$EXTMIN and $EXTMAX are {low} and {high}, expected {expected['box']}")
    findings.need(document.viewports.get("*Active"), "there is no view to open the drawing in")
    properties = dict(document.header.custom_vars.properties)
    rotation = [float(word) for word in properties.get("linecad camera from world", "").split()]
    rows = [value for row in expected["camera"]["rotation"] for value in row]
    findings.need(rotation == rows, f"the properties tell the rotation {rotation}, expected {rows}")
    place = [float(word) for word in properties.get("linecad camera position", "").split()]
    eye = expected["camera"]["eye"]
    findings.need(place == eye, f"the properties tell the camera's place {place}, expected {eye}")
    camera = properties.get("linecad camera", "")
    for number in (expected["camera"]["focal"], *expected["camera"]["principal_point"]):
        findings.need(repr(number) in camera, f"the properties tell the camera {camera!r}, without {number}")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("file")
    parser.add_argument("expectation", type=Path)
    chosen = parser.parse_args()
    expected = json.loads(chosen.expectation.read_text(encoding="utf-8"))
    return run(lambda findings: check(findings, chosen.file, expected))


if __name__ == "__main__":
    sys.exit(main())
