"""STEP AP214 (ISO 10303-21 and -214), in millimetres: https://www.steptools.com/stds/stp_aim/html/

An assembly `linecad` of two assemblies and a part: `lines`, with one part of straight edges a group; `faces`, with one
part a face, which has its holes; and `camera`, a point where it stood. The place of a face's part in its assembly is
named after what it shows, such as `wall 3`. Sewn, `faces` is one part, and faces that share an edge are one shell.

OCCT is used directly. build123d, which wraps it, takes more than twice the time and 160 MB more to load, and its own
STEP export garbles names that are not ASCII, colours part and instance so that FreeCAD doubles the objects, and never
writes the same file twice.
"""

import contextlib
import io
from collections.abc import Iterable, Iterator
from pathlib import Path

from OCP.APIHeaderSection import APIHeaderSection_MakeHeader
from OCP.BRep import BRep_Builder
from OCP.BRepBuilderAPI import (
    BRepBuilderAPI_MakeEdge,
    BRepBuilderAPI_MakeFace,
    BRepBuilderAPI_MakePolygon,
    BRepBuilderAPI_MakeVertex,
    BRepBuilderAPI_Sewing,
)
from OCP.gp import gp_Dir, gp_Pln, gp_Pnt, gp_Trsf, gp_Vec
from OCP.IFSelect import IFSelect_ReturnStatus
from OCP.Interface import Interface_Static
from OCP.Message import Message, Message_Gravity
from OCP.Quantity import Quantity_Color, Quantity_TypeOfColor
from OCP.Standard import Standard_Failure
from OCP.StdFail import StdFail_NotDone
from OCP.STEPCAFControl import STEPCAFControl_Controller, STEPCAFControl_Writer
from OCP.STEPControl import STEPControl_Controller, STEPControl_StepModelType
from OCP.TCollection import TCollection_ExtendedString, TCollection_HAsciiString
from OCP.TDataStd import TDataStd_Name
from OCP.TDF import TDF_Label
from OCP.TDocStd import TDocStd_Document
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Compound, TopoDS_Face, TopoDS_Shape, TopoDS_Wire
from OCP.XCAFApp import XCAFApp_Application
from OCP.XCAFDoc import XCAFDoc_ColorTool, XCAFDoc_ColorType, XCAFDoc_DocumentTool, XCAFDoc_ShapeTool
from OCP.XSControl import XSControl_WorkSession

from exporters.colours import FACE, RGB, face_colour, line_colour
from exporters.faces import FlatFace
from exporters.model import LineGroup, Model, in_component
from exporters.openings import Fitting
from exporters.step.canonical import canonical
from exporters.triangulation import checked_polygon
from linecad.arrays import Float

_MILLIMETRES = 1000.0  # per metre
_METRES_PER_DOCUMENT_UNIT = 0.001
_SEWING_TOLERANCE = 1e-3  # mm; edges that are nearer to each other than this are one edge of a shell
_TIMESTAMP = "1970-01-01T00:00:00"  # the real one would make each file another
_CURVE, _SURFACE = XCAFDoc_ColorType.XCAFDoc_ColorCurv, XCAFDoc_ColorType.XCAFDoc_ColorSurf
_OPTIONS = {"write.step.schema": "AP214IS", "write.step.unit": "MM", "write.step.product.name": "linecad"}


def write(model: Model, path: Path, sewn: bool = False, instances: bool = False) -> None:
    """Write the model as STEP to `path`, its faces sewn where that is asked for; OSError where that fails.

    With `instances` equal openings are one part in several places, if the faces are not sewn.
    """
    with _silence():
        try:
            data = _written(_build_document(model, sewn, instances), model)
        except (Standard_Failure, StdFail_NotDone) as error:
            # The binding does not derive the second from the first; it ends edges of no length in its own tolerance.
            raise OSError(
                f"the STEP library failed with {type(error).__name__}; are lengths of the scene far off metres?"
            ) from error
    path.write_text(canonical(data.decode()), encoding="utf-8", newline="\n")


