"""3DM, read back with rhino3dm."""

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

from exporters.formats import export
from exporters.model import build_model

rhino3dm = pytest.importorskip("rhino3dm", reason="the extra `rhino` is not installed")

TOLERANCE = 1e-6  # m
CURVE, BREP, MESH, POINT = (getattr(rhino3dm.ObjectType, name) for name in ("Curve", "Brep", "Mesh", "Point"))


def saved(scene, folder, **options):
    path = folder / "a.3dm"
    export(scene, path, options=options)
    file = rhino3dm.File3dm.Read(str(path))
    assert file is not None
    return file


def objects(file, kind):
    """The words of each object of a kind with its geometry and the full path of its layer."""
    return [
        (dict(each.Attributes.GetUserStrings()), each.Geometry, file.Layers[each.Attributes.LayerIndex].FullPath, each)
        for each in file.Objects
        if each.Geometry.ObjectType == kind
    ]


def place(point):
    return np.array([point.X, point.Y, point.Z])


def corners(brep):
    """(M, 3) the points of all edges: an edge with a point on its straight side is a polyline."""
    curves = [brep.Edges[number].ToNurbsCurve().Points for number in range(len(brep.Edges))]
    return np.array([place(curve[number]) for curve in curves for number in range(len(curve))])


def area(vertices, triangles):
    a, b, c = (vertices[triangles[:, corner]] for corner in range(3))
    return 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()


def test_lines_are_curves_on_the_layer_of_their_group(scene, line_ends, tmp_path):
    found = objects(saved(scene, tmp_path), CURVE)
    ends = {int(words["linecad id"]): [place(line.PointAtStart), place(line.PointAtEnd)] for words, line, *_ in found}
    assert ends.keys() == line_ends.keys()
    assert max(np.abs(np.array(ends[number]) - line_ends[number]).max() for number in ends) < TOLERANCE
    group = {int(number): group for group in build_model(scene).groups for number in group.ids}
    for words, _, layer, item in found:
        mine = group[int(words["linecad id"])]
        assert layer == f"lines::{mine.name}"
        assert item.Attributes.Name == f"line {words['linecad id']}"
        assert words["linecad boundary"] == str(mine.is_boundary).lower()


def test_faces_are_trimmed_planes_with_their_holes(row, scene, tmp_path):
    for each in (row, scene):
        faces = {face.id: face for face in build_model(each).faces}
        found = objects(saved(each, tmp_path), BREP)
        assert sorted(int(words["linecad id"]) for words, *_ in found) == sorted(faces)
        for words, brep, *_ in found:
            face = faces[int(words["linecad id"])]
            (surface,) = brep.Faces
            assert brep.IsValid
            assert surface.IsPlanar(TOLERANCE)
            assert len(surface.Loops) == len(face.rings)
            apart = np.linalg.norm(corners(brep)[:, None] - face.vertices[None], axis=2)
            assert max(apart.min(axis=0).max(), apart.min(axis=1).max()) < TOLERANCE
            normal = surface.NormalAt(0.5, 0.5)
            assert not surface.OrientationIsReversed
            assert place(normal) == pytest.approx(face.normal, abs=1e-9)


def test_faces_are_meshes_too_on_hidden_layers(row, tmp_path):
    file = saved(row, tmp_path)
    faces = {face.id: face for face in build_model(row).faces}
    found = objects(file, MESH)
    assert sorted(int(words["linecad id"]) for words, *_ in found) == sorted(faces)
    for words, mesh, layer, _ in found:
        face = faces[int(words["linecad id"])]
        vertices = np.array([place(mesh.Vertices.Point3dAt(number)) for number in range(len(mesh.Vertices))])
        assert np.abs(vertices - face.vertices).max() < TOLERANCE
        triangles = np.array([mesh.Faces[number][:3] for number in range(len(mesh.Faces))])
        flat = [ring[:, face.in_plane] for ring in face.rings]
        sums = [0.5 * np.abs(np.sum(r[:, 0] * np.roll(r[:, 1], -1) - np.roll(r[:, 0], -1) * r[:, 1])) for r in flat]
        assert area(vertices, triangles) == pytest.approx(sums[0] - sum(sums[1:]))
        assert layer == f"meshes::meshes_{face.kind}"
    hidden = {layer.FullPath for layer in file.Layers if not layer.Visible}
    assert hidden == {"meshes", *(layer for _, _, layer, _ in found)}


def test_layers_are_by_kind_and_openings_are_groups(row, tmp_path):
    file = saved(row, tmp_path)
    found = objects(file, BREP)
    assert Counter(layer for _, _, layer, _ in found) == {
        "faces::faces_wall": 1,
        "faces::faces_ground": 1,
        "openings::openings_window": 3,
        "openings::openings_reveal": 12,
    }
    names = {number: group.Name for number, group in enumerate(file.Groups)}
    for words, _, _, item in found:
        groups = [names[number] for number in item.Attributes.GetGroupList()]
        opening = words.get("linecad opening")
        assert groups == ([] if opening is None else [f"window {int(opening) + 1}"])
    assert "reveal of window 2" in {item.Attributes.Name for *_, item in found}


def test_the_unit_and_the_camera_are_told(grounded, row, tmp_path):
    known = saved(replace(grounded, metres_per_unit=2.0), tmp_path)
    assert known.Settings.ModelUnitSystem == rhino3dm.UnitSystem.Meters
    ((words, point, layer, _),) = objects(known, POINT)
    assert layer == "camera"
    assert words["linecad unit"] == "lengths are in metres; z = 0 is the ground"
    model = build_model(replace(grounded, metres_per_unit=2.0), origin="ground")
    assert place(point.Location) == pytest.approx(model.eye)
    ((words, *_),) = objects(saved(row, tmp_path), POINT)
    assert words["linecad unit"].startswith("the scale of the photo is not known")


def test_roles_and_probabilities_stand_at_the_lines(told, tmp_path):
    probability = dict(zip(told.lines.id.tolist(), told.lines.probability.tolist(), strict=True))
    for words, *_ in objects(saved(told, tmp_path), CURVE):
        assert float(words["linecad probability"]) == probability[int(words["linecad id"])]
        assert words["linecad role"] == "outline"


def test_objects_have_ids_of_their_own_that_outlive_a_scale_that_becomes_known(row, tmp_path):
    def ids(scene):
        return [str(each.Attributes.Id) for each in saved(scene, tmp_path).Objects]

    first = ids(row)
    assert len(set(first)) == len(first)
    assert ids(replace(row, metres_per_unit=2.0)) == first


def test_ids_that_32_bits_do_not_hold_are_told(large_ids, tmp_path):
    found = {int(words["linecad id"]) for words, *_ in objects(saved(large_ids, tmp_path), CURVE)}
    assert found == set(large_ids.lines.id.tolist())
