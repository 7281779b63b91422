import re
from dataclasses import replace

import numpy as np
import pytest
from build123d import GeomType, Shape, import_step
from OCP.collections import Sequence_TDF_Label
from OCP.IFSelect import IFSelect_ReturnStatus
from OCP.Quantity import Quantity_Color, Quantity_TypeOfColor
from OCP.STEPCAFControl import STEPCAFControl_Reader
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDataStd import TDataStd_Name
from OCP.TDF import TDF_Label
from OCP.TDocStd import TDocStd_Document
from OCP.XCAFDoc import XCAFDoc_ColorType, XCAFDoc_DocumentTool, XCAFDoc_ShapeTool

from exporters.colours import face_colour, line_colour
from exporters.faces import signed_area
from exporters.formats import export
from exporters.model import FREE_UNIT, build_model
from linecad.errors import OutputError

MILLIMETRES = 1000.0  # per metre


class Reader:
    """What a program that knows names and colours sees in a STEP file."""

    def __init__(self, path):
        reader = STEPCAFControl_Reader()
        reader.SetNameMode(True)
        reader.SetColorMode(True)
        assert reader.ReadFile(str(path)) == IFSelect_ReturnStatus.IFSelect_RetDone
        self.document = TDocStd_Document(TCollection_ExtendedString("read"))
        assert reader.Transfer(self.document)
        shapes = XCAFDoc_DocumentTool.ShapeTool_s(self.document.Main())
        self.colours = XCAFDoc_DocumentTool.ColorTool_s(self.document.Main())
        self.parents, self.parts, self.places = {}, {}, {}
        for root in labels(shapes.GetFreeShapes):
            self.walk(root, None)

    def walk(self, label, parent):
        place, referred = name_of(label), TDF_Label()
        if XCAFDoc_ShapeTool.GetReferredShape_s(label, referred):
            label = referred
        name = name_of(label)
        assert name not in self.parents
        self.places[name] = place
        self.parents[name] = parent
        if XCAFDoc_ShapeTool.IsAssembly_s(label):
            for component in labels(lambda found: XCAFDoc_ShapeTool.GetComponents_s(label, found)):
                self.walk(component, name)
        else:
            self.parts[name] = Shape.cast(XCAFDoc_ShapeTool.GetShape_s(label))

    def colour(self, shape, kind):
        colour = Quantity_Color()
        assert self.colours.GetColor(shape.wrapped, kind, colour)
        return [getattr(colour, part)() for part in ("Red", "Green", "Blue")]  # linear light


def labels(fill):
    sequence = Sequence_TDF_Label()
    fill(sequence)
    return [sequence.Value(number) for number in range(1, sequence.Length() + 1)]


def name_of(label):
    attribute = TDataStd_Name()
    assert label.FindAttribute(TDataStd_Name.GetID_s(), attribute)
    return attribute.Get().ToExtString()


def points(shape):
    return np.array([tuple(vertex) for vertex in shape.vertices()]) / MILLIMETRES


def linear_light(colour):
    made = Quantity_Color(*colour, Quantity_TypeOfColor.Quantity_TOC_sRGB)
    return pytest.approx([made.Red(), made.Green(), made.Blue()], abs=1e-3)


@pytest.fixture(scope="module")
def path(scene, tmp_path_factory):
    path = tmp_path_factory.mktemp("step") / "a.step"
    export(scene, path)
    return path


@pytest.fixture(scope="module")
def read(path):
    return Reader(path)


def test_parts_are_named_and_stand_in_their_assembly(read, model):
    expected = {"linecad": None, "lines": "linecad", "faces": "linecad", "camera": "linecad"}
    expected |= {group.name: "lines" for group in model.groups}
    expected |= {face.name: "faces" for face in model.faces}
    assert read.parents == expected


def test_places_are_named_like_their_parts_but_those_of_faces_by_kind(read, model):
    labels = {face.name: face.label for face in model.faces}
    assert read.places == {name: labels.get(name, name) for name in read.parents}


