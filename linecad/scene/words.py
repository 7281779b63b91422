"""The words that the records of a scene use: what each field may say."""

from typing import Literal, get_args

AXES = "xyz"

CameraSource = Literal["file", "focal option", "exif", "vanishing points", "default"]
Confidence = Literal["proven", "supported", "weak"]
Quality = Literal["good", "doubtful", "poor"]
FaceKind = Literal["wall", "ground", "ceiling", "roof", "window", "door", "reveal", "other"]
Role = Literal["outline", "opening", "detail"]  # what a line is drawn for (linecad.model.clean.roles)
DepthKind = Literal["z", "distance", "inverse", "affine-inverse"]  # what a depth map measures (linecad.depth)
OpeningKind = Literal["window", "door"]
# Why a crossing is real or not (linecad.decide.decision, docs/reference/scene-file.md). Real: annotated, chosen.
Reason = Literal[
    "annotated", "chosen", "not chosen", "impossible", "uninformative",
    "unstable", "loose", "small group", "other group",
]  # fmt: skip

CAMERA_SOURCES: tuple[CameraSource, ...] = get_args(CameraSource)
CONFIDENCES: tuple[Confidence, ...] = get_args(Confidence)
REASONS: tuple[Reason, ...] = get_args(Reason)
FACE_KINDS: tuple[FaceKind, ...] = get_args(FaceKind)
ROLES: tuple[Role, ...] = get_args(Role)
OUTLINE, OPENING, DETAIL = ROLES
QUALITIES: tuple[Quality, ...] = get_args(Quality)
DEPTH_KINDS: tuple[DepthKind, ...] = get_args(DepthKind)
OPENING_KINDS: tuple[OpeningKind, ...] = get_args(OpeningKind)
