"""Run by Blender or by its module bpy: open a GLB or USD file and render what the photo's camera sees, beside a view.

    blender --background --factory-startup --python blender_view.py -- FILE PHOTO PICTURE

The picture has two halves: the model through the imported camera, half over the photo, and the model from the left.
The camera's lens and shift are set from its properties as docs/guide/blender.md says.
"""

import math
import sys

import bpy
import numpy as np
from mathutils import Matrix, Vector

SAMPLES = 24  # rays a pixel
WIDTH = 1000  # px of each render
MODEL_SHARE = 0.75  # of the model over the photo
TURN = math.radians(-35)  # of the second view about the middle of the model


def main(file, photo, picture):
    """Import, render twice, and write the two pictures side by side."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    if not hasattr(np, "bool"):  # the importer of Blender 3.4 uses a name that NumPy 1.24 took away
        np.bool = bool
    if file.endswith(".glb"):
        bpy.ops.preferences.addon_enable(module="io_scene_gltf2")
        bpy.ops.import_scene.gltf(filepath=file)
    else:
        bpy.ops.wm.usd_import(filepath=file)
        colour_lines()
    scene = bpy.context.scene
    camera = next(item for item in bpy.data.objects if item.type == "CAMERA")
    scene.camera = camera
    image = bpy.data.images.load(photo)
    width, height = image.size
    if "linecad_fx" in camera:
        set_lens_and_shift(camera)
    prepare(scene, width, height)
    through = render(scene, picture)
    under = pixels(image)
    rows = np.arange(through.shape[0]) * under.shape[0] // through.shape[0]
    columns = np.arange(through.shape[1]) * under.shape[1] // through.shape[1]
    cover = through[..., 3:] * MODEL_SHARE
    left = under[rows][:, columns, :3] * (1 - cover) + through[..., :3] / np.maximum(through[..., 3:], 1e-6) * cover
    orbit(camera)
    beside = render(scene, picture)
    right = beside[..., :3] + (1 - beside[..., 3:])
    save(np.concatenate([left, right], axis=1), picture)


def colour_lines():
    """Give the curves of a USD stage the colours of their axes, for Blender's importer leaves curves without any."""
    axes = {"x": (0.73, 0.02, 0.02), "y": (0.01, 0.34, 0.04), "z": (0.02, 0.11, 0.83)}
    for item in bpy.data.objects:
        if item.type == "CURVES" and item.name.startswith("lines_"):
            material = bpy.data.materials.new(item.name)
            material.use_nodes = True
            shader = material.node_tree.nodes["Principled BSDF"]
            shader.inputs["Emission Color"].default_value = (*axes[item.name[6]], 1)
            shader.inputs["Emission Strength"].default_value = 1
            shader.inputs["Base Color"].default_value = (0, 0, 0, 1)
            item.data.materials.append(material)


def set_lens_and_shift(camera):
    """The photo's camera, from the custom properties that a GLB carries."""
    data, scene = camera.data, bpy.context.scene
    width, height = camera["linecad_width"], camera["linecad_height"]
    scene.render.resolution_x, scene.render.resolution_y = int(width), int(height)
    data.sensor_fit, data.sensor_width = "HORIZONTAL", 36
    data.lens = 36 * camera["linecad_fx"] / width
    data.shift_x = (width / 2 - camera["linecad_cx"]) / width
    data.shift_y = (camera["linecad_cy"] - height / 2) / width


def prepare(scene, width, height):
    """White light from everywhere, no background, colours as they are."""
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.samples = SAMPLES
    scene.cycles.use_denoising = False
    scene.render.film_transparent = True
    scene.view_settings.view_transform = "Standard"
    scene.render.resolution_x, scene.render.resolution_y = width, height
    scene.render.resolution_percentage = round(100 * WIDTH / width)
    scene.world = bpy.data.worlds.new("light")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (1, 1, 1, 1)


def orbit(camera):
    """Turn the camera about the middle of the model, and up a little."""
    bpy.context.view_layer.update()
    corners = [
        item.matrix_world @ Vector(c) for item in bpy.data.objects if item.type == "MESH" for c in item.bound_box
    ]
    distances = sorted((camera.matrix_world.inverted() @ corner).z for corner in corners)
    forward = camera.matrix_world.to_quaternion() @ Vector((0, 0, -1))
    middle = camera.matrix_world.translation + forward * -distances[len(distances) // 2]
    turn = Matrix.Rotation(TURN, 4, "Z") @ Matrix.Rotation(math.radians(-12), 4, camera.matrix_world.to_3x3().col[0])
    camera.data.clip_end *= 4
    camera.matrix_world = (
        Matrix.Translation(middle)
        @ turn
        @ Matrix.Translation(-middle)
        @ camera.matrix_world
        @ Matrix.Translation((0, 0, -distances[len(distances) // 2] * 0.3))
    )


def render(scene, picture):
    """(H, W, 4) sRGB from the top row down, multiplied by its opacity."""
    scene.render.filepath = picture + ".part.png"
    scene.render.image_settings.file_format = "PNG"
    scene.render.image_settings.color_mode = "RGBA"
    bpy.ops.render.render(write_still=True)
    found = pixels(bpy.data.images.load(scene.render.filepath))
    found[..., :3] *= found[..., 3:]
    return found


def pixels(image):
    """(H, W, 4) 0 to 1, from the top row down."""
    width, height = image.size
    return np.array(image.pixels[:], np.float32).reshape(height, width, 4)[::-1].copy()


def save(colours, picture):
    """Write (H, W, 3) as PNG."""
    height, width = colours.shape[:2]
    image = bpy.data.images.new("picture", width, height)
    opaque = np.concatenate([colours, np.ones((height, width, 1))], axis=2)[::-1]
    image.pixels = opaque.astype(np.float32).ravel().tolist()
    image.filepath_raw, image.file_format = picture, "PNG"
    image.save()


main(*(sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:]))
