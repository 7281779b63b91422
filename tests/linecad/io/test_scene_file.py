"""The scene file: reads back exactly, refuses every damage in one line, is what docs/reference/scene-file.md says."""

import copy
import json
import math
import re
import struct
from dataclasses import fields, is_dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from linecad.errors import OutputError, SceneFileError
from linecad.io import scene_file as scenefile
from linecad.io.scene_file import read_scene, scene_from_json, scene_to_json, write_scene
from linecad.line_graph import EDGE_KINDS, STATUSES
from linecad.scene import (
    AXES,
    CAMERA_SOURCES,
    CONFIDENCES,
    DEPTH_KINDS,
    FACE_KINDS,
    OPENING_KINDS,
    QUALITIES,
    REASONS,
    ROLES,
    Camera,
    Certainty,
    DepthMapReport,
    Face,
    Intersections,
    Lines,
    Opening,
    Plane,
    Scene,
    SolveReport,
)

PAGE = Path(__file__).parents[3] / "docs" / "reference" / "scene-file.md"
EXAMPLE = re.search(r"```json\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL).group(1)


# --- random scenes -------------------------------------------------------------------------------------------------

numbers = st.floats(-1e12, 1e12)
coordinates = st.floats(-1e4, 1e4)
ids = st.integers(0, 2**53 - 1)
words = st.text(max_size=12)
rotations = (
    st.tuples(*[st.floats(-1, 1)] * 3)
    .map(lambda v: np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]]))
    .map(lambda skew: np.linalg.solve(np.eye(3) - skew, np.eye(3) + skew))
)  # Cayley


@st.composite
def cameras(draw: st.DrawFn) -> Camera:
    focal, cx, cy = draw(st.floats(1e-3, 1e9)), draw(numbers), draw(numbers)
    return Camera(
        width=draw(st.integers(1, 10**6)),
        height=draw(st.integers(1, 10**6)),
        matrix=np.array([[focal, 0, cx], [0, focal, cy], [0, 0, 1]]),
        source=draw(st.sampled_from(CAMERA_SOURCES)),
        distortion=tuple(draw(st.lists(numbers, max_size=14))),
        is_resampled=draw(st.booleans()),
        taken_fy=draw(st.none() | st.floats(0.1, 1e5)),
    )


@st.composite
def certainties(draw: st.DrawFn) -> Certainty:
    errors = st.floats(0, 1e12)
    # Degrees stand in the file with 12 digits after the point.
    degrees = [round(angle, 12) for angle in draw(st.tuples(*[st.floats(0, 180)] * 3))]
    return Certainty(
        rotation=np.radians(degrees),
        focal=draw(st.none() | errors),
        center=draw(st.none() | st.tuples(errors, errors)),
        radial=draw(st.none() | errors),
        quality=draw(st.sampled_from(QUALITIES)),
        reason=draw(words),
    )


@st.composite
def depth_map_reports(draw: st.DrawFn) -> DepthMapReport:
    positive = st.floats(0, exclude_min=True, allow_infinity=False)
    if draw(st.booleans()):
        return DepthMapReport(draw(words), draw(st.text(min_size=1, max_size=12)))
    return DepthMapReport(
        draw(words),
        "",
        draw(st.sampled_from(DEPTH_KINDS)),
        draw(st.floats(allow_nan=False, allow_infinity=False)),
        draw(positive),
        draw(positive),
    )


pieces = st.lists(st.tuples(*[numbers] * 4), max_size=3).map(lambda rows: np.array(rows).reshape(-1, 2, 2))


@st.composite
def rings(draw: st.DrawFn, axis: int, offset: float) -> np.ndarray:
    ring = np.array(draw(st.lists(st.tuples(*[coordinates] * 3), min_size=3, max_size=6)))
    ring[:, axis] = offset
    return ring


@st.composite
def planes(draw: st.DrawFn, line_ids: list[int]) -> tuple[Plane, ...]:
    plane_ids = draw(st.lists(ids, max_size=3, unique=True))
    face_ids = iter(draw(st.lists(ids, min_size=9, max_size=9, unique=True)))
    found = []
    for plane_id in plane_ids:
        axis, offset = draw(st.integers(0, 2)), draw(coordinates)
        faces = tuple(
            Face(
                next(face_ids),
                draw(rings(axis, offset)),
                tuple(draw(st.lists(rings(axis, offset), max_size=2))),
                draw(st.sampled_from(FACE_KINDS)),
                tuple(draw(st.lists(rings(axis, offset), max_size=2))),
            )
            for _ in range(draw(st.integers(0, 3)))
        )
        members = draw(st.lists(st.sampled_from(line_ids), unique=True)) if line_ids else []
        found.append(Plane(plane_id, axis, offset, tuple(members), faces))
    return tuple(found)


@st.composite
def openings(draw: st.DrawFn, found: tuple[Plane, ...]) -> tuple[Opening, ...]:
    walls = [plane.id for plane in found if plane.axis != 2]
    if not walls:
        return ()
    made = []
    for number in draw(st.lists(ids, max_size=3, unique=True)):
        u, v = (sorted(draw(st.lists(coordinates, min_size=2, max_size=2, unique=True))) for _ in range(2))
        recess, panel = draw(st.just((None, None)) | st.tuples(st.floats(1e-6, 1e3), coordinates))
        kind, shape = draw(st.sampled_from(OPENING_KINDS)), draw(ids)
        wall = draw(st.sampled_from(walls))
        made.append(Opening(number, wall, *u, *v, kind, recess, panel, draw(st.booleans()), shape))
    return tuple(made)


