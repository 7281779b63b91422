"""Binary glTF 2.0 (GLB), in metres, y up: https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html

trimesh packs the geometry. Its document is completed here, because trimesh gives all lines one white lit material,
leaves out the targets of buffer views that the format's validator asks for, and writes cameras with another aspect
ratio than theirs.

A glTF camera looks through the middle of its picture. So ours spans the smallest frame about the principal point that
holds the photo, and its extras `linecad_...` tell that frame and the camera matrix; pixels count from the corner.

Line ids stand in the extras of each group of lines, and as vertex attribute _LINEID where all ids of the group are
small enough for a float32, the only kind of number that holds them there. The roles of the lines stand in the extras
too, and the probabilities that their depths are right, where the scene tells them.

The node of a face has its name by id and says what it is in its extras; its mesh has a name for people, such as
`wall 3`. The faces of an opening stand below a node such as `window 12`, whose translation is the place of the opening.

Renderers leave out what has no surface. So the lines can be written as thin tubes instead.
"""

import math
from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from trimesh.exchange.gltf import export_glb
from trimesh.path import Path3D
from trimesh.path.entities import Line

from exporters.camera import camera_to_world, clipping_range, line_width, padded_frame, principal_point
from exporters.gltf.faces import Y_UP, add_faces, add_parents, describe_faces, meshes_of, tilted
from exporters.gltf.materials import add_pictures, set_materials
from exporters.gltf.tubes import build_tubes
from exporters.model import LineGroup, Model, in_component
from exporters.textures.pages import Textures
from linecad.directions import axis_name

_ROOT, _LINES, _FACES, _CAMERA = "linecad", "lines", "faces", "photo_camera"  # names of nodes
_LARGEST_EXACT_FLOAT32 = 2**24  # all integers up to here have their own float32
_VERTEX_TARGET, _INDEX_TARGET = 34962, 34963  # bufferView.target: ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER

_Tree = dict[str, Any]  # the JSON document of a glTF file


def write(
    model: Model, path: Path, tubes: bool = False, instances: bool = False, textures: Textures | None = None
) -> None:
    """Write the model as GLB to `path`, its lines as tubes where that is asked for; OSError where that fails.

    With `instances` equal openings share their meshes with one texture.
    """
    meshes = meshes_of(model, textures, instances)

    def add_to_buffer(buffer: Any, _: _Tree) -> None:
        if textures is not None:
            add_pictures(buffer, textures)

    def complete(tree: _Tree) -> None:
        tree["asset"]["generator"] = "linecad"
        tree["asset"]["extras"] = {"linecad_unit": model.unit_note, "linecad_photo": model.photo}
        set_materials(tree, model, meshes, textures)
        describe_faces(tree, model, meshes)
        _set_targets(tree)
        _add_camera(tree, model)
        _add_planes(tree, model)

    graph = _build_scene(model, tubes)
    if model.faces:
        add_parents(graph, _ROOT, _FACES, [face.component for face in model.faces])
        add_faces(graph, _FACES, model, meshes, textures)
    path.write_bytes(
        export_glb(graph, include_normals=True, tree_postprocessor=complete, buffer_postprocessor=add_to_buffer)
    )


def _build_scene(model: Model, tubes: bool) -> trimesh.Scene:
    """The nodes and the lines."""
    graph = trimesh.Scene(base_frame="world")
    graph.graph.update(frame_from="world", frame_to=_ROOT)
    if model.groups:
        add_parents(graph, _ROOT, _LINES, [group.component for group in model.groups])
    for group in model.groups:
        width = line_width(model, group.is_boundary)
        lines = _tubes(group, width) if tubes else _path(group)
        graph.add_geometry(
            lines, node_name=group.name, geom_name=group.name, parent_node_name=in_component(_LINES, group.component)
        )
    return graph


def _path(group: LineGroup) -> Path3D:
    path = Path3D(
        entities=[Line([2 * number, 2 * number + 1]) for number in range(len(group.ids))],
        vertices=group.ends.reshape(-1, 3) @ Y_UP.T,
        process=False,  # merged points would be shared by lines, which have their own ids
        metadata=_told(group),
    )
    _set_ids(path, group, 2)
    return path


def _tubes(group: LineGroup, width: float) -> trimesh.Trimesh:
    """The lines of a group as one mesh of closed tubes."""
    vertices, triangles, normals = build_tubes(group.ends, width / 2)
    mesh = trimesh.Trimesh(
        vertices @ Y_UP.T, triangles, process=False, vertex_normals=normals @ Y_UP.T, metadata=_told(group)
    )
    _set_ids(mesh, group, len(vertices) // len(group.ids))
    return mesh


def _told(group: LineGroup) -> _Tree:
    told = {"probabilities": group.probability.tolist()} if len(group.probability) else {}
    return {
        "axis": axis_name(group.axis),
        "boundary": group.is_boundary,
        "line_ids": group.ids.tolist(),
        "roles": group.roles.tolist(),
        **told,
    }


def _set_ids(shape: Path3D | trimesh.Trimesh, group: LineGroup, vertices_per_line: int) -> None:
    if group.ids.max() <= _LARGEST_EXACT_FLOAT32:
        shape.vertex_attributes["_LINEID"] = np.repeat(group.ids, vertices_per_line).astype(np.float32)


def _set_targets(tree: _Tree) -> None:
    views, accessors = tree["bufferViews"], tree["accessors"]
    for mesh in tree["meshes"]:
        for primitive in mesh["primitives"]:
            for accessor in primitive["attributes"].values():
                views[accessors[accessor]["bufferView"]]["target"] = _VERTEX_TARGET
            if "indices" in primitive:
                views[accessors[primitive["indices"]]["bufferView"]]["target"] = _INDEX_TARGET


def _add_camera(tree: _Tree, model: Model) -> None:
    scene, camera = model.scene, model.scene.camera
    frame = padded_frame(camera)
    cx, cy = principal_point(camera)
    near, far = clipping_range(model)
    extras = {
        "linecad_width": camera.width,
        "linecad_height": camera.height,
        "linecad_fx": camera.focal,
        "linecad_fy": camera.focal,
        "linecad_cx": cx,
        "linecad_cy": cy,
        "linecad_padded_width": frame.width,
        "linecad_padded_height": frame.height,
        "linecad_pad_left": frame.left,
        "linecad_pad_top": frame.top,
    }
    perspective = {
        "yfov": 2.0 * math.atan(frame.height / (2.0 * camera.focal)),
        "aspectRatio": frame.width / frame.height,
        "znear": near,
        "zfar": far,
    }
    tree["cameras"] = [{"type": "perspective", "name": _CAMERA, "perspective": perspective, "extras": extras}]
    pose = camera_to_world(scene.rotation, model.eye)
    pose[:3] = Y_UP @ pose[:3]
    matrix = pose.T.ravel().tolist()  # glTF stores columns
    tree["nodes"].append({"name": _CAMERA, "camera": 0, "matrix": matrix, "extras": extras})
    _node(tree, _ROOT)["children"].append(len(tree["nodes"]) - 1)


def _add_planes(tree: _Tree, model: Model) -> None:
    planes = [
        {"id": plane.id, "axis": plane.axis, "offset": plane.offset, "lines": list(plane.lines), **tilted(plane)}
        for plane in model.planes
    ]
    tree["scenes"][tree["scene"]]["extras"] = {"linecad_planes": planes}


def _node(tree: _Tree, name: str) -> _Tree:
    node: _Tree = next(node for node in tree["nodes"] if node.get("name") == name)
    return node
