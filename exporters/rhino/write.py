"""3DM, Rhino 6 and newer, in metres: https://developer.rhino3d.com/guides/opennurbs/

Lines are curves on one layer a group below `lines`. Faces are trimmed planes with holes on one layer a kind, walls,
ground and the like below `faces`, the panes and reveals of windows and doors below `openings`; those of one opening are
a group. The same faces as triangles, for programs that cannot make any, lie on hidden layers below `meshes`. What an
object is stands in its name and its user text. A point is where the camera stood; its user text tells all about the
camera, the photo and the unit. Needs the extra `rhino`.
"""

import base64
import uuid
from collections.abc import Mapping
from pathlib import Path

import rhino3dm

from exporters.camera import principal_point
from exporters.colours import RGB, face_colour, line_colour
from exporters.faces import FlatFace
from exporters.identity import identity_of
from exporters.model import LineGroup, Model, in_component
from exporters.rhino.archive import without_dates
from exporters.rhino.faces import build_brep, build_mesh
from linecad.directions import axis_name

_VERSION = 6  # of the file; 7 and newer hold nothing more of what is written here
_LINES, _FACES, _OPENINGS, _MESHES, _CAMERA = "lines", "faces", "openings", "meshes", "camera"
_GREY: RGB = (0.35, 0.35, 0.35)  # of layers that hold layers


def write(model: Model, path: Path) -> None:
    """Write the model as 3DM to `path`; OSError where that fails."""
    drawing = _Drawing(model)
    for group in model.groups:
        drawing.add_lines(group)
    for face in model.faces:
        drawing.add_face(face)
    drawing.add_camera()
    path.write_bytes(drawing.data())


class _Drawing:
    """A file of Rhino's that objects are added to, each with an id that follows from the scene."""

    def __init__(self, model: Model) -> None:
        self._model = model
        self._ids = identity_of(model.scene)
        self._file = rhino3dm.File3dm()
        self._file.Settings.ModelUnitSystem = rhino3dm.UnitSystem.Meters
        self._layers: dict[str, int] = {}
        self._groups: dict[int, int] = {}
        for number, fitting in enumerate(model.fittings):
            group = rhino3dm.Group()
            group.Name, group.Id = fitting.label, self._id(f"group {fitting.id}")
            self._file.Groups.Add(group)  # which says nothing of its number
            self._groups[fitting.id] = number

    def data(self) -> bytes:
        """The whole file."""
        options = rhino3dm.File3dmWriteOptions()
        options.Version = _VERSION
        return without_dates(base64.b64decode(self._file.Encode(options)))

    def add_lines(self, group: LineGroup) -> None:
        """Add the lines of a group on its layer."""
        layer = self._layer(group.name, line_colour(group.axis, group.is_boundary), _LINES)
        told = map(repr, group.probability.tolist()) if len(group.probability) else [""] * len(group.ids)
        each = zip(group.ids.tolist(), group.ends.tolist(), group.roles.tolist(), told, strict=True)
        for number, (start, end), role, probability in each:
            words = {"axis": axis_name(group.axis), "boundary": str(group.is_boundary).lower(), "role": role}
            words |= {"probability": probability} if probability else {}
            what = self._attributes(f"line {number}", layer, {"id": str(number), **words})
            self._file.Objects.AddLine(rhino3dm.Point3d(*start), rhino3dm.Point3d(*end), what)

    def add_face(self, face: FlatFace) -> None:
        """Add a face on the layer of its kind, and its triangles on a hidden one."""
        parent = _FACES if face.opening is None else _OPENINGS
        self._file.Objects.AddBrep(build_brep(face), self._of_face(face, parent, "face"))
        self._file.Objects.AddMesh(build_mesh(face), self._of_face(face, _MESHES, "mesh"))

    def _of_face(self, face: FlatFace, parent: str, key: str) -> rhino3dm.ObjectAttributes:
        layer = self._layer(in_component(f"{parent}_{face.kind}", face.component), face_colour(face.kind), parent)
        words = {"id": str(face.id), "face": face.name, "kind": face.kind, "plane": str(face.plane)}
        if face.opening is not None:
            words["opening"] = str(face.opening)
        what = self._attributes(f"{key} {face.id}", layer, words)
        what.Name = face.label
        if face.opening is not None:
            what.AddToGroup(self._groups[face.opening])
        return what

    def add_camera(self) -> None:
        """Add a point where the camera stood, whose user text tells all about it and the file."""
        scene = self._model.scene
        words = {
            "unit": self._model.unit_note,
            "photo": self._model.photo,
            "size": f"{scene.camera.width} x {scene.camera.height} px",
            "focal length": f"{scene.camera.focal!r} px",
            "principal point": "{!r} {!r} px from the top left corner".format(*principal_point(scene.camera)),
            "position": " ".join(map(repr, self._model.eye.tolist())),
            "from world": " ".join(map(repr, scene.rotation.ravel().tolist())),
        }
        what = self._attributes("camera", self._layer(_CAMERA, _GREY), words)
        self._file.Objects.AddPoint(rhino3dm.Point3d(*self._model.eye.tolist()), what)

    def _layer(self, name: str, colour: RGB, parent: str = "") -> int:
        """The number of a layer, which is made where it is not there yet, as its parent is."""
        if name not in self._layers:
            layer = rhino3dm.Layer()
            if parent:
                layer.ParentLayerId = self._file.Layers[self._layer(parent, _GREY)].Id
            layer.Name, layer.Id = name, self._id(f"layer {name}")
            layer.Visible = _MESHES not in (name, parent)
            layer.Color = (*(round(255 * value) for value in colour), 255)
            self._layers[name] = self._file.Layers.Add(layer)
        return self._layers[name]

    def _attributes(self, name: str, layer: int, words: Mapping[str, str]) -> rhino3dm.ObjectAttributes:
        what = rhino3dm.ObjectAttributes()
        what.Name, what.Id, what.LayerIndex = name, self._id(name), layer
        for key, word in words.items():
            what.SetUserString(f"linecad {key}", word)
        return what

    def _id(self, key: str) -> uuid.UUID:
        return uuid.uuid5(self._ids, key)