@st.composite
def owned(draw: st.DrawFn, found: tuple[Plane, ...], made: tuple[Opening, ...]) -> tuple[Plane, ...]:
    """The planes, some of whose faces are of openings."""
    owner = st.sampled_from([None, *(opening.id for opening in made)])
    return tuple(
        replace(plane, faces=tuple(replace(face, opening=draw(owner)) for face in plane.faces)) for plane in found
    )


@st.composite
def scenes(draw: st.DrawFn) -> Scene:
    line_ids = draw(st.lists(ids, max_size=5, unique=True))
    n = len(line_ids)
    m = draw(st.integers(0, 4)) if n >= 2 else 0
    real = [draw(st.booleans()) for _ in range(m)]

    def several(count: int, element: st.SearchStrategy[Any]) -> list[Any]:
        return draw(st.lists(element, min_size=count, max_size=count))

    found = draw(planes(line_ids))
    made = draw(openings(found))
    return Scene(
        photo=draw(words),
        camera=draw(cameras()),
        rotation=draw(rotations),
        lines=Lines(
            id=line_ids,
            axis=several(n, st.integers(0, 2)),
            segment=np.array(several(4 * n, numbers)).reshape(n, 2, 2),
            ends=np.array(several(6 * n, coordinates)).reshape(n, 2, 3),
            is_boundary=several(n, st.booleans()),
            component=several(n, ids),
            confidence=several(n, st.sampled_from(CONFIDENCES)),
            probability=several(n, st.floats(0, 1)) if draw(st.booleans()) else (),
            by_depth_map=several(n, st.booleans()) if draw(st.booleans()) else (),
            by_face=several(n, st.booleans()) if draw(st.booleans()) else (),
            role=several(n, st.sampled_from(ROLES)) if draw(st.booleans()) else (),
            pieces=tuple(draw(pieces) for _ in range(n)) if draw(st.booleans()) else (),
        ),
        intersections=Intersections(
            lines=several(m, st.lists(st.sampled_from(line_ids if m else [0, 1]), min_size=2, max_size=2, unique=True)),
            kind=several(m, st.sampled_from(EDGE_KINDS)),
            pixel=np.array(several(2 * m, numbers)).reshape(m, 2),
            real=real,
            in_tree=[each and draw(st.booleans()) for each in real],
            weight=several(m, numbers),
            reason=several(m, st.sampled_from(REASONS)),
        ),
        planes=draw(owned(found, made)),
        solve=SolveReport(
            draw(words),
            draw(words),
            draw(st.sampled_from(STATUSES)),
            *several(3, st.floats(allow_nan=False, allow_infinity=False)),
        ),
        metres_per_unit=draw(st.none() | st.floats(1e-6, 1e6)),
        notes=tuple(draw(st.lists(words, max_size=3))),
        certainty=draw(st.none() | certainties()),
        depth_map=draw(st.none() | depth_map_reports()),
        openings=made,
    )


def exactly(value: Any) -> Any:
    """Something that is equal only where every field, dtype and bit is the same."""
    if is_dataclass(value):
        return type(value), [exactly(getattr(value, field.name)) for field in fields(value)]
    if isinstance(value, np.ndarray):
        return value.shape, [exactly(item) for item in value.ravel().tolist()]
    if isinstance(value, tuple):
        return [exactly(item) for item in value]
    return struct.pack("<d", value) if isinstance(value, float) else (type(value), value)


