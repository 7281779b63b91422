import zipfile
from dataclasses import replace

import numpy as np
import pytest
from pxr import Sdf, Usd, UsdGeom, UsdShade, UsdValidation

from exporters.colours import face_colour, line_colour, linear
from exporters.formats import export
from exporters.model import FREE_UNIT, KNOWN_UNIT, ORIGINS, build_model
from exporters.triangulation import triangulate
from linecad.scene import Camera

ROOT = "/Reconstruction"
kinds = pytest.mark.parametrize("suffix", [".usda", ".usdc", ".usdz"])


@pytest.fixture(scope="module")
def paths(scene, tmp_path_factory):
    folder = tmp_path_factory.mktemp("usd")
    paths = {suffix: folder / f"a{suffix}" for suffix in (".usda", ".usdc", ".usdz")}
    for path in paths.values():
        export(scene, path)
    return paths


@pytest.fixture(scope="module")
def stage(paths):
    return Usd.Stage.Open(str(paths[".usdc"]))


def complaints(path):
    context = UsdValidation.ValidationContext(UsdValidation.ValidationRegistry().GetOrLoadAllValidators())
    errors = context.Validate(Usd.Stage.Open(str(path)))
    return [f"{error.GetIdentifier()}: {error.GetMessage()}" for error in errors if not error.HasNoError()]


def reprojection(path, model, line_pixels):
    """The largest distance in px of a line end on the photo, through USD's own frustum of the camera in the file."""
    stage = Usd.Stage.Open(str(path))
    prim = stage.GetPrimAtPath(f"{ROOT}/PhotoCamera")
    width, height = (prim.GetAttribute(f"linecad:image{name}").Get() for name in ("Width", "Height"))
    frustum = UsdGeom.Camera(prim).GetCamera(Usd.TimeCode.Default()).frustum
    through = np.array(frustum.ComputeViewMatrix()) @ np.array(frustum.ComputeProjectionMatrix())
    worst = 0.0
    for group in model.groups:
        points = np.array(UsdGeom.BasisCurves(stage.GetPrimAtPath(f"{ROOT}/Lines/{group.name}")).GetPointsAttr().Get())
        seen = np.c_[points, np.ones(len(points))] @ through
        assert (seen[:, 3] > 0).all()
        x, y, depth = (seen[:, :3] / seen[:, 3:]).T
        assert (np.abs(depth) < 1).all()  # between the clipping planes
        pixels = np.stack([(x + 1) / 2 * width, (1 - y) / 2 * height], axis=1)
        expected = np.concatenate([line_pixels[number] for number in group.ids.tolist()])
        worst = max(worst, np.abs(pixels - expected).max())
    return worst


@kinds
def test_no_validator_complains(paths, suffix):
    assert complaints(paths[suffix]) == []


@pytest.mark.parametrize("changed", ["no_faces", "no_lines", "one_line", "large_ids"])
def test_no_validator_complains_about_unusual_scenes(request, tmp_path, changed):
    export(request.getfixturevalue(changed), tmp_path / "a.usda")
    assert complaints(tmp_path / "a.usda") == []


@kinds
def test_every_line_falls_on_the_photo_through_the_camera_of_the_file(paths, model, line_pixels, suffix):
    assert reprojection(paths[suffix], model, line_pixels) <= 0.05


def test_the_camera_of_an_upright_photo(scene, model, line_pixels, tmp_path):
    matrix = scene.camera.matrix.copy()
    matrix[:2, 2] += (-500, 200)
    export(replace(scene, camera=Camera(900, 1600, matrix, "file")), tmp_path / "a.usdc")
    moved = {number: pixels + np.array([-500, 200]) for number, pixels in line_pixels.items()}
    assert reprojection(tmp_path / "a.usdc", model, moved) <= 0.05


def test_the_stage_says_what_it_is(stage, scene):
    assert UsdGeom.GetStageUpAxis(stage) == "Z"
    assert UsdGeom.GetStageMetersPerUnit(stage) == 1.0
    assert stage.GetDefaultPrim().GetPath() == ROOT
    assert Usd.ModelAPI(stage.GetDefaultPrim()).GetKind() == "component"
    assert stage.GetRootLayer().documentation == f"linecad: reconstruction of {scene.photo}; {KNOWN_UNIT}"


def test_an_unknown_scale_is_told(free_unit, tmp_path):
    export(free_unit, tmp_path / "a.usda")
    assert FREE_UNIT in Sdf.Layer.FindOrOpen(str(tmp_path / "a.usda")).documentation