def test_every_line_is_a_straight_edge_at_its_place(read, model):
    for group in model.groups:
        edges = read.parts[group.name].edges()
        assert all(edge.geom_type == GeomType.LINE for edge in edges)
        found = sorted(sorted(points(edge).round(7).tolist()) for edge in edges)
        expected = sorted(sorted(ends) for ends in group.ends.round(7).tolist())
        np.testing.assert_allclose(found, expected, atol=1e-6)


def test_every_face_is_flat_valid_and_has_its_holes(read, model):
    for face in model.faces:
        (shape,) = read.parts[face.name].faces()
        assert shape.is_valid
        assert shape.geom_type == GeomType.PLANE
        assert len(shape.outer_wire().edges()) == len(face.rings[0])
        assert sorted(len(wire.edges()) for wire in shape.inner_wires()) == sorted(map(len, face.rings[1:]))
        np.testing.assert_allclose(points(shape)[:, face.axis], face.offset, atol=1e-9)
        area = sum(signed_area(ring[:, face.in_plane]) for ring in face.rings)
        assert shape.area / MILLIMETRES**2 == pytest.approx(area, rel=1e-9)


def test_faces_look_at_the_camera(read, model):
    for face in model.faces:
        (shape,) = read.parts[face.name].faces()
        np.testing.assert_allclose(tuple(shape.normal_at()), face.normal, atol=1e-12)


def test_lines_and_faces_have_their_colours(read, model):
    for group in model.groups:
        pieces = list(read.parts[group.name])  # OCCT reads each curve as a compound of its own, and colours that
        assert len(pieces) == len(group.ids)
        for piece in pieces:
            colour = read.colour(piece, XCAFDoc_ColorType.XCAFDoc_ColorCurv)
            assert colour == linear_light(line_colour(group.axis, group.is_boundary))
    for face in model.faces:
        (shape,) = read.parts[face.name].faces()
        assert read.colour(shape, XCAFDoc_ColorType.XCAFDoc_ColorSurf) == linear_light(face_colour(face.kind))


def test_the_camera_is_a_point_where_it_stood(read):
    assert points(read.parts["camera"]).tolist() == [[0.0, 0.0, 0.0]]
    assert not read.parts["camera"].edges()


def test_on_the_ground_the_camera_stands_above_it(grounded, tmp_path):
    export(grounded, tmp_path / "a.step")
    read = Reader(tmp_path / "a.step")
    model = build_model(grounded, origin="ground")
    np.testing.assert_allclose(points(read.parts["camera"]), [model.eye])
    for face in model.faces:
        np.testing.assert_allclose(points(read.parts[face.name])[:, face.axis], face.offset, atol=1e-9)


def test_an_opening_is_an_assembly_of_its_faces_in_their_places(row, tmp_path):
    export(row, tmp_path / "a.step")
    read, model = Reader(tmp_path / "a.step"), build_model(row, origin="ground")
    for fitting in model.fittings:
        assert read.parents[fitting.label] == "faces"
        for face in fitting.faces:
            assert read.parents[face.name] == fitting.label
            assert read.places[face.name] == face.label
            found = sorted(points(read.parts[face.name]).round(6).tolist())
            np.testing.assert_allclose(found, sorted(face.vertices.round(6).tolist()), atol=2e-6)


def test_as_instances_equal_openings_are_one_assembly_in_many_places(row, tmp_path):
    path = tmp_path / "a.step"
    export(row, path, options={"instances": True})
    text = path.read_text()
    model = build_model(row, origin="ground")
    assert text.count("PRODUCT('window shape 4'") == 1
    assert text.count("ADVANCED_FACE") == len(model.loose_faces) + 5
    for fitting in model.fittings:
        assert f"'{fitting.label}'" in text
    whole = import_step(path)
    assert len(whole.faces()) == len(model.faces)
    boxes = sorted(tuple(np.round(points(face).mean(axis=0), 6)) for face in whole.faces())
    wanted = sorted(tuple(np.round(np.unique(face.vertices, axis=0).mean(axis=0), 6)) for face in model.faces)
    np.testing.assert_allclose(boxes, wanted, atol=2e-6)


