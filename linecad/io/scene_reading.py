"""Plain JSON values as a Scene, with everything checked that docs/reference/scene-file.md promises."""

import math
from typing import cast

import numpy as np

from linecad.arrays import Float
from linecad.directions import UP, Turns, axis_name
from linecad.io.members import (
    LARGEST_NUMBER,
    count_or_zero,
    distinct_ids,
    known_member,
    line_ids,
    optional_boolean,
    optional_items,
)
from linecad.io.scene_document import FORMAT, FRAMES_VERSION, LARGEST_ERROR, VERSION
from linecad.io.strict_json import JsonError, Node
from linecad.io.surface_reading import read_direction, read_openings, read_planes
from linecad.line_graph import EDGE_KINDS
from linecad.scene import (
    CAMERA_SOURCES,
    CONFIDENCES,
    DEPTH_KINDS,
    QUALITIES,
    REASONS,
    ROLES,
    Camera,
    CameraSource,
    Certainty,
    DepthKind,
    DepthMapReport,
    Intersections,
    Lines,
    Quality,
    Scene,
    SolveReport,
)

LARGEST_TURN = math.pi / 4 + 1e-9  # rad; what is turned by more is turned by less against the other axis
LARGEST_PHOTO = 10**6  # px along one side
FLATNESS = 1e-6  # of the scene's size: how far a face may leave its plane before the file contradicts itself
ROTATION_ERROR = 1e-6  # largest element of R R' - 1
SQUARENESS = 1e-9  # relative difference of the two focal lengths, and skew over focal length


def scene_of(top: Node) -> Scene:
    """The scene that a document tells; ValueError in one line, mostly a JsonError with the place, where it is wrong."""
    if top["format"].value != FORMAT:
        raise top["format"].wrong(f'"{FORMAT}"')
    if top["version"].integer() not in (VERSION, FRAMES_VERSION):
        found = top["version"].value
        raise JsonError(f"version is {found}, but only versions {VERSION} and {FRAMES_VERSION} can be read here")
    camera, rotation = _camera(top["camera"])
    turns = _turns(top)
    lines = _lines(top["lines"].items(), turns)
    known = set(lines.id.tolist())
    told = optional_items(top, "openings")
    is_second = top["version"].integer() == FRAMES_VERSION
    planes = read_planes(
        top["planes"].items(), known, {node["id"].integer() for node in told}, turns if is_second else None
    )
    if is_second and not turns and not any(plane.tilt for plane in planes):
        raise JsonError(f"neither turns nor a tilt stands in the file, but it is of version {FRAMES_VERSION}")
    scene = Scene(
        photo=top["photo"].text(),
        camera=camera,
        rotation=rotation,
        lines=lines,
        intersections=_intersections(top["intersections"].items(), known),
        planes=planes,
        solve=_solve_report(top["solve"]),
        metres_per_unit=_metres_per_unit(top.get("metres_per_unit")),
        scale_source=_text_or_none(top.get("scale_source")),
        notes=tuple(note.text() for note in optional_items(top, "notes")),
        certainty=_certainty(top.get("certainty")),
        depth_map=_depth_map(top.get("depth_map")),
        openings=read_openings(told, {plane.id for plane in planes if plane.axis != UP and not plane.tilt}),
        turns=turns,
    )
    _check_flatness(scene)
    return scene


def _turns(top: Node) -> Turns:
    """Of the frames beside the world's axes, rad; only files of the second version may have some."""
    told = optional_items(top, "turns")
    if told and top["version"].integer() != FRAMES_VERSION:
        raise JsonError(f"turns stands in a file of version {top['version'].value}, expected {FRAMES_VERSION}")
    for node in told:
        if not 0 < abs(node.number()) <= LARGEST_TURN:
            raise node.wrong("a turn of at most an eighth of a circle, in radians, that is not 0")
    return tuple(node.number() for node in told)


