"""The records that pass between the stages: frozen, with read-only arrays, NumPy and nothing else.

Frames of reference, the same everywhere:

- pixels: OpenCV's; the centre of the first pixel is (0, 0), x right, y down;
- camera: x right, y down, z forward;
- world: the Manhattan axes, z up, right-handed, origin at the camera centre. x is the horizontal axis that runs most
  left to right in the photo and points right, y points away from the camera. The unit is free until a length is known.

Words: a *segment* is in the image, a *line* is in space, an *edge* joins two nodes of the line graph, a *crossing* is
where two segments meet in the image, an *axis* is 0, 1 or 2 (x, y, z), a *depth* is the camera z of a point.
"""

from linecad.scene.camera import Camera, Certainty
from linecad.scene.cells import CELL_KINDS, CellKind, Cells
from linecad.scene.lines import Intersections, Lines
from linecad.scene.reports import DepthMapReport, SolveReport
from linecad.scene.surfaces import Face, Opening, Plane, ground_of
from linecad.scene.whole import SAME_HEIGHT, Scene
from linecad.scene.words import (
    AXES,
    CAMERA_SOURCES,
    CONFIDENCES,
    DEPTH_KINDS,
    DETAIL,
    FACE_KINDS,
    OPENING,
    OPENING_KINDS,
    OUTLINE,
    QUALITIES,
    REASONS,
    ROLES,
    CameraSource,
    Confidence,
    DepthKind,
    FaceKind,
    OpeningKind,
    Quality,
    Reason,
    Role,
)

__all__ = [
    "AXES",
    "CAMERA_SOURCES",
    "CELL_KINDS",
    "CONFIDENCES",
    "DEPTH_KINDS",
    "DETAIL",
    "FACE_KINDS",
    "OPENING",
    "OPENING_KINDS",
    "OUTLINE",
    "QUALITIES",
    "REASONS",
    "ROLES",
    "SAME_HEIGHT",
    "Camera",
    "CameraSource",
    "CellKind",
    "Cells",
    "Certainty",
    "Confidence",
    "DepthKind",
    "DepthMapReport",
    "Face",
    "FaceKind",
    "Intersections",
    "Lines",
    "Opening",
    "OpeningKind",
    "Plane",
    "Quality",
    "Reason",
    "Role",
    "Scene",
    "SolveReport",
    "ground_of",
]
