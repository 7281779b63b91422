"""Run by FreeCAD itself, as check_freecad.py --guide starts it: run what docs/guide/freecad.md shows.

FreeCAD imports this file instead of running it, so everything happens at the end of the module.
"""

import json
import os
import shutil
from pathlib import Path

import FreeCAD
import FreeCADGui

from guide_blocks import blocks_of, run_block
from verdict import judge


def check(findings):
    """Note all problems; returns a summary."""
    guide, expectation, report = (Path(os.environ[f"CHECK_{name}"]) for name in ("GUIDE", "EXPECTATION", "REPORT"))
    expected = json.loads(expectation.read_text(encoding="utf-8"))
    shutil.copy(os.environ["CHECK_FILE"], report.with_name("facade.step"))  # as the guide calls it
    os.chdir(report.parent)
    FreeCADGui.showMainWindow()
    (block,) = blocks_of(guide)
    run_block(block, guide)
    labels = {item.Label for item in FreeCAD.ActiveDocument.Objects}
    wanted = {"linecad", "lines", "faces", "camera", *expected["groups"], *(face["name"] for face in expected["faces"])}
    findings.need(wanted <= labels, f"the tree has no {sorted(wanted - labels)[:5]}")
    return f"FreeCAD {'.'.join(FreeCAD.Version()[:3])}: the guide's Python brings {len(labels)} named objects"


Path(os.environ["CHECK_REPORT"]).write_text("\n".join(judge(check)), encoding="utf-8")
os._exit(0)  # the report tells the rest; FreeCAD's own end may crash where it was started without a screen
