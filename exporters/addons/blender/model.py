"""The model of a photo in Blender: what the command wrote, as a collection with its camera and the photo behind it."""

import contextlib
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import bmesh
import bpy
import numpy as np

from exporters.addons.running import AddonError, Request
from exporters.addons.told import (
    GROUPINGS,
    Line,
    SceneFile,
    groups_of,
    is_shown,
    read_scene_file,
    write_photo,
)

SENSOR = 36.0  # mm, as the guide has it
WEIGHTS = "probability"  # the vertex group that holds it for each line, and the name of the property on faces
MASK = "confidence"  # the modifier that hides lines
JUST_BELOW = 1e-6  # Blender's mask shows what is above its threshold; as much as asked for shall be shown too
TAG = "linecad_groups"  # the property of what was imported: its groups by the names of GROUPINGS
FACES = "faces"


def import_model(context: Any, request: Request) -> Any:
    """Import what the command wrote, in place of the earlier model of this photo; its collection."""
    told, photo = read_scene_file(request.output(".json")), write_photo(request)  # before anything is removed
    confidence, grouping = 0.0, GROUPINGS[0][0]
    for former in models_of(request.photo):
        confidence, grouping = former.linecad.confidence, former.linecad.grouping
        remove_model(former)
    before = set(bpy.data.objects)
    with _numpy_of_old():
        bpy.ops.import_scene.gltf(filepath=str(request.output(".glb")))
    root = bpy.data.collections.new(request.photo.stem)
    context.scene.collection.children.link(root)
    for item in [item for item in bpy.data.objects if item not in before]:
        for part in _parts_of(item, told):
            if TAG not in part:
                part[TAG] = {}
            for place in part.users_collection:
                place.objects.unlink(part)
            root.objects.link(part)
            part.select_set(False)  # what is selected is drawn in one colour
            if part.type == "CAMERA":
                set_camera(context.scene, part, photo)
    root.linecad.photo = str(request.photo)
    root.linecad.has_probabilities = any(line.probability is not None for line in told.lines.values())
    root.linecad.grouping, root.linecad.confidence = grouping, confidence  # which arrange and hide
    return root


@contextlib.contextmanager
def _numpy_of_old() -> Iterator[None]:
    """Blender 3.4's importer asks for a name that NumPy 1.24 took away, which Debian has."""
    missing = "bool" not in vars(np)
    if missing:
        np.bool = bool  # type: ignore[misc, assignment]
    try:
        yield
    finally:
        if missing:
            del np.bool


def _parts_of(item: Any, told: SceneFile) -> list[Any]:
    """The object itself, told what it is; of an object of lines one for each part."""
    if item.type == "MESH" and "line_ids" in item.data:
        return _split(item, told.lines)
    if item.type == "MESH" and "face_id" in item:
        face = told.faces[item["face_id"]]
        item[TAG] = {FACES: face.kind}
        if face.probability is not None:
            item[WEIGHTS] = face.probability
    return [item]


def _split(item: Any, lines: dict[int, Line]) -> list[Any]:
    """Objects of the lines of one role, band and component each, in place of one of lines of one axis and kind."""
    ids, roles = list(item.data["line_ids"]), list(item.data["roles"])
    of_a_line = len(item.data.vertices) // len(ids)
    if of_a_line * len(ids) != len(item.data.vertices):
        raise AddonError(f"{item.name} has {len(item.data.vertices)} points for {len(ids)} lines; report this")
    places: dict[str, list[int]] = {}
    for place, number in enumerate(ids):
        places.setdefault(lines[number].part, []).append(place)
    made = []
    for name, chosen in places.items():
        own = [ids[place] for place in chosen]
        part = item.copy()
        part.name, part.data = name, _mesh_of(item.data, set(chosen), of_a_line)
        part.data.name = name
        part.data["line_ids"], part.data["roles"] = own, [roles[place] for place in chosen]
        part[TAG] = lines[own[0]].groups()
        if lines[own[0]].probability is not None:
            probabilities = [float(lines[number].probability or 0.0) for number in own]
            part.data["probabilities"] = probabilities
            _weigh(part, probabilities, of_a_line)
        made.append(part)
    _remove([item])
    return made


