"""The faces of a stage: a mesh each, those of an opening below a prim that is its place.

Equal openings refer to one shape below `Shapes`, a class that nothing draws. What is a face's own, its ids, its texture
coordinates and its material, stands on the mesh itself, and every program finds the mesh under its own name. As
instances, whole openings refer to their shape and programs keep it once; then no face of them has its own name or place
on the photo.
"""

from dataclasses import dataclass

import numpy as np
from pxr import Gf, Sdf, Usd, UsdGeom, Vt

from exporters.colours import face_colour, face_colour_name, linear
from exporters.faces import FlatFace
from exporters.model import Model
from exporters.openings import Fitting
from exporters.textures.pages import Textures
from exporters.triangulation import triangulate
from exporters.usd.attributes import set_display_colour, set_extent, set_own
from exporters.usd.materials import add_material, add_photo_material, bind, set_coordinates
from linecad.directions import axis_name

_LARGEST_INT32 = 2**31 - 1


@dataclass(frozen=True)
class Places:
    """Where in a stage things stand."""

    faces: Sdf.Path
    shapes: Sdf.Path
    materials: Sdf.Path


def add_face_materials(stage: Usd.Stage, places: Places, model: Model, textures: Textures | None, folder: str) -> None:
    """Add what faces look like: pictures in `folder`, or a colour a kind."""
    if textures is None:
        for name, colour in sorted(
            {face_colour_name(face.kind): face_colour(face.kind) for face in model.faces}.items()
        ):
            add_material(stage, places.materials.AppendChild(name), colour, emits=False)
    else:
        for number, page in enumerate(textures.pages):
            add_photo_material(stage, places.materials.AppendChild(_photo(number)), f"{folder}/{page.name}")


def add_faces(stage: Usd.Stage, places: Places, model: Model, textures: Textures | None, instances: bool) -> None:
    """Add all faces; their materials must be there."""
    writer = _Writer(stage, places, model, textures)
    for face in model.loose_faces:
        writer.add_face(within(places.faces, face.component), face)
    if any(len(equal) > 1 for equal in model.equal_fittings):
        stage.CreateClassPrim(places.shapes)
    shape_of: dict[int, Sdf.Path] = {}
    for number, equal in enumerate(model.equal_fittings):
        if len(equal) > 1:
            shape = places.shapes.AppendChild(f"shape_{number}")
            writer.add_shape(shape, equal, whole=instances)
            shape_of |= {fitting.id: shape for fitting in equal}
    for fitting in model.fittings:
        writer.add_fitting(fitting, shape_of.get(fitting.id), instances)


