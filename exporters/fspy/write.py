"""fSpy projects: https://github.com/stuffmatic/fSpy/blob/develop/project_file_format.md

A header, the state of the program as JSON, and the photo. The importer for Blender reads `cameraParameters`. fSpy
itself computes them anew from the control points whenever it opens a project; so these lie where that gives the same
camera: on lines of the scene through the vanishing points.

Glossary: *relative* coordinates count 0 to 1 from the photo's top left corner; *image plane* coordinates have their
origin in the middle of the photo, y up, and half of its longer side as unit. `horizontalFieldOfView` is the angle of
the longer side, also where that stands upright, for so does Blender take it.

An fSpy world has its origin at a point in the photo. In `cameraParameters` it is the model's origin, so that what is
imported stands where the other formats stand; once fSpy has saved the project, it is the control point.
"""

import io
import json
import math
import struct
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from exporters.camera import camera_to_world, principal_point, vanishing_points
from exporters.fspy.control_lines import find_control_lines
from exporters.model import LineGroup, Model
from linecad.arrays import Float
from linecad.directions import MAIN
from linecad.errors import OutputError
from linecad.line_graph import Segments
from linecad.scene import AXES, Camera

_MAGIC, _VERSION = b"fspy", 1
_QUALITY = 95  # of the JPEG, out of 100
_FILM = 36.0  # mm, the longer side of the film that the focal length in mm refers to
_LEAST_SLOPE = 0.05  # sine of the angle between an axis and the image plane; fSpy cannot use a flatter one
_DEFAULT_DISTANCE = 10.0  # from the camera to fSpy's origin where no line gives a length

_Point = dict[str, float]


class _Reference(NamedTuple):
    """fSpy's origin in the photo, and a length from there."""

    origin: _Point
    axis: int | None  # that the length runs along; None where nothing gives one
    distance: float  # m
    offset: float  # of the other end from the origin, towards the vanishing point, in relative coordinates
    has_unit: bool  # the length is known in metres


def write(model: Model, path: Path, photo: NDArray[np.uint8] | None) -> None:
    """Write the camera and the photo as a project; OSError where that fails, OutputError where there is no photo."""
    if photo is None:
        raise OutputError("an fSpy project holds the photo, which was not found; name it with --photo")
    scene = model.scene
    segments = Segments(scene.lines.segment, scene.lines.axis)
    state = _state(scene.camera, scene.rotation, model.eye, segments, _reference(model))
    _write(state, path, photo)


def write_camera(camera: Camera, rotation: Float, segments: Segments, path: Path, photo: NDArray[np.uint8]) -> None:
    """The same without a scene: its control lines are `segments` (axis -1: of none), its length is not known.

    `rotation` (3, 3) takes world to camera. OSError where that fails.
    """
    _write(_state(camera, rotation, np.zeros(3), segments, _no_reference(camera)), path, photo)


def _write(project: dict[str, object], path: Path, photo: NDArray[np.uint8]) -> None:
    state = json.dumps(project, separators=(",", ":")).encode()
    picture = io.BytesIO()
    Image.fromarray(photo).save(picture, format="JPEG", quality=_QUALITY, subsampling=0)
    image = picture.getvalue()
    path.write_bytes(_MAGIC + struct.pack("<III", _VERSION, len(state), len(image)) + state + image)


def _state(camera: Camera, rotation: Float, eye: Float, segments: Segments, reference: _Reference) -> dict[str, object]:
    """All that fSpy keeps of a project; `eye` (3,) is where the camera stands in the world."""
    first, second, third = np.argsort(-np.abs(rotation[2]), kind="stable").tolist()
    two = abs(rotation[2, second]) >= _LEAST_SLOPE
    longer = max(camera.width, camera.height)
    controls = [_controls(camera, rotation, segments, number) for number in (first, second, third)]
    return {
        "globalSettings": {
            "calibrationMode": "TwoVanishingPoints" if two else "OneVanishingPoint",
            "overlay3DGuide": "None",
            "imageOpacity": 1.0,
        },
        "calibrationSettingsBase": {
            "referenceDistanceAxis": None if reference.axis is None else f"{AXES[reference.axis]}Positive",
            "referenceDistance": reference.distance,
            "referenceDistanceUnit": "Meters" if reference.has_unit else "No unit",
            "cameraData": {
                "presetId": None,
                "presetData": None,
                "customSensorWidth": _FILM * camera.width / longer,
                "customSensorHeight": _FILM * camera.height / longer,
            },
            "firstVanishingPointAxis": _axis_word(rotation, first),
            "secondVanishingPointAxis": _axis_word(rotation, second),
        },
        "calibrationSettings1VP": {
            "principalPointMode": "Manual",
            "absoluteFocalLength": _FILM * camera.focal / longer,
        },
        "calibrationSettings2VP": {"principalPointMode": "Manual", "quadModeEnabled": False},
        "controlPointsStateBase": {
            "principalPoint": _relative(camera, principal_point(camera)),
            "origin": reference.origin,
            "referenceDistanceAnchor": reference.origin,
            "referenceDistanceHandleOffsets": [0.0, reference.offset],
            "firstVanishingPoint": controls[0],
        },
        "controlPointsState1VP": {"horizon": _horizon(camera, rotation, first, second)},
        "controlPointsState2VP": {"secondVanishingPoint": controls[1], "thirdVanishingPoint": controls[2]},
        "cameraParameters": _camera_parameters(camera, rotation, eye, (first, second, third)),
        "resultDisplaySettings": {
            "orientationFormat": "AxisAngleDegrees",
            "principalPointFormat": "Absolute",
            "fieldOfViewFormat": "Degrees",
            "displayAbsoluteFocalLength": False,
        },
    }


