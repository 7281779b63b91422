"""OpenUSD stages, in metres, z up, as text, crate or package: https://openusd.org/release/spec.html

Lines are BasisCurves, one prim a group; faces are triangle meshes, those of a window below a prim of its own. USD's
camera has aperture offsets, so it is the photo's camera exactly. The variant set `content` shows all, the lines alone
or the faces alone.
"""

import io
import tempfile
import zipfile
from pathlib import Path

import numpy as np
from pxr import Gf, Kind, Sdf, Tf, Usd, UsdGeom, Vt

from exporters.beside import NO_FILES, Names, SideFiles
from exporters.camera import camera_to_world, clipping_range, line_width, principal_point
from exporters.colours import line_colour, linear
from exporters.model import LineGroup, Model
from exporters.textures.pages import Textures
from exporters.usd.attributes import set_display_colour, set_extent, set_own
from exporters.usd.faces import Places, add_face_materials, add_faces, within
from exporters.usd.materials import add_material, bind
from linecad.directions import axis_name
from linecad.io.files import UNFINISHED

_ROOT = Sdf.Path("/Reconstruction")
_LINES, _FACES, _SHAPES, _MATERIALS = map(_ROOT.AppendChild, ("Lines", "Faces", "Shapes", "Materials"))
_PACKAGED = "textures"  # the folder of the pictures in a package
_CONTENT = {"full": (True, True), "wireframe": (True, False), "faces": (False, True)}  # variant: lines, faces shown

_APERTURE = 0.36  # width of the film in tenths of a unit, as USD counts them: 36 mm where the unit is a metre
_LARGEST_INT32 = 2**31 - 1
_ALIGNMENT = 64  # bytes; a package's layers start at multiples of it, so that they can be mapped into memory
_PADDING_ID = 0x1986  # of the zip extra field that makes up the alignment, as USD's own writer calls it
_ZIP_LOCAL_HEADER = 30  # bytes before name and extra field
_EPOCH = (1980, 1, 1, 0, 0, 0)  # the earliest time of a zip entry; the real one would make each file another


def write(
    model: Model,
    path: Path,
    instances: bool = False,
    names: Names | None = None,
    textures: Textures | None = None,
) -> SideFiles:
    """Write the model as .usda, .usdc or .usdz, by the suffix of `path`; OSError where that fails.

    With `instances` equal openings are instances of one shape with one texture.
    The pages of the textures lie beside a stage, in the folder of `names`; without names, as a package, it holds them.
    """
    pages = {} if textures is None else textures.files
    if names is not None:
        _save(_build_stage(model, textures, names.folder, instances), path)
        return SideFiles(pages)
    with tempfile.TemporaryDirectory(prefix=UNFINISHED, dir=path.parent) as temporary:
        layer = Path(temporary) / "scene.usdc"
        _save(_build_stage(model, textures, _PACKAGED, instances), layer)
        files = {layer.name: layer.read_bytes()}
    files |= {f"{_PACKAGED}/{name}": data for name, data in pages.items()}
    path.write_bytes(_package(files))
    return NO_FILES


def _save(stage: Usd.Stage, path: Path) -> None:
    try:
        saved = stage.GetRootLayer().Export(str(path))
    except Tf.ErrorException as error:
        raise OSError("the USD library could not write it") from error
    if not saved:
        raise OSError("the USD library could not write it")


def _package(files: dict[str, bytes]) -> bytes:
    """A .usdz: a zip that holds files, the layer first, not compressed and aligned."""
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_STORED) as archive:
        for name, data in files.items():
            entry = zipfile.ZipInfo(name, _EPOCH)
            start = packed.tell() + _ZIP_LOCAL_HEADER + len(name) + 4  # 4: the extra field's own header
            missing = -start % _ALIGNMENT
            entry.extra = _PADDING_ID.to_bytes(2, "little") + missing.to_bytes(2, "little") + bytes(missing)
            archive.writestr(entry, data)
    return packed.getvalue()


def _build_stage(model: Model, textures: Textures | None, folder: str, instances: bool) -> Usd.Stage:
    # In memory first: a stage that is made as a file leaves half of it where the disk is full.
    stage = Usd.Stage.CreateInMemory()
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    stage.GetRootLayer().documentation = f"linecad: reconstruction of {model.photo}; {model.unit_note}"
    root = UsdGeom.Xform.Define(stage, _ROOT)
    stage.SetDefaultPrim(root.GetPrim())
    Usd.ModelAPI(root.GetPrim()).SetKind(Kind.Tokens.component)
    for path in (_LINES, _FACES, _MATERIALS):
        UsdGeom.Scope.Define(stage, path)
    for path, things in ((_LINES, model.groups), (_FACES, model.faces)):
        for component in sorted({thing.component for thing in things} - {0}):
            UsdGeom.Scope.Define(stage, within(path, component))
    for group in model.groups:
        _add_lines(stage, group, line_width(model, group.is_boundary))
    places = Places(_FACES, _SHAPES, _MATERIALS)
    add_face_materials(stage, places, model, textures, folder)
    add_faces(stage, places, model, textures, instances)
    _add_planes(root.GetPrim(), model)
    _add_camera(stage, model)
    _add_variants(stage, root.GetPrim())
    boxes = UsdGeom.BBoxCache(Usd.TimeCode.Default(), [UsdGeom.Tokens.default_])
    hint = UsdGeom.ModelAPI.Apply(root.GetPrim())
    hint.SetExtentsHint(hint.ComputeExtentsHint(boxes))
    return stage


