"""Install the add-on from its file in Blender, let it convert a photo, and look at what it shows.

blender -b --factory-startup --python-exit-code 3 --python check_blender_addon.py -- ADDON.zip LINECAD PHOTO CAMERA
python check_blender_addon.py ADDON.zip LINECAD PHOTO CAMERA      with the module bpy, where it is an extension

LINECAD is the path of the command. PHOTO lies in a folder that can be written, and nobody has corrected it yet.
"""

import os
import sys
from collections import Counter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))  # Blender does not

import bpy
from bpy_extras.object_utils import world_to_camera_view
from mathutils import Vector

from addon_expectation import CONFIDENCE, correct, expected_of, groups_of, kept_of, open_page, read
from shapes import check_lines, check_names, check_pixels
from verdict import run

TOLERANCE = 1e-4  # m; GLB and Blender store points as float32
PIXEL_TOLERANCE = 0.25  # px
EXTENSIONS_SINCE = (4, 2, 0)


def check(findings, addon, command, photo, calibration):
    """Note all problems of the add-on; returns a summary."""
    settings, preferences = install(findings, addon)
    settings.photo, settings.camera = str(photo), str(calibration)
    preferences.command = str(photo.with_name("nothing"))
    check_refusal(findings, "is no command that can be started")
    preferences.command = command
    settings.scale, settings.camera_height = "1,2:3,4=1", 1.0
    check_refusal(findings, "are both given")
    settings.scale, settings.camera_height = "a=b", 0.0
    check_refusal(findings, "'b' is not a number")  # in the words of the command
    settings.scale = ""
    check_page(findings)
    findings.need(bpy.ops.linecad.convert() == {"FINISHED"}, "the photo was not converted")
    scene_file = photo.with_name(f"{photo.name}.linecad") / f"{photo.stem}.json"
    scene = read(scene_file)
    root = only_model(findings, photo)
    expected = expected_of(scene)
    placed = check_model(findings, root, expected)
    largest = check_camera(findings, expected, placed)
    check_groups(findings, root, scene)
    root.linecad.confidence = CONFIDENCE
    kept = kept_of(command, scene_file)
    findings.need(0 < len(kept["lines"]) < len(expected["lines"]), "the sample shows nothing about confidence")
    check_model(findings, root, kept)
    root.linecad.grouping = "role"
    own = bpy.data.objects.new("somebody's own", None)
    root.children[0].objects.link(own)
    correct(photo, scene)
    settings.is_fast = settings.has_tubes = True
    findings.need(bpy.ops.linecad.convert(corrected=True) == {"FINISHED"}, "the photo was not solved again")
    check_again(findings, only_model(findings, photo), read(scene_file))
    version = bpy.app.version_string
    return f"Blender {version}: {len(placed)} lines, at most {largest:.4f} px off, {len(kept['lines'])} of them sure"


def install(findings, addon):
    """As the guide says for this version; the add-on's settings in the scene, and its preferences."""
    import addon_utils  # which the module bpy brings along

    bpy.ops.wm.read_factory_settings(use_empty=True)
    addon_utils.enable("io_scene_gltf2")
    name = "linecad"
    if bpy.app.version >= EXTENSIONS_SINCE:
        addon_utils.enable("bl_pkg")
        name = "bl_ext.user_default.linecad"
        bpy.ops.extensions.package_install_files(filepath=str(addon), repo="user_default", enable_on_install=True)
    else:
        bpy.ops.preferences.addon_install(filepath=str(addon))
        bpy.ops.preferences.addon_enable(module=name)
    findings.need(name in bpy.context.preferences.addons, "the add-on is not there once it is installed")
    return bpy.context.scene.linecad, bpy.context.preferences.addons[name].preferences


def check_refusal(findings, words):
    """Need an error with these words, in one line, and nothing imported."""
    try:
        bpy.ops.linecad.convert()
        findings.need(False, f"no error that says {words!r}")
    except RuntimeError as error:
        lines = str(error).strip().splitlines()
        findings.need(len(lines) == 1 and words in lines[0], f"the error is {lines}, expected {words!r} in it")
    findings.need(not bpy.data.collections, "something was imported all the same")


def check_page(findings):
    """The button opens the page, and pressed again it ends the command."""
    module = sys.modules[type(bpy.context.scene.linecad).__module__]
    bpy.ops.linecad.edit()
    running = module._at_work["edit"]
    findings.need(open_page(running), "the page has no title")
    bpy.ops.linecad.edit()
    findings.need(running.is_done and not module._at_work, "the page is there still once it was closed")


