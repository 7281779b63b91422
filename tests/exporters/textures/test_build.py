"""The photo on the faces, read back from the files of every format that has textures."""

import hashlib
import io
import json
import os
import struct
import subprocess
import sys
import zipfile
from dataclasses import dataclass, replace
from pathlib import Path

import cv2
import numpy as np
import pytest
import shapely
from PIL import Image
from pxr import Usd, UsdGeom, UsdShade, UsdUtils, UsdValidation

from exporters import formats
from exporters.beside import NOTHING
from exporters.faces import signed_area
from exporters.format_options import TEXTURES
from exporters.formats import FORMATS, export
from exporters.model import build_model
from exporters.textures.build import build_textures
from exporters.textures.layout import MARGIN, TEXELS_PER_PIXEL, build_layout, seen_part, view_of
from exporters.textures.rectify import PLAIN, paint_pages
from linecad.io.scene_file import write_scene
from linecad.scene import Face, Plane

REPOSITORY = Path(__file__).parents[3]
TEXTURED = [suffix for suffix, row in FORMATS.items() if TEXTURES[0] in row.options]
BESIDE = [suffix for suffix in TEXTURED if FORMATS[suffix].beside != NOTHING]
MOST_ERROR = 0.05  # px
OVERSHOOT = 40  # of 255, beside an edge of great contrast
FACADE, GROUND, SLAB, BALCONY = 0, 2, 7, 8  # ids of faces of the made house

STEPS = np.array([(1, 0), (0, 1), (-1, 0), (0, -1), (0.7, 0.7), (-0.7, 0.7), (0.7, -0.7), (-0.7, -0.7)])

every_format = pytest.mark.parametrize("suffix", TEXTURED)
beside = pytest.mark.parametrize("suffix", BESIDE)


@dataclass
class Textured:
    """A face as a reader sees it."""

    points: np.ndarray  # (V, 3) m, z up
    triangles: np.ndarray  # (T, 3)
    coordinates: np.ndarray  # (V, 2) from the lower left corner
    picture: bytes

    def pixels(self):
        return np.asarray(Image.open(io.BytesIO(self.picture)).convert("RGB"))

    def to_texels(self, points):
        """Texels from the corner of the picture, by the one affine map that the corners of the face define."""
        height, width = self.pixels().shape[:2]
        corners = self.coordinates * [width, -height] + [0, height]
        matrix, *_ = np.linalg.lstsq(np.c_[self.points, np.ones(len(self.points))], corners, rcond=None)
        return np.c_[points, np.ones(len(points))] @ matrix


def read_glb(path):
    data = path.read_bytes()
    size = struct.unpack_from("<I", data, 12)[0]
    tree, binary = json.loads(data[20 : 20 + size]), data[28 + size :]

    def view(index):
        there = tree["bufferViews"][index]
        return binary[there["byteOffset"] : there["byteOffset"] + there["byteLength"]]

    def array(index, kind, width):
        return np.frombuffer(view(tree["accessors"][index]["bufferView"]), kind).reshape(-1, width)

    faces = {}
    meshes = [(node, tree["meshes"][node["mesh"]]) for node in tree["nodes"] if "mesh" in node]
    for node, mesh in meshes:
        (primitive,) = mesh["primitives"]
        material = tree["materials"][primitive["material"]]
        if "baseColorTexture" in material["pbrMetallicRoughness"]:
            texture = tree["textures"][material["pbrMetallicRoughness"]["baseColorTexture"]["index"]]
            points = array(primitive["attributes"]["POSITION"], np.float32, 3) + node.get("translation", [0, 0, 0])
            x, y, z = points.T
            s, t = array(primitive["attributes"]["TEXCOORD_0"], np.float32, 2).astype(float).T
            faces[node["name"]] = Textured(
                np.stack([x, -z, y], axis=1).astype(float),
                array(primitive["indices"], np.uint32, 3),
                np.stack([s, 1 - t], axis=1),
                view(tree["images"][texture["source"]]["bufferView"]),
            )
    return faces