def _add_lines(stage: Usd.Stage, group: LineGroup, width: float) -> None:
    curves = UsdGeom.BasisCurves.Define(stage, within(_LINES, group.component).AppendChild(group.name))
    curves.CreateTypeAttr(UsdGeom.Tokens.linear)
    curves.CreateWrapAttr(UsdGeom.Tokens.nonperiodic)
    curves.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(group.ends.reshape(-1, 3).astype(np.float32)))
    curves.CreateCurveVertexCountsAttr(Vt.IntArray(len(group.ids), 2))
    curves.CreateWidthsAttr(Vt.FloatArray([width]))
    curves.SetWidthsInterpolation(UsdGeom.Tokens.constant)
    set_extent(curves)
    colour = line_colour(group.axis, group.is_boundary)
    set_display_colour(curves, linear(colour))

    whole, wide = (Sdf.ValueTypeNames.IntArray, np.int32), (Sdf.ValueTypeNames.Int64Array, np.int64)
    kind, number = whole if group.ids.max() <= _LARGEST_INT32 else wide
    array = Vt.IntArray if number is np.int32 else Vt.Int64Array
    variables = UsdGeom.PrimvarsAPI(curves)
    ids = variables.CreatePrimvar("linecad:id", kind, UsdGeom.Tokens.uniform)
    ids.Set(array.FromNumpy(group.ids.astype(number)))
    boundary = variables.CreatePrimvar("linecad:boundary", Sdf.ValueTypeNames.BoolArray, UsdGeom.Tokens.uniform)
    boundary.Set(Vt.BoolArray(len(group.ids), group.is_boundary))
    if len(group.probability):
        told = variables.CreatePrimvar("linecad:probability", Sdf.ValueTypeNames.DoubleArray, UsdGeom.Tokens.uniform)
        told.Set(Vt.DoubleArray.FromNumpy(group.probability))
    roles = variables.CreatePrimvar("linecad:role", Sdf.ValueTypeNames.TokenArray, UsdGeom.Tokens.uniform)
    roles.Set(Vt.TokenArray(group.roles.tolist()))
    set_own(curves.GetPrim(), "linecad:direction", Sdf.ValueTypeNames.Token, axis_name(group.axis))

    material = _MATERIALS.AppendChild(group.name)
    add_material(stage, material, colour, emits=True)
    bind(stage, curves.GetPrim(), material)


def _add_planes(root: Usd.Prim, model: Model) -> None:
    """All planes, also those without a face, as three arrays on the root prim."""
    planes = model.planes
    set_own(root, "linecad:planeIds", Sdf.ValueTypeNames.Int64Array, Vt.Int64Array([plane.id for plane in planes]))
    axes = Vt.TokenArray([plane.axis for plane in planes])
    set_own(root, "linecad:planeAxes", Sdf.ValueTypeNames.TokenArray, axes)
    offsets = Vt.DoubleArray([plane.offset for plane in planes])
    set_own(root, "linecad:planeOffsets", Sdf.ValueTypeNames.DoubleArray, offsets)
    if any(plane.tilt for plane in planes):
        tilts = Vt.DoubleArray([plane.tilt for plane in planes])
        set_own(root, "linecad:planeTilts", Sdf.ValueTypeNames.DoubleArray, tilts)


def _add_camera(stage: Usd.Stage, model: Model) -> None:
    scene = model.scene
    width, height, focal = scene.camera.width, scene.camera.height, scene.camera.focal
    cx, cy = principal_point(scene.camera)
    camera = UsdGeom.Camera.Define(stage, _ROOT.AppendChild("PhotoCamera"))
    camera.CreateProjectionAttr(UsdGeom.Tokens.perspective)
    camera.CreateFocalLengthAttr(_APERTURE * focal / width)
    camera.CreateHorizontalApertureAttr(_APERTURE)
    camera.CreateVerticalApertureAttr(_APERTURE * height / width)
    camera.CreateHorizontalApertureOffsetAttr(_APERTURE * (0.5 - cx / width))
    camera.CreateVerticalApertureOffsetAttr(_APERTURE * height / width * (cy / height - 0.5))
    camera.CreateClippingRangeAttr(Gf.Vec2f(*clipping_range(model)))
    pose = Gf.Matrix4d(camera_to_world(scene.rotation, model.eye).T.tolist())  # USD multiplies rows from the left
    camera.AddTransformOp(UsdGeom.XformOp.PrecisionDouble).Set(pose)
    prim = camera.GetPrim()
    set_own(prim, "linecad:imageWidth", Sdf.ValueTypeNames.Int, width)
    set_own(prim, "linecad:imageHeight", Sdf.ValueTypeNames.Int, height)
    matrix = [focal, 0.0, cx, 0.0, focal, cy, 0.0, 0.0, 1.0]
    set_own(prim, "linecad:K", Sdf.ValueTypeNames.DoubleArray, Vt.DoubleArray(matrix))


def _add_variants(stage: Usd.Stage, root: Usd.Prim) -> None:
    variants = root.GetVariantSets().AddVariantSet("content")
    for name, shown in _CONTENT.items():
        variants.AddVariant(name)
        variants.SetVariantSelection(name)
        with variants.GetVariantEditContext():
            for path, visible in zip((_LINES, _FACES), shown, strict=True):
                visibility = UsdGeom.Tokens.inherited if visible else UsdGeom.Tokens.invisible
                UsdGeom.Imageable(stage.GetPrimAtPath(path)).CreateVisibilityAttr(visibility)
    variants.SetVariantSelection("full")
