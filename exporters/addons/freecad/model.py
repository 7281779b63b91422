"""The model of a photo in FreeCAD: the parts of a STEP file in groups, with the photo on a plane behind them."""

import contextlib
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import FreeCAD
import FreeCADGui
import ImportGui
import Part

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

MILLIMETRES = 1000.0  # per metre
BEHIND = 1.05  # the photo stands as much farther than the farthest line
FIRST_FACE = "face_"  # what the names of faces begin with, before their id
GROUP = "App::DocumentObjectGroup"
OURS = "linecad"  # the group of properties that we add
# On by default, or else set by the user, these merge all parts into one without names or colours.
IMPORT = (
    ("User parameter:BaseApp/Preferences/Mod/Import/hSTEP", "ReadShapeCompoundMode", False),
    ("User parameter:BaseApp/Preferences/Mod/Import", "ReduceObjects", False),
)


def import_model(request: Request) -> Any:
    """Import what the command wrote, in place of the earlier model of this photo; the group that holds it."""
    told, photo = read_scene_file(request.output(".json")), write_photo(request)  # before anything is removed
    confidence, grouping = 0.0, GROUPINGS[0][0]
    former = model_of(request.photo)
    if former is None:
        document = FreeCAD.newDocument(request.photo.stem)
    else:
        document, confidence, grouping = former.Document, former.Confidence, former.Grouping
        remove_model(former)
    before = set(document.Objects)
    with _import_preferences():
        ImportGui.insert(str(request.output(".step")), document.Name)
    brought = [item for item in document.Objects if item not in before]
    parts = [item for item in brought if item.TypeId == "Part::Feature"]
    assemblies = [item.Name for item in brought if item.TypeId != "Part::Feature"]
    root = _group(document, None, request.photo.stem)
    for kind, name in (
        ("Path", "Photo"),
        ("Float", "Confidence"),
        ("String", "Grouping"),
        ("Bool", "HasProbabilities"),
    ):
        root.addProperty(f"App::Property{kind}", name, OURS)
    root.Photo, root.Confidence, root.Grouping = str(request.photo), confidence, grouping
    root.HasProbabilities = any(line.probability is not None for line in told.lines.values())
    for name in assemblies:
        document.removeObject(name)
    _take_over(root, parts, told)
    _add_photo(root, photo, told)
    arrange(root)
    hide(root)
    document.recompute()
    return root


@contextlib.contextmanager
def _import_preferences() -> Iterator[None]:
    """Those that the guide asks for, for this import alone."""
    groups = [(FreeCAD.ParamGet(path), name, value) for path, name, value in IMPORT]
    former = [name in group.GetBools() and group.GetBool(name) for group, name, _ in groups]
    was_set = [name in group.GetBools() for group, name, _ in groups]
    for group, name, value in groups:
        group.SetBool(name, value)
    try:
        yield
    finally:
        for (group, name, _), value, was in zip(groups, former, was_set, strict=True):
            if was:
                group.SetBool(name, value)
            else:
                group.RemBool(name)


def _take_over(root: Any, parts: list[Any], told: SceneFile) -> None:
    """Put the parts of the file into our group: lines split further, faces by the ids in their names."""
    ids: dict[str, list[int]] = {}
    for number in sorted(told.lines):
        ids.setdefault(told.lines[number].base, []).append(number)
    for part in parts:
        if part.Label in ids:
            _split(root, part, ids[part.Label], told.lines)
            root.Document.removeObject(part.Name)
        elif part.Label.startswith(FIRST_FACE):
            face = told.faces[int(part.Label.removeprefix(FIRST_FACE))]
            _add_to(root, part, {"faces": face.kind})
            if face.probability is not None:
                part.addProperty("App::PropertyFloat", "Probability", OURS)
                part.Probability = face.probability
        else:  # the point where the camera stood
            _add_to(root, part, {})


def _split(root: Any, whole: Any, ids: list[int], lines: dict[int, Line]) -> None:
    """Parts of the lines of one role, band and component each, out of one of the lines of one axis and kind."""
    edges = whole.Shape.Edges
    if len(edges) != len(ids):
        raise AddonError(f"{whole.Label} has {len(edges)} edges for {len(ids)} lines; report this")
    places: dict[str, list[int]] = {}
    for place, number in enumerate(ids):
        places.setdefault(lines[number].part, []).append(place)
    for name, chosen in places.items():
        part = root.Document.addObject("Part::Feature", "lines")
        part.Label = name
        part.Shape = Part.makeCompound([edges[place] for place in chosen])
        own = [ids[place] for place in chosen]
        part.addProperty("App::PropertyIntegerList", "LineIds", OURS)
        part.LineIds = own
        if lines[own[0]].probability is not None:
            part.addProperty("App::PropertyFloatList", "Probabilities", OURS)
            part.Probabilities = [float(lines[number].probability or 0.0) for number in own]
            part.addProperty("Part::PropertyPartShape", "AllLines", OURS, "those that are hidden too")
            part.AllLines = part.Shape
        part.ViewObject.LineColor = whole.ViewObject.LineColorArray[0]
        _add_to(root, part, lines[own[0]].groups())


