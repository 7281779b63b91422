"""Roofs in the exports: faces in planes that slope, with their part of the photo."""

import json
import struct
from dataclasses import replace

import ezdxf
import numpy as np
import pytest
import trimesh
from pxr import Usd

from exporters.addons.told import read_scene_file
from exporters.formats import export
from exporters.model import build_model
from exporters.textures.layout import build_layout, view_of
from exporters.triangulation import triangulate
from linecad.confidence import keep_probable
from linecad.geometry import world_rays
from linecad.io.scene_file import write_scene
from linecad.model.groups import keep_main
from linecad.scene import Face, Plane

PITCH = np.radians(40.0)
TILT = PITCH + np.pi / 2


@pytest.fixture(scope="module")
def roofed(scene):
    """The made house with a roof beside it that rises away from the camera, which is above its plane."""
    low, high = scene.planes[0].faces[0].outline[:, 2].max(), 5.0
    left, right, front = -3.0, 6.0, scene.planes[0].offset
    rise = high * np.tan(PITCH)
    outline = np.array([[left, 0, 0], [right, 0, 0], [right, high, rise], [left, high, rise]])
    outline += np.array([0, front, low - 6.0])
    normal = np.array([0, np.cos(TILT), np.sin(TILT)])
    roof = Plane(77, 1, float(normal @ outline[0]), (), (Face(55, outline, kind="roof"),), TILT)
    return replace(scene, planes=(*scene.planes, roof))


@pytest.fixture(scope="module")
def flat(roofed):
    """The face of the roof."""
    return next(face for face in build_model(roofed).faces if face.id == 55)


def test_its_normal_is_that_of_its_slope(flat):
    assert flat.normal @ [0, 0, 1] == pytest.approx(np.cos(PITCH))
    edges = np.diff(flat.rings[0], axis=0)
    assert edges @ flat.normal == pytest.approx(np.zeros(3), abs=1e-9)
    assert flat.normal @ (0 - flat.vertices[0]) > 0


def test_it_is_moved_with_the_eye_to_the_ground(roofed):
    ground = replace(roofed.planes[0], id=90, axis=2, offset=-1.7, lines=(), faces=())
    ring = np.array([[0.0, 5, -1.7], [1, 5, -1.7], [1, 6, -1.7]])
    ground = replace(ground, faces=(Face(91, ring, kind="ground"),))
    scene = replace(roofed, planes=(*roofed.planes, ground), metres_per_unit=2.0)
    face = next(face for face in build_model(scene, origin="ground").faces if face.id == 55)
    assert face.vertices @ face.direction == pytest.approx(np.full(4, face.offset))


def test_its_texture_lies_in_its_plane_and_is_upright_along_the_slope(roofed, flat):
    model = build_model(roofed)
    layout = build_layout(model, view_of(roofed), 4096)
    (patch,) = [patch for face, patch in zip(model.faces, layout.patches, strict=True) if face.id == 55]
    for direction in (patch.right, patch.up):
        assert direction @ flat.normal == pytest.approx(0, abs=1e-9)
        assert np.linalg.norm(direction) == pytest.approx(1)
    assert patch.up[2] == pytest.approx(np.sin(PITCH))


def test_its_texture_shows_what_the_photo_shows_there(roofed, tmp_path):
    """Red and green grow with the place in the photo, so that a texel tells the pixel that it is of."""
    width, height = roofed.camera.width, roofed.camera.height
    rows, columns = np.mgrid[:height, :width]
    photo = np.stack([columns * 255 / width, rows * 255 / height, np.full((height, width), 90.0)], axis=2)
    export(roofed, tmp_path / "a.glb", np.rint(photo).astype(np.uint8))
    read = trimesh.load_scene(tmp_path / "a.glb")
    pose, name = read.graph["face_0055"]
    mesh = read.geometry[name].apply_transform(pose)
    picture = np.asarray(mesh.visual.material.baseColorTexture.convert("RGB"), float)
    middle, at = mesh.vertices.mean(axis=0), mesh.visual.uv.mean(axis=0)
    world = np.array([middle[0], -middle[2], middle[1]])
    ray = roofed.camera.matrix @ roofed.rotation @ world
    shown = picture[int((1 - at[1]) * picture.shape[0]), int(at[0] * picture.shape[1])]
    assert shown[:2] == pytest.approx(ray[:2] / ray[2] * 255 / [width, height], abs=4)


