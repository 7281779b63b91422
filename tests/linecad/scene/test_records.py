"""The records refuse what contradicts itself, with both numbers in the message, and cannot be changed afterwards."""

from dataclasses import FrozenInstanceError, fields, replace
from typing import Any

import numpy as np
import pytest

from linecad.line_graph import LineGraph, ManhattanFrame, Segments, Solution
from linecad.scene import Camera, DepthMapReport, Face, Intersections, Lines, Opening, Plane, Scene, SolveReport

K = np.array([[500.0, 0, 320], [0, 500, 240], [0, 0, 1]])
TRIANGLE = [[0, 4, 0], [1, 4, 0], [0, 4, 1]]

camera = Camera(640, 480, K, "file")
segments = Segments(np.arange(12.0).reshape(3, 2, 2), [0, 1, 2])
frame = ManhattanFrame(np.eye(3), residual=0.01, explained=0.9)
graph = LineGraph(
    segments=segments,
    rays=np.ones((3, 3)),
    end_rays=np.ones((3, 2, 3)),
    edges=[[0, 1], [1, 2]],
    crossing=[[5, 5], [6, 6]],
    gap=[[0, 1], [2, 0]],
    kind=["L", "T"],
    corner=[True, False],
    weight=[1, 2],
    coordinate=[2, 0],
    log_ratio=[0.1, -0.1],
    tolerance=[0.01, 0.01],
    possible=[True, True],
    informative=[True, True],
)
solution = Solution(
    status="optimal",
    solver="SCIP",
    formulation="paper",
    objective=1,
    bound=1,
    gap=0,
    seconds=0.1,
    nodes=1,
    connected=[True, False],
    is_boundary=[False, False, True],
    planar_pairs=np.zeros((0, 3)),
    log_depth=[0, 0, 0],
)
lines = Lines(
    id=[4, 7],
    axis=[0, 2],
    segment=np.zeros((2, 2, 2)),
    ends=np.zeros((2, 2, 3)),
    is_boundary=[True, False],
    component=[0, 0],
    confidence=["proven", "weak"],
)
intersections = Intersections(lines=[[4, 7]], kind=["L"], pixel=[[1, 2]], real=[True], in_tree=[True], weight=[1])
face = Face(0, TRIANGLE, (TRIANGLE,))
plane = Plane(0, 1, 4.0, (4, 7), (face,))
scene = Scene(
    photo="room.jpg",
    camera=camera,
    rotation=np.eye(3),
    lines=lines,
    intersections=intersections,
    planes=(plane,),
    solve=SolveReport("SCIP", "paper", "optimal", 1, 1, 0),
)
used = DepthMapReport("a.npz", "", "z", 0.0, 1.5, 0.02)
left_out = DepthMapReport("a.npz", "it holds one depth throughout")
RECORDS = [camera, segments, frame, graph, solution, lines, intersections, face, plane, scene, used, left_out]

