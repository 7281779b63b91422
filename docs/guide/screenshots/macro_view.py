"""Run by FreeCAD itself: run the macro, convert a photo by its button and save a picture of the window.

Arguments come by the environment, because FreeCAD takes every word of its command line for a file to open.
"""

import os
import time
import traceback
from pathlib import Path

import FreeCAD  # noqa: F401, it comes before its window
import FreeCADGui
from PySide2 import QtWidgets

WIDTH, HEIGHT = 1450, 860  # px, within the screen that docs/guide/screenshots/make.py gives it
LIMIT = 300.0  # s


def main():
    """Convert PHOTO with CAMERA by LINECAD, and write PICTURE."""
    window = FreeCADGui.getMainWindow()
    window.showNormal()
    ratio = window.devicePixelRatioF()  # FreeCAD scales its window by the screen's resolution
    window.setGeometry(0, 0, int(WIDTH / ratio), int(HEIGHT / ratio))
    FreeCADGui.activateWorkbench("PartWorkbench")
    names = {"__name__": "__main__"}  # as FreeCAD runs a macro
    exec(compile(Path(os.environ["MACRO"]).read_text(encoding="utf-8"), "linecad.FCMacro", "exec"), names)
    panel = names["show"]()
    for field in ("photo", "camera", "command"):
        panel.files[field].setText(os.environ[{"command": "LINECAD"}.get(field, field.upper())])
    wait(2)
    panel.buttons["Convert"].click()
    end = time.monotonic() + LIMIT
    while panel.running is not None and time.monotonic() < end:
        wait(0.5)
    if panel.model() is None:
        raise RuntimeError(panel.state.text())
    wait(2)
    for tree in window.findChildren(QtWidgets.QTreeWidget):
        if tree.topLevelItemCount() and tree.topLevelItem(0).text(0) == "Application":
            tree.expandToDepth(3)
    wait(2)
    window.screen().grabWindow(window.winId()).save(os.environ["PICTURE"])


def wait(seconds):
    """Let the window live."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        FreeCADGui.updateGui()
        time.sleep(0.05)


try:
    main()
    code = 0
except Exception:  # FreeCAD would swallow it and wait for ever
    traceback.print_exc()
    code = 1
os._exit(code)
