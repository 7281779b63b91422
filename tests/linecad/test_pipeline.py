"""A drawn photo of the made scene, and a sample photo, from pixels to a scene."""

import json
from dataclasses import replace
from pathlib import Path

import networkx as nx
import numpy as np
import pytest

from linecad.camera.photo import Photo, read_photo
from linecad.decide.annotations import annotate
from linecad.decide.decision import decide
from linecad.errors import ReconstructionError
from linecad.finding import find_lines
from linecad.geometry import angle_between_frames, project
from linecad.graph.build import build_line_graph
from linecad.io.scene_file import read_scene, write_scene
from linecad.line_graph import ManhattanFrame, Segments, Solution
from linecad.model.build import TYPICAL_DEPTH, View, build_scene, find_components
from linecad.model.lifting import lift
from linecad.options import SHORT_REACH, Options
from linecad.pipeline import reconstruct
from linecad.scene import Camera
from solver.options import SolveOptions

# The made scene is two boxes of two faces each. The whole program of the paper cuts them apart at their edges: its
# 3-cycles forbid a true corner, and mu_2 = 10 outweighs the crossings at an edge that is kept off the boundary.
WHOLE_BOXES = Options(solve=SolveOptions(without=frozenset({"cycles", "boundary"})))

# At short reach the room is solved to the end; at the usual one a gap remains, and what it stops at hangs on the clock.
SOLVED = Options(reach=SHORT_REACH, weights="junctions", solve=SolveOptions(time_limit_s=20))

SAMPLES = Path(__file__).resolve().parents[2] / "samples"


@pytest.fixture(scope="module")
def drawn(made):
    return Photo("drawn.png", np.repeat(made.image()[..., None], 3, axis=2), made.camera)


@pytest.fixture(scope="module")
def scene(drawn):
    return reconstruct(drawn, WHOLE_BOXES)


@pytest.fixture(scope="module")
def room():
    return read_photo(SAMPLES / "room.jpg", SAMPLES / "room.json")


@pytest.fixture(scope="module")
def room_scene(room):
    return reconstruct(room, SOLVED)


@pytest.fixture(params=["scene", "room_scene"])
def any_scene(request):
    return request.getfixturevalue(request.param)


def written(scene, path):
    write_scene(scene, path)
    return path.read_bytes()


def true_line(made, scene, line):
    """The true line whose image a line of the scene lies on, or None."""
    segment, axis = scene.lines.segment[line], scene.lines.axis[line]
    for true in np.flatnonzero(made.axis == axis):
        start, end = made.pixels[true]
        along = (end - start) / np.linalg.norm(end - start)
        off = np.abs((segment - start) @ np.array([-along[1], along[0]])).max()
        position = (segment - start) @ along
        if off < 2 and position.min() > -10 and position.max() < np.linalg.norm(end - start) + 10:
            return true
    return None


def test_the_drawn_photo_gives_the_true_frame(made, scene):
    error, names = angle_between_frames(scene.rotation, made.frame.rotation)
    assert np.degrees(error) < 0.1
    assert names == (0, 1, 2)


def test_the_drawn_photo_gives_every_true_line(made, scene):
    found = [true_line(made, scene, line) for line in range(len(scene.lines))]
    assert {true for true in found if true is not None} == set(range(len(made.axis)))
    assert found.count(None) <= 2


def test_the_drawn_photo_gives_the_true_depths(made, scene):
    assert len(set(scene.lines.component.tolist())) == 2
    for component in (0, 1):
        ratio = []
        for line in np.flatnonzero(scene.lines.component == component):
            true = true_line(made, scene, line)
            if true is not None:
                across = np.arange(3) != made.axis[true]
                there = scene.lines.ends[line, 0, across]
                ratio.append(np.linalg.norm(there) / np.linalg.norm(made.ends[true, 0, across]))
        assert len(ratio) >= 14
        assert np.abs(ratio / np.median(ratio) - 1).max() < 0.02


def test_the_drawn_photo_gives_the_true_faces(scene):
    # The front and the side of each box, as planes that hold at least six of its lines.
    component = dict(zip(scene.lines.id.tolist(), scene.lines.component.tolist(), strict=True))
    large = {(component[plane.lines[0]], plane.axis) for plane in scene.planes if len(plane.lines) >= 6}
    assert {(0, 0), (0, 1), (1, 0), (1, 1)} <= large


