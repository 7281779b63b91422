import json

import pytest
from pxr import Gf, Usd, UsdGeom, UsdShade, Vt

from check_usd import check
from expectation import build_expectation
from faults import missing_face, missing_hole, missing_line, moved_line, wrong_camera, wrong_colour
from verdict import judge

ROOT = "/Reconstruction"


def verdict(path, expected):
    return judge(lambda findings: check(findings, path, expected))[-1]


@pytest.mark.parametrize("suffix", [".usda", ".usdc", ".usdz"])
def test_a_stage_of_ours_is_right(export_to, expected, suffix):
    assert verdict(export_to(suffix), expected).startswith("CHECK OK usd")


@pytest.mark.parametrize("by_band", [False, True])
def test_a_stage_of_a_scene_with_probabilities_is_right(export_to, told, by_band):
    expected = json.loads(json.dumps(build_expectation(told, by_band)))
    assert verdict(export_to(".usda", told, by_band), expected).startswith("CHECK OK usd")


@pytest.mark.parametrize("fault", [moved_line, missing_line, missing_face, missing_hole, wrong_camera, wrong_colour])
def test_a_fault_is_noticed(export_to, expected, fault):
    fault(expected)
    assert verdict(export_to(".usdc"), expected).startswith("CHECK FAILED")


def move_line(stage):
    points = UsdGeom.BasisCurves.Get(stage, f"{ROOT}/Lines/lines_x_boundary").GetPointsAttr()
    values = list(points.Get())
    points.Set(Vt.Vec3fArray([values[0] + Gf.Vec3f(0, 0, 0.001), *values[1:]]))


def exchange_ids(stage):
    ids = stage.GetPrimAtPath(f"{ROOT}/Lines/lines_z_boundary").GetAttribute("primvars:linecad:id")
    ids.Set(list(reversed(ids.Get())))


def drop_face(stage):
    stage.RemovePrim(f"{ROOT}/Faces/face_0007")


def drop_triangle(stage):
    mesh = UsdGeom.Mesh.Get(stage, f"{ROOT}/Faces/face_0004")
    mesh.GetFaceVertexIndicesAttr().Set(mesh.GetFaceVertexIndicesAttr().Get()[3:])
    mesh.GetFaceVertexCountsAttr().Set(mesh.GetFaceVertexCountsAttr().Get()[1:])


def turn_triangle(stage):
    indices = UsdGeom.Mesh.Get(stage, f"{ROOT}/Faces/face_0004").GetFaceVertexIndicesAttr()
    a, b, *rest = indices.Get()
    indices.Set([b, a, *rest])


def round_off(stage):
    UsdGeom.Mesh.Get(stage, f"{ROOT}/Faces/face_0004").GetSubdivisionSchemeAttr().Set("catmullClark")


def shift_camera(stage):
    camera = UsdGeom.Camera.Get(stage, f"{ROOT}/PhotoCamera")
    pixel = 0.36 / 800
    camera.GetHorizontalApertureOffsetAttr().Set(camera.GetHorizontalApertureOffsetAttr().Get() + 0.1 * pixel)


def clip(stage):
    UsdGeom.Camera.Get(stage, f"{ROOT}/PhotoCamera").GetClippingRangeAttr().Set(Gf.Vec2f(20, 100))


def centimetres(stage):
    UsdGeom.SetStageMetersPerUnit(stage, 0.01)


def hide_nothing(stage):
    for name in ("Lines", "Faces"):
        UsdGeom.Imageable(stage.GetPrimAtPath(f"{ROOT}/{name}")).CreateVisibilityAttr(UsdGeom.Tokens.inherited)


def forget_material(stage):
    UsdShade.MaterialBindingAPI(stage.GetPrimAtPath(f"{ROOT}/Lines/lines_z_boundary")).UnbindAllBindings()


def forget_default_prim(stage):
    stage.ClearDefaultPrim()


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (move_line, "the nearest of"),
        (exchange_ids, "linecad:id does not tell"),
        (drop_face, "meshes: 1 are missing"),
        (drop_triangle, "do not bound the triangles"),
        (turn_triangle, "turned differently"),
        (round_off, "subdivision catmullClark"),
        (shift_camera, "px from its place in the photo"),
        (clip, "cuts the lines"),
        (centimetres, "a unit is 0.01 m"),
        (hide_nothing, "are not hidden"),
        (forget_material, "has no material"),
        (forget_default_prim, "there is no default prim"),
    ],
)
def test_a_change_is_noticed(export_to, expected, change, told):
    path = export_to(".usda")
    stage = Usd.Stage.Open(str(path))
    change(stage)
    stage.Save()
    report = judge(lambda findings: check(findings, path, expected))
    assert report[-1].startswith("CHECK FAILED")
    assert any(told in line for line in report)


@pytest.mark.parametrize("by_role", [False, True])
def test_an_export_tells_roles_and_is_by_role_only_where_asked(export_to, drawn, by_role):
    told, other = (json.loads(json.dumps(build_expectation(drawn, by_role=asked))) for asked in (by_role, not by_role))
    path = export_to(".usda", drawn, by_role=by_role)
    assert verdict(path, told).startswith("CHECK OK usd")
    assert verdict(path, other).startswith("CHECK FAILED")


def test_roles_and_kinds_that_are_others_are_noticed(export_to, drawn, expected):
    assert verdict(export_to(".usda", drawn), expected).startswith("CHECK FAILED")
    expected["faces"][0]["label"] = "wall 1"
    assert verdict(export_to(".usda"), expected).startswith("CHECK FAILED")