def read_usd(path):
    faces = {}
    stage = Usd.Stage.Open(str(path))
    for prim in stage.Traverse():
        variable = UsdGeom.PrimvarsAPI(prim).GetPrimvar("st")
        if prim.IsA(UsdGeom.Mesh) and variable:
            surface = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()[0].ComputeSurfaceSource()[0]
            texture = UsdShade.Shader(surface.GetInput("emissiveColor").GetConnectedSource()[0])
            asset = texture.GetInput("file").Get()
            if path.suffix == ".usdz":
                picture = zipfile.ZipFile(path).read(asset.path.removeprefix("./"))
            else:
                picture = Path(asset.resolvedPath).read_bytes()
            mesh = UsdGeom.Mesh(prim)
            triangles = np.array(mesh.GetFaceVertexIndicesAttr().Get()).reshape(-1, 3)
            matrix = np.array(UsdGeom.XformCache().GetLocalToWorldTransform(prim))
            points = np.array(mesh.GetPointsAttr().Get(), float) @ matrix[:3, :3] + matrix[3, :3]
            faces[prim.GetName()] = Textured(points, triangles, np.array(variable.Get(), float), picture)
    return faces


def read_obj(path):
    vertices, coordinates, corners, faces, pictures = [], [], [], {}, {}
    name = material = None
    for row in path.read_text().splitlines():
        word, _, rest = row.partition(" ")
        if word == "mtllib":
            for line in path.with_name(rest).read_text().splitlines():
                key, _, value = line.partition(" ")
                if key == "newmtl":
                    material = value
                elif key == "map_Kd":
                    pictures[material] = (path.parent / value).read_bytes()
        elif word == "o":
            name, vertices_before, corners = rest, len(vertices), []
        elif word == "v":
            x, up, minus_y = map(float, rest.split())
            vertices.append([x, -minus_y, up])
        elif word == "vt":
            coordinates.append([float(number) for number in rest.split()])
        elif word == "usemtl":
            material = rest
        elif word == "f":
            corners.append([[int(number) - 1 for number in corner.split("/")] for corner in rest.split()])
            here = np.array(corners)
            if here.shape[2] == 1:
                continue
            assert (here[..., 0] == here[..., 1]).all()
            span = slice(vertices_before, None)
            faces[name] = Textured(
                np.array(vertices[span]),
                here[..., 0] - vertices_before,
                np.array(coordinates[span]),
                pictures[material],
            )
    return faces


def read(path):
    return {".glb": read_glb, ".obj": read_obj}.get(path.suffix, read_usd)(path)


def project(scene, points):
    ray = np.asarray(points).reshape(-1, 3) @ scene.rotation.T @ scene.camera.matrix.T
    return ray[:, :2] / ray[:, 2:]


def on_plane(scene, plane, pixel):
    """Where the ray of a pixel meets a plane."""
    ray = np.linalg.solve(scene.camera.matrix @ scene.rotation, [*pixel, 1.0])
    return ray * (plane.offset / ray[plane.axis])


def polygon(points):
    return shapely.Polygon(points[0], points[1:])


def is_hidden(scene, point):
    """Whether a face is nearer to the camera on the way to a point of another one; by rays, not by pixels."""
    for plane, face in scene.faces:
        share = plane.offset / point[plane.axis] if point[plane.axis] else np.inf
        if 0 < share < 1 - 1e-6:
            flat = [axis for axis in range(3) if axis != plane.axis]
            shape = polygon([ring[:, flat] for ring in (face.outline, *face.holes)])
            if shape.covers(shapely.Point(share * point[flat])):
                return True
    return False


@pytest.fixture(scope="module")
def marks(scene):
    """Face name -> points (M, 3) well inside the face and in plain view, far from each other in the photo."""
    taken, found = [], {}
    for plane, face in scene.faces:
        shape = polygon([project(scene, ring) for ring in (face.outline, *face.holes)]).buffer(-12)
        shape &= shapely.box(12, 12, scene.camera.width - 12, scene.camera.height - 12)
        flat = [axis for axis in range(3) if axis != plane.axis]
        low, high = face.outline[:, flat].min(axis=0), face.outline[:, flat].max(axis=0)
        points = np.full((9 * 9, 3), plane.offset)
        points[:, flat] = np.stack(np.meshgrid(*np.linspace(low, high, 9).T), axis=-1).reshape(-1, 2)
        for point, pixel in zip(points, project(scene, points), strict=True):
            apart = all(np.abs(pixel - other).max() > 24 for other in taken)
            if not apart or not shape.covers(shapely.Point(pixel)):
                continue
            about = [point, *(on_plane(scene, plane, pixel + step) for step in 12 * STEPS)]
            if not any(is_hidden(scene, each) for each in about):
                taken.append(pixel)
                found.setdefault(f"face_{face.id:04d}", []).append(point)
    assert len(found) >= 7
    return found