def _camera_parameters(camera: Camera, rotation: Float, eye: Float, order: tuple[int, int, int]) -> dict[str, object]:
    width, height = camera.width, camera.height
    half = max(width, height) / 2
    pose = camera_to_world(rotation, eye)
    points = vanishing_points(camera, rotation)[list(order)]
    return {
        "principalPoint": _on_image_plane(camera, principal_point(camera)),
        "viewTransform": {"rows": np.linalg.inv(pose).tolist()},
        "cameraTransform": {"rows": pose.tolist()},
        "horizontalFieldOfView": 2.0 * math.atan(half / camera.focal),
        "verticalFieldOfView": 2.0 * math.atan(half * height / width / camera.focal),
        "vanishingPoints": [_on_image_plane(camera, (x, y)) for x, y in points.tolist()],
        "vanishingPointAxes": [_axis_word(rotation, axis) for axis in order],
        "relativeFocalLength": camera.focal / half,
        "imageWidth": width,
        "imageHeight": height,
    }


def _axis_word(rotation: Float, axis: int) -> str:
    """The end of an axis that runs away from the camera, whose vanishing point is the one before it."""
    return f"{AXES[axis]}{'Positive' if rotation[2, axis] >= 0 else 'Negative'}"


def _controls(camera: Camera, rotation: Float, segments: Segments, axis: int) -> dict[str, object]:
    lines = find_control_lines(camera, rotation, segments, axis)
    return {"lineSegments": [[_relative(camera, (x, y)) for x, y in line] for line in lines.tolist()]}


def _horizon(camera: Camera, rotation: Float, first: int, second: int) -> list[_Point]:
    """Two points in the photo on a line that runs as the one through both vanishing points does."""
    start, end = vanishing_points(camera, rotation)[[first, second]]
    direction = (end - start) / np.linalg.norm(end - start)
    size = np.array([camera.width, camera.height], float)
    reach = 0.3 * size.min() * direction
    return [_relative(camera, (x, y)) for x, y in (size / 2 - reach, size / 2 + reach)]


def _reference(model: Model) -> _Reference:
    """The longest line of the largest group."""
    scene = model.scene
    largest = set(scene.lines.id[scene.lines.component == 0].tolist())
    # Along an axis of the world, for fSpy knows no others.
    groups = [group for group in model.groups if group.axis < MAIN and largest & set(group.ids.tolist())]
    found = _longest(groups, largest)
    known = scene.metres_per_unit is not None
    if found is None:
        return _no_reference(scene.camera)._replace(has_unit=known)
    axis, ends = found
    rays = (ends - model.eye) @ scene.rotation.T @ scene.camera.matrix.T
    size = np.array([scene.camera.width, scene.camera.height])
    start, end = (rays[:, :2] / rays[:, 2:] + 0.5) / size
    goal = vanishing_points(scene.camera, scene.rotation)[axis] / size
    towards = goal - start
    offset = float((end - start) @ towards / np.linalg.norm(towards))
    origin = {"x": float(start[0]), "y": float(start[1])}
    return _Reference(origin, axis, float(np.linalg.norm(ends[1] - ends[0])), offset, known)


def _no_reference(camera: Camera) -> _Reference:
    """The middle of the photo, some way off."""
    middle = _relative(camera, (camera.width / 2, camera.height / 2))
    return _Reference(middle, None, _DEFAULT_DISTANCE, 0.0, False)


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


def _relative(camera: Camera, point: tuple[float, float]) -> _Point:
    """Relative coordinates of px from the photo's corner."""
    return {"x": float(point[0]) / camera.width, "y": float(point[1]) / camera.height}


def _on_image_plane(camera: Camera, point: tuple[float, float]) -> _Point:
    """Image plane coordinates of px from the photo's corner."""
    width, height = camera.width, camera.height
    half = max(width, height) / 2
    return {"x": (point[0] - width / 2) / half, "y": (height / 2 - point[1]) / half}
