from collections import defaultdict
from dataclasses import replace

import ezdxf
import numpy as np
import pytest

from exporters.formats import export
from exporters.model import FREE_UNIT, KNOWN_UNIT, ORIGINS, build_model
from exporters.triangulation import triangulate


@pytest.fixture(scope="module")
def path(scene, tmp_path_factory):
    path = tmp_path_factory.mktemp("dxf") / "a.dxf"
    export(scene, path)
    return path


@pytest.fixture(scope="module")
def document(path):
    return ezdxf.readfile(path, errors="strict")


def values(entity, code):
    return [tag.value for tag in entity.get_xdata("LINECAD") if tag.code == code]


def test_the_auditor_finds_nothing_to_say(path):
    auditor = ezdxf.readfile(path, errors="strict").audit()
    assert not auditor.errors
    assert not auditor.fixes


def test_it_is_in_metres(document):
    assert document.dxfversion == "AC1024"
    assert document.header["$INSUNITS"] == 6
    assert document.header["$MEASUREMENT"] == 1


def test_every_line_stands_on_the_layer_of_its_group_with_its_id(document, scene, line_ends):
    entities = {values(entity, 1071)[0]: entity for entity in document.modelspace().query("LINE")}
    assert set(entities) == set(line_ends)
    for number, axis, is_boundary in zip(
        scene.lines.id.tolist(), scene.lines.axis.tolist(), scene.lines.is_boundary.tolist(), strict=True
    ):
        entity = entities[number]
        np.testing.assert_allclose([entity.dxf.start, entity.dxf.end], line_ends[number], atol=1e-12)
        assert entity.dxf.layer == f"LINES_{'XYZ'[axis]}_{'BOUNDARY' if is_boundary else 'NONBOUNDARY'}"
        assert values(entity, 1000) == ["line", "xyz"[axis], "outline"]
        assert values(entity, 1070) == [int(is_boundary)]


def test_the_triangles_of_each_face_are_there(document, model):
    corners = defaultdict(set)
    for entity in document.modelspace().query("3DFACE"):
        assert entity.dxf.layer == "FACES"
        assert entity.dxf.vtx2 == entity.dxf.vtx3
        triangle = [tuple(np.round(entity.dxf.get(f"vtx{k}"), 9)) for k in range(3)]
        corners[values(entity, 1071)[0]].add(frozenset(triangle))
    for face in model.faces:
        expected = {frozenset(map(tuple, face.vertices[t].round(9).tolist())) for t in triangulate(face)}
        assert corners[face.id] == expected


def test_exactly_the_edges_of_the_rings_are_visible(document, model):
    shown = defaultdict(set)
    for entity in document.modelspace().query("3DFACE"):
        corners = [tuple(np.round(entity.dxf.get(f"vtx{k}"), 9)) for k in range(3)]
        for place, flag in enumerate((1, 2, 8)):
            if not entity.dxf.invisible_edges & flag:
                shown[values(entity, 1071)[0]].add(frozenset((corners[place], corners[(place + 1) % 3])))
    for face in model.faces:
        edges = {
            frozenset((tuple(start), tuple(end)))
            for ring in face.rings
            for start, end in zip(ring.round(9).tolist(), np.roll(ring, -1, axis=0).round(9).tolist(), strict=True)
        }
        assert shown[face.id] == edges


def test_the_outlines_are_closed_polylines(document, model):
    rings = defaultdict(dict)
    for entity in document.modelspace().query("POLYLINE"):
        assert entity.dxf.layer == "FACE_OUTLINES"
        assert entity.is_closed
        assert entity.is_3d_polyline
        rings[values(entity, 1071)[0]][values(entity, 1070)[0]] = [vertex.dxf.location for vertex in entity.vertices]
    for face in model.faces:
        assert list(rings[face.id]) == list(range(len(face.rings)))
        for number, ring in enumerate(face.rings):
            np.testing.assert_allclose(rings[face.id][number], ring, atol=1e-12)


def test_the_extents_enclose_the_model(document, model):
    assert (np.array(document.header["$EXTMIN"]) <= model.points.min(axis=0) + 1e-9).all()
    assert (np.array(document.header["$EXTMAX"]) >= model.points.max(axis=0) - 1e-9).all()


def test_layers_are_ascii_and_have_distinct_colours(document):
    layers = [layer for layer in document.layers if layer.dxf.name.startswith("LINES_")]
    assert len(layers) == 6
    assert len({layer.dxf.color for layer in layers}) == 6
    assert all(layer.dxf.name.isascii() for layer in document.layers)


def test_the_unit_the_photo_and_the_camera_are_told(scene, free_unit, document, tmp_path):
    told = dict(document.header.custom_vars.properties)
    assert told["linecad unit"] == KNOWN_UNIT
    assert told["linecad photo"] == scene.photo
    assert "focal length 1350.0 px, principal point 879.8 542.3 px from the top left" in told["linecad camera"]
    rotation = np.array(told["linecad camera from world"].split(), float).reshape(3, 3)
    np.testing.assert_array_equal(rotation, scene.rotation)
    export(free_unit, tmp_path / "free.dxf")
    free = ezdxf.readfile(tmp_path / "free.dxf")
    assert dict(free.header.custom_vars.properties)["linecad unit"] == FREE_UNIT


@pytest.mark.parametrize("origin", ORIGINS)
def test_z_0_is_the_ground_and_the_place_of_the_camera_is_told(grounded, tmp_path, origin):
    export(grounded, tmp_path / "a.dxf", options={"origin": origin})
    document, model = ezdxf.readfile(tmp_path / "a.dxf"), build_model(grounded, origin=origin)
    place = dict(document.header.custom_vars.properties)["linecad camera position"]
    assert [float(word) for word in place.split()] == model.eye.tolist()
    lowest = min(min(line.dxf.start.z, line.dxf.end.z) for line in document.modelspace().query("LINE"))
    assert lowest == pytest.approx(0.0 if origin == "ground" else -build_model(grounded, origin="ground").eye[2])