def test_every_group_of_lines_is_a_prim(stage, model):
    for group in model.groups:
        prim = stage.GetPrimAtPath(f"{ROOT}/Lines/{group.name}")
        curves, variables = UsdGeom.BasisCurves(prim), UsdGeom.PrimvarsAPI(prim)
        assert (curves.GetTypeAttr().Get(), curves.GetWrapAttr().Get()) == ("linear", "nonperiodic")
        assert list(curves.GetCurveVertexCountsAttr().Get()) == [2] * len(group.ids)
        np.testing.assert_allclose(np.array(curves.GetPointsAttr().Get()), group.ends.reshape(-1, 3), atol=1e-5)
        ids, boundary = (variables.GetPrimvar(f"linecad:{name}") for name in ("id", "boundary"))
        assert list(ids.Get()) == group.ids.tolist()
        assert list(boundary.Get()) == [group.is_boundary] * len(group.ids)
        roles = variables.GetPrimvar("linecad:role")
        assert list(roles.Get()) == group.roles.tolist()
        assert ids.GetInterpolation() == boundary.GetInterpolation() == roles.GetInterpolation() == "uniform"
        assert prim.GetAttribute("linecad:direction").Get() == "xyz"[group.axis]
        colour = linear(line_colour(group.axis, group.is_boundary))
        assert np.array(curves.GetDisplayColorAttr().Get())[0] == pytest.approx(colour)


def in_world(prim):
    matrix = np.array(UsdGeom.XformCache().GetLocalToWorldTransform(prim))
    return np.array(UsdGeom.Mesh(prim).GetPointsAttr().Get(), float) @ matrix[:3, :3] + matrix[3, :3]


def test_every_face_is_a_mesh(stage, model):
    for face in model.faces:
        prim = stage.GetPrimAtPath(f"{ROOT}/Faces/{face.name}")
        mesh = UsdGeom.Mesh(prim)
        np.testing.assert_allclose(in_world(prim), face.vertices, atol=1e-5)
        np.testing.assert_allclose(np.min(mesh.GetPointsAttr().Get(), axis=0)[2], 0, atol=1e-6)
        triangles = np.array(mesh.GetFaceVertexIndicesAttr().Get()).reshape(-1, 3)
        np.testing.assert_array_equal(triangles, triangulate(face))
        assert set(mesh.GetFaceVertexCountsAttr().Get()) == {3}
        assert mesh.GetSubdivisionSchemeAttr().Get() == "none"
        assert mesh.GetDoubleSidedAttr().Get()
        assert prim.GetDisplayName() == face.name
        assert [prim.GetAttribute(f"linecad:{name}").Get() for name in ("kind", "label")] == [face.kind, face.label]
        told = {name: prim.GetAttribute(f"linecad:{name}").Get() for name in ("faceId", "planeAxis", "planeOffset")}
        assert told == {"faceId": face.id, "planeAxis": "xyz"[face.axis], "planeOffset": face.offset}
        assert list(prim.GetAttribute("linecad:ringCounts").Get()) == [len(ring) for ring in face.rings]


def test_everything_has_a_material_of_its_colour(stage, model):
    colours = {f"Lines/{g.name}": ("emissiveColor", line_colour(g.axis, g.is_boundary)) for g in model.groups}
    colours |= {f"Faces/{face.name}": ("diffuseColor", face_colour(face.kind)) for face in model.faces}
    for name, (channel, colour) in colours.items():
        material, _ = UsdShade.MaterialBindingAPI(stage.GetPrimAtPath(f"{ROOT}/{name}")).ComputeBoundMaterial()
        shader, _, _ = material.ComputeSurfaceSource()
        assert shader.GetIdAttr().Get() == "UsdPreviewSurface"
        assert np.array(shader.GetInput(channel).Get()) == pytest.approx(linear(colour))


def test_everything_that_has_a_size_says_it(stage):
    shapes = [prim for prim in stage.Traverse() if prim.IsA(UsdGeom.Gprim)]
    assert shapes
    assert all(prim.GetAttribute("extent").HasAuthoredValue() for prim in shapes)


def test_all_planes_are_listed(stage, scene):
    root = stage.GetDefaultPrim()
    assert list(root.GetAttribute("linecad:planeIds").Get()) == [plane.id for plane in scene.planes]
    assert list(root.GetAttribute("linecad:planeAxes").Get()) == ["xyz"[plane.axis] for plane in scene.planes]
    assert list(root.GetAttribute("linecad:planeOffsets").Get()) == [plane.offset for plane in scene.planes]