def _add_to(root: Any, part: Any, groups: dict[str, str]) -> None:
    part.addProperty("App::PropertyMap", "Groups", OURS, "the group that it belongs to, by what groups are made")
    part.Groups = groups
    root.addObject(part)


def _add_photo(root: Any, photo: Path, told: SceneFile) -> None:
    """The photo on a plane behind the model, where its pixels lie on the rays that they were seen along."""
    right, down, ahead = (FreeCAD.Vector(*row) for row in told.camera["R_cam_from_world"])
    (focal, _, centre_u), (_, _, centre_v), _ = told.camera["K"]
    width, height = told.camera["width"], told.camera["height"]
    eye = _eye(root)
    far = max(ahead.dot(FreeCAD.Vector(*end)) for line in told.lines.values() for end in line.ends)
    distance = BEHIND * MILLIMETRES * far
    aside = right * (width / 2 - centre_u - 0.5) + down * (height / 2 - centre_v - 0.5)  # pixels count from centres
    at = eye + ahead * distance + aside * (distance / focal)
    plane = root.Document.addObject("Image::ImagePlane", "photo")
    plane.ImageFile = str(photo)
    plane.XSize, plane.YSize = width * distance / focal, height * distance / focal
    plane.Placement = FreeCAD.Placement(at, FreeCAD.Rotation(right, -down, -ahead, "ZXY"))
    _add_to(root, plane, {})


def _eye(root: Any) -> Any:
    """Where the camera stood, in mm."""
    return next(part.Shape.Vertexes[0].Point for part in _parts(root) if part.Label.startswith("camera"))


def look_from_camera(root: Any) -> None:
    """Show the model from where the camera stood, over the photo."""
    plane = next(part for part in _parts(root) if part.TypeId == "Image::ImagePlane")
    view = FreeCADGui.getDocument(root.Document.Name).ActiveView
    view.setCameraType("Perspective")
    # From the eye to the middle of the photo, right, up and back: the axis that the view looks along passes beside it.
    right, up, back = plane.Placement.Rotation.inverted().multVec(plane.Placement.Base - _eye(root))
    wide, high = view.getSize()
    half = max(plane.YSize.Value / 2 + abs(up), (plane.XSize.Value / 2 + abs(right)) * high / wide)
    camera = view.getCameraNode()
    camera.position.setValue(*_eye(root))
    camera.orientation.setValue(*plane.Placement.Rotation.Q)
    camera.heightAngle.setValue(2 * math.atan(half / -back))
    camera.focalDistance.setValue(-back)


def model_of(photo: Path) -> Any:
    """The group of the model of a photo, in any document; None where there is none."""
    for document in FreeCAD.listDocuments().values():
        for item in document.Objects:
            if item.TypeId == GROUP and getattr(item, "Photo", "") == str(photo):
                return item
    return None


def remove_model(root: Any) -> None:
    """Remove what was imported, and the groups of it; what somebody put into them stays in the document."""
    document = root.Document
    inner = list(_groups_below(root))
    for part in _parts(root):
        document.removeObject(part.Name)
    for group in [*reversed(inner), root]:
        document.removeObject(group.Name)


def arrange(root: Any) -> None:
    """Put parts of lines into groups by the chosen grouping, and faces by what they are."""
    former, parts = list(_groups_below(root)), {part.Name: part for part in _parts(root)}
    groups = {name: dict(part.Groups) for name, part in parts.items()}
    for part in parts.values():
        root.addObject(part)
    for group in reversed(former):
        root.Document.removeObject(group.Name)
    for by, name in ((root.Grouping, "lines"), ("faces", "faces")):
        chosen = {name: told for name, told in groups.items() if by in told}
        if not chosen:
            continue
        parent = _group(root.Document, root, name)
        for label, names in groups_of(chosen, by).items():
            child = _group(root.Document, parent, label)
            for each in names:
                child.addObject(parts[each])


def hide(root: Any) -> None:
    """Hide lines and faces that are less sure than the group's confidence."""
    for part in _parts(root):
        if hasattr(part, "AllLines"):
            pairs = zip(part.AllLines.Edges, part.Probabilities, strict=True)
            edges = [edge for edge, probability in pairs if is_shown(probability, root.Confidence)]
            if edges:  # FreeCAD cannot draw an empty shape
                part.Shape = Part.makeCompound(edges)
            part.ViewObject.Visibility = bool(edges)
        elif hasattr(part, "Probability"):
            part.ViewObject.Visibility = is_shown(part.Probability, root.Confidence)


def _parts(root: Any) -> list[Any]:
    """What was imported, in all groups."""
    groups = [root, *_groups_below(root)]
    return [item for group in groups for item in group.Group if hasattr(item, "Groups")]


def _groups_below(group: Any) -> Iterator[Any]:
    for item in group.Group:
        if item.TypeId == GROUP:
            yield item
            yield from _groups_below(item)


def _group(document: Any, parent: Any, label: str) -> Any:
    group = document.addObject(GROUP, "group")
    group.Label = label
    if parent is not None:
        parent.addObject(group)
    return group