@pytest.fixture(scope="module")
def panes(row):
    """The row with its panes alone."""
    planes = [
        replace(plane, faces=tuple(face for face in plane.faces if face.kind != "reveal")) for plane in row.planes
    ]
    return replace(row, planes=tuple(planes))


def test_a_pane_alone_is_a_part_and_no_assembly_that_would_take_its_name(panes, tmp_path):
    export(panes, tmp_path / "a.step")
    read = Reader(tmp_path / "a.step")
    for fitting in build_model(panes, origin="ground").fittings:
        (face,) = fitting.faces
        assert read.parents[face.name] == "faces"
        assert read.places[face.name] == fitting.label
        assert fitting.label not in read.parents


def test_as_instances_panes_alone_are_one_part_in_many_places(panes, tmp_path):
    path = tmp_path / "a.step"
    export(panes, path, options={"instances": True})
    assert path.read_text().count("ADVANCED_FACE") == 3
    middles = sorted(tuple(points(face).mean(axis=0)) for face in import_step(path).faces())
    wanted = sorted(tuple(face.vertices.mean(axis=0)) for face in build_model(panes, origin="ground").faces)
    panes_only = [each for each in wanted if any(np.allclose(each, other, atol=2e-6) for other in middles)]
    assert len(middles) == len(wanted)
    assert len(panes_only) >= 3


def test_sewn_faces_that_share_edges_are_one_shell(scene, model, tmp_path):
    export(scene, tmp_path / "a.step", options={"sewn": True})
    sewn = Reader(tmp_path / "a.step")
    groups = {group.name: "lines" for group in model.groups}
    assert sewn.parents == {"linecad": None, "lines": "linecad", "faces": "linecad", "camera": "linecad"} | groups
    part = sewn.parts["faces"]
    assert part.is_valid
    assert len(part.faces()) == len(model.faces)
    area = sum(signed_area(ring[:, face.in_plane]) for face in model.faces for ring in face.rings)
    assert sum(face.area for face in part.faces()) == pytest.approx(area * MILLIMETRES**2, rel=1e-9)
    # The two walls of the house and the ground hang together, and so do the two faces of the canopy.
    assert sorted(len(shell.faces()) for shell in part.shells() if len(shell.faces()) > 1) == [2, 3]


def test_it_says_millimetres_and_nothing_of_this_run(path):
    text = path.read_text()
    assert "SI_UNIT(.MILLI.,.METRE.)" in text
    assert "'1970-01-01T00:00:00'" in text
    assert path.parent.name not in text
    assert not re.search(r"FILE_NAME\([^)]*(\.linecad|\.step)", text)


def test_an_unknown_scale_is_told(free_unit, tmp_path):
    export(free_unit, tmp_path / "a.step")
    header = tmp_path.joinpath("a.step").read_text().split("FILE_NAME")[0]
    assert FREE_UNIT in "".join(line.strip("\n") for line in header.replace("\n  ", "").splitlines())


def test_lines_alone_keep_their_names(no_faces, tmp_path):
    export(no_faces, tmp_path / "a.step")
    groups = {group.name for group in build_model(no_faces).groups}
    assert set(Reader(tmp_path / "a.step").parts) == {"camera", *groups}


def test_nothing_is_printed(scene, tmp_path, capfd):
    export(scene, tmp_path / "a.step")
    assert capfd.readouterr() == ("", "")


def test_lengths_that_the_library_takes_for_zero_are_an_error_of_one_line(scene, tmp_path):
    # It ended in a traceback: StdFail_NotDone does not derive from Standard_Failure in Python.
    with pytest.raises(OutputError, match="STEP library failed") as raised:
        export(replace(scene, metres_per_unit=1e-12), tmp_path / "tiny.step")
    assert "\n" not in str(raised.value)
    assert list(tmp_path.iterdir()) == []