def test_component_0_has_a_handy_size(scene):
    own = scene.lines.component == 0
    in_camera = scene.lines.ends[own] @ scene.rotation.T
    assert np.median(in_camera[..., 2]) == pytest.approx(TYPICAL_DEPTH, rel=0.2)


def test_ends_are_seen_where_the_segments_are(any_scene):
    scene = any_scene
    back = project(scene.lines.ends, scene.camera.matrix, scene.rotation)
    along = scene.lines.segment[:, 1] - scene.lines.segment[:, 0]
    along /= np.linalg.norm(along, axis=1)[:, None]
    off = back - scene.lines.segment[:, :1]
    across = np.abs(off[..., 0] * along[:, None, 1] - off[..., 1] * along[:, None, 0])
    assert np.quantile(across, 0.9) < 2.0  # px


def test_lines_run_along_their_axes(any_scene):
    lines = any_scene.lines
    across = np.arange(3) != lines.axis[:, None]
    assert (lines.ends[:, 0][across] == lines.ends[:, 1][across]).all()


def test_real_crossings_coincide(any_scene):
    lines, real = any_scene.lines, any_scene.intersections.real
    i, j = np.searchsorted(lines.id, any_scene.intersections.lines[real]).T
    size = np.ptp(lines.ends.reshape(-1, 3), axis=0).max()
    for axis in range(3):
        # Lines of two axes agree in the third coordinate; pieces of one line agree in both that are not its own.
        agree = (lines.axis[i] != axis) & (lines.axis[j] != axis)
        assert agree.any()
        apart = lines.ends[i[agree], :, axis] - lines.ends[j[agree], :, axis]
        assert np.abs(apart).max() <= 1e-9 * size


def test_lines_lie_in_their_planes(any_scene):
    lines = any_scene.lines
    assert any_scene.planes
    for plane in any_scene.planes:
        own = np.isin(lines.id, plane.lines)
        assert (lines.ends[own, :, plane.axis] == plane.offset).all()
        if own.any():
            assert len(set(lines.component[own].tolist())) == 1
        else:
            assert {face.kind for face in plane.faces} in ({"ground"}, {"ceiling"}, {"wall"})
        for face in plane.faces:
            assert (face.outline[:, plane.axis] == plane.offset).all()


def parts_of(scene):
    """The sets of lines that real crossings connect."""
    net = nx.Graph()
    net.add_nodes_from(scene.lines.id.tolist())
    net.add_edges_from(scene.intersections.lines[scene.intersections.real].tolist())
    return [set(part) for part in nx.connected_components(net)]


def test_components_are_numbered_by_size_and_hold_what_real_crossings_connect(any_scene):
    lines = any_scene.lines
    named = [lines.component == number for number in range(int(lines.component.max()) + 1)]
    ids = [set(lines.id[own].tolist()) for own in named]
    assert all(any(part <= component for component in ids) for part in parts_of(any_scene))
    assert len(named) > 1
    sizes = [len(component) for component in ids]
    assert sizes == sorted(sizes, reverse=True)
    stubs = any("stubs of detail" in note for note in any_scene.notes)  # of a group of four, some may be left out
    assert sizes[-1] >= (2 if stubs else 4)


def test_the_spanning_tree_spans_each_component(any_scene):
    lines, crossings = any_scene.lines, any_scene.intersections
    assert not (crossings.in_tree & ~crossings.real).any()
    tree = nx.Graph()
    tree.add_edges_from(crossings.lines[crossings.in_tree].tolist())
    assert nx.is_forest(tree)
    assert nx.number_connected_components(tree) == len(parts_of(any_scene))
    assert len(tree) == len(lines)


def test_confidence_says_what_the_documentation_promises(any_scene):
    lines, crossings = any_scene.lines, any_scene.intersections
    assert any_scene.solve.status == "optimal"
    assert ((lines.confidence == "weak") == (lines.component != 0)).all()
    net = nx.Graph()
    net.add_edges_from(crossings.lines[crossings.real].tolist())
    word = dict(zip(lines.id.tolist(), lines.confidence.tolist(), strict=True))
    for line in lines.id[lines.component == 0].tolist():
        # A line closes cycles when it lies on one, that is, when some neighbour is reached without their own crossing.
        in_cycle = any(
            nx.has_path(nx.restricted_view(net, [], [(line, other)]), line, other) for other in list(net[line])
        )
        assert (word[line] == "proven") <= in_cycle
        if net.degree(line) == 1:
            assert word[line] == "supported"


