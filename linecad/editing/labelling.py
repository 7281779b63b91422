"""A person's labels of crossings as a file that `linecad evaluate` reads (docs/reference/evaluation.md).

Only annotations are written: what the program proposes is no label.
"""

import json
from pathlib import Path

from linecad.camera.photo import Photo
from linecad.corrections.annotations import Annotations
from linecad.directions import axis_name
from linecad.errors import OutputError
from linecad.io.files import check_output
from linecad.line_graph import LineGraph

FORMAT = "linecad-labels"
VERSION = 1


def camera_of_labels(photo: Photo, camera_file: Path | None) -> object:
    """What a labels file says about the camera: its calibration's name, its matrix, or nothing."""
    if camera_file is not None:
        return camera_file.name
    if photo.camera is not None and photo.camera.is_given:
        named: dict[str, object] = {"K": photo.camera.matrix.tolist()}
        if photo.bend is not None:
            named["distortion"] = list(photo.removed_distortion(photo.camera.focal))
        return named
    return None


def check_labels(path: Path, photo_file: Path, camera_file: Path | None) -> None:
    """Raise OutputError where a labels file would not find its photo and its calibration beside it."""
    check_output(path)
    for given in (photo_file, camera_file):
        if given is not None and given.resolve().parent != path.resolve().parent:
            raise OutputError(f"{path} must lie beside {given}, which it names; choose {given.parent / path.name}")
    if path.suffix.lower() != ".json":
        raise OutputError(f"{path.name} must end in .json, or linecad evaluate does not find it")


def labels_to_json(photo: Photo, camera: object, graph: LineGraph, annotations: Annotations) -> str:
    """The text of the labels file, with one crossing in each line."""
    rows = []
    for edge, label in enumerate(annotations.label):
        if label is not None:
            pair = graph.edges[edge]
            record = {
                "pixel": graph.crossing[edge].tolist(),
                "segments": graph.segments.ends[pair].tolist(),
                "axes": [axis_name(axis) for axis in graph.axis[pair].tolist()],
                "label": label,
            }
            rows.append("  " + json.dumps(record))
    head = [
        f' "{key}": {json.dumps(value)}'
        for key, value in {"format": FORMAT, "version": VERSION, "photo": photo.name, "camera": camera}.items()
    ]
    crossings = ",\n".join(rows)
    return "{\n" + ",\n".join(head) + ',\n "crossings": [' + (f"\n{crossings}\n " if rows else "") + "]\n}\n"