def _mesh_of(whole: Any, chosen: set[int], of_a_line: int) -> Any:
    """A mesh of the lines at these places of another one."""
    mesh, points = whole.copy(), bmesh.new()
    points.from_mesh(mesh)
    gone = [point for place, point in enumerate(points.verts) if place // of_a_line not in chosen]
    bmesh.ops.delete(points, geom=gone, context="VERTS")
    points.to_mesh(mesh)
    points.free()
    return mesh


def _weigh(part: Any, probabilities: list[float], of_a_line: int) -> None:
    """Let a mask hide lines by their probability, which is the weight of their points."""
    group = part.vertex_groups.new(name=WEIGHTS)
    for place, probability in enumerate(probabilities):
        group.add(list(range(place * of_a_line, (place + 1) * of_a_line)), probability, "REPLACE")
    mask = part.modifiers.new(MASK, "MASK")
    mask.vertex_group = WEIGHTS


def set_camera(scene: Any, camera: Any, photo: Path) -> None:
    """Make a camera of a GLB the photo's, with the photo behind the model, and the scene's."""
    width, height = camera["linecad_width"], camera["linecad_height"]
    scene.render.resolution_x, scene.render.resolution_y = int(width), int(height)
    scene.render.resolution_percentage = 100
    scene.render.pixel_aspect_x = scene.render.pixel_aspect_y = 1.0
    lens = camera.data
    lens.sensor_fit, lens.sensor_width = "HORIZONTAL", SENSOR
    lens.lens = SENSOR * camera["linecad_fx"] / width
    lens.shift_x = (width / 2 - camera["linecad_cx"]) / width
    lens.shift_y = (camera["linecad_cy"] - height / 2) / width
    scene.camera = camera
    lens.show_background_images = True
    behind = lens.background_images.new()
    behind.image = bpy.data.images.load(str(photo))
    behind.image.pack()  # the .blend file holds it, wherever the folder goes
    behind.alpha, behind.display_depth, behind.frame_method = 1.0, "BACK", "FIT"


def models_of(photo: Path) -> list[Any]:
    """The collections of the models of a photo: one or none, but for copies that somebody made."""
    return [each for each in bpy.data.collections if each.linecad.photo == str(photo)]


def remove_model(root: Any) -> None:
    """Remove what was imported; what somebody put into the collection goes to the scene's own."""
    own = [item for item in objects_of(root) if TAG in item]
    others = [item for item in objects_of(root) if TAG not in item]
    for item in others:
        if len(item.users_collection) == 1:
            bpy.context.scene.collection.objects.link(item)
    _remove(own)
    for each in [*root.children_recursive, root]:
        bpy.data.collections.remove(each)


def _remove(items: Iterable[Any]) -> None:
    """Remove objects, with the data, materials and pictures that only they used."""
    chosen = list(items)
    data = {item.data for item in chosen if item.data is not None}
    lenses = [each for each in data if isinstance(each, bpy.types.Camera)]
    materials = {each for mesh in data if isinstance(mesh, bpy.types.Mesh) for each in mesh.materials if each}
    nodes = [node for each in materials if each.use_nodes for node in each.node_tree.nodes]
    pictures = {node.image for node in nodes if node.type == "TEX_IMAGE"}
    pictures |= {behind.image for lens in lenses for behind in lens.background_images}
    bpy.data.batch_remove(chosen)
    for kind in (data, materials, pictures - {None}):
        bpy.data.batch_remove([each for each in kind if not each.users])


def objects_of(root: Any) -> list[Any]:
    """The objects of a model; a copy, because Blender frees its own list where an object in it changes."""
    return list(root.all_objects)


def arrange(root: Any) -> None:
    """Put objects of lines into collections by the chosen grouping, and faces by what they are."""
    groups = {item.name: item[TAG].to_dict() for item in objects_of(root) if TAG in item}
    for each in list(root.children_recursive):
        for item in list(each.objects):
            if item.name not in root.objects:
                root.objects.link(item)
            each.objects.unlink(item)
        bpy.data.collections.remove(each)
    for by, parent_name in ((root.linecad.grouping, "lines"), (FACES, FACES)):
        parts = {name: told for name, told in groups.items() if by in told}
        if not parts:
            continue
        parent = bpy.data.collections.new(parent_name)
        root.children.link(parent)
        for group, names in groups_of(parts, by).items():
            child = bpy.data.collections.new(group)
            parent.children.link(child)
            for name in names:
                child.objects.link(root.objects[name])
                root.objects.unlink(root.objects[name])


def hide(root: Any) -> None:
    """Hide lines and faces that are less sure than was chosen, in the view and in renders."""
    confidence = root.linecad.confidence
    for item in objects_of(root):
        mask = item.modifiers.get(MASK)
        if mask is not None:
            mask.show_viewport = mask.show_render = confidence > 0
            mask.threshold = max(0.0, confidence - JUST_BELOW)
        elif "face_id" in item:
            item.hide_viewport = item.hide_render = not is_shown(item.get(WEIGHTS), confidence)
