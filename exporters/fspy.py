"""fSpy projects: https://github.com/stuffmatic/fSpy/blob/develop/project_file_format.md

A header, the state of the program as JSON, and the photo. The importer for Blender reads `cameraParameters`. fSpy
itself computes them anew from the control points whenever it opens a project; so these lie where that gives the same
camera: on lines of the scene through the vanishing points.

Glossary: *relative* coordinates count 0 to 1 from the photo's top left corner; *image plane* coordinates have their
origin in the middle of the photo, y up, and half of its longer side as unit. `horizontalFieldOfView` is the angle of
the longer side, also where that stands upright, for so does Blender take it.

An fSpy world has its origin at a point in the photo. In `cameraParameters` it is the scene's origin, the camera, so
that what is imported stands where the other formats stand; once fSpy has saved the project, it is the control point.
"""

import io
import json
import math
import struct
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from exporters.camera import camera_to_world, principal_point
from exporters.control_lines import find_control_lines, vanishing_points
from exporters.model import LineGroup, build_model
from linecad.errors import OutputError
from linecad.scene import AXES, Float, Scene

_MAGIC, _VERSION = b"fspy", 1
_QUALITY = 95  # of the JPEG, out of 100
_FILM = 36.0  # mm, the longer side of the film that the focal length in mm is said for
_LEAST_SLOPE = 0.05  # sine of the angle between an axis and the image plane; fSpy cannot use a flatter one
_DEFAULT_DISTANCE = 10.0  # from the camera to fSpy's origin where no line gives a length

_Point = dict[str, float]


def write(scene: Scene, path: Path, photo: NDArray[np.uint8] | None) -> None:
    """Write the camera and the photo as a project; OSError where that fails, OutputError where there is no photo."""
    if photo is None:
        raise OutputError("an fSpy project holds the photo, which was not found; name it with --photo")
    state = json.dumps(_state(scene), separators=(",", ":")).encode()
    picture = io.BytesIO()
    Image.fromarray(photo).save(picture, format="JPEG", quality=_QUALITY, subsampling=0)
    image = picture.getvalue()
    path.write_bytes(_MAGIC + struct.pack("<III", _VERSION, len(state), len(image)) + state + image)


def _state(scene: Scene) -> dict[str, object]:
    """All that fSpy keeps of a project."""
    first, second, third = np.argsort(-np.abs(scene.rotation[2]), kind="stable").tolist()
    two = abs(scene.rotation[2, second]) >= _LEAST_SLOPE
    width, height = scene.camera.width, scene.camera.height
    longer = max(width, height)
    centre = _relative(scene, principal_point(scene.camera))
    origin, axis, distance, offset = _reference(scene)
    known = scene.metres_per_unit is not None
    controls = [_controls(scene, number) for number in (first, second, third)]
    return {
        "globalSettings": {
            "calibrationMode": "TwoVanishingPoints" if two else "OneVanishingPoint",
            "overlay3DGuide": "None",
            "imageOpacity": 1.0,
        },
        "calibrationSettingsBase": {
            "referenceDistanceAxis": None if axis is None else f"{AXES[axis]}Positive",
            "referenceDistance": distance,
            "referenceDistanceUnit": "Meters" if known else "No unit",
            "cameraData": {
                "presetId": None,
                "presetData": None,
                "customSensorWidth": _FILM * width / longer,
                "customSensorHeight": _FILM * height / longer,
            },
            "firstVanishingPointAxis": _axis_word(scene, first),
            "secondVanishingPointAxis": _axis_word(scene, second),
        },
        "calibrationSettings1VP": {
            "principalPointMode": "Manual",
            "absoluteFocalLength": _FILM * scene.camera.focal / longer,
        },
        "calibrationSettings2VP": {"principalPointMode": "Manual", "quadModeEnabled": False},
        "controlPointsStateBase": {
            "principalPoint": centre,
            "origin": origin,
            "referenceDistanceAnchor": origin,
            "referenceDistanceHandleOffsets": [0.0, offset],
            "firstVanishingPoint": controls[0],
        },
        "controlPointsState1VP": {"horizon": _horizon(scene, first, second)},
        "controlPointsState2VP": {"secondVanishingPoint": controls[1], "thirdVanishingPoint": controls[2]},
        "cameraParameters": _camera_parameters(scene, (first, second, third)),
        "resultDisplaySettings": {
            "orientationFormat": "AxisAngleDegrees",
            "principalPointFormat": "Absolute",
            "fieldOfViewFormat": "Degrees",
            "displayAbsoluteFocalLength": False,
        },
    }


