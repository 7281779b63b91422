"""IFC, read back with ifcopenshell and its geometry; the validator that comes with it knows the rules of the schema."""

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

from exporters.formats import export
from exporters.model import build_model
from linecad.scene import Face, Opening, Plane

ifcopenshell = pytest.importorskip("ifcopenshell", reason="the extra `ifc` is not installed")
geom = pytest.importorskip("ifcopenshell.geom", reason="the extra `ifc` is not installed")
validate = pytest.importorskip("ifcopenshell.validate", reason="the extra `ifc` is not installed")

THICKNESS = 0.3
WALL = 15  # id of the face of the wall in `row`, which is 12 m wide and 8 m tall


def saved(scene, folder, **options):
    path = folder / "a.ifc"
    export(scene, path, options=options)
    return ifcopenshell.open(path)


def solid(element):
    """(V, 3) m and (T, 3): the triangles of an element with its openings cut out, in the world."""
    settings = geom.settings()
    settings.set("use-world-coords", True)
    shape = geom.create_shape(settings, element).geometry
    return np.array(shape.verts).reshape(-1, 3), np.array(shape.faces).reshape(-1, 3)


def volume(element):
    vertices, triangles = solid(element)
    a, b, c = (vertices[triangles[:, corner]] for corner in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


def area(face):
    sums = [0.5 * np.linalg.norm(np.cross(ring, np.roll(ring, -1, axis=0)).sum(axis=0)) for ring in face.rings]
    return sums[0] - sum(sums[1:])


def told(element, name):
    """The properties of a set by name, single values and lists alike."""
    for relation in element.IsDefinedBy:
        properties = relation.RelatingPropertyDefinition
        if properties.Name == name:
            return {
                each.Name: [value.wrappedValue for value in each.ListValues]
                if each.is_a("IfcPropertyListValue")
                else each.NominalValue.wrappedValue
                for each in properties.HasProperties
            }
    return {}


@pytest.fixture(scope="module")
def town(row):
    """The row of windows with a roof, a ceiling and a door that is a notch in the foot of a second wall."""
    foot = -1.7
    right = 7.0
    ring = np.array(
        [[right, 4, foot], [right, 5, foot], [right, 5, foot + 2.1], [right, 6, foot + 2.1], [right, 6, foot],
         [right, 9, foot], [right, 9, 4], [right, 4, 4]]
    )  # fmt: skip
    pane = ring[[1, 2, 3, 4]]
    door = Opening(90, 60, 5.0, 6.0, foot, foot + 2.1, "door", shape=7)
    side = Plane(60, 0, right, (), (Face(60, ring, (), "wall"), Face(61, pane, (), "door", opening=90)))
    level = np.array([[0.0, 4, 5], [3, 4, 5], [3, 6, 5], [0, 6, 5]])
    ceiling = Plane(61, 2, 5.0, (), (Face(62, level, (), "ceiling"),))
    tilt = np.radians(130.0)
    normal = np.array([0, np.cos(tilt), np.sin(tilt)])
    slope = np.array([[0.0, 4, 6], [6, 4, 6], [6, 7, 6], [0, 7, 6]])
    slope[:, 2] -= (slope - slope[0]) @ normal / normal[2]
    roof = Plane(62, 1, float(normal @ slope[0]), (), (Face(63, slope, (), "roof"),), tilt)
    return replace(row, planes=(*row.planes, side, ceiling, roof), openings=(*row.openings, door))


def faults(file):
    """What the validator says of a file, its path or what was read: the types, and the rules of the schema."""
    logger = validate.json_logger()
    validate.validate(file, logger, express_rules=True)
    return logger.statements


# The validator reads its rules, most of its 8 s a file, from a module that it does not close.
validating = pytest.mark.filterwarnings("ignore:unclosed file:ResourceWarning")


@validating
def test_the_file_keeps_all_rules_of_the_schema(town, tmp_path):
    saved(town, tmp_path)
    assert faults(str(tmp_path / "a.ifc")) == []


@validating
@pytest.mark.thorough
@pytest.mark.parametrize("name", ["scene", "told", "one_line", "large_ids"])
def test_files_of_other_scenes_keep_them_too(name, tmp_path, request):
    saved(request.getfixturevalue(name), tmp_path)
    assert faults(str(tmp_path / "a.ifc")) == []


@validating
@pytest.mark.thorough
def test_the_validator_notices_what_breaks_a_rule(row, tmp_path):
    file = saved(row, tmp_path)
    file.by_type("IfcExtrudedAreaSolid")[0].ExtrudedDirection.DirectionRatios = (1.0, 0.0, 0.0)
    assert len(faults(file)) > 0


def test_every_face_is_what_its_kind_says(town, tmp_path):
    file = saved(town, tmp_path)
    kinds = ("IfcWall", "IfcWindow", "IfcDoor", "IfcOpeningElement", "IfcCovering", "IfcGeographicElement", "IfcRoof")
    assert [len(file.by_type(kind)) for kind in kinds] == [2, 3, 1, 4, 1, 1, 1]
    (slab,) = file.by_type("IfcSlab")
    assert slab.PredefinedType == "ROOF"
    assert slab.Decomposes[0].RelatingObject.is_a("IfcRoof")
    assert [each.Name for each in file.by_type("IfcWall")] == ["wall 1", "wall 2"]
    assert [each.Name for each in file.by_type("IfcWindow")] == ["window 1", "window 2", "window 3"]
    assert {each.Tag for each in file.by_type("IfcWall")} == {"face_0015", "face_0060"}


def test_every_element_is_in_one_place_of_the_building(town, tmp_path):
    file = saved(town, tmp_path)
    assert file.by_type("IfcProject")[0].IsDecomposedBy[0].RelatedObjects[0].is_a("IfcSite")
    place = {}
    for element in file.by_type("IfcElement") + file.by_type("IfcAnnotation"):
        inside = [each.RelatingStructure.is_a() for each in getattr(element, "ContainedInStructure", ())]
        wholes = [each.RelatingObject.is_a() for each in element.Decomposes]
        place.setdefault(element.is_a(), set()).add(tuple(inside + wholes))
    assert place == {
        "IfcWall": {("IfcBuilding",)},
        "IfcWindow": {("IfcBuildingStorey",)},
        "IfcDoor": {("IfcBuildingStorey",)},
        "IfcOpeningElement": {()},
        "IfcCovering": {("IfcBuilding",)},
        "IfcRoof": {("IfcBuilding",)},
        "IfcSlab": {("IfcRoof",)},
        "IfcGeographicElement": {("IfcSite",)},
        "IfcAnnotation": {("IfcBuilding",)},
    }


def test_a_wall_is_its_face_pushed_away_from_the_camera(town, tmp_path):
    file = saved(town, tmp_path)
    faces = {face.name: face for face in build_model(town).faces}
    for wall in file.by_type("IfcWall"):
        face = faces[wall.Tag]
        assert volume(wall) == pytest.approx(THICKNESS * area(face), rel=1e-6)
        behind = (solid(wall)[0] - face.vertices[0]) @ -face.normal
        assert (behind.min(), behind.max()) == pytest.approx((0.0, THICKNESS), abs=1e-6)


def test_a_door_in_the_foot_of_a_wall_is_cut_out_of_the_whole_wall(town, tmp_path):
    file = saved(town, tmp_path)
    (door,) = file.by_type("IfcDoor")
    opening = door.FillsVoids[0].RelatingOpeningElement
    wall = opening.VoidsElements[0].RelatingBuildingElement
    assert wall.Tag == "face_0060"
    profile = wall.Representation.Representations[0].Items[0].SweptArea
    assert profile.is_a("IfcArbitraryClosedProfileDef")
    assert len(profile.OuterCurve.Points) == 5 + 2  # the rectangle again, with the door's corners on its foot
    assert (door.OverallWidth, door.OverallHeight) == pytest.approx((1.0, 2.1))


def test_a_hole_that_no_opening_fills_stays_a_hole(row, tmp_path):
    (wall,) = [plane for plane in row.planes if any(face.id == WALL for face in plane.faces)]
    (face,) = wall.faces
    gap = face.holes[0] + np.array([0.1, 0, -3.0])
    holed = replace(wall, faces=(replace(face, holes=(*face.holes, gap)),))
    file = saved(replace(row, planes=tuple(holed if plane is wall else plane for plane in row.planes)), tmp_path)
    (made,) = file.by_type("IfcWall")
    profile = made.Representation.Representations[0].Items[0].SweptArea
    assert [len(curve.Points) for curve in (profile.OuterCurve, *profile.InnerCurves)] == [5, 5]
    assert volume(made) == pytest.approx(THICKNESS * (12 * 8 - 4 * 1.2 * 1.6), rel=1e-6)


def test_windows_stand_as_far_behind_the_wall_as_the_scene_tells(row, tmp_path):
    file = saved(row, tmp_path)
    (wall,) = file.by_type("IfcWall")
    faces = {face.thing: face for face in build_model(row).faces if face.kind == "window"}
    for window in file.by_type("IfcWindow"):
        assert (window.OverallWidth, window.OverallHeight) == pytest.approx((1.2, 1.6))
        corners, pane = solid(window)[0], faces[window.Name]
        behind = (corners - pane.vertices[0]) @ -pane.normal
        assert behind.min() == pytest.approx(0.0, abs=1e-6)
        assert corners[:, [0, 2]].min(axis=0) == pytest.approx(pane.vertices[:, [0, 2]].min(axis=0), abs=1e-6)
        assert corners[:, [0, 2]].max(axis=0) == pytest.approx(pane.vertices[:, [0, 2]].max(axis=0), abs=1e-6)
    assert told(wall, "linecad_Face")["Thickness"] == THICKNESS


def test_windows_of_one_size_are_of_one_type(town, tmp_path):
    file = saved(town, tmp_path)
    names = {each.Name: {one.Name for one in each.Types[0].RelatedObjects} for each in file.by_type("IfcElementType")}
    assert names == {
        "window 1.200 x 1.600 m": {"window 1", "window 2", "window 3"},
        "door 1.000 x 2.100 m": {"door"},
    }


def test_the_thickness_is_chosen_and_told(row, tmp_path):
    file = saved(row, tmp_path, **{"wall-thickness": 0.45})
    (wall,), (project,) = file.by_type("IfcWall"), file.by_type("IfcProject")
    face = next(face for face in build_model(row).faces if face.id == WALL)
    assert volume(wall) == pytest.approx(0.45 * area(face), rel=1e-6)
    assert told(wall, "linecad_Face")["ThicknessIs"] == "assumed"
    assert "walls are assumed to be 0.45 m thick" in project.Description
    assert "0.45 m thick" in file.header.file_description.description[1]


def test_a_wall_is_thicker_where_its_windows_are_set_deeper(row, tmp_path):
    file = saved(row, tmp_path, **{"wall-thickness": 0.1})
    (wall,) = file.by_type("IfcWall")
    properties = told(wall, "linecad_Face")
    assert properties["Thickness"] == pytest.approx(0.25 + 0.05)
    assert properties["ThicknessIs"] == "assumed, so that its deepest window is in it"


def test_a_row_of_windows_tells_a_storey(row, tmp_path):
    file = saved(row, tmp_path)
    (storey,) = file.by_type("IfcBuildingStorey")
    sill = min(opening.v0 for opening in row.openings)
    assert storey.Elevation == pytest.approx(sill)
    assert len(storey.ContainsElements[0].RelatedElements) == 3
    assert [each.Name for each in storey.ReferencesElements[0].RelatedElements] == ["wall"]


def test_lines_are_annotations_on_layers_with_their_ids(scene, line_ends, tmp_path):
    file = saved(scene, tmp_path)
    found = {}
    for annotation in file.by_type("IfcAnnotation"):
        (curves,) = annotation.Representation.Representations[0].Items
        ids = map(int, told(annotation, "linecad_Lines")["Ids"])
        for number, curve in zip(ids, curves.Elements, strict=True):
            found[number] = np.array([point.Coordinates for point in curve.Points])
    assert found.keys() == line_ends.keys()
    assert max(np.abs(found[number] - ends).max() for number, ends in line_ends.items()) < 1e-9
    layers = {each.Name for each in file.by_type("IfcPresentationLayerAssignment")}
    assert {group.name for group in build_model(scene).groups} <= layers


def test_windows_without_openings_of_older_scenes_stand_alone(scene, tmp_path):
    file = saved(scene, tmp_path)
    assert len(file.by_type("IfcOpeningElement")) == 0
    kinds = Counter(face.kind for _, face in scene.faces)
    assert len(file.by_type("IfcWindow")) == kinds["window"] == 3
    assert len(file.by_type("IfcDoor")) == kinds["door"] == 1
    assert len(file.by_type("IfcBuildingElementProxy")) == kinds["other"] == 3
    assert len(file.by_type("IfcBuildingStorey")) == 0


def test_openings_whose_wall_has_no_face_stand_alone(row, tmp_path):
    planes = tuple(replace(plane, faces=tuple(face for face in plane.faces if face.id != WALL)) for plane in row.planes)
    file = saved(replace(row, planes=planes), tmp_path)
    assert (len(file.by_type("IfcWall")), len(file.by_type("IfcOpeningElement"))) == (0, 0)
    sizes = [(each.OverallWidth, each.OverallHeight) for each in file.by_type("IfcWindow")]
    assert np.array(sizes) == pytest.approx(np.array([(1.2, 1.6)] * 3))


def test_a_scale_that_is_not_known_is_told(row, tmp_path):
    assert row.metres_per_unit is None
    file = saved(row, tmp_path)
    (project,) = file.by_type("IfcProject")
    assert "the scale of the photo is not known" in project.Description
    assert told(project, "linecad_Photo")["ScaleIsKnown"] is False


def test_nothing_says_where_on_earth_it_is(row, tmp_path):
    file = saved(row, tmp_path)
    (site,) = file.by_type("IfcSite")
    assert (site.RefLatitude, site.RefLongitude, site.RefElevation) == (None, None, None)
    assert len(file.by_type("IfcMapConversion")) == 0
    assert [each.TrueNorth for each in file.by_type("IfcGeometricRepresentationContext", False)] == [None]


def test_the_surest_word_of_a_face_is_what_its_lines_say(told_row, tmp_path):
    file = saved(told_row, tmp_path)
    (wall,) = file.by_type("IfcWall")
    properties = told(wall, "linecad_Face")
    assert properties["Probability"] == pytest.approx(0.7)
    assert properties["Lines"] == 3
    assert properties["Components"] == "0, 2"


@pytest.fixture
def told_row(row):
    """The row, three lines of whose wall tell how sure they are."""
    count = len(row.lines)
    lines = replace(
        row.lines,
        probability=np.resize([0.2, 0.7, 0.9], count),
        component=np.where(np.arange(count) == 1, 2, 0),
    )
    ids = tuple(lines.id[:3].tolist())
    planes = tuple(replace(plane, lines=ids if plane.id == 11 else ()) for plane in row.planes)
    return replace(row, lines=lines, planes=planes)


def identities(file):
    return [each.GlobalId for each in file.by_type("IfcRoot")]


def test_global_ids_differ_and_outlive_a_scale_that_becomes_known(row, scene, tmp_path):
    first = identities(saved(row, tmp_path))
    assert len(set(first)) == len(first)
    assert identities(saved(replace(row, metres_per_unit=2.0), tmp_path, **{"wall-thickness": 0.4})) == first
    # Sizes that millimetres cannot tell apart were one type then.
    assert identities(saved(replace(row, metres_per_unit=1e-4), tmp_path)) == first
    assert set(identities(saved(scene, tmp_path))).isdisjoint(first)