@pytest.fixture(scope="module")
def spotted(scene, marks):
    """A dark photo with a bright spot where the camera sees each of the marked points."""
    photo = np.full((scene.camera.height, scene.camera.width), 30.0)
    for points in marks.values():
        for x, y in project(scene, points):
            left, top = round(x) - 14, round(y) - 14
            across, down = np.arange(left, left + 29) - x, np.arange(top, top + 29) - y
            spot = np.exp(-(across[None] ** 2 + down[:, None] ** 2) / (2 * 2.5**2))
            photo[top : top + 29, left : left + 29] += 200 * spot
    return np.repeat(np.round(photo).astype(np.uint8)[..., None], 3, axis=2)


@pytest.fixture(scope="module")
def coloured(scene):
    """A photo in which every face has a colour of its own, the near ones before the far ones; and the colours."""
    colours = {face.id: (40 + 24 * face.id, 230 - 20 * face.id, 60 * (face.id % 4)) for _, face in scene.faces}
    photo = np.full((scene.camera.height, scene.camera.width, 3), 255, np.uint8)
    for number in (2, 3, 4, 5, 6, 0, 1, SLAB, BALCONY):
        face = next(face for _, face in scene.faces if face.id == number)
        rings = [np.round(project(scene, ring) * 16).astype(np.int32) for ring in (face.outline, *face.holes)]
        cv2.fillPoly(photo, rings, colours[number], cv2.LINE_AA, 4)
    return photo, colours


@pytest.fixture(scope="module")
def folder(scene, spotted, tmp_path_factory):
    """The scene in every format with the spotted photo."""
    folder = tmp_path_factory.mktemp("textures")
    for suffix in TEXTURED:
        export(scene, folder / f"a{suffix}", spotted)
    return folder


@every_format
def test_the_texture_shows_at_a_point_what_the_camera_saw_there(scene, marks, folder, suffix):
    faces = read(folder / f"a{suffix}")
    assert set(faces) == {face.name for face in build_model(scene).faces}
    worst = 0.0
    for name, points in marks.items():
        face = faces[name]
        pixels = face.pixels()[..., 0].astype(float) - 30
        base = face.points[0]
        # The way back, from texels to the plane, by three points of it.
        along = [np.eye(3)[axis] for axis in range(3) if np.ptp(face.points[:, axis]) > 0]
        zero, one, two = face.to_texels(np.stack([base, base + along[0], base + along[1]]))
        back = np.linalg.inv(np.stack([one - zero, two - zero], axis=1))
        for texel, pixel in zip(face.to_texels(np.array(points)), project(scene, points), strict=True):
            left, top = max(int(texel[0]) - 40, 0), max(int(texel[1]) - 40, 0)
            window = pixels[top : top + 80, left : left + 80]
            x, y = np.meshgrid(np.arange(window.shape[1]) + left + 0.5, np.arange(window.shape[0]) + top + 0.5)
            plane = (np.stack([x.ravel(), y.ravel()], axis=1) - zero) @ back.T
            space = base + plane @ np.stack(along)
            seen = project(scene, space)
            near = np.linalg.norm(seen - pixel, axis=1) < 10
            weight = window.ravel()[near] / (space[near] @ scene.rotation[2]) ** 3  # as many texels as pixels
            middle = (seen[near] * weight[:, None]).sum(axis=0) / weight.sum()
            worst = max(worst, float(np.linalg.norm(middle - pixel)))
    assert worst <= MOST_ERROR