def _camera_parameters(scene: Scene, order: tuple[int, int, int]) -> dict[str, object]:
    width, height, focal = scene.camera.width, scene.camera.height, scene.camera.focal
    half = max(width, height) / 2
    pose = camera_to_world(scene)
    points = vanishing_points(scene)[list(order)]
    return {
        "principalPoint": _on_image_plane(scene, principal_point(scene.camera)),
        "viewTransform": {"rows": np.linalg.inv(pose).tolist()},
        "cameraTransform": {"rows": pose.tolist()},
        "horizontalFieldOfView": 2.0 * math.atan(half / focal),
        "verticalFieldOfView": 2.0 * math.atan(half * height / width / focal),
        "vanishingPoints": [_on_image_plane(scene, (x, y)) for x, y in points.tolist()],
        "vanishingPointAxes": [_axis_word(scene, axis) for axis in order],
        "relativeFocalLength": focal / half,
        "imageWidth": width,
        "imageHeight": height,
    }


def _axis_word(scene: Scene, axis: int) -> str:
    """The end of an axis that runs away from the camera, whose vanishing point is the one before it."""
    return f"{AXES[axis]}{'Positive' if scene.rotation[2, axis] >= 0 else 'Negative'}"


def _controls(scene: Scene, axis: int) -> dict[str, object]:
    lines = find_control_lines(scene, axis)
    return {"lineSegments": [[_relative(scene, (x, y)) for x, y in line] for line in lines.tolist()]}


def _horizon(scene: Scene, first: int, second: int) -> list[_Point]:
    """Two points in the photo on a line that runs as the one through both vanishing points does."""
    start, end = vanishing_points(scene)[[first, second]]
    direction = (end - start) / np.linalg.norm(end - start)
    size = np.array([scene.camera.width, scene.camera.height], float)
    reach = 0.3 * size.min() * direction
    return [_relative(scene, (x, y)) for x, y in (size / 2 - reach, size / 2 + reach)]


def _reference(scene: Scene) -> tuple[_Point, int | None, float, float]:
    """fSpy's origin in the photo, and a length from there: axis, length in m, and its end in the photo.

    The longest line of the largest group is taken; the end is told by its distance from the origin towards the
    vanishing point, in relative coordinates.
    """
    largest = set(scene.lines.id[scene.lines.component == 0].tolist())
    groups = [group for group in build_model(scene).groups if largest & set(group.ids.tolist())]
    found = _longest(groups, largest)
    if found is None:
        middle = (scene.camera.width / 2, scene.camera.height / 2)
        return _relative(scene, middle), None, _DEFAULT_DISTANCE, 0.0
    axis, ends = found
    rays = ends @ scene.rotation.T @ scene.camera.matrix.T
    size = np.array([scene.camera.width, scene.camera.height])
    start, end = (rays[:, :2] / rays[:, 2:] + 0.5) / size
    goal = vanishing_points(scene)[axis] / size
    towards = goal - start
    offset = float((end - start) @ towards / np.linalg.norm(towards))
    return {"x": float(start[0]), "y": float(start[1])}, axis, float(np.linalg.norm(ends[1] - ends[0])), offset


def _longest(groups: list[LineGroup], ids: set[int]) -> tuple[int, Float] | None:
    """Axis and ends (2, 3) m of the longest of these lines."""
    best: tuple[int, Float] | None = None
    longest = 0.0
    for group in groups:
        lengths = np.linalg.norm(group.ends[:, 1] - group.ends[:, 0], axis=1)
        lengths[~np.isin(group.ids, list(ids))] = 0.0
        row = int(lengths.argmax())
        if lengths[row] > longest:
            longest, best = float(lengths[row]), (group.axis, group.ends[row])
    return best


def _relative(scene: Scene, point: tuple[float, float]) -> _Point:
    """Relative coordinates of px from the photo's corner."""
    return {"x": float(point[0]) / scene.camera.width, "y": float(point[1]) / scene.camera.height}


def _on_image_plane(scene: Scene, point: tuple[float, float]) -> _Point:
    """Image plane coordinates of px from the photo's corner."""
    width, height = scene.camera.width, scene.camera.height
    half = max(width, height) / 2
    return {"x": (point[0] - width / 2) / half, "y": (height / 2 - point[1]) / half}
