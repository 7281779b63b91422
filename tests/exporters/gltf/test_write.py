import json
import struct

import numpy as np
import pytest
import trimesh

from exporters.colours import face_colour, line_colour, linear
from exporters.formats import export
from exporters.model import FREE_UNIT, KNOWN_UNIT, ORIGINS, build_model
from exporters.triangulation import triangulate

COUNTS = {"SCALAR": 1, "VEC3": 3}
KINDS = {5125: np.uint32, 5126: np.float32}
LINES, TRIANGLES = 1, 4


class Glb:
    """The two parts of a GLB file, read by hand."""

    def __init__(self, path):
        data = path.read_bytes()
        magic, version, length = struct.unpack_from("<4sII", data)
        assert (magic, version, length) == (b"glTF", 2, len(data))
        size, kind = struct.unpack_from("<I4s", data, 12)
        assert kind == b"JSON"
        self.tree = json.loads(data[20 : 20 + size])
        self.binary = data[28 + size :]

    def array(self, index):
        accessor = self.tree["accessors"][index]
        view = self.tree["bufferViews"][accessor["bufferView"]]
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        width = COUNTS[accessor["type"]]
        numbers = np.frombuffer(self.binary, KINDS[accessor["componentType"]], accessor["count"] * width, start)
        return numbers.reshape(-1, width)

    def node(self, name):
        return next(node for node in self.tree["nodes"] if node["name"] == name)

    def primitive(self, name):
        (primitive,) = self.tree["meshes"][self.node(name)["mesh"]]["primitives"]
        return primitive

    def positions(self, name):
        """In the scene's frame: z up."""
        local = self.array(self.primitive(name)["attributes"]["POSITION"]).astype(float)
        x, y, z = (local + self.node(name).get("translation", [0, 0, 0])).T
        return np.stack([x, -z, y], axis=1)

    def material(self, name):
        return self.tree["materials"][self.primitive(name)["material"]]

    def children(self, name):
        return [self.tree["nodes"][child]["name"] for child in self.node(name)["children"]]


@pytest.fixture(scope="module")
def path(scene, tmp_path_factory):
    path = tmp_path_factory.mktemp("gltf") / "a.glb"
    export(scene, path)
    return path


@pytest.fixture(scope="module")
def glb(path):
    return Glb(path)


def test_nodes_are_named_and_stand_in_their_group(glb, model):
    assert sorted(glb.children("linecad")) == ["faces", "lines", "photo_camera"]
    assert sorted(glb.children("lines")) == sorted(group.name for group in model.groups)
    assert sorted(glb.children("faces")) == sorted(face.name for face in model.faces)


def test_every_line_is_at_its_place_with_its_id(glb, model):
    for group in model.groups:
        primitive = glb.primitive(group.name)
        assert primitive["mode"] == LINES
        np.testing.assert_allclose(glb.positions(group.name), group.ends.reshape(-1, 3), atol=1e-5)
        numbers = glb.array(primitive["attributes"]["_LINEID"]).ravel()
        np.testing.assert_array_equal(numbers, np.repeat(group.ids, 2))
        extras = glb.tree["meshes"][glb.node(group.name)["mesh"]]["extras"]
        assert extras == {
            "axis": "xyz"[group.axis], "boundary": group.is_boundary, "line_ids": group.ids.tolist(),
            "roles": ["outline"] * len(group.ids),
        }  # fmt: skip


def test_every_face_is_there_as_its_triangles_with_normals_towards_the_camera(glb, model):
    for face in model.faces:
        primitive = glb.primitive(face.name)
        assert primitive["mode"] == TRIANGLES
        np.testing.assert_allclose(glb.positions(face.name), face.vertices, atol=1e-5)
        np.testing.assert_array_equal(glb.array(primitive["indices"]).reshape(-1, 3), triangulate(face))
        x, y, z = glb.array(primitive["attributes"]["NORMAL"]).T
        np.testing.assert_array_equal(np.stack([x, -z, y], axis=1), np.tile(face.normal, (len(face.vertices), 1)))


def test_the_mesh_of_a_face_is_named_by_its_kind_and_its_node_says_what_it_is(glb, model):
    for face in model.faces:
        mesh = glb.tree["meshes"][glb.node(face.name)["mesh"]]
        assert mesh["name"] == face.label
        assert glb.node(face.name)["extras"] == {
            "face_id": face.id, "kind": face.kind, "label": face.label, "plane_id": face.plane,
            "axis": "xyz"[face.axis], "offset": face.offset,
        }  # fmt: skip