def only_model(findings, photo):
    models = [each for each in bpy.data.collections if each.linecad.photo == str(photo)]
    findings.need(len(models) == 1, f"{len(models)} models of the photo, expected 1")
    return models[0]


def lines_of(root):
    """The objects of lines."""
    return [item for item in root.all_objects if item.type == "MESH" and "line_ids" in item.data]


def check_model(findings, root, expected):
    """Compare what is shown; returns the lines that are in their place."""
    bpy.context.view_layer.update()
    graph = bpy.context.evaluated_depsgraph_get()
    segments = {}
    for item in lines_of(root):
        mesh = item.evaluated_get(graph).data  # after modifiers
        points = [tuple(item.matrix_world @ vertex.co) for vertex in mesh.vertices]
        if mesh.edges:
            name = item.name.partition(" component ")[0]
            own = [tuple(points[number] for number in edge.vertices) for edge in mesh.edges]
            segments.setdefault(name, []).extend(own)
    faces = [item.name for item in root.all_objects if "face_id" in item and not item.hide_viewport]
    check_names(findings, "faces that are shown", faces, [face["name"] for face in expected["faces"]])
    return check_lines(findings, expected, segments, TOLERANCE)


def check_camera(findings, expected, placed):
    """The scene's camera is the photo's, with the photo behind; returns the largest distance of a line's end in px."""
    scene = bpy.context.scene
    width, height = scene.render.resolution_x, scene.render.resolution_y
    camera = expected["camera"]
    findings.need((width, height) == (camera["width"], camera["height"]), f"pictures are {width} x {height} px")
    lens = scene.camera.data
    photos = [behind.image for behind in lens.background_images if behind.image]
    if findings.need(len(photos) == 1 and lens.show_background_images, f"{len(photos)} photos behind the model"):
        findings.need(tuple(photos[0].size) == (width, height), f"the photo is {tuple(photos[0].size)} px large")
        findings.need(photos[0].packed_file, "the photo is not in the .blend file")

    def project(point):
        x, y, depth = world_to_camera_view(scene, scene.camera, Vector(point))
        return x * width, (1 - y) * height, depth

    return check_pixels(findings, expected, placed, project, PIXEL_TOLERANCE)


def check_groups(findings, root, told):
    """Every grouping puts every line into its collection, and each object into one."""
    for by in ("component", "confidence", "role", "axis"):
        root.linecad.grouping = by
        parents = [each for each in root.children if each.name.partition(".")[0] == "lines"]
        counts = Counter()
        for child in parents[0].children if parents else ():
            for item in child.objects:
                counts[child.name] += len(item.data["line_ids"])
        wanted = groups_of(told, by)
        findings.need(dict(counts) == wanted, f"collections by {by} are {dict(counts)}, expected {wanted}")
        twice = [item.name for item in root.all_objects if len(item.users_collection) != 1]
        findings.need(not twice, f"{twice[:3]} are in several collections by {by}")


def check_again(findings, root, scene):
    """The model is in metres now, its lines are tubes, and the chosen grouping is kept."""
    findings.need(scene["metres_per_unit"], "the correction was not used")
    findings.need(root.linecad.grouping == "role", "the grouping was lost")
    expected = expected_of(scene)
    for item in lines_of(root):
        count = len(item.data["line_ids"])
        findings.need(len(item.data.polygons) == 20 * count, f"{item.name} has no tubes")
    eye = tuple(bpy.context.scene.camera.matrix_world.translation)
    off = max(abs(a - b) for a, b in zip(eye, expected["camera"]["eye"], strict=True))
    findings.need(off < TOLERANCE, f"the camera stands at {eye}, expected {expected['camera']['eye']}")
    kept = "somebody's own" in bpy.context.scene.objects
    findings.need(kept, "what somebody put into the collection is gone with the former model")
    cameras = [item for item in bpy.data.objects if item.type == "CAMERA"]
    findings.need(len(cameras) == 1 and len(bpy.data.images) > 0, f"{len(cameras)} cameras, expected 1")


def main():
    words = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:]
    addon, command, photo, calibration = words
    places = [Path(each).resolve() for each in (addon, photo, calibration)]
    return run(lambda findings: check(findings, places[0], command, *places[1:]))


if __name__ == "__main__":
    status = main()
    sys.stdout.flush()
    os._exit(status)  # Blender says more when it ends, and the module crashes in some versions