@dataclass(frozen=True, eq=False)
class _Writer:
    stage: Usd.Stage
    places: Places
    model: Model
    textures: Textures | None

    def add_face(self, parent: Sdf.Path, face: FlatFace) -> None:
        """A face by itself, with its foot as its origin."""
        mesh = self._define(parent, face.name, face.moved(-face.foot))
        mesh.AddTranslateOp(UsdGeom.XformOp.PrecisionDouble).Set(Gf.Vec3d(*face.foot.tolist()))
        self._set_own(mesh, face)
        self._cover(mesh, face)

    def add_shape(self, path: Sdf.Path, equal: tuple[Fitting, ...], whole: bool) -> None:
        """The shape of equal openings; `whole` with all that instances need, else what their meshes have in common."""
        UsdGeom.Xform.Define(self.stage, path)
        for number, face in enumerate(equal[0].local_faces):
            mesh = self._define(path, _part(number), face)
            if whole:
                alike = [fitting.faces[number] for fitting in equal]
                self._cover(mesh, alike[0] if self.textures is None else self.textures.best_shown(alike))

    def add_fitting(self, fitting: Fitting, shape: Sdf.Path | None, instances: bool) -> None:
        """An opening at its place, by its shape where it has one."""
        path = within(self.places.faces, fitting.component).AppendChild(fitting.key)
        place = UsdGeom.Xform.Define(self.stage, path)
        place.AddTranslateOp(UsdGeom.XformOp.PrecisionDouble).Set(Gf.Vec3d(*fitting.place.tolist()))
        prim = place.GetPrim()
        prim.SetDisplayName(fitting.label)
        set_own(prim, "linecad:opening", Sdf.ValueTypeNames.Int64, fitting.id)
        set_own(prim, "linecad:shape", Sdf.ValueTypeNames.Int64, fitting.shape)
        set_own(prim, "linecad:kind", Sdf.ValueTypeNames.Token, fitting.kind)
        set_own(prim, "linecad:label", Sdf.ValueTypeNames.String, fitting.label)
        ids = Vt.Int64Array([face.id for face in fitting.faces])
        set_own(prim, "linecad:faceIds", Sdf.ValueTypeNames.Int64Array, ids)
        if shape is not None and instances:
            prim.GetReferences().AddInternalReference(shape)
            prim.SetInstanceable(True)
            return
        for number, (face, local) in enumerate(zip(fitting.faces, fitting.local_faces, strict=True)):
            if shape is None:
                mesh = self._define(path, face.name, local)
            else:
                mesh = UsdGeom.Mesh.Define(self.stage, path.AppendChild(face.name))
                mesh.GetPrim().GetReferences().AddInternalReference(shape.AppendChild(_part(number)))
            self._set_own(mesh, face)
            self._cover(mesh, face)

    def _define(self, parent: Sdf.Path, name: str, face: FlatFace) -> UsdGeom.Mesh:
        """A mesh of what equal faces have in common."""
        triangles = triangulate(face)
        mesh = UsdGeom.Mesh.Define(self.stage, parent.AppendChild(name))
        mesh.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(face.vertices.astype(np.float32)))
        mesh.CreateFaceVertexCountsAttr(Vt.IntArray(len(triangles), 3))
        mesh.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(triangles.astype(np.int32).ravel()))
        mesh.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)  # the default would round all corners off
        mesh.CreateDoubleSidedAttr(True)
        mesh.CreateOrientationAttr(UsdGeom.Tokens.rightHanded)
        mesh.CreateNormalsAttr(Vt.Vec3fArray(len(face.vertices), Gf.Vec3f(*face.normal.tolist())))
        mesh.SetNormalsInterpolation(UsdGeom.Tokens.vertex)
        set_extent(mesh)
        set_display_colour(mesh, linear(face_colour(face.kind)))
        prim = mesh.GetPrim()
        set_own(prim, "linecad:kind", Sdf.ValueTypeNames.Token, face.kind)
        set_own(prim, "linecad:planeAxis", Sdf.ValueTypeNames.Token, axis_name(face.axis))
        if face.tilt:
            set_own(prim, "linecad:planeTilt", Sdf.ValueTypeNames.Double, face.tilt)
        counts = Vt.IntArray([len(ring) for ring in face.rings])
        set_own(prim, "linecad:ringCounts", Sdf.ValueTypeNames.IntArray, counts)
        return mesh

    def _set_own(self, mesh: UsdGeom.Mesh, face: FlatFace) -> None:
        """What no two faces have in common."""
        prim = mesh.GetPrim()
        prim.SetDisplayName(face.name)
        id_type = Sdf.ValueTypeNames.Int if face.id <= _LARGEST_INT32 else Sdf.ValueTypeNames.Int64
        set_own(prim, "linecad:faceId", id_type, face.id)
        set_own(prim, "linecad:label", Sdf.ValueTypeNames.String, face.label)
        set_own(prim, "linecad:planeOffset", Sdf.ValueTypeNames.Double, face.offset)

    def _cover(self, mesh: UsdGeom.Mesh, face: FlatFace) -> None:
        """Give a mesh the material of a face, and its part of the photo where there is one."""
        name = face_colour_name(face.kind)
        if self.textures is not None:
            set_coordinates(mesh, self.textures.coordinates(face, self.model.eye))
            name = _photo(self.textures.page(face))
        bind(self.stage, mesh.GetPrim(), self.places.materials.AppendChild(name))


def within(path: Sdf.Path, component: int) -> Sdf.Path:
    """Where below `path` what is of a component stands: that of component 0 right below it."""
    return path.AppendChild(f"component_{component}") if component else path


def _part(number: int) -> str:
    return f"part_{number}"


def _photo(page: int) -> str:
    return f"photo_{page}"