@pytest.mark.parametrize("origin", ORIGINS)
def test_z_0_is_the_ground_and_the_camera_still_sees_the_lines_on_the_photo(grounded, line_pixels, tmp_path, origin):
    export(grounded, tmp_path / "a.usdc", options={"origin": origin})
    model = build_model(grounded, origin=origin)
    assert reprojection(tmp_path / "a.usdc", model, line_pixels) <= 0.05
    stage = Usd.Stage.Open(str(tmp_path / "a.usdc"))
    offsets = list(stage.GetDefaultPrim().GetAttribute("linecad:planeOffsets").Get())
    assert offsets == [plane.offset for plane in model.planes]
    ground = in_world(stage.GetPrimAtPath(f"{ROOT}/Faces/face_0002"))
    assert {point[2] == 0 for point in ground} == {origin == "ground"}


@pytest.mark.parametrize(
    ("variant", "lines", "faces"), [("full", True, True), ("wireframe", True, False), ("faces", False, True)]
)
def test_variants_show_all_lines_or_faces(paths, variant, lines, faces):
    stage = Usd.Stage.Open(str(paths[".usda"]))
    variants = stage.GetDefaultPrim().GetVariantSet("content")
    assert variants.GetVariantSelection() == "full"
    variants.SetVariantSelection(variant)
    for name, shown in (("Lines", lines), ("Faces", faces)):
        visibility = UsdGeom.Imageable(stage.GetPrimAtPath(f"{ROOT}/{name}")).ComputeVisibility()
        assert visibility == ("inherited" if shown else "invisible")


def test_names_of_prims_are_ascii(stage):
    assert all(str(prim.GetPath()).isascii() for prim in stage.Traverse())


def test_the_package_is_a_plain_zip_with_aligned_layers_and_no_time(paths):
    data = paths[".usdz"].read_bytes()
    with zipfile.ZipFile(paths[".usdz"]) as package:
        (entry,) = package.infolist()
        assert entry.compress_type == zipfile.ZIP_STORED
        assert entry.date_time == (1980, 1, 1, 0, 0, 0)
        assert package.testzip() is None
        layer = package.read(entry)
    assert entry.filename == "scene.usdc"
    assert data.index(layer) % 64 == 0


def test_the_package_holds_the_same_layer_as_the_compact_file(paths):
    with zipfile.ZipFile(paths[".usdz"]) as package:
        assert package.read("scene.usdc") == paths[".usdc"].read_bytes()


def test_nothing_of_this_run_stands_in_the_text(paths):
    text = paths[".usda"].read_text()
    assert paths[".usda"].parent.name not in text
    assert ".linecad" not in text


def test_ids_that_32_bits_do_not_hold(large_ids, tmp_path):
    export(large_ids, tmp_path / "a.usdc")
    stage = Usd.Stage.Open(str(tmp_path / "a.usdc"))
    model = build_model(large_ids)
    for group in model.groups:
        variables = UsdGeom.PrimvarsAPI(stage.GetPrimAtPath(f"{ROOT}/Lines/{group.name}"))
        assert list(variables.GetPrimvar("linecad:id").Get()) == group.ids.tolist()
    faces = {prim.GetAttribute("linecad:faceId").Get() for prim in stage.GetPrimAtPath(f"{ROOT}/Faces").GetChildren()}
    assert faces == {face.id for face in model.faces}


@pytest.mark.parametrize("by_band", [False, True])
def test_where_the_scene_tells_probabilities_prims_hold_them_and_may_be_named_by_them(told, tmp_path, by_band):
    export(told, tmp_path / "a.usda", options={"probability": by_band})
    stage = Usd.Stage.Open(str(tmp_path / "a.usda"))
    groups = build_model(told, by_band).groups
    prims = stage.GetPrimAtPath(f"{ROOT}/Lines").GetChildren()
    assert sorted(prim.GetName() for prim in prims) == sorted(group.name for group in groups)
    for group in groups:
        prim = stage.GetPrimAtPath(f"{ROOT}/Lines/{group.name}")
        probability = UsdGeom.PrimvarsAPI(prim).GetPrimvar("linecad:probability")
        assert list(probability.Get()) == group.probability.tolist()
        assert probability.GetInterpolation() == "uniform"
