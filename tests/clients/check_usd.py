"""Open a USD stage with usd-core, with every validator it has: check_usd.py FILE.usda|usdc|usdz EXPECTATION.json"""

import argparse
import itertools
import json
import math
import sys
import zipfile
from pathlib import Path, PurePosixPath

import numpy as np
from pxr import Usd, UsdGeom, UsdShade, UsdUtils, UsdValidation

from shapes import check_clipping, check_colour, check_face, check_lines, check_names, check_pixels
from verdict import run

TOLERANCE = 1e-4  # m; USD stores points as float32
PIXEL_TOLERANCE = 0.05  # px
CONTENT = {"full": (True, True), "wireframe": (True, False), "faces": (False, True)}  # variant: lines, faces are shown
LAYERS = (".usda", ".usdc", ".usd")


def check(findings, path, expected):
    """Note all problems of the stage; returns a summary."""
    stage = Usd.Stage.Open(str(path))
    check_stage(findings, stage, expected)
    context = UsdValidation.ValidationContext(UsdValidation.ValidationRegistry().GetOrLoadAllValidators())
    for error in context.Validate(stage):
        findings.need(error.HasNoError(), f"{error.GetType()} {error.GetIdentifier()}: {error.GetMessage()}")
    prims = list(stage.Traverse())
    cache = UsdGeom.XformCache()
    placed = check_curves(
        findings, [UsdGeom.BasisCurves(p) for p in prims if p.IsA(UsdGeom.BasisCurves)], cache, expected
    )
    meshes = [UsdGeom.Mesh(prim) for prim in prims if prim.IsA(UsdGeom.Mesh)]
    check_names(
        findings, "meshes", [mesh.GetPrim().GetName() for mesh in meshes], [f["name"] for f in expected["faces"]]
    )
    faces = {face["name"]: face for face in expected["faces"]}
    for mesh in meshes:
        if mesh.GetPrim().GetName() in faces:
            check_mesh(findings, mesh, cache, faces[mesh.GetPrim().GetName()])
    for opening in expected["openings"]:
        check_opening(findings, stage, opening)
    for prim in prims:
        if prim.IsA(UsdGeom.Gprim):
            check_extent(findings, UsdGeom.Gprim(prim))
            check_material(findings, prim, expected)
    cameras = [UsdGeom.Camera(prim) for prim in prims if prim.IsA(UsdGeom.Camera)]
    largest = math.nan
    if findings.need(len(cameras) == 1, f"{len(cameras)} cameras, expected 1"):
        largest = check_camera(findings, cameras[0], cache, expected, placed)
    check_variants(findings, stage)
    check_files(findings, path)
    version = ".".join(map(str, Usd.GetVersion()))
    return f"usd {version}: {len(placed)} lines, {len(meshes)} meshes, lines at most {largest:.5f} px off"


def check_stage(findings, stage, expected):
    for name in ("upAxis", "metersPerUnit"):
        findings.need(stage.HasAuthoredMetadata(name), f"the stage does not say its {name}")
    up, metres = UsdGeom.GetStageUpAxis(stage), UsdGeom.GetStageMetersPerUnit(stage)
    findings.need((up, metres) == ("Z", 1.0), f"{up} is up and a unit is {metres} m, expected Z and 1 m")
    root = stage.GetDefaultPrim()
    if findings.need(root.IsValid(), "there is no default prim"):
        roots = [prim.GetName() for prim in stage.GetPseudoRoot().GetChildren()]
        findings.need(roots == [root.GetName()], f"{roots} are at the root, expected the default prim alone")
        kind = Usd.ModelAPI(root).GetKind()
        findings.need(kind == "component", f"the default prim has the kind {kind!r}, expected component")
        ids, axes, offsets = (root.GetAttribute(f"linecad:plane{what}").Get() for what in ("Ids", "Axes", "Offsets"))
        planes = [{"id": i, "axis": a, "offset": o} for i, a, o in zip(ids, axes, offsets, strict=True)]
        findings.need(planes == expected["planes"], "the default prim does not list the planes of the scene")
    for prim in stage.Traverse():
        findings.need(prim.GetName().isascii(), f"{prim.GetPath()} is not ASCII, which older programs refuse")


def in_world(cache, prim, points):
    """Points of a prim in the world, as tuples."""
    matrix = np.array(cache.GetLocalToWorldTransform(prim))
    return list(map(tuple, (np.array(points, float).reshape(-1, 3) @ matrix[:3, :3] + matrix[3, :3]).tolist()))