class _Assembly:
    """An XCAF document that parts and assemblies are added to."""

    def __init__(self) -> None:
        self.document = TDocStd_Document(TCollection_ExtendedString("XmlOcaf"))
        XCAFApp_Application.GetApplication_s().InitDocument(self.document)
        XCAFDoc_DocumentTool.SetLengthUnit_s(self.document, _METRES_PER_DOCUMENT_UNIT)
        self._shapes: XCAFDoc_ShapeTool = XCAFDoc_DocumentTool.ShapeTool_s(self.document.Main())
        self._colours: XCAFDoc_ColorTool = XCAFDoc_DocumentTool.ColorTool_s(self.document.Main())
        XCAFDoc_ShapeTool.SetAutoNaming_s(False)  # else OCCT calls every part after its kind of shape

    def add_assembly(self, parent: TDF_Label | None, name: str) -> TDF_Label:
        label = self._shapes.NewShape()
        _set_name(label, name)
        if parent is not None:
            self.place(parent, label, name)
        return label

    def add_part(self, parent: TDF_Label | None, name: str, shape: TopoDS_Shape, place_name: str = "") -> TDF_Label:
        """Add a part; its place in the parent, if it has one, has a name of its own where one is given."""
        label = self._shapes.AddShape(shape, False)
        _set_name(label, name)
        if parent is not None:
            self.place(parent, label, place_name or name)
        return label

    def paint(self, part: TDF_Label, colour: RGB, kind: XCAFDoc_ColorType) -> None:
        """Colour the part alone; a second colour on its instance would double the object in FreeCAD."""
        self._colours.SetColor(part, _quantity(colour), kind)

    def finish(self) -> TDocStd_Document:
        self._shapes.UpdateAssemblies()
        return self.document

    def place(self, parent: TDF_Label, label: TDF_Label, name: str, at: Float | None = None) -> None:
        """Place a part or an assembly in another one, where its numbers say or `at` (3,) m."""
        location = TopLoc_Location()
        if at is not None:
            move = gp_Trsf()
            move.SetTranslation(gp_Vec(*(at * _MILLIMETRES).tolist()))
            location = TopLoc_Location(move)
        _set_name(self._shapes.AddComponent(parent, label, location), name)


def _build_document(model: Model, sewn: bool, instances: bool) -> TDocStd_Document:
    assembly = _Assembly()
    root = assembly.add_assembly(None, "linecad")
    if model.groups:
        lines = _add_parents(assembly, root, "lines", [group.component for group in model.groups])
        for group in model.groups:
            _add_lines(assembly, lines[group.component], group)
    components = [face.component for face in model.faces]
    if model.faces and sewn:
        for component in sorted(set(components)):
            shapes = (_face_shape(face) for face in model.faces if face.component == component)
            part = assembly.add_part(root, in_component("faces", component), _sewn(shapes))
            assembly.paint(part, FACE, _SURFACE)
    elif model.faces:
        faces = _add_parents(assembly, root, "faces", components)
        for face in model.loose_faces:
            _add_face(assembly, faces[face.component], face, face.name)
        for equal in model.equal_fittings:
            if instances and len(equal) > 1:
                _add_equal(assembly, faces, equal)
            else:
                for fitting in equal:
                    _add_fitting(assembly, faces[fitting.component], fitting)
    # In a compound, because OCCT loses the name of a bare vertex.
    eye = gp_Pnt(*(model.eye * _MILLIMETRES).tolist())
    assembly.add_part(root, "camera", _compound([BRepBuilderAPI_MakeVertex(eye).Vertex()]))
    return assembly.finish()


def _add_parents(assembly: _Assembly, root: TDF_Label, name: str, components: Iterable[int]) -> dict[int, TDF_Label]:
    """An assembly for component 0, and in it one for each of the others."""
    parents = {0: assembly.add_assembly(root, name)}
    for component in sorted({*components} - {0}):
        parents[component] = assembly.add_assembly(parents[0], in_component(name, component))
    return parents


def _add_face(assembly: _Assembly, parent: TDF_Label | None, face: FlatFace, name: str) -> TDF_Label:
    part = assembly.add_part(parent, name, _face_shape(face), face.label)
    assembly.paint(part, face_colour(face.kind), _SURFACE)
    return part


def _add_fitting(assembly: _Assembly, parent: TDF_Label, fitting: Fitting) -> None:
    """An opening as an assembly of its faces, which tell their places themselves: FreeCAD's parts have none else.

    A pane alone is no assembly, because FreeCAD would give it the name of that.
    """
    opening = parent if len(fitting.faces) == 1 else assembly.add_assembly(parent, fitting.label)
    for face in fitting.faces:
        _add_face(assembly, opening, face, face.name)


def _add_equal(assembly: _Assembly, parents: dict[int, TDF_Label], equal: tuple[Fitting, ...]) -> None:
    """Equal openings as one assembly in several places, or as one part where they are panes alone."""
    first, name = equal[0], f"{equal[0].kind} shape {equal[0].shape}"
    faces = first.local_faces
    if len(faces) == 1:
        shape = _add_face(assembly, None, faces[0], name)
    else:
        shape = assembly.add_assembly(None, name)
        for number, face in enumerate(faces):
            _add_face(assembly, shape, face, f"{face.kind} {number}")
    for fitting in equal:
        assembly.place(parents[fitting.component], shape, fitting.label, fitting.place)