def test_without_a_proof_nothing_is_called_proven(drawn):
    stopped = reconstruct(drawn, Options(solve=SolveOptions(gap=0.5)))
    if stopped.solve.status == "optimal":
        stopped = reconstruct(drawn, Options(solve=SolveOptions(time_limit_s=1e-6)))
    assert stopped.solve.status in ("gap limit", "time limit")
    assert set(stopped.lines.confidence.tolist()) == {"supported", "weak"}
    assert any(stopped.solve.status in note and "not proven" in note for note in stopped.notes)


def test_smaller_components_are_mentioned(scene):
    assert any("1 smaller group" in note for note in scene.notes)


def test_largest_component_alone(made, drawn, scene):
    alone = reconstruct(drawn, replace(WHOLE_BOXES, largest_component=True))
    assert set(alone.lines.component.tolist()) == {0}
    assert len(alone.lines) == (scene.lines.component == 0).sum()
    middle = alone.lines.segment.mean(axis=(0, 1))
    assert middle[0] < made.camera.width / 2  # the left box has more edges


def test_scene_files_give_the_scene_back(any_scene, tmp_path):
    first = written(any_scene, tmp_path / "a.json")
    assert written(read_scene(tmp_path / "a.json"), tmp_path / "b.json") == first


@pytest.mark.thorough
def test_two_runs_give_the_same_bytes(room, room_scene, tmp_path):
    again = reconstruct(room, SOLVED)
    first = written(room_scene, tmp_path / "a.json")
    assert written(again, tmp_path / "b.json") == first


def test_focal_length_comes_from_the_vanishing_points_when_nothing_tells_it(made, drawn):
    scene = reconstruct(Photo("drawn.png", drawn.pixels, None), Options())
    assert scene.camera.source == "vanishing points"
    assert scene.camera.focal == pytest.approx(made.camera.focal, rel=0.02)
    assert any(note.startswith("focal length guessed from the vanishing points") for note in scene.notes)


def frontal_photo():
    """A wall of windows seen straight on: two vanishing points at infinity."""
    image = np.full((600, 800, 3), 230, np.uint8)
    for i in range(4):
        for j in range(3):
            image[80 + 150 * j : 230 + 150 * j, 100 + 150 * i : 250 + 150 * i] = 60 if (i + j) % 2 else 140
    return Photo("wall.png", image, None)


def test_focal_length_is_assumed_and_noted_when_it_cannot_be_told():
    scene = reconstruct(frontal_photo(), Options())
    assert scene.camera.source == "default"
    assert scene.camera.focal == pytest.approx(28 / 43.27 * 1000)
    assert any("not to be told" in note for note in scene.notes)


def test_stages_are_reported_in_order(drawn):
    stages = []
    reconstruct(drawn, Options(largest_component=True, faint=True), on_stage=stages.append)
    words = [
        "finding segments",
        "finding the Manhattan frame",
        "finding faint",
        "following lines",
        "finding details",
        "fitting depths",
        "finding what ties",
        "placing",
        "deciding",
        "lifting",
        "building planes",
    ]
    assert [word for word, stage in zip(words, stages, strict=True) if stage.startswith(word)] == words


def test_a_flat_photo_holds_too_little():
    flat = Photo("flat.png", np.full((300, 400, 3), 128, np.uint8), None)
    with pytest.raises(ReconstructionError, match="0 straight segments found"):
        reconstruct(flat, Options())