@settings(max_examples=settings.default.max_examples * 3 // 2)
@given(scenes())
def test_scene_reads_back_bit_for_bit(scene: Scene) -> None:
    text = scene_to_json(scene)
    again = scene_from_json(text)
    assert exactly(again) == exactly(scene)
    assert scene_to_json(again) == text


# --- damage --------------------------------------------------------------------------------------------------------


def containers(value: Any) -> list[tuple[Any, Any]]:
    """Every (container, key) of a document, in a fixed order."""
    found = []
    pairs = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, member in pairs:
        found.append((value, key))
        found += containers(member)
    return found


STRANGE = [
    None,
    True,
    -1,
    0,
    1.5,
    1e300,
    10**400,
    math.nan,
    math.inf,
    "",
    "x",
    "NaN",
    [],
    [[]],
    {},
    [1, 2, 3],
    {"id": 0},
]


def parses(text: str) -> bool:
    """Whether a text reads as a scene; anything but SceneFileError in one short line fails the test."""
    try:
        scene_from_json(text)
    except SceneFileError as error:
        message = str(error)
    else:
        return True
    assert len(message.splitlines()) == 1
    assert len(message) < 300
    return False


@settings(max_examples=settings.default.max_examples * 4)
@given(st.data())
def test_damaged_file_is_refused_with_one_line_or_read(data: st.DataObject) -> None:
    document = json.loads(EXAMPLE)
    for _ in range(data.draw(st.integers(1, 3))):
        container, key = data.draw(st.sampled_from(containers(document)))
        if data.draw(st.booleans()):
            container[key] = copy.deepcopy(data.draw(st.sampled_from(STRANGE)))
        else:
            del container[key]
    parses(json.dumps(document))


@settings(max_examples=settings.default.max_examples * 2)
@given(st.integers(0, len(EXAMPLE) - 3))
def test_cut_file_is_refused(length: int) -> None:
    assert not parses(EXAMPLE[:length])


@settings(max_examples=settings.default.max_examples * 2)
@given(st.integers(0, len(EXAMPLE) - 1), st.characters())
def test_file_with_a_changed_character_is_refused_with_one_line_or_read(place: int, character: str) -> None:
    parses(EXAMPLE[:place] + character + EXAMPLE[place + 1 :])


@given(st.binary(max_size=200))
def test_any_bytes_are_refused(tmp_path_factory: pytest.TempPathFactory, data: bytes) -> None:
    path = tmp_path_factory.getbasetemp() / "any.json"
    path.write_bytes(data)
    with pytest.raises(SceneFileError):
        read_scene(path)


REQUIRED = [
    *("format", "version", "photo", "camera", "lines", "intersections", "planes", "solve"),
    *(f"camera.{key}" for key in ("width", "height", "K", "source", "R_cam_from_world")),
    *(f"lines[1].{key}" for key in ("id", "axis", "segment", "ends", "boundary", "component", "confidence")),
    *(f"intersections[0].{key}" for key in ("lines", "kind", "pixel", "real", "in_tree", "weight")),
    *(f"planes[0].{key}" for key in ("id", "axis", "offset", "lines")),
    *(f"planes[0].faces[0].{key}" for key in ("id", "outline")),
    *(f"solve.{key}" for key in ("solver", "formulation", "status", "objective", "bound", "gap")),
    *(f"certainty.{key}" for key in ("quality", "reason", "rotation_degrees")),
    *(f"depth_map.{key}" for key in ("file", "kind", "shift", "scale", "width")),
    *(f"openings[0].{key}" for key in ("id", "plane", "kind", "u", "v")),
]
OPTIONAL = [
    *("camera.distortion", "camera.resampled", "camera.taken_fy"),
    *("metres_per_unit", "scale_source", "planes[0].faces", "planes[0].faces[0].holes", "notes"),
    *("planes[0].faces[0].kind", "planes[0].faces[0].hidden"),
    *("solve.cuts", "solve.nodes", "intersections[0].reason"),
    *("certainty", "certainty.focal", "certainty.principal_point", "certainty.k1"),
    *("depth_map", "depth_map.left_out", "lines[2].by_depth_map", "lines[1].by_face"),
    *("lines[0].role", "lines[0].pieces"),
    *("openings", "openings[0].shape", "openings[0].completed"),
]


def place_in(document: Any, place: str) -> tuple[Any, Any]:
    """The container and the key of a place such as lines[3].ends."""
    *way, last = [int(word) if word.isdigit() else word for word in re.findall(r"\w+", place)]
    for word in way:
        document = document[word]
    return document, last


def changed(place: str, value: Any) -> str:
    """The example with another value at a place."""
    document = json.loads(EXAMPLE)
    container, key = place_in(document, place)
    container[key] = value
    return json.dumps(document)


def without(place: str) -> str:
    """The example without the key at a place."""
    document = json.loads(EXAMPLE)
    container, key = place_in(document, place)
    del container[key]
    return json.dumps(document)


def refusal(text: str) -> str:
    with pytest.raises(SceneFileError) as caught:
        scene_from_json(text)
    return str(caught.value)


def of_two_frames(turn: Any = 0.25, version: int = 2, axis: str = "x", frame: Any = 1) -> str:
    """The example with its second line along the first axis of another frame."""
    document = json.loads(EXAMPLE) | {"version": version, "turns": [turn]}
    document["lines"][2] |= {"axis": axis, "frame": frame}
    return json.dumps(document)


def test_lines_of_a_second_frame_are_read() -> None:
    scene = scene_from_json(of_two_frames())
    assert scene.turns == (0.25,)
    assert scene.lines.axis.tolist() == [0, 2, 3]


def test_a_scene_of_one_frame_is_written_as_version_1() -> None:
    assert json.loads(scene_to_json(scene_from_json(EXAMPLE)))["version"] == 1
    assert json.loads(scene_to_json(scene_from_json(of_two_frames())))["version"] == 2


@pytest.mark.parametrize("turn", [0, 0.8, -1.0])
def test_a_turn_that_means_another_frame_is_refused(turn: float) -> None:
    expected = "expected a turn of at most an eighth of a circle, in radians, that is not 0"
    assert refusal(of_two_frames(turn)) == f"turns[0] is {turn}, {expected}; see docs/reference/scene-file.md"


def test_turns_in_a_file_of_version_1_are_refused() -> None:
    assert refusal(of_two_frames(version=1)).startswith("turns stands in a file of version 1, expected 2")


def test_version_2_without_turns_and_sloped_planes_is_refused() -> None:
    text = EXAMPLE.replace('"version": 1', '"version": 2')
    assert refusal(text).startswith("neither turns nor a tilt stands in the file, but it is of version 2")


def with_roof(tilt: Any = 2.0, version: int = 2, axis: str = "y") -> str:
    """The example with one more plane, whose normal is turned up from an axis, and a face in it."""
    document = json.loads(EXAMPLE) | {"version": version}
    normal = np.array([0.0, np.cos(2.0), np.sin(2.0)])
    flat = np.array([[1.0, 0, 0], np.cross([1.0, 0, 0], normal)])
    outline = (-3 * normal + np.array([[0, 0], [1, 0], [0, 1]]) @ flat).tolist()
    ids = [face["id"] for plane in document["planes"] for face in plane["faces"]]
    face = {"id": max(ids, default=0) + 1, "kind": "roof", "outline": outline, "holes": []}
    number = max(plane["id"] for plane in document["planes"]) + 1
    plane = {"id": number, "axis": axis, "tilt": tilt, "offset": -3.0, "lines": [], "faces": [face]}
    document["planes"].append(plane)
    return json.dumps(document)


def test_a_sloped_plane_is_read_and_written_in_version_2() -> None:
    scene = scene_from_json(with_roof())
    assert (scene.planes[-1].axis, scene.planes[-1].tilt, scene.turns) == (1, 2.0, ())
    written = json.loads(scene_to_json(scene))
    assert written["version"] == 2
    assert written["planes"][-1]["tilt"] == 2.0
    assert "tilt" not in written["planes"][0]


def test_a_tilt_means_nothing_in_version_1() -> None:
    assert "leaves plane" in refusal(with_roof(version=1))


def test_a_face_that_leaves_its_sloped_plane_is_refused() -> None:
    assert "leaves plane" in refusal(with_roof(tilt=1.9))


@pytest.mark.parametrize(("tilt", "axis"), [(0, "y"), (3.2, "y"), (-1.0, "x"), (1.0, "z")])
def test_a_tilt_that_means_another_plane_is_refused(tilt: float, axis: str) -> None:
    expected = "expected more than 0 and less than pi, beside a level axis"
    assert expected in refusal(with_roof(tilt, axis=axis))


@pytest.mark.parametrize("frame", [-1, 2, 0.5, "1"])
def test_a_frame_that_is_not_told_is_refused(frame: Any) -> None:
    assert refusal(of_two_frames(frame=frame)).startswith(f"lines[2].frame is {json.dumps(frame)}, expected")


def test_an_axis_that_names_its_frame_is_refused() -> None:
    assert refusal(of_two_frames(axis="x2")).startswith('lines[2].axis is "x2", expected one of')


@pytest.mark.parametrize(("axis", "frame", "number"), [("y", 1, 4), ("x", 0, 0), ("y", None, 1), ("z", 1, 2)])
def test_the_frame_decides_which_axis_a_letter_means(axis: str, frame: Any, number: int) -> None:
    assert scene_from_json(of_two_frames(axis=axis, frame=frame)).lines.axis[2] == number


def test_only_level_lines_of_further_frames_tell_a_frame() -> None:
    lines = json.loads(scene_to_json(scene_from_json(of_two_frames())))["lines"]
    assert [(line["axis"], line.get("frame")) for line in lines] == [("x", None), ("z", None), ("x", 1)]


def test_a_key_called_frame_means_nothing_in_version_1() -> None:
    text = EXAMPLE.replace('"axis": "x"', '"axis": "x", "frame": "oak"')
    assert scene_from_json(text).lines.axis.tolist() == [0, 2, 2]


@pytest.mark.parametrize("place", REQUIRED)
def test_missing_key_is_named_with_its_place(place: str) -> None:
    assert refusal(without(place)) == f"{place} is missing; see docs/reference/scene-file.md"


@pytest.mark.parametrize("place", OPTIONAL)
def test_optional_key_may_be_missing(place: str) -> None:
    assert parses(without(place))


def test_every_key_is_either_required_or_optional() -> None:
    document = json.loads(EXAMPLE)
    keys = {key for _, key in containers(document) if isinstance(key, str)}
    # All lines have a probability or none has, so it is optional for all at once.
    assert keys == {re.findall(r"\w+", place)[-1] for place in REQUIRED + OPTIONAL} | {"probability", "recess", "panel"}


WRONG = [
    ("format", "gltf", 'format is "gltf", expected "linecad-scene"'),
    ("version", 3, "version is 3, but only versions 1 and 2 can be read here"),
    ("version", "1", 'version is "1", expected a whole number'),
    ("version", True, "version is true, expected a whole number"),
    ("photo", 7, "photo is 7, expected a string"),
    ("photo", None, "photo is null, expected a string"),
    ("camera", [], "camera is a list of 0, expected an object"),
    ("camera.width", 0, "camera.width is 0, expected a whole number from 1 to 1000000"),
    ("camera.height", 10**7, "camera.height is 10000000, expected a whole number from 1 to 1000000"),
    ("camera.width", 640.5, "camera.width is 640.5, expected a whole number"),
    ("camera.K", [[1, 0, 0], [0, 1, 0]], "camera.K is a list of 2, expected a list of 3"),
    ("camera.K[1]", [0, 500], "camera.K[1] is a list of 2, expected a list of 3"),
    ("camera.K[0][0]", True, "camera.K[0][0] is true, expected a number"),
    ("camera.K[0][0]", -500, "camera.K has focal lengths -500 and 500"),
    ("camera.K[0][0]", 501, "camera.K has focal lengths 501 and 500, expected two equal positive numbers"),
    ("camera.K[0][1]", 1, "camera.K has a wrong form"),
    ("camera.K[1][0]", 1, "camera.K has a wrong form"),
    ("camera.K[2]", [0, 0, 2], "camera.K has a wrong form"),
    ("camera.source", "guess", 'camera.source is "guess", expected one of file, focal option, exif'),
    ("camera.distortion", [0.1, "0"], 'camera.distortion[1] is "0", expected a number'),
    ("camera.R_cam_from_world[0][0]", 1.001, "camera.R_cam_from_world is not a rotation (off by 0.002)"),
    ("camera.R_cam_from_world[0][0]", -1, "camera.R_cam_from_world is not a rotation"),
    ("camera.taken_fy", 0, "camera.taken_fy is 0, expected a positive number"),
    ("camera.taken_fy", "a", "camera.taken_fy is"),
    ("camera.resampled", 1, "camera.resampled is 1, expected true or false"),
    ("certainty", [], "certainty is a list of 0, expected an object"),
    ("certainty.quality", "excellent", 'certainty.quality is "excellent", expected one of good, doubtful, poor'),
    ("certainty.reason", None, "certainty.reason is null, expected a string"),
    ("certainty.rotation_degrees", [1, 2], "certainty.rotation_degrees is a list of 2, expected a list of 3"),
    ("certainty.rotation_degrees[2]", -1, "certainty.rotation_degrees[2] is -1, expected a number of 0 or more"),
    ("certainty.rotation_degrees[0]", 181, "certainty.rotation_degrees[0] is 181, expected a finite number of at most"),
    ("certainty.focal", -5.0, "certainty.focal is -5.0, expected a number of 0 or more"),
    ("certainty.focal", "5 px", 'certainty.focal is "5 px", expected a number'),
    ("certainty.focal", 1e300, "certainty.focal is 1e+300, expected a finite number of at most 1e+12"),
    ("certainty.principal_point", 3, "certainty.principal_point is 3, expected a list"),
    ("certainty.principal_point", [3], "certainty.principal_point is a list of 1, expected a list of 2"),
    ("certainty.principal_point", [3, None], "certainty.principal_point[1] is null, expected a number"),
    ("certainty.k1", True, "certainty.k1 is true, expected a number"),
    ("metres_per_unit", 0, "metres_per_unit is 0, expected a positive number or null"),
    ("metres_per_unit", -2.5, "metres_per_unit is -2.5, expected a positive number or null"),
    ("metres_per_unit", "1 m", 'metres_per_unit is "1 m", expected a number'),
    ("lines", {}, "lines is an object, expected a list"),
    ("lines[1]", 5, "lines[1] is 5, expected an object"),
    ("lines[1].id", 0, "lines[1].id is 0, as is lines[0].id, expected different ids"),
    ("lines[1].id", -1, "lines[1].id is -1, expected a whole number from 0"),
    ("lines[1].id", 2**53, "lines[1].id is 9007199254740992, expected a whole number"),
    ("lines[0].axis", "u", 'lines[0].axis is "u", expected one of x, y, z'),
    ("lines[0].axis", 0, "lines[0].axis is 0, expected one of x, y, z"),
    ("lines[0].axis", "", 'lines[0].axis is "", expected one of x, y, z'),
    ("lines[0].segment", [1, 2, 3, 4], "lines[0].segment is a list of 4, expected a list of 2"),
    ("lines[0].segment[1][0]", "445", 'lines[0].segment[1][0] is "445", expected a number'),
    ("lines[1].ends", [[0, 4], [0, 4]], "lines[1].ends[0] is a list of 2, expected a list of 3"),
    ("lines[1].ends[0][2]", None, "lines[1].ends[0][2] is null, expected a number"),
    (
        "lines[1].ends[0][2]",
        1.1e12,
        "lines[1].ends[0][2] is 1100000000000.0, expected a finite number of at most",
    ),
    ("lines[1].ends[0][2]", 10**400, "expected a finite number of at most 1e+12"),
    ("lines[0].boundary", 1, "lines[0].boundary is 1, expected true or false"),
    ("lines[0].component", -1, "lines[0].component is -1, expected a whole number from 0"),
    ("lines[0].confidence", "sure", 'lines[0].confidence is "sure", expected one of proven, supported, weak'),
    ("lines[0].role", "edge", 'lines[0].role is "edge", expected one of outline, opening, detail'),
    ("lines[0].pieces", [[[0, 1]]], "lines[0].pieces[0] is a list of 1, expected a list of 2"),
    ("lines[1].by_face", "no", 'lines[1].by_face is "no", expected true or false'),
    ("lines[0].pieces", None, "lines[0].pieces is null, expected a list"),
    ("intersections[0].lines", [0, 3], "intersections[0].lines[1] is 3, but no line has this id"),
    ("intersections[0].lines", [0, -1], "intersections[0].lines[1] is -1, expected a whole number from 0"),
    ("intersections[0].lines", [0, 0], "intersections[0].lines[1] is 0, as is intersections[0].lines[0]"),
    ("intersections[0].lines", [0], "intersections[0].lines is a list of 1, expected a list of 2"),
    ("intersections[0].kind", "Y", 'intersections[0].kind is "Y", expected one of L, T, X, collinear'),
    ("intersections[0].pixel", [1, 2, 3], "intersections[0].pixel is a list of 3, expected a list of 2"),
    ("intersections[0].real", "yes", 'intersections[0].real is "yes", expected true or false'),
    ("intersections[0].real", False, "intersections[0] is in the tree without being real"),
    ("intersections[0].weight", [], "intersections[0].weight is a list of 0, expected a number"),
    ("planes[0].axis", "w", 'planes[0].axis is "w", expected one of x, y, z'),
    ("planes[0].offset", "4", 'planes[0].offset is "4", expected a number'),
    ("planes[0].lines", [0, 9], "planes[0].lines[1] is 9, but no line has this id"),
    ("planes[0].faces", None, "planes[0].faces is null, expected a list"),
    (
        "planes[0].faces[0].outline",
        [[0, 4, 0], [1, 4, 0]],
        "faces[0].outline is a list of 2, expected at least 3 points",
    ),
    ("planes[0].faces[0].holes", [[]], "planes[0].faces[0].holes[0] is a list of 0, expected at least 3 points"),
    (
        "planes[0].faces[0].kind",
        "floor",
        'planes[0].faces[0].kind is "floor", expected one of wall, ground, ceiling, roof, window, door, reveal, other',
    ),
    ("planes[0].faces[0].kind", 3, "planes[0].faces[0].kind is 3, expected one of wall, ground"),
    ("planes[0].faces[0].opening", 9, "planes[0].faces[0].opening is 9, but no opening has this id"),
    ("planes[0].faces[0].hidden", [[]], "planes[0].faces[0].hidden[0] is a list of 0, expected at least 3 points"),
    ("planes[0].faces[0].hidden[0][1][1]", 4.1, "face 0 leaves plane 0 (y = 4) by 0.1, expected at most 2.45e-06"),
    ("planes[0].faces[0].outline[2][1]", 4.00001, "face 0 leaves plane 0 (y = 4) by 1e-05, expected at most 2.45e-06"),
    ("planes[0].offset", 5, "face 0 leaves plane 0 (y = 5) by 1"),
    ("openings", {}, "openings is an object, expected a list"),
    ("openings[0].plane", 7, "openings[0].plane is 7, but no vertical plane has this id"),
    ("openings[0].kind", "gate", 'openings[0].kind is "gate", expected one of window, door'),
    ("openings[0].u", [1, 1], "openings[0].u is a list of 2, expected two ascending numbers"),
    ("openings[0].v", [0.2], "openings[0].v is a list of 1, expected a list of 2"),
    ("openings[0].recess", 0, "openings[0].recess is 0, expected a positive number or null"),
    ("openings[0].panel", None, "openings[0] has a recess without a panel, or a panel without a recess"),
    ("openings[0].completed", 1, "openings[0].completed is 1, expected true or false"),
    ("openings[0].shape", -1, "openings[0].shape is -1, expected"),
    ("lines[2].by_depth_map", 1, "lines[2].by_depth_map is 1, expected true or false"),
    ("lines[2].by_depth_map", None, "lines[2].by_depth_map is null, expected true or false"),
    ("lines[0].by_depth_map", "no", 'lines[0].by_depth_map is "no", expected true or false'),
    ("depth_map", "a.npz", 'depth_map is "a.npz", expected an object'),
    ("depth_map", {"file": 3, "left_out": "flat"}, "depth_map.file is 3, expected a string"),
    ("depth_map.file", None, "depth_map.file is null, expected a string"),
    ("depth_map.left_out", True, "depth_map.left_out is true, expected a string"),
    ("depth_map.left_out", "", 'depth_map.left_out is "", expected a reason or null'),
    ("depth_map.kind", "depth", 'depth_map.kind is "depth", expected one of z, distance, inverse, affine-inverse'),
    ("depth_map.kind", None, "depth_map.kind is null, expected one of z, distance, inverse, affine-inverse"),
    ("depth_map.shift", None, "depth_map.shift is null, expected a number"),
    ("depth_map.scale", "1 m", 'depth_map.scale is "1 m", expected a number'),
    ("depth_map.scale", 0, "depth_map.scale is 0, expected a positive number"),
    ("depth_map.scale", 10**400, "expected a finite number"),
    ("depth_map.width", -0.01, "depth_map.width is -0.01, expected a positive number"),
    ("depth_map.width", [], "depth_map.width is a list of 0, expected a number"),
    ("solve", "SCIP", 'solve is "SCIP", expected an object'),
    ("solve.status", 3, "solve.status is 3, expected a string"),
    ("solve.objective", None, "solve.objective is null, expected a number"),
    ("solve.objective", 10**400, "expected a finite number"),
    ("solve.gap", "0", 'solve.gap is "0", expected a number'),
    ("notes", "all well", 'notes is "all well", expected a list'),
    ("notes", ["a", 1], "notes[1] is 1, expected a string"),
]


@pytest.mark.parametrize(("place", "value", "line"), WRONG, ids=[f"{place}-{value!s:.30}" for place, value, _ in WRONG])
def test_wrong_value_is_refused_with_its_place(place: str, value: Any, line: str) -> None:
    message = refusal(changed(place, value))
    assert line in message
    assert message.endswith("; see docs/reference/scene-file.md")


def test_two_planes_may_not_share_an_id_nor_two_faces() -> None:
    document = json.loads(EXAMPLE)
    document["planes"].append(dict(document["planes"][0]))
    assert "planes[1].id is 0, as is planes[0].id" in refusal(json.dumps(document))
    document["planes"][1]["id"] = 1
    assert "planes[1].faces[0].id is 0, as is planes[0].faces[0].id" in refusal(json.dumps(document))


@pytest.mark.parametrize("token", ["NaN", "Infinity", "-Infinity"])
def test_tokens_that_are_not_json_are_refused(token: str) -> None:
    text = EXAMPLE.replace('"weight": 1.0', f'"weight": {token}')
    assert refusal(text).startswith(f"{token} stands for a number, which JSON does not allow")


def test_number_that_overflows_is_refused() -> None:
    text = EXAMPLE.replace('"weight": 1.0', '"weight": 1e999')
    assert "intersections[0].weight is Infinity, expected a finite number" in refusal(text)


def test_number_of_thousands_of_digits_is_refused() -> None:
    text = EXAMPLE.replace('"weight": 1.0', '"weight": ' + "9" * 5000)
    assert "too many digits" in refusal(text)


def test_key_that_stands_twice_is_refused() -> None:
    text = EXAMPLE.replace('"weight": 1.0', '"weight": 1.0, "weight": 2.0')
    assert refusal(text).startswith('the key "weight" stands twice in one object')


@pytest.mark.parametrize("opening", ["[", '{"a":'])
def test_deep_nesting_is_refused(opening: str) -> None:
    assert refusal(opening * 200_000).startswith("lists or objects are nested too deeply")


@pytest.mark.parametrize("text", ["", "[]", "null", "3", '"linecad-scene"'])
def test_what_is_no_object_is_refused(text: str) -> None:
    assert refusal(text).startswith(("not JSON: ", "the file is "))


def test_broken_json_is_named_with_line_and_column() -> None:
    message = refusal(EXAMPLE.replace('"version": 1,', '"version": 1'))
    assert message.startswith("not JSON: ")
    assert "in line 4, column 2" in message


# --- tolerance -----------------------------------------------------------------------------------------------------


def test_unknown_keys_are_ignored_everywhere() -> None:
    document = json.loads(EXAMPLE)
    objects = [document] + [container[key] for container, key in containers(document)]
    for each in objects:
        if isinstance(each, dict):
            each["from the future"] = {"id": [None]}
    assert scene_to_json(scene_from_json(json.dumps(document))) == EXAMPLE


def test_whole_numbers_may_have_a_decimal_point() -> None:
    assert scene_from_json(changed("lines[1].id", 1.0)).lines.id.tolist() == [0, 1, 2]


def test_numbers_may_be_whole() -> None:
    assert scene_from_json(changed("planes[0].offset", 4)).planes[0].offset == 4.0


@pytest.mark.parametrize("seconds", [0.25, None, "long"])
def test_the_time_of_the_solver_in_files_of_earlier_versions_is_ignored(seconds: Any) -> None:
    assert exactly(scene_from_json(changed("solve.seconds", seconds))) == exactly(scene_from_json(EXAMPLE))
    assert scene_to_json(scene_from_json(changed("solve.seconds", seconds))) == scene_to_json(scene_from_json(EXAMPLE))


def test_unknown_status_is_read_as_it_stands() -> None:
    assert scene_from_json(changed("solve.status", "stopped by the weather")).solve.status == "stopped by the weather"


def test_nothing_proven_is_null_in_the_file() -> None:
    scene = scene_from_json(EXAMPLE)
    unproven = replace(scene, solve=replace(scene.solve, bound=math.inf, gap=math.inf))
    text = scene_to_json(unproven)
    assert '"bound": null, "gap": null' in text
    assert scene_from_json(text).solve == unproven.solve


def test_a_camera_that_does_not_tell_was_not_resampled() -> None:
    assert not scene_from_json(without("camera.resampled")).camera.is_resampled
    assert scene_from_json(changed("camera.resampled", True)).camera.is_resampled


def test_certainty_is_null_in_the_file_where_there_is_none() -> None:
    text = scene_to_json(replace(scene_from_json(EXAMPLE), certainty=None))
    assert '"certainty": null' in text
    assert scene_from_json(text).certainty is None


def test_a_scene_without_a_depth_map_says_nothing_of_one() -> None:
    """Its file is what it was before there were depth maps."""
    document = json.loads(EXAMPLE)
    del document["depth_map"], document["lines"][2]["by_depth_map"]
    text = json.dumps(document)
    scene = scene_from_json(text)
    assert scene.depth_map is None
    assert scene.lines.by_depth_map.tolist() == [False] * 3
    assert json.loads(scene_to_json(scene)) == document
    assert "depth_map" not in scene_to_json(scene)


def test_a_scene_of_an_earlier_version_has_outlines_alone() -> None:
    document = json.loads(EXAMPLE)
    for line in document["lines"]:
        line.pop("role")
        line.pop("pieces", None)
    lines = scene_from_json(json.dumps(document)).lines
    assert lines.role.tolist() == ["outline"] * 3
    assert [len(each) for each in lines.pieces] == [0] * 3


def test_faces_of_earlier_files_are_of_no_kind_and_hide_nothing() -> None:
    document = json.loads(EXAMPLE)
    (face,) = document["planes"][0]["faces"]
    del face["kind"], face["hidden"]
    (read,) = scene_from_json(json.dumps(document)).planes[0].faces
    assert (read.kind, read.hidden) == ("other", ())


def test_a_face_that_nothing_hides_says_nothing_of_it() -> None:
    scene = scene_from_json(changed("planes[0].faces[0].hidden", []))
    (face,) = json.loads(scene_to_json(scene))["planes"][0]["faces"]
    assert "hidden" not in face
    assert face["kind"] == "wall"


def test_a_ground_may_have_no_lines() -> None:
    scene = scene_from_json(changed("planes[0].lines", []))
    assert scene.planes[0].lines == ()
    assert json.loads(scene_to_json(scene))["planes"][0]["lines"] == []


def test_lines_that_others_place_do_not_name_the_depth_map() -> None:
    text = changed("lines[0].by_depth_map", False)
    assert scene_to_json(scene_from_json(text)) == EXAMPLE
    both = scene_from_json(changed("lines[0].by_depth_map", True))
    assert both.lines.by_depth_map.tolist() == [True, False, True]


def test_a_depth_map_that_was_left_out_is_a_name_and_a_reason() -> None:
    for more in ({}, {"kind": "z", "scale": "of an earlier version"}):
        text = changed("depth_map", {"file": "a.npz", "left_out": "it holds one depth throughout", **more})
        scene = scene_from_json(text)
        assert scene.depth_map == DepthMapReport("a.npz", "it holds one depth throughout")
        assert json.loads(scene_to_json(scene))["depth_map"] == {
            "file": "a.npz",
            "left_out": "it holds one depth throughout",
        }
    assert scene_from_json(changed("depth_map", None)).depth_map is None


@pytest.mark.parametrize("scale", [1e-30, 1e30])
def test_the_unit_of_a_depth_map_may_be_any(scale: float) -> None:
    scene = scene_from_json(changed("depth_map.scale", scale))
    assert scene.depth_map is not None
    assert scene.depth_map.scale == scale


def test_a_hopeless_rotation_is_180_degrees_in_the_file() -> None:
    scene = scene_from_json(EXAMPLE)
    lost = replace(scene, certainty=replace(scene.certainty, rotation=np.array([1e9, 0.0, 0.0])))
    assert scene_from_json(scene_to_json(lost)).certainty.rotation == pytest.approx([np.pi, 0, 0])


# --- files ---------------------------------------------------------------------------------------------------------


def test_file_reads_back_and_is_the_same_every_time(tmp_path: Path) -> None:
    scene = scene_from_json(EXAMPLE)
    first, second = tmp_path / "été.json", tmp_path / "b.json"
    write_scene(scene, first)
    write_scene(read_scene(first), second)
    assert first.read_bytes() == second.read_bytes() == EXAMPLE.encode()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["b.json", "été.json"]


def test_photo_name_is_kept(tmp_path: Path) -> None:
    for name in ["fotos/Straße 7.jpg", "写真.png", 'a\\b"c.jpg', "not UTF-8 \udce9.jpg"]:
        write_scene(replace(scene_from_json(EXAMPLE), photo=name), tmp_path / "s.json")
        assert read_scene(tmp_path / "s.json").photo == name


def test_byte_order_mark_is_accepted(tmp_path: Path) -> None:
    (tmp_path / "s.json").write_bytes(b"\xef\xbb\xbf" + EXAMPLE.encode())
    assert read_scene(tmp_path / "s.json").photo == "room.jpg"


def test_errors_name_the_file(tmp_path: Path) -> None:
    path = tmp_path / "s.json"
    path.write_text(without("lines[1].ends"))
    with pytest.raises(SceneFileError, match=rf"^{re.escape(str(path))}: lines\[1\]\.ends is missing"):
        read_scene(path)


def test_file_that_is_not_utf8_is_refused(tmp_path: Path) -> None:
    (tmp_path / "s.json").write_bytes(EXAMPLE.encode("utf-16"))
    with pytest.raises(SceneFileError, match=r"s\.json: byte 0 is not UTF-8"):
        read_scene(tmp_path / "s.json")


def test_missing_file_and_folder_are_refused(tmp_path: Path) -> None:
    with pytest.raises(SceneFileError, match=r"none\.json cannot be read: No such file"):
        read_scene(tmp_path / "none.json")
    with pytest.raises(SceneFileError, match="cannot be read: Is a directory"):
        read_scene(tmp_path)


@pytest.mark.usefixtures("bound_by_permissions")
def test_closed_file_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "s.json"
    path.write_text(EXAMPLE)
    path.chmod(0)
    with pytest.raises(SceneFileError, match=r"s\.json cannot be read: Permission denied; give a scene file"):
        read_scene(path)


def test_huge_file_is_refused_without_being_read(tmp_path: Path) -> None:
    path = tmp_path / "huge.json"
    with path.open("wb") as file:
        file.truncate(300 * 2**20)  # sparse: takes no space
    with pytest.raises(SceneFileError, match=r"huge\.json is larger than 256 MiB"):
        read_scene(path)


def test_endless_file_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(scenefile, "LARGEST_FILE", 2**20)
    with pytest.raises(SceneFileError, match="/dev/zero is larger than 1 MiB"):
        read_scene("/dev/zero")


def test_scene_that_could_not_be_read_is_not_written(tmp_path: Path) -> None:
    scene = scene_from_json(EXAMPLE)
    far = replace(scene, lines=replace(scene.lines, ends=scene.lines.ends * 1e12))
    with pytest.raises(OutputError, match=r"the scene cannot be saved: lines\[0\]\.ends\[0\]\[1\] is 4"):
        write_scene(far, tmp_path / "far.json")
    assert not list(tmp_path.iterdir())


def test_missing_folder_is_an_output_error(tmp_path: Path) -> None:
    with pytest.raises(OutputError):
        write_scene(scene_from_json(EXAMPLE), tmp_path / "none" / "s.json")


# --- the page ------------------------------------------------------------------------------------------------------


def test_example_of_the_page_is_exactly_what_is_written() -> None:
    assert scene_to_json(scene_from_json(EXAMPLE)) == EXAMPLE


def test_example_of_the_page_is_a_true_picture() -> None:
    scene = scene_from_json(EXAMPLE)
    seen = scene.lines.ends @ scene.rotation.T @ scene.camera.matrix.T
    np.testing.assert_allclose(seen[..., :2] / seen[..., 2:], scene.lines.segment, atol=1e-9)
    along = np.abs(np.diff(scene.lines.ends, axis=1)[:, 0]).argmax(axis=1)
    assert along.tolist() == scene.lines.axis.tolist()


def named_in_tables(heading: str) -> list[str]:
    """What stands in the first columns of the tables under a heading of the page."""
    section = PAGE.read_text(encoding="utf-8").split(f"\n## {heading}\n")[1].split("\n## ")[0]
    tables = re.findall(r"^\|.*\n\| ---.*\n((?:\|.*\n)+)", section, re.MULTILINE)
    return re.findall(r"`([^`]+)`", "\n".join(row.split("|")[1] for rows in tables for row in rows.splitlines()))


@pytest.mark.parametrize(
    ("heading", "place", "others"),
    [
        ("The top object", "", ("turns",)),
        ("`camera`", "camera", CAMERA_SOURCES),
        ("`certainty`", "certainty", QUALITIES),
        ("`lines[]`", "lines[2]", (*CONFIDENCES, *ROLES, "pieces", "frame", "by_face")),
        ("`intersections[]`", "intersections[0]", REASONS),
        ("`planes[]`", "planes[0]", ("frame", "tilt")),
        ("`planes[].faces[]`", "planes[0].faces[0]", (*FACE_KINDS, "opening")),
        ("`solve`", "solve", STATUSES),
        ("`depth_map`", "depth_map", DEPTH_KINDS),
    ],
)
def test_page_names_every_key_and_word(heading: str, place: str, others: tuple[str, ...]) -> None:
    record = json.loads(EXAMPLE)
    if place:
        container, key = place_in(record, place)
        record = container[key]
    assert sorted(named_in_tables(heading)) == sorted([*record, *others])


def test_page_names_every_kind_and_axis() -> None:
    page = PAGE.read_text(encoding="utf-8")
    assert ", ".join(f'`"{kind}"`' for kind in EDGE_KINDS) in page
    assert ", ".join(f'`"{axis}"`' for axis in AXES) in page