@every_format
def test_holes_have_no_triangles_and_every_corner_is_used(scene, folder, suffix):
    faces = read(folder / f"a{suffix}")
    for plane, face in scene.faces:
        found = faces[f"face_{face.id:04d}"]
        flat = [axis for axis in range(3) if axis != plane.axis]
        shape = polygon([ring[:, flat] for ring in (face.outline, *face.holes)])
        corners = found.points[found.triangles][:, :, flat]
        a, b = (corners[:, 1] - corners[:, 0]).T, (corners[:, 2] - corners[:, 0]).T
        assert np.abs(a[0] * b[1] - a[1] * b[0]).sum() / 2 == pytest.approx(shape.area, rel=1e-5)
        assert all(shape.contains(shapely.Point(middle)) for middle in corners.mean(axis=1))
        assert set(found.triangles.ravel().tolist()) == set(range(len(found.points)))


@every_format
def test_all_coordinates_lie_in_the_picture(folder, suffix):
    for face in read(folder / f"a{suffix}").values():
        assert face.coordinates.min() >= 0
        assert face.coordinates.max() <= 1


@every_format
def test_the_same_scene_and_photo_give_the_same_bytes(scene, spotted, folder, tmp_path, suffix):
    formats._last_made.clear()
    export(scene, tmp_path / f"a{suffix}", spotted)
    for path in sorted(tmp_path.rglob("*")):
        if path.is_file():
            assert path.read_bytes() == (folder / path.relative_to(tmp_path)).read_bytes()


EXPORT_ALL = """
import sys
from pathlib import Path
import cv2
from exporters.formats import export
from linecad.io.scene_file import read_scene
folder, *suffixes = sys.argv[1:]
scene = read_scene(Path(folder) / "scene.json")
photo = cv2.imread(folder + "/photo.png")[..., ::-1].copy()
Path(folder, "out").mkdir()
for suffix in suffixes:
    export(scene, Path(folder) / "out" / ("a" + suffix), photo)
"""


@pytest.mark.thorough
def test_a_fresh_process_writes_the_same_bytes(scene, spotted, folder, tmp_path):
    write_scene(scene, tmp_path / "scene.json")
    cv2.imwrite(str(tmp_path / "photo.png"), spotted[..., ::-1])
    command = [sys.executable, "-c", EXPORT_ALL, str(tmp_path), *TEXTURED]
    subprocess.run(command, cwd=REPOSITORY, env=os.environ | {"PYTHONHASHSEED": "7"}, check=True)
    written = {path.relative_to(tmp_path / "out"): path for path in (tmp_path / "out").rglob("*") if path.is_file()}
    assert len(written) == len([path for path in folder.rglob("*") if path.is_file()])
    assert [name for name, path in written.items() if path.read_bytes() != (folder / name).read_bytes()] == []


@every_format
def test_without_a_photo_or_with_textures_off_the_file_is_plain_and_alone(scene, spotted, tmp_path, suffix):
    export(scene, tmp_path / f"none{suffix}")
    export(scene, tmp_path / f"off{suffix}", spotted, {"textures": False})
    assert sorted(path.name for path in tmp_path.iterdir()) == [f"none{suffix}", f"off{suffix}"]
    assert (tmp_path / f"none{suffix}").read_bytes() == (tmp_path / f"off{suffix}").read_bytes()
    assert read(tmp_path / f"off{suffix}") == {}


@every_format
def test_lines_alone_need_no_texture(no_faces, spotted, tmp_path, suffix):
    export(no_faces, tmp_path / f"a{suffix}", spotted)
    assert [path.name for path in tmp_path.iterdir()] == [f"a{suffix}"]


@beside
def test_the_pictures_lie_in_a_folder_named_after_the_file(folder, suffix):
    names = sorted(path.name for path in (folder / f"a{suffix}.textures").iterdir())
    pictures = {face.picture for face in read(folder / f"a{suffix}").values()}
    assert names == sorted(f"photo-{hashlib.sha256(picture).hexdigest()[:16]}.jpg" for picture in pictures)


@beside
def test_any_name_finds_its_pictures(scene, spotted, tmp_path, suffix):
    path = tmp_path / f"""Häuschen "家" it's @ # %20{suffix}"""
    export(scene, path, spotted)
    assert len(read(path)) == len(scene.faces)
    if suffix != ".obj":
        assert UsdUtils.ComputeAllDependencies(str(path))[2] == []


