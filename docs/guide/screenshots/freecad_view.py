"""Run by FreeCAD itself: open a STEP file as docs/guide/freecad.md says and save a picture of the window.

Arguments come by the environment, because FreeCAD takes every word of its command line for a file to open.
"""

import os
import time
import traceback

import FreeCAD
import FreeCADGui
import ImportGui
from PySide2 import QtWidgets

WIDTH, HEIGHT = 1500, 900  # px, as large as the screen that docs/guide/screenshots/make.py gives it
ZOOM = 0.55  # of the view's height that fits the sphere around everything


def main():
    """Import SCENE_STEP, look at it from in front, to the left and above, and write PICTURE."""
    preferences = FreeCAD.ParamGet("User parameter:BaseApp/Preferences/Mod/Import/hSTEP")
    preferences.SetBool("ReadShapeCompoundMode", False)  # Enable STEP Compound merge
    FreeCADGui.activateWorkbench("PartWorkbench")
    document = FreeCAD.newDocument("courtyard")
    ImportGui.insert(os.environ["SCENE_STEP"], document.Name)
    for item in document.Objects:
        if hasattr(item.ViewObject, "LineWidth"):
            item.ViewObject.LineWidth = 2
        if item.Label == "camera":
            item.ViewObject.PointSize = 12
    window = FreeCADGui.getMainWindow()
    window.showNormal()
    ratio = window.devicePixelRatioF()  # FreeCAD scales its window by the screen's resolution
    window.setGeometry(0, 0, int(WIDTH / ratio), int(HEIGHT / ratio))
    wait()
    view = FreeCADGui.getDocument(document.Name).ActiveView
    view.setCameraOrientation(
        FreeCAD.Rotation(FreeCAD.Vector(0, 0, 1), -12) * FreeCAD.Rotation(FreeCAD.Vector(1, 0, 0), 66)
    )
    view.fitAll()
    wait()
    view.getCameraNode().height.setValue(view.getCameraNode().height.getValue() * ZOOM)
    for tree in window.findChildren(QtWidgets.QTreeWidget):
        if tree.topLevelItemCount() and tree.topLevelItem(0).text(0) == "Application":
            tree.expandToDepth(3)
            tree.setColumnWidth(0, 260)
    wait()
    window.screen().grabWindow(window.winId()).save(os.environ["PICTURE"])


def wait():
    """Let the window catch up."""
    for _ in range(20):
        FreeCADGui.updateGui()
        time.sleep(0.1)


try:
    main()
    code = 0
except Exception:  # FreeCAD would swallow it and wait for ever
    traceback.print_exc()
    code = 1
os._exit(code)
