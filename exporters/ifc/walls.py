"""Walls with the openings cut out of them, and the windows and doors in these.

The photo shows the face of a wall alone; its body is that face, pushed away from the camera by a thickness that is
taken for granted, and said so. An opening goes through the whole wall; its pane stands as far behind the face as the
scene tells.
"""

from collections.abc import Sequence

import numpy as np
import shapely

from exporters.colours import face_colour
from exporters.faces import FlatFace
from exporters.ifc.document import Document, Entity, Metres, Value, X
from exporters.ifc.voids import Side, Void
from exporters.model import in_component
from exporters.triangulation import checked_polygon
from linecad.errors import OutputError

PANE = 0.05  # m, how thick windows and doors are taken to be
_TOUCHING = 1e-6  # m; borders that are nearer are one
_GRID = 1e-7  # m, that corners of a wall are rounded to where a door is a notch in its outline

WINDOW = {"PredefinedType": "WINDOW", "PartitioningType": "NOTDEFINED"}
DOOR = {"PredefinedType": "DOOR", "OperationType": "NOTDEFINED"}


def wall_thickness(assumed: float, voids: Sequence[Void]) -> float:
    """m: what is assumed, or more where its deepest window would stand behind its back."""
    return max([assumed, *(void.recess + PANE for void in voids)])


def add_wall(
    document: Document, place: Entity, face: FlatFace, side: Side, voids: Sequence[Void], thickness: float
) -> Entity:
    """A wall without its openings, which `add_opening` cuts out of it. `place` is that of what contains it."""
    body = document.solid(document.polygon(_closed(face, side, voids)), 0.0, thickness)
    document.paint(body, face.kind, face_colour(face.kind))
    wall = document.add_rooted(
        "IfcWall",
        f"face {face.id}",
        face.label,
        Tag=face.name,
        ObjectPlacement=document.place(place, side.origin, side.along),
        Representation=document.shape("SweptSolid", body, layer=in_component("walls", face.component)),
        PredefinedType="NOTDEFINED",
    )
    document.make_of(wall, "wall, not known of what")
    return wall


def _closed(face: FlatFace, side: Side, voids: Sequence[Void]) -> shapely.Polygon:
    """The face in the axes of its side, its openings closed again: holes of it, or notches in its outline."""
    checked_polygon(face)
    polygon, boxes = side.polygon(face), [void.box(side) for void in voids]
    cut = shapely.union_all([box.buffer(_TOUCHING, join_style="mitre") for box in boxes])
    holes = [ring for ring in polygon.interiors if not cut.covers(shapely.Polygon(ring))]
    outline = shapely.Polygon(polygon.exterior)
    reached = outline.buffer(_TOUCHING, join_style="mitre")
    notches = [box for box in boxes if not reached.covers(box)]
    if notches:
        # Rounded, because a hair would stay between a notch and the door in it.
        outline = shapely.union_all([outline, *notches], grid_size=_GRID)
        if not isinstance(outline, shapely.Polygon):
            raise OutputError(f"{face.name} is not one piece with its openings; correct it in the scene file")
    return shapely.Polygon(outline.exterior, [*outline.interiors, *holes])


def add_opening(document: Document, wall: Entity, side: Side, void: Void, thickness: float) -> Entity:
    """The opening in its wall with the window or door that fills it, which comes back."""
    (low, high), fitting = void.rectangle(side), void.fitting
    width, height = (high - low).tolist()
    place = document.place(wall.ObjectPlacement, np.array([low[0], 0.0, low[1]]))
    opening = document.add_rooted(
        "IfcOpeningElement",
        f"opening {fitting.id}",
        f"opening of {fitting.label}",
        Tag=f"opening_{fitting.id:04d}",
        ObjectPlacement=place,
        Representation=document.shape("SweptSolid", document.solid(document.rectangle(width, height), 0.0, thickness)),
        PredefinedType="OPENING",
    )
    document.void(wall, opening)
    body = document.solid(document.rectangle(width, height), void.recess, PANE)
    document.paint(body, fitting.kind, face_colour(fitting.kind))
    filling = add_filling(
        document,
        fitting.kind,
        f"{fitting.kind} {fitting.id}",
        fitting.label,
        (width, height),
        Tag=f"opening_{fitting.id:04d}",
        ObjectPlacement=document.place(place, x=X),
        Representation=document.shape(
            "SweptSolid", body, layer=in_component(f"{fitting.kind}s", fitting.faces[0].component)
        ),
    )
    document.fill(opening, filling)
    return filling


def add_filling(
    document: Document, kind: str, key: str, name: str, size: tuple[float, float], **named: object
) -> Entity:
    """A window or a door of a width and height, m, of the type of all that are as large."""
    made_as, words = ("IfcWindow", WINDOW) if kind == "window" else ("IfcDoor", DOOR)
    made = document.add_rooted(made_as, key, name, OverallWidth=size[0], OverallHeight=size[1], **words, **named)
    document.make_of(made, f"{kind}, not known of what")
    what = "{} {:.4g} x {:.4g}".format(kind, *(each / document.unit for each in size))
    document.classify(made, f"{made_as}Type", what, f"{kind} {size[0]:.3f} x {size[1]:.3f} m", words)
    return made


def describe_filling(void: Void) -> dict[str, Value]:
    """What is known of a window or door beyond its size."""
    told: dict[str, Value] = {
        "OpeningId": str(void.fitting.id),
        "Shape": str(void.fitting.shape),
        "Seen": not void.opening.is_completed,
        "PaneThicknessAssumed": Metres(PANE),
    }
    return told if void.opening.recess is None else {**told, "Recess": Metres(void.recess)}