def _add_lines(assembly: _Assembly, parent: TDF_Label, group: LineGroup) -> None:
    """One part for the whole group: a part a line takes FreeCAD 17 s to open for 2,000 lines."""
    ends = (group.ends * _MILLIMETRES).tolist()
    edges = [BRepBuilderAPI_MakeEdge(gp_Pnt(*start), gp_Pnt(*end)).Edge() for start, end in ends]
    part = assembly.add_part(parent, group.name, _compound(edges))
    assembly.paint(part, line_colour(group.axis, group.is_boundary), _CURVE)


def _compound(shapes: Iterable[TopoDS_Shape]) -> TopoDS_Compound:
    compound, builder = TopoDS_Compound(), BRep_Builder()
    builder.MakeCompound(compound)
    for shape in shapes:
        builder.Add(compound, shape)
    return compound


def _face_shape(face: FlatFace) -> TopoDS_Face:
    """The face in mm, looking to where its outline turns counter-clockwise, so to the camera."""
    checked_polygon(face)
    outline, *holes = (_wire(ring) for ring in face.rings)
    plane = gp_Pln(gp_Pnt(*(face.rings[0][0] * _MILLIMETRES).tolist()), gp_Dir(*face.normal.tolist()))
    maker = BRepBuilderAPI_MakeFace(plane, outline, True)
    for hole in holes:
        maker.Add(hole)
    return maker.Face()


def _wire(ring: Float) -> TopoDS_Wire:
    polygon = BRepBuilderAPI_MakePolygon()
    for point in (ring * _MILLIMETRES).tolist():
        polygon.Add(gp_Pnt(*point))
    polygon.Close()
    return polygon.Wire()


def _sewn(faces: Iterable[TopoDS_Face]) -> TopoDS_Shape:
    """Shells of the faces that share edges, and the faces that share none."""
    sewing = BRepBuilderAPI_Sewing(_SEWING_TOLERANCE)
    for face in faces:
        sewing.Add(face)
    sewing.Perform()
    return sewing.SewedShape()


def _written(document: TDocStd_Document, model: Model) -> bytes:
    STEPControl_Controller.Init_s()
    STEPCAFControl_Controller.Init_s()
    for name, value in _OPTIONS.items():
        if not Interface_Static.SetCVal_s(name, value):
            raise OSError(f"the STEP library does not know {name} = {value}")
    Interface_Static.SetIVal_s("write.surfacecurve.mode", 0)  # planes need no curves in their parameter space
    writer = STEPCAFControl_Writer(XSControl_WorkSession(), False)
    writer.SetColorMode(True)
    writer.SetNameMode(True)
    if not writer.Transfer(document, STEPControl_StepModelType.STEPControl_AsIs):
        raise OSError("the STEP library could not convert it")
    header = APIHeaderSection_MakeHeader(writer.Writer().Model())
    header.SetDescriptionValue(1, _ascii(f"linecad reconstruction; {model.unit_note}"))
    header.SetName(_ascii("linecad"))
    header.SetTimeStamp(_ascii(_TIMESTAMP))
    header.SetAuthorValue(1, _ascii(""))
    header.SetOrganizationValue(1, _ascii(""))
    header.SetOriginatingSystem(_ascii("linecad"))
    header.SetPreprocessorVersion(_ascii("linecad"))
    stream = io.BytesIO()
    if writer.WriteStream(stream) != IFSelect_ReturnStatus.IFSelect_RetDone:
        raise OSError("the STEP library could not write it")
    return stream.getvalue()


@contextlib.contextmanager
def _silence() -> Iterator[None]:
    """Keep OCCT from printing its progress; its return values tell of failures."""
    printers = list(Message.DefaultMessenger_s().Printers())
    levels = [printer.GetTraceLevel() for printer in printers]
    for printer in printers:
        printer.SetTraceLevel(Message_Gravity.Message_Fail)
    try:
        yield
    finally:
        for printer, level in zip(printers, levels, strict=True):
            printer.SetTraceLevel(level)


def _set_name(label: TDF_Label, name: str) -> None:
    TDataStd_Name.Set_s(label, TCollection_ExtendedString(name, True))  # True: the name is UTF-8


def _quantity(colour: RGB) -> Quantity_Color:
    return Quantity_Color(*colour, Quantity_TypeOfColor.Quantity_TOC_sRGB)


def _ascii(text: str) -> TCollection_HAsciiString:
    return TCollection_HAsciiString(text)