def test_every_format_has_its_corners(roofed, flat, tmp_path):
    triangles = flat.vertices[triangulate(flat)]
    for suffix in (".ply", ".stl"):
        export(roofed, tmp_path / f"a{suffix}")
        read = trimesh.load_mesh(tmp_path / f"a{suffix}", process=False)
        corners = read.vertices[read.faces]
        assert all(np.abs(corners - one).max(axis=(1, 2)).min() < 1e-5 for one in triangles)
    export(roofed, tmp_path / "a.dxf")
    found = np.array([
        np.array(vertex) for entity in ezdxf.readfile(tmp_path / "a.dxf").modelspace() if entity.dxftype() == "MESH"
        for vertex in entity.vertices
    ] + [
        np.array(entity.dxf.get(f"vtx{number}")) for entity in ezdxf.readfile(tmp_path / "a.dxf").modelspace()
        if entity.dxftype() == "3DFACE" for number in range(3)
    ])  # fmt: skip
    assert all(np.linalg.norm(found - corner, axis=1).min() < 1e-5 for corner in flat.vertices)


def test_glb_and_usd_tell_its_tilt_and_no_other(roofed, tmp_path):
    export(roofed, tmp_path / "a.glb")
    data = (tmp_path / "a.glb").read_bytes()
    tree = json.loads(data[20 : 20 + struct.unpack_from("<I", data, 12)[0]])
    planes = tree["scenes"][0]["extras"]["linecad_planes"]
    assert {plane["id"]: plane["tilt"] for plane in planes if "tilt" in plane} == {77: TILT}
    told = {node["name"]: node["extras"] for node in tree["nodes"] if "face_id" in node.get("extras", {})}
    assert {name for name, extras in told.items() if "tilt" in extras} == {"face_0055"}
    export(roofed, tmp_path / "a.usda")
    stage = Usd.Stage.Open(str(tmp_path / "a.usda"))
    tilts = list(stage.GetDefaultPrim().GetAttribute("linecad:planeTilts").Get())
    assert tilts == [plane.tilt for plane in roofed.planes]
    of_faces = {prim.GetName(): prim.GetAttribute("linecad:planeTilt").Get() for prim in stage.Traverse()}
    assert {name for name, tilt in of_faces.items() if tilt is not None} == {"face_0055"}


def test_a_ray_through_its_outline_meets_it(roofed):
    plane = roofed.planes[-1]
    (outline,) = [face.outline for face in plane.faces]
    pixels = outline @ roofed.rotation.T @ roofed.camera.matrix.T
    rays = world_rays(pixels[:, :2] / pixels[:, 2:], roofed.camera.matrix, roofed.rotation)
    depth = plane.offset / plane.along_normal(rays, ())
    assert rays * depth[:, None] == pytest.approx(outline)


def carrying(roofed):
    return roofed.planes[0].id


def test_a_roof_is_of_the_wall_that_its_eave_lies_in(roofed):
    assert roofed.walls_of_roofs == {77: carrying(roofed)}
    lower = replace(roofed.planes[-1], faces=(Face(55, roofed.planes[-1].faces[0].outline - [0, 0.1, 0], kind="roof"),))
    normal = lower.normal(roofed.turns)
    lower = replace(lower, offset=float(normal @ lower.faces[0].outline[0]))
    assert replace(roofed, planes=(*roofed.planes[:-1], lower)).walls_of_roofs == {}  # before the wall


def test_a_roof_goes_with_its_wall(roofed):
    """It hung in the air where its wall was not sure enough, or of another component."""
    own = np.isin(roofed.lines.id, roofed.planes[0].lines)
    told = replace(roofed.lines, probability=np.where(own, 0.2, 0.9), component=np.where(own, 4, 0))
    scene = replace(roofed, lines=told)
    assert 77 in {plane.id for plane in keep_probable(scene, 0.1).planes}
    left = {plane.id for plane in keep_probable(scene, 0.5).planes}
    assert carrying(roofed) not in left
    assert 77 not in left
    assert scene.components_of_planes[77] == scene.components_of_planes[carrying(roofed)] == 4
    assert 77 not in {plane.id for plane in keep_main(scene).planes}


def test_the_add_ons_hide_a_roof_with_its_wall(roofed, tmp_path):
    own = np.isin(roofed.lines.id, roofed.planes[0].lines)
    scene = replace(roofed, lines=replace(roofed.lines, probability=np.where(own, 0.25, 0.75)))
    write_scene(scene, tmp_path / "a.json")
    assert read_scene_file(tmp_path / "a.json").faces[55].probability == 0.25
