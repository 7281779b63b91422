"""Two facades that are turned against each other, from labelled segments to a scene and its files."""

import json
from functools import cache
from typing import Any

import numpy as np
import pytest

from exporters.model import build_model
from linecad.directions import components, directions_of
from linecad.finding import FoundLines
from linecad.geometry import project
from linecad.io.scene_file import read_scene, write_scene
from linecad.line_graph import ManhattanFrame, Segments
from linecad.options import Options
from linecad.pipeline import reconstruct_lines
from linecad.scene import Camera, Scene

TURN = np.radians(25.0)
CAMERA = Camera(1920, 1280, np.array([[1300.0, 0, 959.5], [0, 1300, 639.5], [0, 0, 1]]), "file")
YAW = np.radians(-12.0)
C, S = np.cos(YAW), np.sin(YAW)
ROTATION = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]) @ [[C, S, 0], [-S, C, 0], [0, 0, 1]]
FRAME = ManhattanFrame(ROTATION, 0.0, 1.0, (TURN,))
UPWARDS = np.array([0.0, 0.0, 1.0])
CORNER = np.array([1.0, 14.0, 0.0])
HEIGHTS, PLACES = (-1.5, 0.4, 1.9, 3.3), (0.0, 1.1, 2.4, 3.8, 5.0)
NOISE = 0.15  # px


def facade(along: np.ndarray, axis: int) -> list[tuple[int, np.ndarray]]:
    """Level lines and uprights of a wall that begins at the corner: the axis and both ends (2, 3) of each."""
    start, end = CORNER, CORNER + PLACES[-1] * along
    found = [(axis, np.array([start, end]) + height * UPWARDS) for height in HEIGHTS]
    for place in PLACES:
        foot = CORNER + place * along
        found.append((2, np.array([foot + HEIGHTS[0] * UPWARDS, foot + HEIGHTS[-1] * UPWARDS])))
    return found


def lines_in_space() -> list[tuple[int, np.ndarray]]:
    vectors = directions_of((TURN,))
    left, right = facade(-vectors[0], 0), facade(vectors[3], 3)
    return left + [line for line in right if not (line[0] == 2 and np.allclose(line[1][0, :2], CORNER[:2]))]


@cache
def made() -> tuple[Any, np.ndarray]:
    """The reconstruction and the true ends (N, 2, 3) of the lines that its photo shows."""
    lines = lines_in_space()
    ends = np.array([line[1] for line in lines])
    rng = np.random.default_rng(5)
    segments = Segments(
        project(ends, CAMERA.matrix, ROTATION) + rng.normal(0, NOISE, (len(lines), 2, 2)), [line[0] for line in lines]
    )
    return reconstruct_lines("street.jpg", FoundLines(CAMERA, FRAME, segments, ()), Options()), ends


def scene() -> Scene:
    found: Scene = made()[0].scene
    return found


def test_every_line_is_in_its_place():
    true = made()[1]
    lines = scene().lines
    scale = np.median(np.linalg.norm(lines.ends, axis=2)) / np.median(np.linalg.norm(true, axis=2))
    assert len(lines) == len(true)
    for ends in lines.ends / scale:
        off = np.minimum(
            np.linalg.norm(true - ends, axis=2).max(axis=1), np.linalg.norm(true - ends[::-1], axis=2).max(axis=1)
        )
        assert off.min() < 0.05


def test_level_lines_of_the_turned_wall_run_along_its_direction():
    lines = scene().lines
    along = lines.ends[:, 1] - lines.ends[:, 0]
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    assert np.bincount(lines.axis).tolist() == [4, 0, 9, 4]
    cosine = np.abs((along * directions_of((TURN,))[lines.axis]).sum(axis=1))
    np.testing.assert_allclose(cosine, 1.0, atol=1e-12)


def test_lines_of_one_frame_meet_to_rounding_and_those_of_two_nearly():
    graph, lifted = made()[0].graph, made()[0].lifted
    real = np.flatnonzero(made()[0].decision.real & (graph.kind != "collinear"))
    i, j = graph.edges[real].T
    normal = graph.coordinate[real]
    told = components(lifted.ends[:, 0], graph.turns)
    apart = np.abs(told[i, normal] / told[j, normal] - 1)
    own = graph.in_one_frame[real]
    assert own.any()
    assert not own.all()
    assert apart[own].max() < 1e-12
    assert apart[~own].max() < 0.006  # the noise of 0.15 px, of two walls


def test_the_turned_wall_is_a_plane_with_its_lines():
    planes = {plane.axis: plane for plane in scene().planes}
    assert {1, 4} <= set(planes)
    for axis in (1, 4):
        rows = np.isin(scene().lines.id, planes[axis].lines)
        off = components(scene().lines.ends[rows], (TURN,))[..., axis] - planes[axis].offset
        assert np.abs(off).max() < 1e-9 * abs(planes[axis].offset)
        assert rows.sum() >= 8


def test_faces_of_the_turned_wall_lie_in_it():
    faces = [(plane, face) for plane, face in scene().faces if plane.axis == 4]
    assert faces
    for plane, face in faces:
        off = components(face.outline, (TURN,))[:, 4] - plane.offset
        assert np.abs(off).max() < 1e-6 * abs(plane.offset)


def test_the_scene_file_tells_the_turns_and_is_read_as_it_was(tmp_path):
    path = tmp_path / "street.json"
    write_scene(scene(), path)
    document = json.loads(path.read_text())
    assert document["version"] == 2
    assert document["turns"] == [TURN]
    assert {(line["axis"], line.get("frame", 0)) for line in document["lines"]} == {("x", 0), ("z", 0), ("x", 1)}
    assert {("y", 0), ("y", 1)} <= {(plane["axis"], plane.get("frame", 0)) for plane in document["planes"]}
    again = read_scene(path)
    assert again.turns == (TURN,)
    assert again.lines.axis.tolist() == scene().lines.axis.tolist()
    assert again.lines.ends.tobytes() == scene().lines.ends.tobytes()


def test_the_model_of_formats_has_the_angle_of_the_walls():
    model = build_model(scene())
    names = {group.name for group in model.groups}
    assert any(name.startswith("lines_x2_") for name in names)
    by_plane = {plane.id: plane.axis for plane in scene().planes}
    normals = {by_plane[face.plane]: face.normal for face in model.faces}
    angle = np.arccos(abs(normals[1] @ normals[4]))
    assert angle == pytest.approx(TURN, abs=1e-12)
    for face in model.faces:
        assert np.ptp(face.vertices @ face.normal) < 1e-6 * np.abs(face.vertices).max()
        assert face.normal @ face.vertices[0] < 0  # it looks at the camera, which is the origin


def test_real_crossings_of_both_frames_meet_in_space():
    lines, crossings = scene().lines, scene().intersections
    first, second = np.searchsorted(lines.id, crossings.lines[crossings.real]).T
    vectors = directions_of(scene().turns)
    normal = np.cross(vectors[lines.axis[first]], vectors[lines.axis[second]])
    across = ~np.isclose(np.linalg.norm(normal, axis=1), 0)
    apart = ((lines.ends[first, 0] - lines.ends[second, 0]) * normal).sum(axis=1)[across]
    two_frames = (lines.axis[first] >= 3) != (lines.axis[second] >= 3)
    assert two_frames[across].sum() > 5
    assert np.abs(apart).max() < 1e-9 * np.abs(lines.ends).max()