def test_lines_are_unlit_in_the_colour_of_their_group(glb, model):
    for group in model.groups:
        material = glb.material(group.name)
        assert "KHR_materials_unlit" in material["extensions"]
        colour = material["pbrMetallicRoughness"]["baseColorFactor"]
        assert colour == pytest.approx([*linear(line_colour(group.axis, group.is_boundary)), 1.0])
    assert glb.tree["extensionsUsed"] == ["KHR_materials_unlit"]


def test_faces_are_two_sided(glb, model):
    for face in model.faces:
        material = glb.material(face.name)
        assert material["doubleSided"]
        assert material["pbrMetallicRoughness"]["baseColorFactor"] == pytest.approx(
            [*linear(face_colour(face.kind)), 1.0]
        )


def test_no_material_is_left_over(glb):
    used = {primitive["material"] for mesh in glb.tree["meshes"] for primitive in mesh["primitives"]}
    assert used == set(range(len(glb.tree["materials"])))


def test_every_view_of_the_buffer_says_what_it_holds(glb):
    assert {view["target"] for view in glb.tree["bufferViews"]} == {34962, 34963}


def test_every_line_falls_on_the_photo_through_the_camera_of_the_file(glb, model, line_pixels):
    node = glb.node("photo_camera")
    camera = glb.tree["cameras"][node["camera"]]["perspective"]
    extras = node["extras"]
    assert extras == glb.tree["cameras"][node["camera"]]["extras"]
    pose = np.array(node["matrix"]).reshape(4, 4).T
    height, width = extras["linecad_padded_height"], extras["linecad_padded_width"]
    assert camera["aspectRatio"] == pytest.approx(width / height, rel=1e-9)
    focal = height / 2 / np.tan(camera["yfov"] / 2)
    worst = 0.0
    for group in model.groups:
        x, y, z = glb.positions(group.name).T
        seen = np.linalg.inv(pose)[:3] @ np.stack([x, z, -y, np.ones(len(x))])
        assert (-seen[2] > camera["znear"]).all()
        assert (-seen[2] < camera["zfar"]).all()
        across = width / 2 + focal * seen[0] / -seen[2] - extras["linecad_pad_left"]
        down = height / 2 - focal * seen[1] / -seen[2] - extras["linecad_pad_top"]
        expected = np.concatenate([line_pixels[number] for number in group.ids.tolist()])
        worst = max(worst, np.abs(np.stack([across, down], axis=1) - expected).max())
    assert worst <= 0.05


@pytest.mark.parametrize("origin", ORIGINS)
def test_on_the_ground_the_camera_stands_as_high_as_it_did(grounded, tmp_path, origin):
    export(grounded, tmp_path / "a.glb", options={"origin": origin})
    glb, model = Glb(tmp_path / "a.glb"), build_model(grounded, origin=origin)
    x, y, z = glb.node("photo_camera")["matrix"][12:15]
    assert (x, -z, y) == pytest.approx(tuple(model.eye))
    for face in model.faces:
        np.testing.assert_allclose(glb.positions(face.name), face.vertices, atol=1e-5)
    offsets = [plane["offset"] for plane in glb.tree["scenes"][0]["extras"]["linecad_planes"]]
    assert offsets == [plane.offset for plane in model.planes]


def test_the_extras_tell_the_camera_matrix_from_the_corner(glb, scene):
    extras = glb.node("photo_camera")["extras"]
    assert (extras["linecad_width"], extras["linecad_height"]) == (scene.camera.width, scene.camera.height)
    assert extras["linecad_fx"] == extras["linecad_fy"] == scene.camera.focal
    assert extras["linecad_cx"] == pytest.approx(scene.camera.matrix[0, 2] + 0.5)
    assert extras["linecad_cy"] == pytest.approx(scene.camera.matrix[1, 2] + 0.5)


def test_the_unit_the_photo_and_the_planes_are_told(glb, scene, free_unit, tmp_path):
    assert glb.tree["asset"]["extras"] == {"linecad_unit": KNOWN_UNIT, "linecad_photo": scene.photo}
    planes = glb.tree["scenes"][0]["extras"]["linecad_planes"]
    assert [(plane["id"], plane["axis"], plane["offset"], tuple(plane["lines"])) for plane in planes] == [
        (plane.id, "xyz"[plane.axis], plane.offset, plane.lines) for plane in scene.planes
    ]
    export(free_unit, tmp_path / "a.glb")
    assert Glb(tmp_path / "a.glb").tree["asset"]["extras"]["linecad_unit"] == FREE_UNIT


