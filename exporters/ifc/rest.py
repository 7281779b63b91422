"""What of a scene is no wall with openings: ground, ceilings, roofs, other faces, and the lines.

Of these the photo shows a surface and nothing tells a thickness, so they are surfaces.
"""

from collections.abc import Iterable

import numpy as np

from exporters.colours import face_colour, face_colour_name, line_colour
from exporters.faces import FlatFace
from exporters.ifc.document import Document, Entity
from exporters.ifc.walls import add_filling
from exporters.model import LineGroup, in_component
from exporters.openings import Fitting
from linecad.directions import axis_name

_CLASS = {
    "ground": ("IfcGeographicElement", {"PredefinedType": "TERRAIN"}),
    "ceiling": ("IfcCovering", {"PredefinedType": "CEILING"}),
    "roof": ("IfcSlab", {"PredefinedType": "ROOF"}),
    "wall": ("IfcWall", {"PredefinedType": "NOTDEFINED"}),  # one that leans
}
_OTHER = ("IfcBuildingElementProxy", {"PredefinedType": "NOTDEFINED"})
_LAYER = {
    "ground": "ground",
    "ceiling": "ceilings",
    "roof": "roofs",
    "wall": "walls",
    "window": "windows",
    "door": "doors",
}


def add_surface(document: Document, place: Entity, face: FlatFace) -> Entity:
    """A face that is of no opening."""
    item = document.surface([face])
    document.paint(item, face_colour_name(face.kind), face_colour(face.kind))
    shape = document.shape(
        "SurfaceModel", item, layer=in_component(_LAYER.get(face.kind, "other faces"), face.component)
    )
    named = {"Tag": face.name, "ObjectPlacement": document.place(place), "Representation": shape}
    key = f"face {face.id}"
    if face.kind in ("window", "door"):
        return add_filling(document, face.kind, key, face.label, _size([face]), **named)
    kind, words = _CLASS.get(face.kind, _OTHER)
    return document.add_rooted(kind, key, face.label, **words, **named)


def add_loose_fitting(document: Document, place: Entity, fitting: Fitting) -> Entity:
    """A window or a door whose wall has no face: its own faces, where they are."""
    item = document.surface(fitting.faces)
    document.paint(item, fitting.kind, face_colour(fitting.kind))
    shape = document.shape("SurfaceModel", item, layer=in_component(_LAYER[fitting.kind], fitting.faces[0].component))
    panes = [face for face in fitting.faces if face.kind != "reveal"]
    return add_filling(
        document, fitting.kind, f"{fitting.kind} {fitting.id}", fitting.label, _size(panes or fitting.faces),
        Tag=f"opening_{fitting.id:04d}", ObjectPlacement=document.place(place), Representation=shape,
    )  # fmt: skip


def _size(faces: Iterable[FlatFace]) -> tuple[float, float]:
    """m, the level and the upright extent of faces of one direction."""
    faces = list(faces)
    level = np.cross([0.0, 0.0, 1.0], faces[0].normal)
    points = np.concatenate([face.vertices for face in faces])
    along = points @ level
    return float(np.ptp(along)), float(np.ptp(points[:, 2]))


def add_lines(document: Document, place: Entity, group: LineGroup) -> Entity:
    """The lines of a group as one annotation on a layer of its name, with their ids in the order of the curves."""
    curves = [document.add("IfcPolyline", [document.point(end) for end in ends]) for ends in group.ends]
    item = document.add("IfcGeometricCurveSet", curves)
    document.draw(item, group.name, line_colour(group.axis, group.is_boundary))
    made = document.add_rooted(
        "IfcAnnotation",
        f"annotation {group.name}",
        group.name,
        ObjectPlacement=document.place(place),
        Representation=document.shape("GeometricCurveSet", item, document.annotation, group.name),
    )
    told = {"Probabilities": tuple(map(repr, group.probability.tolist()))} if len(group.probability) else {}
    document.describe(
        made,
        "linecad_Lines",
        {
            "Axis": axis_name(group.axis),
            "Boundary": group.is_boundary,
            "Ids": tuple(map(str, group.ids.tolist())),
            "Roles": tuple(group.roles.tolist()),
            **told,
        },
    )
    return made