def _camera(node: Node) -> tuple[Camera, Float]:
    """The camera and the (3, 3) rotation from the world to it."""
    matrix = node["K"].array(3, 3, largest=LARGEST_NUMBER)
    fx, fy = matrix[0, 0], matrix[1, 1]
    if not (fx > 0 and fy > 0 and abs(fx - fy) <= SQUARENESS * fx):
        raise JsonError(f"camera.K has focal lengths {fx:g} and {fy:g}, expected two equal positive numbers")
    if abs(matrix[0, 1]) > SQUARENESS * fx or matrix[1, 0] != 0 or matrix[2].tolist() != [0, 0, 1]:
        raise JsonError("camera.K has a wrong form, expected [[f, 0, cx], [0, f, cy], [0, 0, 1]]")
    rotation = node["R_cam_from_world"].array(3, 3, largest=LARGEST_NUMBER)
    off = np.abs(rotation @ rotation.T - np.eye(3)).max()
    if off > ROTATION_ERROR or np.linalg.det(rotation) < 0:
        raise JsonError(f"camera.R_cam_from_world is not a rotation (off by {off:.3g})")
    camera = Camera(
        width=node["width"].integer(1, LARGEST_PHOTO),
        height=node["height"].integer(1, LARGEST_PHOTO),
        matrix=matrix,
        source=cast(CameraSource, node["source"].one_of(CAMERA_SOURCES)),
        distortion=tuple(item.number(LARGEST_NUMBER) for item in optional_items(node, "distortion")),
        is_resampled=optional_boolean(node, "resampled"),
        taken_fy=_taken_fy(node),
    )
    return camera, rotation


def _taken_fy(node: Node) -> float | None:
    told = known_member(node, "taken_fy")
    if told is not None and not told.number(LARGEST_NUMBER) > 0:
        raise told.wrong("a positive number")
    return None if told is None else told.number()


def _certainty(node: Node | None) -> Certainty | None:
    if node is None or node.value is None:
        return None
    turns = node["rotation_degrees"].items()
    if len(turns) != 3:
        raise node["rotation_degrees"].wrong("a list of 3")
    center = known_member(node, "principal_point")
    if center is not None and len(center.items()) != 2:
        raise center.wrong("a list of 2")
    focal, radial = known_member(node, "focal"), known_member(node, "k1")
    x, y = (0.0, 0.0) if center is None else map(_standard_error, center.items())
    return Certainty(
        rotation=np.radians([_standard_error(turn, LARGEST_ERROR) for turn in turns]),
        focal=None if focal is None else _standard_error(focal),
        center=None if center is None else (x, y),
        radial=None if radial is None else _standard_error(radial),
        quality=cast(Quality, node["quality"].one_of(QUALITIES)),
        reason=node["reason"].text(),
    )


def _depth_map(node: Node | None) -> DepthMapReport | None:
    if node is None or node.value is None:
        return None
    left_out = known_member(node, "left_out")
    if left_out is not None:
        if not left_out.text():
            raise left_out.wrong("a reason or null")
        return DepthMapReport(node["file"].text(), left_out.text())
    shift, scale, width = (node[key].number() for key in ("shift", "scale", "width"))
    for key, value in (("scale", scale), ("width", width)):
        if value <= 0:
            raise node[key].wrong("a positive number")
    return DepthMapReport(
        node["file"].text(), "", cast(DepthKind, node["kind"].one_of(DEPTH_KINDS)), shift, scale, width
    )


def _standard_error(node: Node, largest: float = LARGEST_NUMBER) -> float:
    if node.number(largest) < 0:
        raise node.wrong("a number of 0 or more")
    return node.number()


def _lines(nodes: list[Node], turns: Turns) -> Lines:
    ids = [node["id"] for node in nodes]
    return Lines(
        id=np.array(distinct_ids(ids), np.int64),
        axis=np.array([read_direction(node, turns) for node in nodes], np.int64),
        segment=np.array([node["segment"].array(2, 2, largest=LARGEST_NUMBER) for node in nodes]),
        ends=np.array([node["ends"].array(2, 3, largest=LARGEST_NUMBER) for node in nodes]),
        is_boundary=np.array([node["boundary"].boolean() for node in nodes], bool),
        component=np.array([node["component"].integer() for node in nodes], np.int64),
        confidence=np.array([node["confidence"].one_of(CONFIDENCES) for node in nodes], str),
        probability=_probabilities(nodes),
        by_depth_map=np.array([optional_boolean(node, "by_depth_map") for node in nodes], bool),
        by_face=np.array([optional_boolean(node, "by_face") for node in nodes], bool),
        role=np.array([_role(node.get("role")) for node in nodes], str),
        pieces=tuple(_pieces(node) for node in nodes),
    )


