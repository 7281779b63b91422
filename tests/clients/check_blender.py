"""Open a GLB or USD in Blender and look at the lines through the camera that came with it.

blender -b --factory-startup --python-exit-code 3 --python check_blender.py -- FILE.glb EXPECTATION.json [...]
python check_blender.py FILE.glb|usda|usdc|usdz EXPECTATION.json [...]      with the module bpy, which also reads USD

--textures needs a picture on every face; --render PICTURE.png --photo PHOTO renders the faces through the camera and
compares the picture with the photo.
"""

import argparse
import json
import math
import os
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))  # Blender does not

import bpy
import numpy as np
from bpy_extras.object_utils import world_to_camera_view
from mathutils import Vector

from rendering import check_render
from shapes import apart, check_clipping, check_colour, check_face, check_lines, check_names, check_pixels
from verdict import run

TOLERANCE = 1e-4  # m; the formats and Blender store points as float32
PIXEL_TOLERANCE = 0.25  # px; the camera is float32 too
COLOUR_TOLERANCE = 1e-3
PROPERTIES = ("width", "height", "fx", "fy", "cx", "cy", "padded_width", "padded_height", "pad_left", "pad_top")


def check(findings, chosen):
    """Note all problems of the file; returns a summary."""
    expected = json.loads(chosen.expectation.read_text(encoding="utf-8"))
    is_gltf = chosen.file.suffix == ".glb"
    open_file(chosen.file, is_gltf)
    shapes = [item for item in bpy.data.objects if item.type in ("MESH", "CURVE", "CURVES")]
    meshes = [item for item in shapes if item.type == "MESH" and len(item.data.polygons)]
    lines = [item for item in shapes if item not in meshes]
    check_names(findings, "objects of lines", [item.name for item in lines], expected["groups"])
    placed = check_lines(findings, expected, {item.name: segments_of(item) for item in lines}, TOLERANCE)
    faces = {face["name"]: face for face in expected["faces"]}
    check_names(findings, "meshes of faces", [item.name for item in meshes], faces)
    for item in meshes:
        if item.name in faces:
            points, triangles = triangles_of(item)
            check_face(findings, faces[item.name], points, triangles, TOLERANCE)
            if is_gltf:
                check_label(findings, item, faces[item.name], expected)
            if chosen.textures:
                check_texture(findings, item)
    if is_gltf:
        check_line_colours(findings, lines, expected)
    cameras = [item for item in bpy.data.objects if item.type == "CAMERA"]
    largest = math.nan
    if findings.need(len(cameras) == 1, f"{len(cameras)} cameras, expected 1"):
        largest = look_through(findings, cameras[0], expected, placed, is_gltf)
        if chosen.render is not None:
            check_render(findings, meshes, chosen.render, chosen.photo, chosen.scale)
    version = bpy.app.version_string
    return f"Blender {version}: {len(placed)} lines, {len(meshes)} faces, lines at most {largest:.4f} px off"


def check_label(findings, item, face, expected):
    """The mesh is named for people, after the face or, where equal faces share it, after their shape.

    Blender adds a number to names that are there already. The face of an opening hangs on what that is called.
    """
    own = [each for each in expected["openings"] if each["id"] == face["opening"]]
    names = [face["label"], *(f"{face['kind']} of shape {each['shape']}" for each in own)]
    shown = item.data.name
    right = any(shown == name or shown.startswith(f"{name}.") for name in names)
    findings.need(right, f"{item.name} shows a {shown}")
    if face["opening"] is not None:
        findings.need(item.parent.name == face["thing"], f"{item.name} hangs on {item.parent.name}")


def open_file(path, is_gltf):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    if is_gltf:
        if "bool" not in vars(np):
            np.bool = bool  # Blender 3.4 still asks for the name that NumPy 1.24 took away
        import addon_utils

        addon_utils.enable("io_scene_gltf2")
        bpy.ops.import_scene.gltf(filepath=str(path))
    elif bpy.app.build_options.usd:
        bpy.ops.wm.usd_import(filepath=str(path))
    else:
        raise RuntimeError("this Blender was built without USD; the module bpy has it")
    bpy.context.view_layer.update()


def in_world(item, points):
    return [tuple(item.matrix_world @ Vector(point)) for point in points]


def segments_of(item):
    """The lines of an object: edges of a mesh, or curves of two points."""
    data = item.data
    if item.type == "MESH":
        points = in_world(item, [vertex.co for vertex in data.vertices])
        return [tuple(points[number] for number in edge.vertices) for edge in data.edges]
    if item.type == "CURVES":
        points = in_world(item, [point.position for point in data.points])
        pieces = [
            points[curve.first_point_index : curve.first_point_index + curve.points_length] for curve in data.curves
        ]
    else:
        pieces = [in_world(item, [point.co[:3] for point in spline.points]) for spline in data.splines]
    longer = sum(len(piece) != 2 for piece in pieces)
    if longer:
        raise ValueError(f"{longer} curves of {item.name} have other than 2 points")
    return list(map(tuple, pieces))


