"""The faces of a GLB: a mesh a face, or one for all equal ones; the faces of an opening under a node that is its place.

The origin of a face is its foot, so that programs turn and scale it there.

Equal openings share the numbers of their corners in any case. They share meshes where these carry no picture: a mesh
has one set of texture coordinates, so equal windows with a picture each need a mesh each.
"""

from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np
import trimesh
from trimesh.visual import TextureVisuals
from trimesh.visual.material import PBRMaterial

from exporters.faces import FlatFace
from exporters.model import FlatPlane, Model, in_component
from exporters.openings import Fitting
from exporters.textures.pages import Textures
from exporters.triangulation import triangulate
from linecad.arrays import Float
from linecad.directions import axis_name

Y_UP = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])  # (x, y, z) -> (x, z, -y)
_PLACEHOLDER = PBRMaterial()  # trimesh wants one; `set_materials` puts ours in its place

_Tree = dict[str, Any]  # the JSON document of a glTF file


class FaceMesh(NamedTuple):
    """The mesh of a face or of several equal ones."""

    name: str  # while the document is made: that of its first face
    label: str  # for people, in the file
    face: FlatFace  # its shape, in the frame of its nodes
    shown: FlatFace  # the face in its place whose part of the photo it carries


def meshes_of(model: Model, textures: Textures | None, instances: bool) -> dict[str, FaceMesh]:
    """The mesh of every face by the name of the face; equal faces have the same one where they can share it."""
    meshes = {face.name: FaceMesh(face.name, face.label, face.moved(-face.foot), face) for face in model.loose_faces}
    for equal in model.equal_fittings:
        for number, local in enumerate(equal[0].local_faces):
            faces = [fitting.faces[number] for fitting in equal]
            if len(faces) > 1 and (instances or textures is None):
                label = f"{local.kind} of shape {equal[0].shape}"
                shown = faces[0] if textures is None else textures.best_shown(faces)
                meshes |= dict.fromkeys((face.name for face in faces), FaceMesh(faces[0].name, label, local, shown))
            else:
                meshes |= {face.name: FaceMesh(face.name, face.label, local, face) for face in faces}
    return meshes


def add_parents(graph: trimesh.Scene, root: str, name: str, components: Iterable[int]) -> None:
    """Add the node of what is of component 0 below `root`, and in it one for each of the others."""
    graph.graph.update(frame_from=root, frame_to=name)
    for component in sorted({*components} - {0}):
        graph.graph.update(frame_from=name, frame_to=in_component(name, component))


def add_faces(
    graph: trimesh.Scene, parent: str, model: Model, meshes: dict[str, FaceMesh], textures: Textures | None
) -> None:
    """Add the nodes of all faces and openings below `parent`, or below the node of their component in it."""
    for mesh in dict.fromkeys(meshes.values()):
        coordinates = None if textures is None else textures.coordinates(mesh.shown, model.eye)
        graph.geometry[mesh.name] = _trimesh(mesh.face, coordinates)
    for face in model.loose_faces:
        graph.graph.update(
            frame_from=in_component(parent, face.component), frame_to=face.name, matrix=_pose(face.foot),
            geometry=meshes[face.name].name,
        )  # fmt: skip
    for fitting in model.fittings:
        graph.graph.update(
            frame_from=in_component(parent, fitting.component), frame_to=fitting.label, matrix=_pose(fitting.place)
        )
        for face in fitting.faces:
            graph.graph.update(frame_from=fitting.label, frame_to=face.name, geometry=meshes[face.name].name)


def _pose(place: Float) -> Float:
    """(4, 4) where a node stands in its parent, of a place in the scene."""
    pose = np.eye(4)
    pose[:3, 3] = Y_UP @ place
    return pose


def _trimesh(face: FlatFace, coordinates: Float | None) -> trimesh.Trimesh:
    return trimesh.Trimesh(
        face.vertices @ Y_UP.T,
        triangulate(face),
        process=False,
        visual=TextureVisuals(uv=coordinates, material=_PLACEHOLDER),
        vertex_normals=np.tile(Y_UP @ face.normal, (len(face.vertices), 1)),
    )


def describe_faces(tree: _Tree, model: Model, meshes: dict[str, FaceMesh]) -> None:
    """Complete the document: nodes say what they are, and meshes are named for people."""
    labels = {mesh.name: mesh.label for mesh in meshes.values()}
    for mesh in tree["meshes"]:
        mesh["name"] = labels.get(mesh["name"], mesh["name"])
    told = {face.name: _told_of_face(face) for face in model.faces}
    told |= {fitting.label: _told_of_fitting(fitting) for fitting in model.fittings}
    places = {face.name: face.foot for face in model.loose_faces}
    places |= {fitting.label: fitting.place for fitting in model.fittings}
    for node in tree["nodes"]:
        if node["name"] in told:
            node["extras"] = told[node["name"]]
        if node["name"] in places:
            node.pop("matrix", None)  # which people cannot read
            node["translation"] = (Y_UP @ places[node["name"]]).tolist()


def tilted(flat: FlatFace | FlatPlane) -> _Tree:
    """What a sloped plane has beside its axis."""
    return {"tilt": flat.tilt} if flat.tilt else {}


def _told_of_face(face: FlatFace) -> _Tree:
    return {
        "face_id": face.id,
        "kind": face.kind,
        "label": face.label,
        "plane_id": face.plane,
        "axis": axis_name(face.axis),
        "offset": face.offset,
        **tilted(face),
        **({} if face.opening is None else {"opening": face.opening}),
    }


def _told_of_fitting(fitting: Fitting) -> _Tree:
    return {"opening": fitting.id, "shape": fitting.shape, "kind": fitting.kind, "label": fitting.label}
