"""A GLB read back: all that another reader finds in it, and nothing that would be left out unseen."""

import json
import struct

import numpy as np
import pytest
import trimesh

from linecad.errors import LinecadError
from linecad.evaluation.turned.glb import is_front, read_glb


def rewritten(path, change, tmp_path):
    """The file with its document changed."""
    data = path.read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    tree = json.loads(data[20 : 20 + length])
    change(tree)
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    rest = data[20 + length :]
    out = tmp_path / "b.glb"
    out.write_bytes(
        struct.pack("<IIIII", 0x46546C67, 2, 20 + len(text) + len(rest), len(text), 0x4E4F534A) + text + rest
    )
    return out


def test_another_reader_finds_the_same_triangles(glb, model):
    other = trimesh.load_scene(glb(), process=False)
    placed = [(other.geometry[name], pose) for pose, name in map(other.graph.get, other.graph.nodes_geometry)]
    meshes = [each.copy().apply_transform(pose) for each, pose in placed if isinstance(each, trimesh.Trimesh)]
    theirs = np.concatenate([each.triangles for each in meshes])
    assert sorted(map(tuple, theirs.reshape(len(theirs), -1).round(5).tolist())) == sorted(
        map(tuple, model.triangles.reshape(len(model.triangles), -1).round(5).tolist())
    )
    places = np.concatenate([each.visual.uv[each.faces] for each in meshes])  # theirs start at the lower left
    assert sorted(places[..., 1].ravel()) == pytest.approx(sorted(1 - model.texels[..., 1].ravel()), abs=1e-5)


def test_the_lines_are_those_of_the_scene(scene, model):
    turned = scene.lines.ends @ np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]]).T  # glTF's y is up
    assert sorted(map(tuple, model.lines.reshape(-1, 6).tolist())) == [
        pytest.approx(each) for each in sorted(map(tuple, turned.reshape(-1, 6).tolist()))
    ]
    assert not any(model.materials[number].is_lit for number in model.line_material)


def test_the_camera_is_the_photos(scene, model):
    assert model.camera.matrix == pytest.approx(scene.camera.matrix)
    assert (model.camera.width, model.camera.height) == (320, 240)
    point = np.array([1.0, 9.0, 0.5])
    turned = np.array([point[0], point[2], -point[1]])
    assert model.camera.rotation @ (turned - model.camera.position) == pytest.approx(scene.rotation @ point)


def test_faces_turn_their_front_to_the_photo(model):
    assert is_front(model.triangles, model.camera.position).all()


def test_faces_without_a_photo_are_lit_and_have_no_picture(glb):
    plain = read_glb(glb(textured=False))
    looks = [plain.materials[number] for number in np.unique(plain.material)]
    assert [(look.picture, look.is_lit, look.is_double_sided) for look in looks] == [(None, True, True)]


def test_a_mesh_that_two_nodes_name_comes_twice(glb, model, tmp_path):
    places = []

    def twice(tree):
        node = next(each for each in tree["nodes"] if each.get("name") == "face_0001")
        places.append(node["translation"])
        half = np.sqrt(0.5)
        tree["nodes"].append(
            {"mesh": node["mesh"], "translation": [0, 0, 5], "rotation": [0, half, 0, half], "scale": [2, 2, 2]}
        )
        tree["scenes"][0]["nodes"].append(len(tree["nodes"]) - 1)

    found = read_glb(rewritten(glb(), twice, tmp_path))
    assert len(found.triangles) == len(model.triangles) + 2
    once = model.triangles[np.ptp(model.triangles[:, :, 0], axis=1) == 0] - places[0]  # the side wall, from its foot
    moved = 2 * np.stack([once[..., 2], once[..., 1], -once[..., 0]], axis=-1) + [0, 0, 5]
    new = [each for each in found.triangles.round(4).tolist() if each not in model.triangles.round(4).tolist()]
    assert sorted(new) == pytest.approx(np.array(sorted(moved.round(4).tolist())))


def points(tree):
    tree["meshes"][0]["primitives"][0]["mode"] = 0


def clear(tree):
    tree["materials"][0]["alphaMode"] = "BLEND"


def extended(tree):
    tree["extensionsRequired"] = ["KHR_draco_mesh_compression"]


def blind(tree):
    for node in tree["nodes"]:
        node.pop("camera", None)


def interleaved(tree):
    tree["bufferViews"][0]["byteStride"] = 24


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (points, "mode 0"),
        (clear, "transparent"),
        (extended, "draco"),
        (blind, "no camera"),
        (interleaved, "interleaved"),
    ],
)
def test_what_would_be_left_out_is_refused(glb, tmp_path, change, said):
    with pytest.raises(LinecadError, match=said):
        read_glb(rewritten(glb(), change, tmp_path))


def test_another_file_is_no_glb(tmp_path):
    path = tmp_path / "a.glb"
    path.write_bytes(b"not a GLB, but long enough to have a head")
    with pytest.raises(LinecadError, match="no GLB"):
        read_glb(path)