def check_curves(findings, all_curves, cache, expected):
    """Returns the lines that are in their place, by id."""
    segments = {}
    for curves in all_curves:
        prim, name = curves.GetPrim(), curves.GetPrim().GetName()
        kind = curves.GetTypeAttr().Get(), curves.GetWrapAttr().Get()
        findings.need(kind == ("linear", "nonperiodic"), f"{name} is {kind}, expected linear and nonperiodic")
        counts = set(curves.GetCurveVertexCountsAttr().Get())
        findings.need(counts == {2}, f"{name}: curves of {counts} points, expected 2")
        widths = curves.GetWidthsAttr().Get()
        findings.need(widths and min(widths) > 0, f"{name}: widths {widths}")
        points = in_world(cache, prim, curves.GetPointsAttr().Get())
        segments[name] = list(zip(points[::2], points[1::2], strict=True))
        group = expected["groups"].get(name, {"ids": [], "axis": None, "boundary": None, "roles": []})
        variables = UsdGeom.PrimvarsAPI(prim)
        boundaries = [group["boundary"]] * len(group["ids"])
        for what, values in (("id", group["ids"]), ("boundary", boundaries), ("role", group["roles"])):
            variable = variables.GetPrimvar(f"linecad:{what}")
            uniform = variable.IsDefined() and variable.GetInterpolation() == UsdGeom.Tokens.uniform
            right = uniform and list(variable.Get()) == values
            findings.need(right, f"{name}: linecad:{what} does not tell the {what} of each curve")
        axis = prim.GetAttribute("linecad:direction").Get()
        findings.need(axis == group["axis"], f"{name}: linecad:direction is {axis}")
    placed = check_lines(findings, expected, segments, TOLERANCE)
    for name, group in expected["groups"].items():
        for number, segment in zip(group["ids"], segments.get(name, []), strict=False):
            own = number not in placed or set(placed[number]) == set(segment)
            findings.need(own, f"{name}: the curve with the id {number} is another line")
    return placed


def check_mesh(findings, mesh, cache, face):
    prim, name = mesh.GetPrim(), face["name"]
    points = mesh.GetPointsAttr().Get()
    counts, indices = mesh.GetFaceVertexCountsAttr().Get(), mesh.GetFaceVertexIndicesAttr().Get()
    valid, why = UsdGeom.Mesh.ValidateTopology(indices, counts, len(points))
    if not findings.need(valid and set(counts) == {3}, f"{name}: polygons of {set(counts)} corners, {why}"):
        return
    scheme = mesh.GetSubdivisionSchemeAttr().Get()
    findings.need(scheme == "none", f"{name}: subdivision {scheme}, which rounds the corners off")
    findings.need(mesh.GetDoubleSidedAttr().Get(), f"{name} is seen from one side only")
    findings.need(not mesh.GetHoleIndicesAttr().Get(), f"{name} has holeIndices, which few programs know")
    check_face(findings, face, in_world(cache, prim, points), np.reshape(indices, (-1, 3)).tolist(), TOLERANCE)
    shown = prim.GetDisplayName() or prim.GetName()
    findings.need(shown == name, f"{name} is displayed as {shown!r}")
    kinds = ("faceId", "kind", "label", "planeAxis", "planeOffset")
    told = [prim.GetAttribute(f"linecad:{what}").Get() for what in kinds]
    wanted = [face[what] for what in ("id", "kind", "label", "axis", "offset")]
    findings.need(told == wanted, f"{name} says {told}, expected {wanted}")
    normals = set(map(tuple, mesh.GetNormalsAttr().Get()))
    wanted = tuple(face["normal"])
    same = len(normals) == 1 and np.allclose(list(normals), wanted)
    findings.need(same, f"{name}: normals {normals}, expected {wanted}")


def check_opening(findings, stage, opening):
    """An opening is a prim above its faces."""
    label = opening["label"]
    prim = stage.GetDefaultPrim().GetPrimAtPath(f"Faces/{label.replace(' ', '_')}")
    if not findings.need(prim.IsValid(), f"there is no prim for {label}"):
        return
    told = {what: prim.GetAttribute(f"linecad:{what}").Get() for what in ("shape", "kind", "label")}
    told |= {"id": prim.GetAttribute("linecad:opening").Get(), "faces": [each.GetName() for each in prim.GetChildren()]}
    findings.need(told == opening, f"{label} says {told}, expected {opening}")


def check_extent(findings, shape):
    authored = shape.GetExtentAttr().HasAuthoredValue()
    if findings.need(authored, f"{shape.GetPath()} has no extent"):
        extent = shape.GetExtentAttr().Get()
        wanted = UsdGeom.Boundable.ComputeExtentFromPlugins(shape, Usd.TimeCode.Default())
        findings.need(np.allclose(extent, wanted), f"{shape.GetPath()}: extent {extent}, expected {wanted}")


def check_material(findings, prim, expected):
    """Lines and plain faces have their colour, in linear light; a textured face finds its picture."""
    name = prim.GetName()
    group = expected["groups"].get(name)
    wanted = group or next((face for face in expected["faces"] if face["name"] == name), group)
    if not findings.need(wanted, f"{name} is neither a group of lines nor a face"):
        return
    wanted = wanted["linear"]
    shown = UsdGeom.Gprim(prim).GetDisplayColorAttr().Get()
    if findings.need(shown, f"{name} has no displayColor"):
        check_colour(findings, f"{name}, displayColor", shown[0], wanted)
    material, _ = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()
    if not findings.need(material, f"{name} has no material"):
        return
    surface = material.ComputeSurfaceSource()[0]
    if not findings.need(surface and surface.GetShaderId() == "UsdPreviewSurface", f"{name}: no UsdPreviewSurface"):
        return
    pictures = [
        UsdShade.Shader(part)
        for part in Usd.PrimRange(material.GetPrim())
        if part.IsA(UsdShade.Shader) and UsdShade.Shader(part).GetShaderId() == "UsdUVTexture"
    ]
    if not pictures:
        inputs = "emissiveColor" if group else "diffuseColor"
        check_colour(findings, f"{name}, {inputs}", surface.GetInput(inputs).Get(), wanted)
    for picture in pictures:
        asset = picture.GetInput("file").Get()
        findings.need(asset.resolvedPath, f"{name}: there is no picture {asset.path}")
        findings.need(not PurePosixPath(asset.path).is_absolute(), f"{name}: {asset.path} is a path of one machine")
        coordinates = UsdGeom.PrimvarsAPI(prim).GetPrimvar("st")
        findings.need(coordinates.HasValue(), f"{name} has a picture and no texture coordinates")


