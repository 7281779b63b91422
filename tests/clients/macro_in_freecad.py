"""Run by FreeCAD itself, as check_freecad_macro.py starts it: run the macro, use its panel and look at the model.

FreeCAD imports this file instead of running it, so everything happens at the end of the module.
"""

import os
import time
from collections import Counter
from pathlib import Path

import FreeCAD
import FreeCADGui
from PySide import QtCore

from addon_expectation import CONFIDENCE, correct, expected_of, groups_of, kept_of, open_page, read
from shapes import apart, check_colour, check_lines, check_names
from verdict import judge

MILLIMETRES = 1000.0  # per metre
TOLERANCE = 1e-6  # m
PIXEL_TOLERANCE = 0.01  # px
COLOUR_TOLERANCE = 5e-3  # FreeCAD keeps a channel in 8 bits
SECONDS = 120  # that a conversion may take
MERGE = "User parameter:BaseApp/Preferences/Mod/Import/hSTEP"


def check(findings):
    """Note all problems of the macro that the environment names; returns a summary."""
    photo, command = Path(os.environ["CHECK_PHOTO"]), os.environ["CHECK_COMMAND"]
    FreeCADGui.showMainWindow()
    FreeCAD.ParamGet(MERGE).SetBool("ReadShapeCompoundMode", True)
    macro = Path(os.environ["CHECK_MACRO"])
    names = {"__name__": "__main__"}  # as FreeCAD runs it
    exec(compile(macro.read_text(encoding="utf-8"), str(macro), "exec"), names)
    panel = names["show"]()  # the one that is there already
    panel.files["photo"].setText(str(photo))
    panel.files["camera"].setText(os.environ["CHECK_CAMERA"])
    panel.files["command"].setText(str(photo.with_name("nothing")))
    check_refusal(findings, panel, "is no command that can be started")
    panel.files["command"].setText(command)
    panel.scale.setText("a=b")
    check_refusal(findings, panel, "'b' is not a number")  # in the words of the command
    panel.scale.setText("")
    check_cancel(findings, panel)
    check_page(findings, panel)
    stages = convert(panel, is_corrected=False)
    findings.need(len(stages) > 5, f"the stages shown are {stages}")
    scene_file = photo.with_name(f"{photo.name}.linecad") / f"{photo.stem}.json"
    scene = read(scene_file)
    expected = expected_of(scene)
    root = panel.model()
    placed = check_model(findings, root, expected)
    check_photo(findings, root, expected)
    check_groups(findings, panel, root, scene)
    kept = kept_of(command, scene_file)
    panel.confidence.setValue(round(CONFIDENCE * 100))
    findings.need(0 < len(kept["lines"]) < len(expected["lines"]), "the sample shows nothing about confidence")
    check_model(findings, root, kept)
    own = root.Document.addObject("App::FeaturePython", "SomebodysOwn")
    root.addObject(own)
    correct(photo, scene)
    convert(panel, is_corrected=True)
    again = read(scene_file)
    findings.need(again["metres_per_unit"], f"the correction was not used: {panel.state.text()}")
    root = panel.model()
    findings.need(root.Confidence == CONFIDENCE, f"the confidence is {root.Confidence}, expected {CONFIDENCE}")
    check_model(findings, root, kept_of(command, scene_file))
    check_photo(findings, root, expected_of(again))
    own = root.Document.getObject("SomebodysOwn")
    findings.need(own, "what somebody put into the group is gone with the former model")
    findings.need(len(FreeCAD.listDocuments()) == 1, "the model was not replaced in its document")
    findings.need(FreeCAD.ParamGet(MERGE).GetBool("ReadShapeCompoundMode"), "the user's preference was lost")
    version = ".".join(FreeCAD.Version()[:3])
    return f"FreeCAD {version}: {len(placed)} lines, {len(kept['lines'])} of them sure, {len(stages)} stages"


def wait(panel):
    """Let the window live until the command has ended; the stages that it showed."""
    stages, end = [], time.monotonic() + SECONDS
    while panel.running is not None:
        if time.monotonic() > end:
            raise TimeoutError(panel.state.text())
        QtCore.QCoreApplication.processEvents()
        time.sleep(0.02)
        stage = panel.state.text().rpartition(" (")[0]
        if stage not in stages and panel.running is not None:
            stages.append(stage)
    return stages


def convert(panel, is_corrected):
    """Press the button."""
    panel.buttons["Solve Again, Corrected" if is_corrected else "Convert"].click()
    return wait(panel)


def check_refusal(findings, panel, words):
    """Need an error with these words, in one line, and nothing imported."""
    convert(panel, is_corrected=False)
    shown = panel.state.text()
    findings.need(words in shown and "\n" not in shown, f"the error is {shown!r}, expected {words!r} in it")
    findings.need(not FreeCAD.listDocuments(), "something was imported all the same")


