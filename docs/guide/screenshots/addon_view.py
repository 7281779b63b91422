"""Run by Blender on a screen: install the add-on, convert a photo by its button and save a picture of the window.

blender --factory-startup --enable-event-simulate --window-geometry 0 0 W H --python addon_view.py -- ADDON LINECAD
        PHOTO CAMERA PICTURE
"""

import os
import sys
import time
import traceback

import bpy

CONFIDENCE = 0.9
TAB = (0.817, 0.773)  # of the window's width and height, where the sidebar has the tab of the add-on
DRAWN = 3.0  # s in which the sidebar is there
TICK = 0.2  # s
SETTLED = 20.0  # s in which Blender has compiled its shaders
LIMIT = 300.0  # s


def steps(addon, command, photo, camera, picture):
    """What to do one after another; it yields the seconds until it goes on."""
    bpy.data.batch_remove(list(bpy.data.objects))
    bpy.ops.preferences.addon_install(filepath=addon)
    bpy.ops.preferences.addon_enable(module="linecad")
    bpy.context.preferences.addons["linecad"].preferences.command = command
    settings, window = bpy.context.scene.linecad, bpy.context.window_manager.windows[0]
    settings.photo, settings.camera = photo, camera
    view = next(area for area in window.screen.areas if area.type == "VIEW_3D").spaces.active
    view.show_region_ui = True
    yield from pause(DRAWN)
    at = {"x": round(TAB[0] * window.width), "y": round(TAB[1] * window.height)}
    for kind, value in (("MOUSEMOVE", "NOTHING"), ("LEFTMOUSE", "PRESS"), ("LEFTMOUSE", "RELEASE")):
        window.event_simulate(type=kind, value=value, **at)
    yield from pause(DRAWN)
    with bpy.context.temp_override(window=window):
        bpy.ops.linecad.convert("INVOKE_DEFAULT")
    made = []
    while not made:
        yield TICK
        made = [each for each in bpy.data.collections if each.linecad.photo == photo]
    view.shading.type = "MATERIAL"
    made[0].linecad.confidence = CONFIDENCE
    yield from pause(SETTLED)
    with bpy.context.temp_override(window=window):
        bpy.ops.screen.screenshot(filepath=picture)
    os._exit(0)


def pause(seconds):
    """In ticks, because Blender draws its window after each."""
    for _ in range(round(seconds / TICK)):
        yield TICK


def main(*words):
    """Go through the steps while the window lives."""
    bpy.context.preferences.view.show_splash = False  # it would take the first click
    left, started = steps(*words), time.monotonic()

    def step():
        try:
            if time.monotonic() - started > LIMIT:
                raise TimeoutError("nothing was imported")
            return next(left)
        except Exception:  # Blender would swallow it and wait for ever
            traceback.print_exc()
            os._exit(1)

    bpy.app.timers.register(step, first_interval=2.0)


main(*sys.argv[sys.argv.index("--") + 1 :])