def test_ids_that_32_bits_do_not_hold_are_text(large_ids, tmp_path):
    export(large_ids, tmp_path / "a.dxf")
    entities = ezdxf.readfile(tmp_path / "a.dxf", errors="strict").modelspace().query("LINE")
    assert {int(values(entity, 1000)[1]) for entity in entities} == set(large_ids.lines.id.tolist())
    assert all(not values(entity, 1071) for entity in entities)


def test_the_setting_of_ezdxf_is_as_before(scene, tmp_path):
    before = ezdxf.options.write_fixed_meta_data_for_testing
    export(scene, tmp_path / "a.dxf")
    assert ezdxf.options.write_fixed_meta_data_for_testing == before


def test_classes_stand_in_an_order_that_no_hash_decides(document):
    # ezdxf adds those in use from a set of strings, so that two runs wrote different files.
    names = [entry.dxf.name for entry in document.classes]
    used = [name for name in names if name in document.entitydb.dxf_types_in_use()]
    assert len(used) > 1
    assert used == sorted(used)


def test_a_later_release_holds_the_same_and_passes_the_auditor(document, scene, tmp_path):
    export(scene, tmp_path / "a.dxf", options={"version": "R2018"})
    later = ezdxf.readfile(tmp_path / "a.dxf", errors="strict")
    assert later.dxfversion == "AC1032"
    auditor = later.audit()
    assert not auditor.errors
    assert not auditor.fixes
    assert later.header["$INSUNITS"] == 6
    kinds = [[entity.dxftype() for entity in each.modelspace()] for each in (document, later)]
    assert kinds[0] == kinds[1]


def test_layers_by_probability_and_the_number_itself_in_each_line(told, tmp_path):
    export(told, tmp_path / "a.dxf", options={"probability": True})
    document = ezdxf.readfile(tmp_path / "a.dxf", errors="strict")
    assert not document.audit().errors
    probability = dict(zip(told.lines.id.tolist(), told.lines.probability.tolist(), strict=True))
    ends = {0.99: "_SURE", 0.7: "_LIKELY", 0.2: "_GUESS"}
    lines = document.modelspace().query("LINE")
    assert len(lines) == len(told.lines)
    for line in lines:
        told_here = probability[values(line, 1071)[0]]
        assert line.dxf.layer.endswith(ends[told_here])
        assert line.dxf.layer in document.layers
        assert values(line, 1040) == [told_here]
    names = [layer.dxf.name for layer in document.layers if layer.dxf.name.startswith("LINES_")]
    assert len(names) == 18


def test_layers_are_those_of_a_scene_that_does_not_tell_and_each_line_has_the_number(told, document, tmp_path):
    export(told, tmp_path / "a.dxf")
    plain = ezdxf.readfile(tmp_path / "a.dxf", errors="strict")
    assert [layer.dxf.name for layer in plain.layers] == [layer.dxf.name for layer in document.layers]
    assert [line.dxf.layer for line in plain.modelspace()] == [line.dxf.layer for line in document.modelspace()]
    probability = dict(zip(told.lines.id.tolist(), told.lines.probability.tolist(), strict=True))
    for line in plain.modelspace().query("LINE"):
        assert values(line, 1040) == [probability[values(line, 1071)[0]]]


def test_detail_has_layers_of_the_thinnest_pen(scene, tmp_path):
    lines = replace(scene.lines, role=np.resize(["outline", "detail"], len(scene.lines)))
    export(replace(scene, lines=lines), tmp_path / "a.dxf", options={"roles": True})
    document = ezdxf.readfile(tmp_path / "a.dxf", errors="strict")
    weights = {layer.dxf.name: layer.dxf.lineweight for layer in document.layers if layer.dxf.name.startswith("LINES_")}
    assert len(weights) == 12
    assert {weight for name, weight in weights.items() if name.endswith("_DETAIL")} == {9}
    assert min(weight for name, weight in weights.items() if not name.endswith("_DETAIL")) > 9
    role = dict(zip(scene.lines.id.tolist(), lines.role.tolist(), strict=True))
    for line in document.modelspace().query("LINE"):
        assert line.dxf.layer.endswith("_DETAIL") == (role[values(line, 1071)[0]] == "detail")


def test_each_line_tells_its_role_on_the_plain_layers(scene, document, tmp_path):
    lines = replace(scene.lines, role=np.resize(["outline", "opening", "detail"], len(scene.lines)))
    export(replace(scene, lines=lines), tmp_path / "a.dxf")
    drawn = ezdxf.readfile(tmp_path / "a.dxf", errors="strict")
    assert [layer.dxf.name for layer in drawn.layers] == [layer.dxf.name for layer in document.layers]
    role = dict(zip(scene.lines.id.tolist(), lines.role.tolist(), strict=True))
    for line in drawn.modelspace().query("LINE"):
        assert values(line, 1000)[2] == role[values(line, 1071)[0]]


def test_triangles_and_outlines_tell_what_their_face_is(document, model):
    told = {face.id: ["face", face.name, face.kind, face.label] for face in model.faces}
    entities = document.modelspace().query("3DFACE POLYLINE")
    assert {values(entity, 1071)[0] for entity in entities} == set(told)
    assert all(values(entity, 1000) == told[values(entity, 1071)[0]] for entity in entities)
