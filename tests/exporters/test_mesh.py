import numpy as np
import pytest
import trimesh

from exporters.formats import export
from exporters.model import FREE_UNIT, KNOWN_UNIT, ORIGINS, build_model
from exporters.triangulation import triangulate


def y_up(points):
    """Points (..., 3) turned by a quarter about x, so that z up becomes y up."""
    return points @ np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]])


@pytest.fixture(scope="module")
def paths(scene, tmp_path_factory):
    folder = tmp_path_factory.mktemp("mesh")
    paths = {suffix: folder / f"a{suffix}" for suffix in (".obj", ".ply", ".stl")}
    for path in paths.values():
        export(scene, path)
    return paths


@pytest.fixture(scope="module")
def triangles(model):
    """(T, 3, 3) m, the corners of the triangles of all faces in their order."""
    return np.concatenate([face.vertices[triangulate(face)] for face in model.faces])


@pytest.mark.parametrize("suffix", [".ply", ".stl"])
def test_all_triangles_are_there_in_metres(paths, triangles, suffix):
    read = trimesh.load_mesh(paths[suffix], process=False)
    np.testing.assert_allclose(read.vertices[read.faces], triangles, atol=1e-5)


def test_ply_uses_the_vertices_of_the_faces_and_no_others(paths, model):
    read = trimesh.load_mesh(paths[".ply"], process=False)
    np.testing.assert_allclose(read.vertices, np.concatenate([face.vertices for face in model.faces]), atol=1e-5)


def test_every_face_is_an_object_of_the_obj(paths, model):
    read = trimesh.load_scene(paths[".obj"], process=False, split_objects=True, group_material=False)
    for face in model.faces:
        mesh = read.geometry[face.name]
        expected = trimesh.Trimesh(y_up(face.vertices), triangulate(face), process=False)
        assert mesh.area == pytest.approx(expected.area, rel=1e-6)
        np.testing.assert_allclose(mesh.bounds, expected.bounds, atol=1e-7)


def test_the_obj_says_what_each_face_is(paths, model):
    rows = paths[".obj"].read_text().splitlines()
    assert [rows[rows.index(f"o {face.name}") + 1] for face in model.faces] == [
        f"# {face.label}" for face in model.faces
    ]


@pytest.mark.parametrize("suffix", [".obj", ".ply", ".stl"])
@pytest.mark.parametrize("origin", ORIGINS)
def test_z_0_is_the_ground_unless_the_camera_is_to_be_the_origin(grounded, tmp_path, suffix, origin):
    path = tmp_path / f"a{suffix}"
    export(grounded, path, options={"origin": origin})
    height = build_model(grounded, origin=origin).eye[2]
    faces = np.concatenate([face.outline for _, face in grounded.faces])
    low, high = trimesh.load_mesh(path, process=False).bounds[:, 1 if suffix == ".obj" else 2]
    assert (low, high) == pytest.approx((faces[:, 2].min() + height, faces[:, 2].max() + height), abs=1e-5)
    assert (height > 0) == (origin == "ground")


def obj_lines(path):
    """Group name -> line id -> its two ends, read by hand as other programs read an OBJ."""
    vertices, groups, name, number = [], {}, None, None
    for row in path.read_text().splitlines():
        word, _, rest = row.partition(" ")
        if word == "v":
            vertices.append([float(value) for value in rest.split()])
        elif word == "o":
            name = rest
        elif row.startswith("# line "):
            number = int(row.split()[2])
        elif word == "l":
            first, last = (vertices[int(index) - 1] for index in rest.split())
            groups.setdefault(name, {})[number] = np.array([first, last])
    return groups


@pytest.mark.parametrize("name", ["scene", "no_faces", "one_line"])
def test_every_line_is_in_the_obj(request, tmp_path, name):
    scene = request.getfixturevalue(name)
    export(scene, tmp_path / "a.obj")
    groups = obj_lines(tmp_path / "a.obj")
    found = {number: ends for group in groups.values() for number, ends in group.items()}
    assert set(found) == set(scene.lines.id.tolist())
    for number, ends, axis in zip(scene.lines.id.tolist(), scene.lines.ends, scene.lines.axis.tolist(), strict=True):
        np.testing.assert_allclose(found[number], y_up(ends), atol=1e-7)
        assert any(number in group for key, group in groups.items() if key.startswith(f"lines_{'xyz'[axis]}_"))


@pytest.mark.parametrize("suffix", [".obj", ".ply", ".stl"])
def test_the_unit_is_told(paths, free_unit, tmp_path, suffix):
    assert KNOWN_UNIT.encode() in paths[suffix].read_bytes()[:400]
    export(free_unit, tmp_path / f"a{suffix}")
    start = tmp_path.joinpath(f"a{suffix}").read_bytes()[:400]
    assert FREE_UNIT.encode()[:50] in start


def test_a_binary_stl_does_not_begin_like_one_in_text(paths):
    assert not paths[".stl"].read_bytes().startswith(b"solid")


def test_lines_end_in_a_newline_alone(paths):
    assert b"\r" not in paths[".obj"].read_bytes()


def test_an_obj_stands_upright_where_y_is_up(paths, scene, tmp_path):
    """It lay on its back in Blender, which takes y for up unless told otherwise."""
    export(scene, tmp_path / "a.obj", options={"up": "z"})
    upright, flat = (trimesh.load_mesh(path, process=False).vertices for path in (paths[".obj"], tmp_path / "a.obj"))
    np.testing.assert_allclose(upright, y_up(flat), atol=1e-7)
    first = [path.read_text().splitlines()[0] for path in (paths[".obj"], tmp_path / "a.obj")]
    assert [", y up: its x, y, z are x, z, -y of the scene;" in first[0], ", z up;" in first[1]] == [True, True]
