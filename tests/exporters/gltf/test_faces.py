"""Nodes and meshes of openings; the reader of the files is trimesh and the document itself."""

import json
import struct

import numpy as np
import pytest
import trimesh

from exporters.formats import export
from exporters.model import build_model
from linecad.scene import AXES

Z_UP = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])  # (x, y, z) -> (x, -z, y)


def document(path):
    data = path.read_bytes()
    (size,) = struct.unpack_from("<I", data, 12)
    return json.loads(data[20 : 20 + size])


def node_of(tree, name):
    return next(node for node in tree["nodes"] if node["name"] == name)


def mesh_of(tree, face):
    return node_of(tree, face.name)["mesh"]


def primitive_of(tree, face):
    (primitive,) = tree["meshes"][mesh_of(tree, face)]["primitives"]
    return primitive


@pytest.fixture(params=[(False, False), (False, True), (True, False), (True, True)], scope="module")
def made(row, photo, tmp_path_factory, request):
    """The file of the row: with textures, as instances."""
    textured, instances = request.param
    path = tmp_path_factory.mktemp("gltf") / "a.glb"
    export(row, path, photo if textured else None, options={"instances": instances})
    return path, textured, instances


def test_every_face_is_in_its_place_below_its_opening(made, row):
    path, _, _ = made
    model, tree, read = build_model(row, origin="ground"), document(path), trimesh.load_scene(path)
    for face in model.faces:
        pose, geometry = read.graph[face.name]
        vertices = read.geometry[geometry].vertices @ pose[:3, :3].T + pose[:3, 3]
        found = {tuple(point) for point in (vertices @ Z_UP.T).round(4).tolist()}
        assert found == {tuple(point) for point in face.vertices.round(4).tolist()}
    for fitting in model.fittings:
        node = node_of(tree, fitting.label)
        assert sorted(tree["nodes"][child]["name"] for child in node["children"]) == [f.name for f in fitting.faces]
        x, y, z = node["translation"]
        assert (x, -z, y) == pytest.approx(tuple(fitting.place))
        assert node["extras"] == {"opening": fitting.id, "shape": 4, "kind": "window", "label": fitting.label}


def test_the_node_of_a_face_tells_its_opening(made, row):
    tree = document(made[0])
    for face in build_model(row, origin="ground").faces:
        extras = node_of(tree, face.name)["extras"]
        assert (extras["face_id"], extras["label"], extras["axis"]) == (face.id, face.label, AXES[face.axis])
        assert extras.get("opening") == face.opening


def test_equal_faces_share_numbers_and_where_no_picture_or_the_user_forbids_it_meshes(made, row):
    path, textured, instances = made
    tree, (first, *others) = document(path), build_model(row, origin="ground").fittings
    for other in others:
        for one, same in zip(first.faces, other.faces, strict=True):
            a, b = (primitive_of(tree, face) for face in (one, same))
            for key in ("POSITION", "NORMAL"):
                assert a["attributes"][key] == b["attributes"][key]
            assert a["indices"] == b["indices"]
            assert (mesh_of(tree, one) == mesh_of(tree, same)) == (instances or not textured)
            assert ("TEXCOORD_0" in b["attributes"]) == textured
            name = tree["meshes"][mesh_of(tree, same)]["name"]
            assert name == (f"{same.kind} of shape 4" if instances or not textured else same.label)


def test_faces_with_pictures_have_their_own_places_on_them(row, photo, tmp_path):
    export(row, tmp_path / "a.glb", photo)
    tree = document(tmp_path / "a.glb")
    panes = [fitting.faces[0] for fitting in build_model(row, origin="ground").fittings]
    assert len({primitive_of(tree, pane)["attributes"]["TEXCOORD_0"] for pane in panes}) == len(panes)


def test_a_face_that_is_of_no_opening_has_its_origin_at_its_foot(made, row):
    """So that Blender turns and scales it where it stands."""
    tree = document(made[0])
    for face in build_model(row, origin="ground").loose_faces:
        x, y, z = node_of(tree, face.name)["translation"]
        assert (x, -z, y) == pytest.approx(tuple(face.foot))
        low, high = (np.array(tree["accessors"][primitive_of(tree, face)["attributes"]["POSITION"]][key])
                     for key in ("min", "max"))  # fmt: skip
        assert low[1] == pytest.approx(0, abs=1e-6)
        assert (low + high)[[0, 2]] == pytest.approx((0, 0), abs=1e-5)