def check_camera(findings, camera, cache, expected, placed):
    """Look at the lines through USD's own frustum; returns the largest distance from the photo in px."""
    told, prim = expected["camera"], camera.GetPrim()
    width, height = told["width"], told["height"]
    seen = camera.GetCamera(Usd.TimeCode.Default())
    seen.transform = cache.GetLocalToWorldTransform(prim)
    square = math.isclose(seen.aspectRatio, width / height, rel_tol=1e-5)
    findings.need(square, f"the film is {seen.aspectRatio} times as wide as high, the photo {width / height} times")
    frustum = seen.frustum
    view = np.array(frustum.ComputeViewMatrix())
    projection = np.array(frustum.ComputeProjectionMatrix())

    def project(point):
        at = np.array([*point, 1.0]) @ view
        x, y, _, w = at @ projection
        return (x / w + 1) / 2 * width, (1 - y / w) / 2 * height, -at[2]

    largest = check_pixels(findings, expected, placed, project, PIXEL_TOLERANCE)
    check_clipping(findings, expected, seen.clippingRange.min, seen.clippingRange.max)
    metres = seen.focalLength / 10  # USD counts a lens in tenths of a unit
    findings.need(0.001 <= metres <= 1.0, f"the lens has a focal length of {metres} m")
    focal, (cx, cy) = told["focal"], told["principal_point"]
    kept = {name: prim.GetAttribute(f"linecad:{name}").Get() for name in ("K", "imageWidth", "imageHeight")}
    same = (list(kept["K"] or []), kept["imageWidth"], kept["imageHeight"])
    wanted = ([focal, 0, cx, 0, focal, cy, 0, 0, 1], width, height)
    findings.need(same == wanted, f"the camera says {same}, expected {wanted}")
    return largest


def check_variants(findings, stage):
    variants = stage.GetDefaultPrim().GetVariantSets().GetVariantSet("content")
    names = variants.GetVariantNames()
    findings.need(sorted(names) == sorted(CONTENT), f"the variants of content are {names}, expected {list(CONTENT)}")
    chosen = variants.GetVariantSelection()
    findings.need(chosen == "full", f"the variant {chosen!r} is chosen, expected full")
    for name, shown in CONTENT.items():
        variants.SetVariantSelection(name)
        for kind, wanted in zip((UsdGeom.Curves, UsdGeom.Mesh), shown, strict=True):
            shapes = [UsdGeom.Imageable(prim) for prim in stage.Traverse() if prim.IsA(kind)]
            right = all((shape.ComputeVisibility() == UsdGeom.Tokens.inherited) == wanted for shape in shapes)
            findings.need(right, f"variant {name}: {kind.__name__} are not {'shown' if wanted else 'hidden'}")
    variants.SetVariantSelection("full")


def check_files(findings, path):
    """Everything that the stage needs is there, and a package is one that can be mapped into memory."""
    layers, assets, missing = UsdUtils.ComputeAllDependencies(str(path))
    findings.need(layers and not missing, f"what the stage needs is missing: {missing}")
    if path.suffix == ".usdz":
        with zipfile.ZipFile(path) as package:
            entries = package.infolist()
            findings.need(entries[0].filename.endswith(LAYERS), f"{entries[0].filename} comes first, not a layer")
            for entry in entries:
                findings.need(entry.compress_type == zipfile.ZIP_STORED, f"{entry.filename} is compressed")
                begin = entry.header_offset + 30  # a local header, then name and extra field, whose lengths it tells
                package.fp.seek(entry.header_offset + 26)
                begin += sum(int.from_bytes(package.fp.read(2), "little") for _ in range(2))
                findings.need(begin % 64 == 0, f"{entry.filename} begins at byte {begin}, no multiple of 64")
            inside = {entry.filename for entry in entries}
            needed = {str(asset).split("[")[-1].rstrip("]") for asset in itertools.chain(assets)}
            findings.need(needed <= inside, f"{sorted(needed - inside)} lie outside the package")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("file", type=Path)
    parser.add_argument("expectation", type=Path)
    chosen = parser.parse_args()
    expected = json.loads(chosen.expectation.read_text(encoding="utf-8"))
    return run(lambda findings: check(findings, chosen.file, expected))


if __name__ == "__main__":
    sys.exit(main())