def test_trimesh_reads_it(path, model):
    read = trimesh.load_scene(path)
    meshes = [geometry for geometry in read.geometry.values() if isinstance(geometry, trimesh.Trimesh)]
    assert len(meshes) == len(model.faces)
    assert sum(mesh.area for mesh in meshes) == pytest.approx(
        sum(trimesh.Trimesh(face.vertices, triangulate(face), process=False).area for face in model.faces), rel=1e-6
    )


def test_ids_that_a_float32_does_not_hold_stand_in_the_extras_alone(large_ids, tmp_path):
    export(large_ids, tmp_path / "a.glb")
    glb = Glb(tmp_path / "a.glb")
    for group in build_model(large_ids).groups:
        assert "_LINEID" not in glb.primitive(group.name)["attributes"]
        extras = glb.tree["meshes"][glb.node(group.name)["mesh"]]["extras"]
        assert extras["line_ids"] == group.ids.tolist()


def test_lines_alone_need_no_material_for_faces(no_faces, tmp_path):
    export(no_faces, tmp_path / "a.glb")
    glb = Glb(tmp_path / "a.glb")
    assert sorted(glb.children("linecad")) == ["lines", "photo_camera"]
    assert all("KHR_materials_unlit" in material["extensions"] for material in glb.tree["materials"])


def test_faces_alone_use_no_extension(no_lines, tmp_path):
    export(no_lines, tmp_path / "a.glb")
    glb = Glb(tmp_path / "a.glb")
    assert "extensionsUsed" not in glb.tree
    assert [material["name"] for material in glb.tree["materials"]] == ["face", "window", "door"]


def test_lines_can_be_tubes_with_the_same_names_colours_and_ids(scene, model, glb, tmp_path):
    export(scene, tmp_path / "a.glb", options={"tubes": True})
    thick = Glb(tmp_path / "a.glb")
    assert sorted(node["name"] for node in thick.tree["nodes"]) == sorted(node["name"] for node in glb.tree["nodes"])
    for group in model.groups:
        primitive = thick.primitive(group.name)
        assert primitive["mode"] == TRIANGLES
        assert thick.material(group.name) == glb.material(group.name)
        middles = thick.positions(group.name).reshape(len(group.ids), 2, -1, 3).mean(axis=2)
        np.testing.assert_allclose(middles, group.ends, atol=1e-5)
        numbers = thick.array(primitive["attributes"]["_LINEID"]).reshape(len(group.ids), -1)
        np.testing.assert_array_equal(numbers, np.tile(group.ids[:, None], numbers.shape[1]))
        extras = [each.tree["meshes"][each.node(group.name)["mesh"]]["extras"] for each in (thick, glb)]
        assert extras[0] == extras[1]
    for face in model.faces:
        assert thick.material(face.name) == glb.material(face.name)


def test_tubes_are_seen_one_to_four_pixels_wide(scene, model, tmp_path):
    export(scene, tmp_path / "a.glb", options={"tubes": True})
    thick = Glb(tmp_path / "a.glb")
    for group in model.groups:
        rings = thick.positions(group.name).reshape(-1, 6, 3)
        middle = rings.mean(axis=1)
        width = 2 * np.linalg.norm(rings - middle[:, None], axis=2).mean(axis=1)
        pixels = width * scene.camera.focal / (middle @ scene.rotation[2])
        assert 1 < np.median(pixels) < 4, group.name


@pytest.mark.parametrize("by_band", [False, True])
def test_where_the_scene_tells_probabilities_extras_hold_them_and_nodes_may_be_named_by_them(told, tmp_path, by_band):
    export(told, tmp_path / "a.glb", options={"probability": by_band})
    glb = Glb(tmp_path / "a.glb")
    groups = build_model(told, by_band).groups
    assert sorted(glb.children("lines")) == sorted(group.name for group in groups)
    for group in groups:
        extras = glb.tree["meshes"][glb.node(group.name)["mesh"]]["extras"]
        assert extras["probabilities"] == group.probability.tolist()
        assert extras["line_ids"] == group.ids.tolist()
        assert glb.material(group.name)["name"] == group.name
