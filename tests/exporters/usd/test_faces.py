from dataclasses import replace

import numpy as np
import pytest
from pxr import Usd, UsdGeom, UsdShade

from exporters.formats import export
from exporters.model import build_model

FACES, SHAPES = "/Reconstruction/Faces", "/Reconstruction/Shapes"


def in_world(prim):
    matrix = np.array(UsdGeom.XformCache().GetLocalToWorldTransform(prim))
    return np.array(UsdGeom.Mesh(prim).GetPointsAttr().Get(), float) @ matrix[:3, :3] + matrix[3, :3]


def told_of(prim):
    told = {name: prim.GetAttribute(f"linecad:{name}").Get() for name in ("opening", "shape", "kind", "label")}
    return {**told, "faces": list(prim.GetAttribute("linecad:faceIds").Get())}


@pytest.fixture(params=[False, True], scope="module")
def textured(request):
    return request.param


@pytest.fixture(scope="module")
def plain(row, photo, textured, tmp_path_factory):
    path = tmp_path_factory.mktemp("usd") / "a.usda"
    export(row, path, photo if textured else None)
    return Usd.Stage.Open(str(path))


@pytest.fixture(scope="module")
def instanced(row, photo, textured, tmp_path_factory):
    path = tmp_path_factory.mktemp("usd") / "a.usda"
    export(row, path, photo if textured else None, options={"instances": True})
    return Usd.Stage.Open(str(path))


def test_an_opening_is_a_prim_above_its_faces(plain, row):
    for fitting in build_model(row, origin="ground").fittings:
        prim = plain.GetPrimAtPath(f"{FACES}/{fitting.key}")
        assert prim.GetDisplayName() == fitting.label
        ids = [face.id for face in fitting.faces]
        told = {"opening": fitting.id, "shape": 4, "kind": "window", "label": fitting.label, "faces": ids}
        assert told_of(prim) == told
        assert [child.GetName() for child in prim.GetChildren()] == [face.name for face in fitting.faces]


def test_every_face_has_its_own_name_place_and_ids_though_equal_ones_are_one_shape(plain, row, textured):
    meshes = {prim.GetName(): prim for prim in plain.Traverse() if prim.IsA(UsdGeom.Mesh)}
    model = build_model(row, origin="ground")
    assert sorted(meshes) == [face.name for face in model.faces]
    for face in model.faces:
        prim = meshes[face.name]
        np.testing.assert_allclose(in_world(prim), face.vertices, atol=1e-5)
        told = [prim.GetAttribute(f"linecad:{name}").Get() for name in ("faceId", "label", "kind", "planeOffset")]
        assert told == [face.id, face.label, face.kind, face.offset]
        assert (prim.GetDisplayName(), prim.IsInstance()) == (face.name, False)
        assert UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()[0]
        assert UsdGeom.PrimvarsAPI(prim).HasPrimvar("st") == textured
    text = plain.GetRootLayer().ExportToString()
    assert text.count("point3f[] points") == len(model.groups) + len(model.loose_faces) + 5


def test_nothing_draws_the_shape_by_itself(plain):
    shapes = plain.GetPrimAtPath(SHAPES)
    assert shapes.IsAbstract()
    assert [len(shape.GetAllChildren()) for shape in shapes.GetAllChildren()] == [5]


def test_instances_are_one_prototype_that_looks_the_same_everywhere(instanced, row, textured):
    model = build_model(row, origin="ground")
    assert len(instanced.GetPrototypes()) == 1
    found = set()
    for fitting in model.fittings:
        prim = instanced.GetPrimAtPath(f"{FACES}/{fitting.key}")
        assert prim.IsInstance()
        assert told_of(prim)["faces"] == [face.id for face in fitting.faces]
        parts = prim.GetFilteredChildren(Usd.TraverseInstanceProxies())
        for part, face in zip(parts, fitting.faces, strict=True):
            np.testing.assert_allclose(in_world(part), face.vertices, atol=1e-5)
            material, _ = UsdShade.MaterialBindingAPI(part).ComputeBoundMaterial()
            assert material.GetPrim().GetName().startswith("photo_" if textured else face.kind)
        if textured:
            found.add(tuple(map(tuple, UsdGeom.PrimvarsAPI(parts[0]).GetPrimvar("st").Get())))
    assert len(found) == textured


def test_openings_that_are_alone_need_no_shape(row, tmp_path):
    openings = tuple(replace(opening, shape=number) for number, opening in enumerate(row.openings))
    export(replace(row, openings=openings), tmp_path / "a.usda", options={"instances": True})
    stage = Usd.Stage.Open(str(tmp_path / "a.usda"))
    assert not stage.GetPrimAtPath(SHAPES)
    assert len([prim for prim in stage.Traverse() if prim.IsA(UsdGeom.Mesh)]) == len(
        build_model(row, origin="ground").faces
    )