@pytest.mark.parametrize("suffix", [".usda", ".usdc", ".usdz"])
def test_no_validator_complains_of_the_textures(folder, suffix):
    context = UsdValidation.ValidationContext(UsdValidation.ValidationRegistry().GetOrLoadAllValidators())
    stage = Usd.Stage.Open(str(folder / f"a{suffix}"))
    errors = context.Validate(stage)
    assert [f"{error.GetIdentifier()}: {error.GetMessage()}" for error in errors if not error.HasNoError()] == []


def test_a_package_holds_its_pictures_aligned_and_not_compressed(folder):
    package = zipfile.ZipFile(folder / "a.usdz")
    assert next(Path(entry.filename).suffix for entry in package.infolist()) == ".usdc"
    assert len(package.infolist()) > 1
    for entry in package.infolist():
        start = entry.header_offset + 30 + len(entry.filename) + len(entry.extra)
        assert (entry.compress_type, start % 64) == (zipfile.ZIP_STORED, 0)


def test_glb_shows_the_photo_as_it_is_and_repeats_none_of_it(folder):
    data = (folder / "a.glb").read_bytes()
    tree = json.loads(data[20 : 20 + struct.unpack_from("<I", data, 12)[0]])
    assert tree["samplers"] == [{"magFilter": 9729, "minFilter": 9987, "wrapS": 33071, "wrapT": 33071}]
    textured = [each for each in tree["materials"] if "baseColorTexture" in each["pbrMetallicRoughness"]]
    assert textured
    assert all("KHR_materials_unlit" in each["extensions"] and each["doubleSided"] for each in textured)
    assert all("target" not in tree["bufferViews"][image["bufferView"]] for image in tree["images"])


def painted(scene, photo, number, size=4096):
    """The pixels of the one patch of a face with its margin, and the patch."""
    model = build_model(scene)
    layout = build_layout(model, view_of(scene), size)
    pages, _ = paint_pages(model, layout, view_of(scene), photo)
    patch = layout.patches[[face.id for face in model.faces].index(number)]
    rows = slice(patch.top - MARGIN, patch.top + patch.rows + MARGIN)
    return pages[patch.page][rows, patch.left - MARGIN : patch.left + patch.columns + MARGIN], patch


def is_colour(pixels, colour, tolerance=12):
    return np.abs(pixels.astype(int) - colour).max(axis=-1) <= tolerance


def test_what_stands_before_a_face_is_not_painted_on_it(scene, coloured):
    photo, colours = coloured
    pixels, patch = painted(scene, photo, FACADE)
    own, plain = is_colour(pixels, colours[FACADE], OVERSHOOT), is_colour(pixels, PLAIN, 0)
    assert (own | plain).mean() > 0.999  # the rest is in tips that are border alone
    assert not is_colour(pixels, colours[BALCONY]).any()
    # The slab meets the wall and is seen almost from its edge: no more of it than the tip that is a pixel high.
    assert is_colour(pixels, colours[SLAB]).mean() < 0.0005
    # In the middle of what the balcony hides there is nothing to paint.
    plane, balcony = next((plane, face) for plane, face in scene.faces if face.id == BALCONY)
    facade = next(plane for plane, face in scene.faces if face.id == FACADE)
    middle = on_plane(scene, facade, project(scene, balcony.outline.mean(axis=0))[0])
    x, y = (patch.texels(middle) - [patch.left - MARGIN, patch.top - MARGIN]).astype(int)
    assert plain[y, x]
    assert plane.offset < facade.offset


def test_a_face_behind_an_opening_is_painted_where_it_shows(scene, coloured):
    photo, colours = coloured
    for number in (3, 4, 5):
        pixels, _ = painted(scene, photo, number)
        own, plain = is_colour(pixels, colours[number], OVERSHOOT), is_colour(pixels, PLAIN, 0)
        assert own.mean() > 0.7
        assert (own | plain).all()