def _role(node: Node | None) -> str:
    """What a line is drawn for; in files written before it was known all are outlines."""
    return ROLES[0] if node is None else node.one_of(ROLES)


def _pieces(node: Node) -> Float:
    """The segments (K, 2, 2) that a line was joined from, none where it has one."""
    pieces = [piece.array(2, 2, largest=LARGEST_NUMBER) for piece in optional_items(node, "pieces")]
    return np.array(pieces).reshape(-1, 2, 2)


def _probabilities(nodes: list[Node]) -> Float:
    """Of all lines, or of none where the first tells none."""
    if not nodes or nodes[0].get("probability") is None:
        for node in nodes:
            if node.get("probability") is not None:
                raise JsonError(f"{node.place} has a probability, {nodes[0].place} has none: all have one or none has")
        return np.zeros(0)
    told = [node["probability"] for node in nodes]
    for node in told:
        if not 0 <= node.number() <= 1:
            raise node.wrong("a number from 0 to 1")
    return np.array([node.number() for node in told])


def _intersections(nodes: list[Node], known: set[int]) -> Intersections:
    pairs = [line_ids(node["lines"], known) for node in nodes]
    for node, pair in zip(nodes, pairs, strict=True):
        if len(pair) != 2:
            raise node["lines"].wrong("a list of 2")
        if node["in_tree"].boolean() and not node["real"].boolean():
            raise JsonError(f"{node.place} is in the tree without being real")
    return Intersections(
        lines=np.array(pairs, np.int64),
        kind=np.array([node["kind"].one_of(EDGE_KINDS) for node in nodes], str),
        pixel=np.array([node["pixel"].array(2, largest=LARGEST_NUMBER) for node in nodes]),
        real=np.array([node["real"].boolean() for node in nodes], bool),
        in_tree=np.array([node["in_tree"].boolean() for node in nodes], bool),
        weight=np.array([node["weight"].number(LARGEST_NUMBER) for node in nodes], float),
        reason=np.array([_reason(node.get("reason")) for node in nodes], str),
    )


def _reason(node: Node | None) -> str:
    """Why a crossing is real or not; files written before it was known do not tell."""
    return "" if node is None else node.one_of((*REASONS, ""))


def _solve_report(node: Node) -> SolveReport:
    return SolveReport(
        solver=node["solver"].text(),
        formulation=node["formulation"].text(),
        status=node["status"].text(),
        objective=node["objective"].number(),
        bound=_number_or_unknown(node["bound"]),
        gap=_number_or_unknown(node["gap"]),
        cuts=count_or_zero(node.get("cuts")),
        nodes=count_or_zero(node.get("nodes")),
    )


def _number_or_unknown(node: Node) -> float:
    return math.inf if node.value is None else node.number()


def _metres_per_unit(node: Node | None) -> float | None:
    if node is None or node.value is None:
        return None
    metres = node.number(LARGEST_NUMBER)
    if metres <= 0:
        raise node.wrong("a positive number or null")
    return metres


def _text_or_none(node: Node | None) -> str:
    return "" if node is None or node.value is None else node.text()


def _check_flatness(scene: Scene) -> None:
    """JsonError where a face leaves its plane by more than FLATNESS of the diagonal of the box around the scene."""
    rings = [(plane, face, ring) for plane, face in scene.faces for ring in (face.outline, *face.holes, *face.hidden)]
    if not rings:
        return
    points = np.concatenate([scene.lines.ends.reshape(-1, 3), *(ring for _, _, ring in rings)])
    size = float(np.linalg.norm(np.ptp(points, axis=0)))
    for plane, face, ring in rings:
        off = float(np.abs(plane.along_normal(ring, scene.turns) - plane.offset).max())
        if off > FLATNESS * size:
            raise JsonError(
                f"face {face.id} leaves plane {plane.id} ({axis_name(plane.axis)} = {plane.offset:g}) by {off:.3g}, "
                f"expected at most {FLATNESS * size:.3g}"
            )