REFUSED = [
    (camera, "width", 0, "Camera is 0 x 480 px"),
    (camera, "height", -1, "Camera is 640 x -1 px"),
    (camera, "matrix", np.eye(2), "Camera.matrix has shape 2x2, expected 3x3"),
    (camera, "matrix", K * [[np.nan], [1], [1]], "Camera.matrix holds a number that is not finite"),
    (camera, "matrix", K * [[-1], [1], [1]], "Camera has focal lengths -500.0 and 500.0"),
    (camera, "matrix", K * [[1], [1], [2]], r"Camera.matrix ends in \[0.0, 0.0, 2.0\]"),
    (segments, "ends", np.zeros((3, 2, 3)), "Segments.ends has shape 3x2x3, expected anyx2x2"),
    (segments, "ends", np.zeros((2, 2, 2)), "Segments.axis has 3 entries, expected 2"),
    (segments, "axis", [0, 1, -2], "Segments.axis holds -2, expected -1 or the number of a direction"),
    (frame, "rotation", np.diag([1, 1, -1]), "ManhattanFrame.rotation is not a rotation"),
    (frame, "rotation", np.eye(3) * 1.001, r"ManhattanFrame.rotation is not a rotation \(off by 0.002\)"),
    (graph, "rays", np.ones((2, 3)), "LineGraph.rays has 2 entries, expected 3"),
    (graph, "weight", [1, 2, 3], "LineGraph.weight has 3 entries, expected 2"),
    (graph, "edges", [[0, 1], [1, 3]], "LineGraph.edges name segment 3 of 3"),
    (graph, "edges", [[0, 1], [2, 1]], "LineGraph.edges must name the smaller segment first"),
    (graph, "kind", ["L", "Y"], r"LineGraph.kind holds \['Y'\], expected L, T, X, collinear"),
    (graph, "log_ratio", [0, np.inf], "LineGraph.log_ratio holds a number that is not finite"),
    (solution, "log_depth", [0, 0], "Solution.log_depth has 2 entries, expected 3"),
    (solution, "planar_pairs", [[0, 1]], "Solution.planar_pairs has shape 1x2, expected anyx3"),
    (lines, "id", [4, 4], "Lines: the id 4 stands twice"),
    (lines, "id", [4, -7], "Lines.id holds -7, expected 0 or more"),
    (lines, "component", [0, -1], "Lines.component holds -1, expected 0 or more"),
    (lines, "axis", [0, -1], "Lines.axis holds -1, expected 0 or more"),
    (lines, "ends", np.full((2, 2, 3), np.nan), "Lines.ends holds a number that is not finite"),
    (lines, "confidence", ["proven", "sure"], r"Lines.confidence holds \['sure'\], expected proven, supported, weak"),
    (lines, "by_depth_map", [True], "Lines.by_depth_map has 1 entries, expected 2"),
    (used, "left_out", "it is flat", "DepthMapReport must say either why the map was left out, or all about it"),
    *((used, name, None, "DepthMapReport must say either") for name in ("kind", "shift", "scale", "width")),
    (used, "kind", "depth", "DepthMapReport.kind is 'depth', expected one of z, distance, inverse, affine-inverse"),
    (left_out, "left_out", "", "DepthMapReport must say either"),
    (left_out, "scale", 2.0, "DepthMapReport must say"),
    (intersections, "kind", ["Y"], r"Intersections.kind holds \['Y'\], expected L, T, X, collinear"),
    (intersections, "real", [True, False], "Intersections.real has 2 entries, expected 1"),
    (face, "outline", TRIANGLE[:2], r"Face 0 has a ring of shape \(2, 3\), expected at least 3 points"),
    (face, "holes", ([[0, 0], [1, 1], [2, 2]],), r"Face 0 has a ring of shape \(3, 2\), expected at least 3 points"),
    (face, "holes", ([[0, 4, np.inf]] * 3,), "Face 0 holds a number that is not finite"),
    (face, "hidden", (TRIANGLE[:2],), r"Face 0 has a ring of shape \(2, 3\), expected at least 3 points"),
    (face, "hidden", ([[0, 4, np.inf]] * 3,), "Face 0 holds a number that is not finite"),
    (face, "kind", "floor", "Face 0 is a 'floor', expected one of wall, ground, ceiling, roof, window, door, reveal"),
    (plane, "axis", -1, "Plane 0 has axis -1 and offset 4.0, expected 0 or more and a finite number"),
    (plane, "offset", np.nan, "Plane 0 has axis 1 and offset nan, expected 0 or more and a finite number"),
    (scene, "rotation", np.eye(4), "Scene.rotation has shape 4x4, expected 3x3"),
    (scene, "lines", replace(lines, id=[4, 8]), "Intersections.lines names line 7, which the scene does not have"),
    (scene, "planes", (replace(plane, lines=(4, 9)),), "Plane 0 names line 9, which the scene does not have"),
    (scene, "planes", (replace(plane, faces=(replace(face, opening=3),)),), "Face 0 is of opening 3, which the scene"),
    (scene, "planes", (plane, replace(plane, faces=())), "Scene.planes: the id 0 stands twice"),
    (scene, "planes", (plane, replace(plane, id=1)), "Scene.faces: the id 0 stands twice"),
    (scene, "metres_per_unit", 0.0, "Scene.metres_per_unit is 0.0, expected a positive number"),
    (scene, "metres_per_unit", np.nan, "Scene.metres_per_unit is nan, expected a positive number"),
]