def test_holes_and_all_else_about_a_face_are_plain(scene, coloured):
    photo, colours = coloured
    pixels, patch = painted(scene, photo, FACADE)
    face = next(face for face in build_model(scene).faces if face.id == FACADE)
    for hole in face.rings[1:]:
        x, y = (patch.texels(hole.mean(axis=0)) - [patch.left - MARGIN, patch.top - MARGIN]).astype(int)
        assert is_colour(pixels[y, x], PLAIN, 0)
    assert not is_colour(pixels, (255, 255, 255)).any()  # the sky of this photo
    assert is_colour(pixels[0, pixels.shape[1] // 2], colours[FACADE])  # the margin above continues the wall


def test_what_lies_outside_the_photo_is_plain(scene, coloured):
    photo, colours = coloured
    plane, ground = next((plane, face) for plane, face in scene.faces if face.id == GROUND)
    wide = Face(GROUND, ground.outline.mean(axis=0) + (ground.outline - ground.outline.mean(axis=0)) * [9, 9, 1])
    pixels, patch = painted(replace(scene, planes=(replace(plane, faces=(wide,)),)), photo, GROUND)
    behind = wide.outline[wide.outline[:, 1].argmin()]
    assert scene.rotation[2] @ behind < 0
    inner = np.clip(
        (patch.texels(behind) - [patch.left, patch.top]).astype(int), 0, [patch.columns - 1, patch.rows - 1]
    )
    assert is_colour(pixels[inner[1] + MARGIN, inner[0] + MARGIN], PLAIN, 0)
    assert is_colour(pixels, colours[GROUND]).any()


def test_a_face_that_the_photo_does_not_show_is_plain(scene, coloured, tmp_path):
    behind = np.array([[-1.0, -5, -1], [1, -5, -1], [1, -5, 1], [-1, -5, 1]])
    hidden = Plane(id=99, axis=1, offset=-5.0, lines=(), faces=(Face(99, behind),))
    export(replace(scene, planes=(*scene.planes, hidden)), tmp_path / "a.glb", coloured[0])
    face = read(tmp_path / "a.glb")["face_0099"]
    for x, y in face.to_texels(face.points):
        height, width = face.pixels().shape[:2]
        assert is_colour(face.pixels()[min(int(y), height - 1), min(int(x), width - 1)], PLAIN, 4)


def test_a_face_that_is_seen_from_its_edge_is_plain(scene, coloured, tmp_path):
    ring = np.array([[0.0, 5, -1], [0, 9, -1], [0, 9, 1], [0, 5, 1]])
    for offset in (0.0, 1e-9):
        edge = Plane(id=99, axis=0, offset=offset, lines=(), faces=(Face(99, ring + np.array([offset, 0, 0])),))
        export(replace(scene, planes=(*scene.planes, edge)), tmp_path / "a.glb", coloured[0])
        face = read(tmp_path / "a.glb")["face_0099"]
        assert np.ptp(face.coordinates, axis=0).min() > 0


def test_no_pixel_of_the_photo_is_lost_but_where_a_face_would_need_too_many_texels(scene):
    model, view = build_model(scene), view_of(scene)
    layout = build_layout(model, view, 16384)
    capped = 0
    for face, patch in zip(model.faces, layout.patches, strict=True):
        area = shapely.Polygon([point[:2] / point[2] for point in seen_part(face.rings[0], view)]).area
        if patch.columns * patch.rows > 0.98 * TEXELS_PER_PIXEL * area:
            capped += 1
            assert patch.columns * patch.rows <= TEXELS_PER_PIXEL * area + patch.columns + patch.rows
        else:
            seen = project(scene, face.rings[0])
            inside = ((seen > 0) & (seen < [view.width, view.height])).all(axis=1)
            for direction, density in zip((patch.right, patch.up), patch.density, strict=True):
                step = project(scene, face.rings[0] + direction * 1e-4) - project(
                    scene, face.rings[0] - direction * 1e-4
                )
                assert (np.linalg.norm(step, axis=1)[inside] / 2e-4 / density).max(initial=0) <= 1.001
    assert 0 < capped < len(model.faces) / 2


def test_the_size_caps_every_picture(scene, coloured, tmp_path):
    photo, colours = coloured
    export(scene, tmp_path / "a.usda", photo, {"texture-size": 256})
    faces = read(tmp_path / "a.usda")
    assert len({face.picture for face in faces.values()}) > 1
    assert max(max(face.pixels().shape) for face in faces.values()) <= 256
    facade = faces[f"face_{FACADE:04d}"]
    x, y = facade.to_texels(facade.points[:1] + np.array([0.05, 0, 0.2]))[0].astype(int)
    assert is_colour(facade.pixels()[y, x], colours[FACADE], 20)


def test_patches_lie_apart_on_their_pages(scene):
    for size in (256, 700, 4096):
        layout = build_layout(build_model(scene), view_of(scene), size)
        pages = [np.zeros((height, width), int) for width, height in layout.pages]
        for patch in layout.patches:
            rows = slice(patch.top - MARGIN, patch.top + patch.rows + MARGIN)
            columns = slice(patch.left - MARGIN, patch.left + patch.columns + MARGIN)
            assert min(rows.start, columns.start) >= 0
            part = pages[patch.page][rows, columns]
            assert part.shape == (patch.rows + 2 * MARGIN, patch.columns + 2 * MARGIN)
            part += 1
        assert all(page.max() == 1 for page in pages)
        assert max(max(page) for page in layout.pages) <= size


def test_walls_stand_upright_in_their_texture(scene, model):
    layout = build_layout(model, view_of(scene), 4096)
    for face, patch in zip(model.faces, layout.patches, strict=True):
        np.testing.assert_allclose(np.cross(patch.right, patch.up), face.normal, atol=1e-12)
        if face.axis != 2:
            assert patch.up.tolist() == [0, 0, 1]


def test_another_photo_makes_other_textures(scene, spotted, coloured, tmp_path):
    export(scene, tmp_path / "a.glb", spotted)
    export(scene, tmp_path / "b.glb", coloured[0])
    assert (tmp_path / "a.glb").read_bytes() != (tmp_path / "b.glb").read_bytes()


def test_a_photo_that_could_change_is_read_anew(scene, coloured, tmp_path):
    photo = coloured[0].copy()
    export(scene, tmp_path / "a.glb", photo)
    photo[:] = 128
    export(scene, tmp_path / "b.glb", photo)
    assert (tmp_path / "a.glb").read_bytes() != (tmp_path / "b.glb").read_bytes()


def test_textures_are_made_once_for_several_formats(scene, coloured, tmp_path, monkeypatch):
    made = []
    monkeypatch.setattr(
        "exporters.textures.build.build_textures", lambda *given: made.append(1) or build_textures(*given)
    )
    photo = coloured[0].copy()
    photo.flags.writeable = False
    for suffix in TEXTURED:
        export(scene, tmp_path / f"a{suffix}", photo)
    assert len(made) == 1


@pytest.mark.parametrize("suffix", [".obj", ".glb"])
def test_on_the_ground_the_texture_lies_where_it_lay(grounded, spotted, tmp_path, suffix):
    made = []
    for name, origin in (("a", "ground"), ("b", "camera")):
        path = tmp_path / f"{name}{suffix}"
        export(grounded, path, spotted, {"origin": origin})
        made.append(read_obj(path) if suffix == ".obj" else read_glb(path))
    for name, low in made[1].items():
        np.testing.assert_allclose(made[0][name].coordinates, low.coordinates, atol=1e-6)


def test_of_equal_faces_the_one_that_the_photo_shows_best_is_known(row, photo):
    textures, model, view = build_textures(row, photo, 4096), build_model(row), view_of(row)
    panes = [fitting.faces[0] for fitting in model.fittings]
    areas = []
    for pane in panes:
        seen = seen_part(pane.rings[0], view)
        areas.append(abs(signed_area(seen[:, :2] / seen[:, 2:])))
        assert 0 < textures.shown[pane.id] <= 1.05 * areas[-1]
    assert textures.best_shown(panes) is panes[int(np.argmax([textures.shown[pane.id] for pane in panes]))]
    hedged = [
        replace(plane, faces=tuple(replace(f, hidden=(f.outline,)) if f.id == panes[0].id else f for f in plane.faces))
        for plane in row.planes
    ]
    behind = build_textures(replace(row, planes=tuple(hedged)), photo, 4096)
    assert behind.shown[panes[0].id] == 0
