"""DXF R2010 or R2018, in metres: https://help.autodesk.com/view/OARX/2018/ENU/?guid=GUID-235B22E0-A567-4CF6-92D3-38A2306D73F3

Lines are LINE entities on one layer a group, in the thinnest pen where it is one of details. A face is there twice: as
3DFACE triangles with their inner edges hidden on FACES, and as one closed 3D polyline a ring on FACE_OUTLINES, because
many programs ignore 3DFACE. What a line or face is stands in the extended data of each entity, under the application
name LINECAD: for a line its role and the probability that its depth is right, where the scene tells it, for a face its
kind and a label such as `wall 3`. DXF has no place for a camera with a principal point; its numbers are custom
properties of the document.
"""

import contextlib
import io
from collections.abc import Iterator
from itertools import product
from pathlib import Path

from ezdxf import new, options, units  # type: ignore[attr-defined]  # public, but re-exported without saying so
from ezdxf.document import Drawing
from ezdxf.entities.dxfgfx import DXFGraphic

from exporters.bands import BANDS
from exporters.camera import principal_point
from exporters.faces import FlatFace
from exporters.model import LineGroup, Model, group_name, in_component
from exporters.triangulation import triangulate
from linecad.directions import MAIN, axis_name, count_of
from linecad.scene import DETAIL, OUTLINE, ROLES

_APPLICATION = "LINECAD"
_FACES, _OUTLINES = "FACES", "FACE_OUTLINES"  # layer names; ASCII, because FreeCAD replaces other characters

# AutoCAD colour index: x red, y green, z blue, the paler one where the line is no boundary.
_COLOUR = {(0, True): 1, (0, False): 11, (1, True): 3, (1, False): 91, (2, True): 5, (2, False): 171}
# Of the level axes of further frames, in turn, boundary and not: orange, teal, magenta, olive.
_FURTHER = ((30, 31), (132, 131), (212, 211), (52, 51))
_FACE_COLOUR, _OUTLINE_COLOUR = 254, 8
_LINEWEIGHT = {True: 35, False: 13}  # hundredths of a millimetre on paper, by boundary
_DETAIL_LINEWEIGHT = 9

_STRING, _REAL, _INT16, _INT32 = 1000, 1040, 1070, 1071  # group codes of extended data
_LARGEST_INT32 = 2**31 - 1
_HIDDEN_EDGE = (1, 2, 8)  # flags of a triangle's edges 0-1, 1-2, 2-0; 4 is the edge between equal corners 2 and 3
_VIEW_MARGIN = 1.2  # height of the first view over the model's largest side


def write(model: Model, path: Path, version: str = "R2010") -> None:
    """Write the model as DXF of that AutoCAD release to `path`; OSError where that fails."""
    with fixed_metadata():
        path.write_bytes(bytes_of(_build_document(model, version)))


def bytes_of(document: Drawing) -> bytes:
    """The file of a document, the same every time; within `fixed_metadata`."""
    # ezdxf takes these from a set, whose order differs from run to run; what is there already stays where it is.
    for name in sorted(document.entitydb.dxf_types_in_use()):
        document.classes.add_class(name)
    text = io.StringIO()
    document.write(text)
    return document.encode(text.getvalue())


@contextlib.contextmanager
def fixed_metadata() -> Iterator[None]:
    """Without the times and random identifiers that ezdxf puts into a document when it is made and when written."""
    before = options.write_fixed_meta_data_for_testing
    options.write_fixed_meta_data_for_testing = True
    try:
        yield
    finally:
        options.write_fixed_meta_data_for_testing = before


def _build_document(model: Model, version: str) -> Drawing:
    document = new(version, units=units.M)
    document.header["$MEASUREMENT"] = 1  # metric
    document.appids.add(_APPLICATION)
    _add_layers(document, model)
    for group in model.groups:
        _add_lines(document, group)
    for face in model.faces:
        _add_face(document, face)
    _add_properties(document, model)
    _set_view(document, model)
    return document