def check_cancel(findings, panel):
    """The button ends the command at once."""
    panel.buttons["Convert"].click()
    running, started = panel.running, time.monotonic()
    panel.buttons["Cancel"].click()
    seconds = time.monotonic() - started
    findings.need(running.is_done and panel.running is None, "the command goes on after it was cancelled")
    findings.need("cancelled" in panel.state.text() and not FreeCAD.listDocuments(), f"{panel.state.text()} is shown")
    findings.need(seconds < SECONDS / 10, f"to cancel took {seconds:.0f} s")


def check_page(findings, panel):
    """The button opens the page, and pressed again it ends the command."""
    panel.buttons["Correct in Browser"].click()
    running = panel.page
    findings.need(open_page(running), "the page has no title")
    panel.buttons["Correct in Browser"].click()
    findings.need(running.is_done and panel.page is None, "the page is there still once it was closed")


def items(root):
    """What is in a group and those in it, but for the groups."""
    for item in root.Group:
        if item.TypeId == "App::DocumentObjectGroup":
            yield from items(item)
        else:
            yield item


def check_model(findings, root, expected):
    """Compare what is shown with the expectation; returns the lines that are in their place."""
    shown = [item for item in items(root) if item.ViewObject.Visibility]
    segments = {}
    for item in shown:
        if item.Label.startswith("lines_"):
            name = item.Label.partition(" component ")[0]
            own = [tuple(map(metres, edge.Vertexes)) for edge in item.Shape.Edges]
            segments.setdefault(name, []).extend(own)
            if name in expected["groups"]:
                colour = item.ViewObject.LineColor
                check_colour(findings, name, colour, expected["groups"][name]["srgb"], COLOUR_TOLERANCE)
    faces = [item.Label for item in shown if item.Label.startswith("face_")]
    check_names(findings, "faces that are shown", faces, [face["name"] for face in expected["faces"]])
    cameras = [metres(item.Shape.Vertexes[0]) for item in shown if item.Label == "camera"]
    right = len(cameras) == 1 and apart(cameras[0], expected["camera"]["eye"]) < TOLERANCE
    findings.need(right, f"cameras at {cameras}, expected {expected['camera']['eye']}")
    left = [item.Label for item in root.Document.Objects if item.TypeId == "App::LinkGroup"]
    findings.need(not left, f"assemblies {left} are left of the file")
    return check_lines(findings, expected, segments, TOLERANCE)


def metres(vertex):
    return tuple(value / MILLIMETRES for value in (vertex.X, vertex.Y, vertex.Z))


def check_photo(findings, root, expected):
    """The corners of the photo's plane are seen in the photo's corners."""
    planes = [item for item in items(root) if item.TypeId == "Image::ImagePlane"]
    if not findings.need(
        len(planes) == 1 and Path(planes[0].ImageFile).is_file(), f"{len(planes)} planes of the photo"
    ):
        return
    camera, plane = expected["camera"], planes[0]
    for u in (0, camera["width"]):
        for v in (0, camera["height"]):
            x = plane.XSize.Value * (u / camera["width"] - 0.5)
            y = plane.YSize.Value * (0.5 - v / camera["height"])
            point = plane.Placement.multVec(FreeCAD.Vector(x, y, 0)) / MILLIMETRES - FreeCAD.Vector(*camera["eye"])
            right, down, ahead = (point.dot(FreeCAD.Vector(*row)) for row in camera["rotation"])
            seen = [camera["focal"] * each / ahead for each in (right, down)]
            off = max(abs(a + c - b) for a, c, b in zip(seen, camera["principal_point"], (u, v), strict=True))
            findings.need(off < PIXEL_TOLERANCE, f"the photo's corner ({u}, {v}) is seen {off:.3f} px from its place")


def check_groups(findings, panel, root, scene):
    """Every grouping puts every line into its group."""
    for by in ("component", "confidence", "role", "axis"):
        panel.grouping.setCurrentIndex(panel.grouping.findData(by))
        parents = [each for each in root.Group if each.Label == "lines"]
        counts = Counter()
        for group in parents[0].Group if parents else ():
            counts[group.Label] += sum(len(part.Shape.Edges) for part in group.Group)
        wanted = groups_of(scene, by)
        findings.need(dict(counts) == wanted, f"groups by {by} are {dict(counts)}, expected {wanted}")


Path(os.environ["CHECK_REPORT"]).write_text("\n".join(judge(check)), encoding="utf-8")
os._exit(0)  # the report tells the rest; FreeCAD's own end may crash where it was started without a screen