def test_groups_that_only_the_horizon_ties_keep_scales_of_their_own():
    # Two rectangles, and a line of each at the height of the eye. The crossing of these two lines says nothing about
    # depth; were their height one number for both groups, it would be two after scaling.
    camera = Camera(3840, 2880, np.array([[2500.0, 0, 1919.5], [0, 2500, 1439.5], [0, 0, 1]]), "file")
    turn = np.array([[np.cos(0.4), -np.sin(0.4), 0], [np.sin(0.4), np.cos(0.4), 0], [0, 0, 1]])
    frame = ManhattanFrame(np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]) @ turn, 0.0, 1.0)
    eye = 1e-4
    rows = [  # axis, ends
        (0, (-1, 8, eye), (2, 8, eye)), (0, (-1, 8, 2), (2, 8, 2)),
        (2, (-1, 8, eye), (-1, 8, 2)), (2, (0.5, 8, eye), (0.5, 8, 2)),
        (1, (2.02, 8, eye), (2.02, 11, eye)), (1, (2.02, 8, -2), (2.02, 11, -2)),
        (2, (2.02, 9, -2), (2.02, 9, eye)), (2, (2.02, 11, -2), (2.02, 11, eye)),
    ]  # fmt: skip
    ends = np.array([row[1:] for row in rows], float)
    segments = Segments(project(ends, camera.matrix, frame.rotation), [row[0] for row in rows])
    graph = build_line_graph(segments, camera, frame)
    assert len(graph.segments) == len(rows)
    tie = np.flatnonzero((graph.edges == [0, 4]).all(axis=1))
    assert graph.possible[tie].tolist() == [True]
    assert graph.informative[tie].tolist() == [False]
    sides = graph.edges < 4
    within = sides[:, 0] == sides[:, 1]
    within[tie] = True
    rays = graph.rays.copy()
    rays[np.arange(len(rows)), graph.axis] = 0
    depth = (rays * ends[:, 0]).sum(axis=1) / (rays**2).sum(axis=1)
    depth[4:] *= 3  # nothing says how large the second group is
    solution = Solution(
        status="optimal", solver="by hand", formulation="paper", objective=0.0, bound=0.0, gap=0.0, seconds=0.0,
        nodes=0, connected=within, is_boundary=np.zeros(len(rows), bool), planar_pairs=[], log_depth=np.log(depth),
    )  # fmt: skip
    said = annotate(graph, None)[1]
    decision = decide(graph, solution, Options(joins="all"), None, said)
    assert decision.reason[tie].tolist() == ["uninformative"]
    lifted = lift(graph, decision.real, solution.log_depth)
    view = View("two.png", camera, frame, None, len(rows), ())
    scene = build_scene(view, graph, solution, decision, find_components(view, graph, decision, lifted))
    at = {tuple(ends.ravel()): number for number, ends in enumerate(graph.segments.ends)}
    rows = [at[tuple(ends.ravel())] for ends in scene.lines.segment]
    assert scene.lines.component[np.argsort(rows)].tolist() == [0] * 4 + [1] * 4
    for plane in scene.planes:
        own = np.isin(scene.lines.id, plane.lines)
        assert (scene.lines.ends[own][:, :, plane.axis] == plane.offset).all()


def test_notes_are_plain_text_on_one_line(any_scene):
    assert any_scene.notes
    for note in any_scene.notes:
        assert json.loads(json.dumps(note)) == note
        assert len(note.splitlines()) == 1


FAST = Options(solve=SolveOptions(fast=True))


@pytest.fixture(scope="module")
def fast_scene(room):
    return reconstruct(room, FAST)


def test_a_fast_scene_says_what_it_is(fast_scene, tmp_path):
    scene = fast_scene
    assert scene.solve.status == "robust fit"
    assert set(scene.lines.confidence.tolist()) <= {"supported", "weak"}
    assert any("nothing is proven" in note for note in scene.notes)
    first = written(scene, tmp_path / "a.json")
    assert b'"gap": null' in first
    assert written(read_scene(tmp_path / "a.json"), tmp_path / "b.json") == first


@pytest.mark.thorough
def test_a_fast_scene_is_the_same_every_time(room, fast_scene, tmp_path):
    first = written(fast_scene, tmp_path / "a.json")
    assert written(reconstruct(room, FAST), tmp_path / "b.json") == first


def test_the_paper_keeps_its_reach_and_weights(room):
    paper = Options(solve=SolveOptions(formulation="paper"))
    found = find_lines(room)
    assert found.reach_for(paper) == SHORT_REACH
    assert paper.weights_used == "junctions"
    assert found.reach_for(Options()) != SHORT_REACH
    assert found.reach_for(Options(extension=40.0)).extension == 40