def _add_layers(document: Drawing, model: Model) -> None:
    bands = BANDS if any(group.band for group in model.groups) else ("",)
    used = {group.role for group in model.groups}
    roles = [role for role in ("", *ROLES) if role in used or (role == OUTLINE and "" not in used)]
    further = {
        (axis, is_boundary): _FURTHER[(axis - MAIN) % len(_FURTHER)][not is_boundary]
        for axis in range(MAIN, count_of(model.scene.turns))
        for is_boundary in (True, False)
    }
    for ((axis, is_boundary), colour), role, band in product((_COLOUR | further).items(), roles, bands):
        name = group_name(axis, is_boundary, role, band).upper()
        weight = _DETAIL_LINEWEIGHT if role == DETAIL else _LINEWEIGHT[is_boundary]
        document.layers.add(name, color=colour, lineweight=weight)
    for group in model.groups:
        if group.component:  # of component 0 every programs finds all layers, whether lines are on them or not
            plain = document.layers.get(group_name(group.axis, group.is_boundary, group.role, group.band).upper())
            document.layers.add(group.name.upper(), color=plain.color, lineweight=plain.dxf.lineweight)
    for component in sorted({0, *(face.component for face in model.faces)}):
        document.layers.add(_layer(_FACES, component), color=_FACE_COLOUR)
        document.layers.add(_layer(_OUTLINES, component), color=_OUTLINE_COLOUR)


def _layer(name: str, component: int) -> str:
    return in_component(name, component).upper()


def _add_lines(document: Drawing, group: LineGroup) -> None:
    space = document.modelspace()
    kind = ((_INT16, int(group.is_boundary)), (_STRING, axis_name(group.axis)))
    told = [[(_REAL, value)] for value in group.probability.tolist()] or [[]] * len(group.ids)
    each = zip(group.ids.tolist(), group.ends.tolist(), group.roles.tolist(), told, strict=True)
    for number, (start, end), role, more in each:
        line = space.add_line(start, end, dxfattribs={"layer": group.name.upper()})
        _describe(line, "line", number, *kind, (_STRING, role), *more)


def _add_face(document: Drawing, face: FlatFace) -> None:
    space = document.modelspace()
    corners = face.vertices.tolist()
    outer_edges = _ring_edges(face)
    words = [(_STRING, word) for word in (face.name, face.kind, face.label)]
    for triangle in triangulate(face).tolist():
        entity = space.add_3dface(
            [corners[index] for index in triangle], dxfattribs={"layer": _layer(_FACES, face.component)}
        )
        edges = zip(triangle, triangle[1:] + triangle[:1], strict=True)
        hidden = [flag for edge, flag in zip(edges, _HIDDEN_EDGE, strict=True) if frozenset(edge) not in outer_edges]
        entity.dxf.invisible_edges = sum(hidden)
        _describe(entity, "face", face.id, *words)
    for number, ring in enumerate(face.rings):
        outline = space.add_polyline3d(
            ring.tolist(), close=True, dxfattribs={"layer": _layer(_OUTLINES, face.component)}
        )
        _describe(outline, "face", face.id, (_INT16, number), *words)


def _ring_edges(face: FlatFace) -> set[frozenset[int]]:
    """The edges of the rings as pairs of indices into the face's vertices."""
    edges: set[frozenset[int]] = set()
    start = 0
    for ring in face.rings:
        indices = range(start, start + len(ring))
        edges |= {frozenset((index, start + (index + 1 - start) % len(ring))) for index in indices}
        start += len(ring)
    return edges


def _describe(entity: DXFGraphic, kind: str, number: int, *more: tuple[int, str | int | float]) -> None:
    """Attach what the entity shows: its kind, the scene's id (as text where 32 bits do not hold it), and more."""
    identity = (_INT32, number) if number <= _LARGEST_INT32 else (_STRING, str(number))
    entity.set_xdata(_APPLICATION, [(_STRING, kind), identity, *more])


def _add_properties(document: Drawing, model: Model) -> None:
    scene = model.scene
    cx, cy = principal_point(scene.camera)
    properties = {
        "linecad unit": model.unit_note,
        "linecad photo": model.photo,
        "linecad camera": f"{scene.camera.width} x {scene.camera.height} px, focal length {scene.camera.focal!r} px, "
        f"principal point {cx!r} {cy!r} px from the top left corner",
        "linecad camera from world": " ".join(repr(value) for value in scene.rotation.ravel().tolist()),
        "linecad camera position": " ".join(repr(value) for value in model.eye.tolist()),
    }
    for name, value in properties.items():
        document.header.custom_vars.append(name, value)


def _set_view(document: Drawing, model: Model) -> None:
    low, high = model.points.min(axis=0), model.points.max(axis=0)
    space = document.modelspace()
    # The header's extents are what readers look at, the layout's what ezdxf copies into them.
    document.header["$EXTMIN"] = space.dxf.extmin = tuple(low.tolist())
    document.header["$EXTMAX"] = space.dxf.extmax = tuple(high.tolist())
    middle = (low + high) / 2
    height = float((high - low).max()) * _VIEW_MARGIN or 1.0
    document.set_modelspace_vport(height=height, center=(float(middle[0]), float(middle[1])))
