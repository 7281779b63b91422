"""Run in Blender what docs/guide/blender.md shows: guide_in_blender.py GUIDE.md FILE.glb EXPECTATION.json

First what helps its importer, then the import, then the lines that set the photo's camera.
"""

import argparse
import json
import os
import sys
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).parent))  # Blender runs a script without its folder

from guide_blocks import blocks_of, run_block
from verdict import run

TOLERANCE = 1e-5  # of the film's width


def check(findings, guide, file, expected):
    """Note all problems; returns a summary."""
    help_importer, set_camera = blocks_of(guide)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    run_block(help_importer, guide)
    bpy.ops.preferences.addon_enable(module="io_scene_gltf2")
    bpy.ops.import_scene.gltf(filepath=str(file))
    run_block(set_camera, guide)
    scene, camera = bpy.context.scene, expected["camera"]
    render, data = scene.render, scene.camera.data
    size = (render.resolution_x, render.resolution_y)
    findings.need(scene.camera.name == "photo_camera", f"the scene looks through {scene.camera.name}")
    findings.need(size == (camera["width"], camera["height"]), f"a render has {size} px, not the photo's")
    found = (
        data.lens / data.sensor_width * size[0],
        size[0] * (0.5 - data.shift_x),
        size[1] / 2 + data.shift_y * size[0],
    )
    wanted = (camera["focal"], *camera["principal_point"])
    off = max(abs(a - b) for a, b in zip(found, wanted, strict=True)) / size[0]
    findings.need(off < TOLERANCE, f"lens and shift give {found}, expected {wanted}")
    return f"Blender {bpy.app.version_string}: the guide's Python sets the photo's camera"


def main():
    words = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:]
    parser = argparse.ArgumentParser(prog="guide_in_blender.py", description=__doc__.splitlines()[0])
    for name in ("guide", "file", "expectation"):
        parser.add_argument(name, type=Path)
    chosen = parser.parse_args(words)
    expected = json.loads(chosen.expectation.read_text(encoding="utf-8"))
    return run(lambda findings: check(findings, chosen.guide, chosen.file, expected))


if __name__ == "__main__":
    status = main()
    sys.stdout.flush()
    os._exit(status)  # the module bpy crashes at its end in some versions