@pytest.mark.parametrize(
    ("record", "name", "value", "message"), REFUSED, ids=[f"{type(each[0]).__name__}-{each[3]:.40}" for each in REFUSED]
)
def test_contradiction_is_refused(record: Any, name: str, value: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        replace(record, **{name: value})


@pytest.mark.parametrize("record", RECORDS, ids=lambda record: type(record).__name__)
def test_records_cannot_be_changed(record: Any) -> None:
    for field in fields(record):
        value = getattr(record, field.name)
        with pytest.raises(FrozenInstanceError):
            setattr(record, field.name, value)
        if isinstance(value, np.ndarray) and value.size:
            with pytest.raises(ValueError, match="read-only"):
                value.flat[0] = value.flat[0]


def test_hidden_parts_cannot_be_changed() -> None:
    with pytest.raises(ValueError, match="read-only"):
        Face(0, TRIANGLE, hidden=(TRIANGLE,)).hidden[0][0] = 0


def test_holes_cannot_be_changed() -> None:
    with pytest.raises(ValueError, match="read-only"):
        face.holes[0][0] = 0


def test_record_keeps_a_copy_of_its_own() -> None:
    ends = np.zeros((3, 2, 2))
    record = Segments(ends, [0, 1, 2])
    ends[0] = 7
    assert record.ends.max() == 0


def test_empty_lists_take_the_shape_of_their_field() -> None:
    empty = Segments([], [])
    assert empty.ends.shape == (0, 2, 2)
    assert len(empty) == 0


def test_no_line_is_placed_by_a_depth_map_unless_it_is_said() -> None:
    assert lines.by_depth_map.tolist() == [False, False]
    assert replace(lines, by_depth_map=[False, True]).by_depth_map.tolist() == [False, True]
    assert scene.depth_map is None


def test_length_of_segments_is_in_pixels() -> None:
    assert Segments([[[0, 0], [3, 4]]], [0]).length.tolist() == [5]


def test_subset_of_segments_by_mask_and_by_index() -> None:
    by_mask, by_index = segments.subset(np.array([True, False, True])), segments.subset(np.array([0, 2]))
    assert by_mask.axis.tolist() == by_index.axis.tolist() == [0, 2]
    assert by_mask.ends.tolist() == by_index.ends.tolist() == segments.ends[[0, 2]].tolist()


def test_subgraph_is_renumbered_and_keeps_only_its_edges() -> None:
    part = graph.subset(np.array([1, 2]))
    assert part.axis.tolist() == [1, 2]
    assert part.edges.tolist() == [[0, 1]]
    assert part.kind.tolist() == ["T"]
    assert part.crossing.tolist() == [[6, 6]]
    assert part.weight.tolist() == [2]


def test_subgraph_without_edges() -> None:
    part = graph.subset(np.array([0, 2]))
    assert part.edges.shape == (0, 2)
    assert len(part.segments) == 2


def test_focal_length_of_a_camera() -> None:
    assert camera.focal == 500


def test_faces_of_a_scene_are_in_the_order_of_their_ids() -> None:
    first = Plane(0, 1, 4.0, (), (Face(5, TRIANGLE), Face(1, TRIANGLE)))
    second = Plane(1, 1, 4.0, (), (Face(3, TRIANGLE),))
    pairs = replace(scene, planes=(first, second)).faces
    assert [(owner.id, face.id) for owner, face in pairs] == [(0, 1), (1, 3), (0, 5)]


@pytest.mark.parametrize("plane", [1, 2])
def test_openings_are_in_vertical_planes_of_the_scene(plane: int) -> None:
    window = Opening(0, plane, 0.0, 1.0, 0.0, 1.0, "window")
    with pytest.raises(ValueError, match=f"Opening 0 is in plane {plane}, which is no wall"):
        replace(scene, planes=(Plane(0, 1, 4.0, ()), Plane(1, 2, 0.0, ())), openings=(window,))


def test_openings_have_ids_of_their_own() -> None:
    window = Opening(0, 0, 0.0, 1.0, 0.0, 1.0, "window")
    with pytest.raises(ValueError, match=r"Scene\.openings"):
        replace(scene, planes=(Plane(0, 1, 4.0, ()),), openings=(window, window))


def test_a_depth_map_is_told_in_one_line() -> None:
    used = DepthMapReport("a.npz", "", kind="affine-inverse", shift=0.1, scale=2.0, width=0.0123)
    assert used.text == "depth map a.npz: affine-inverse, width of its errors 1.2 %"
    assert (
        DepthMapReport("a.npz", "it covers too few walls").text == "depth map a.npz left out: it covers too few walls"
    )