def triangles_of(item):
    item.data.calc_loop_triangles()
    points = in_world(item, [vertex.co for vertex in item.data.vertices])
    return points, [list(triangle.vertices) for triangle in item.data.loop_triangles]


def check_texture(findings, item):
    nodes = [
        node
        for material in item.data.materials
        if material and material.use_nodes
        for node in material.node_tree.nodes
        if node.type == "TEX_IMAGE" and node.image
    ]
    if not findings.need(nodes, f"{item.name} has no picture"):
        return
    for node in nodes:
        node.image.pixels[0:4]  # Blender reads a picture when it is looked at
        width, height = node.image.size
        findings.need(node.image.has_data and width and height, f"{item.name}: {node.image.name} could not be read")
    findings.need(item.data.uv_layers, f"{item.name} has a picture and no texture coordinates")


def check_line_colours(findings, lines, expected):
    """Blender keeps glTF's colour of an unlit material in its emission or background node."""
    for item in lines:
        group = expected["groups"].get(item.name)
        materials = [material for material in item.data.materials if material]
        if group is None or not findings.need(len(materials) == 1, f"{item.name}: {len(materials)} materials"):
            continue
        colours = [
            tuple(node.inputs["Color"].default_value)
            for node in materials[0].node_tree.nodes
            if node.type in ("EMISSION", "BACKGROUND")
        ]
        if findings.need(len(colours) == 1, f"{item.name} is not unlit"):
            check_colour(findings, item.name, colours[0], group["linear"], COLOUR_TOLERANCE)


def look_through(findings, camera, expected, placed, is_gltf):
    """Compare where the lines fall through the camera with the photo; returns the largest distance in px.

    A glTF camera has no principal point: it spans a larger frame, and with its properties becomes the photo's.
    """
    bpy.context.scene.camera = camera
    scales = camera.matrix_world.to_scale()
    findings.need(max(abs(scale - 1) for scale in scales) < 1e-4, f"the camera is scaled by {tuple(scales)}")
    at = camera.matrix_world.translation
    eye = expected["camera"]["eye"]
    findings.need(apart(at, eye) < TOLERANCE, f"the camera stands at {tuple(at)}, expected {eye}")
    check_clipping(findings, expected, camera.data.clip_start, camera.data.clip_end)
    size = expected["camera"]["width"], expected["camera"]["height"]
    if not is_gltf:
        return project_all(findings, camera, expected, placed, size, (0.0, 0.0))
    frame = expected["frame"]
    inside = frame["left"], frame["top"]
    largest = project_all(findings, camera, expected, placed, (frame["width"], frame["height"]), inside)
    told = {name: camera.get(f"linecad_{name}") for name in PROPERTIES}
    if not findings.need(None not in told.values(), f"the camera's properties are {told}"):
        return largest
    set_exactly(camera, told)
    return max(largest, project_all(findings, camera, expected, placed, size, (0.0, 0.0)))


def set_exactly(camera, told):
    """Set lens and shift by the camera's properties, as docs/guide/blender.md tells users to."""
    width, height = told["width"], told["height"]
    camera.data.sensor_fit, camera.data.sensor_width = "HORIZONTAL", 36
    camera.data.lens = 36 * told["fx"] / width
    camera.data.shift_x = (width / 2 - told["cx"]) / width
    camera.data.shift_y = (told["cy"] - height / 2) / width


def project_all(findings, camera, expected, placed, size, inside):
    """`size`: of the picture that the camera spans, px; `inside`: where the photo's corner lies in it."""
    scene = bpy.context.scene
    scene.render.resolution_percentage = 100
    scene.render.pixel_aspect_x = scene.render.pixel_aspect_y = 1.0
    scene.render.resolution_x, scene.render.resolution_y = size
    bpy.context.view_layer.update()

    def project(point):
        x, y, depth = world_to_camera_view(scene, camera, Vector(point))
        return x * size[0] - inside[0], (1 - y) * size[1] - inside[1], depth

    return check_pixels(findings, expected, placed, project, PIXEL_TOLERANCE)


def main():
    words = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:]
    parser = argparse.ArgumentParser(prog="check_blender.py", description=__doc__.splitlines()[0])
    parser.add_argument("file", type=Path)
    parser.add_argument("expectation", type=Path)
    parser.add_argument("--textures", action="store_true")
    parser.add_argument("--render", type=Path)
    parser.add_argument("--photo", type=Path)
    parser.add_argument("--scale", type=float, default=0.5, help="of the rendered picture")
    chosen = parser.parse_args(words)
    if (chosen.render is None) != (chosen.photo is None):
        parser.error("--render and --photo belong together")
    return run(lambda findings: check(findings, chosen))


if __name__ == "__main__":
    status = main()
    sys.stdout.flush()
    os._exit(status)  # Blender says more when it ends, and the module crashes in some versions
