"""One photo measured as a whole: the drawn boxes, whose truth is known to the last crossing."""

import json
from dataclasses import replace

import numpy as np
import pytest

from linecad.evaluation.datasets import Case, find_dataset
from linecad.evaluation.depth import dense_depths, face_depths, score, score_depth
from linecad.evaluation.measure import measure, measure_photo
from linecad.evaluation.methods import BASELINE, GAIN_ROWS, PAPER_ROWS, Settings
from linecad.evaluation.planes import score_planes
from linecad.evaluation.references import Reference, reference_of
from linecad.evaluation.report import badness, page, worst
from linecad.evaluation.tables import all_tables
from linecad.finding import find_lines
from linecad.geometry import world_rays
from linecad.options import Options
from linecad.pipeline import reconstruct
from linecad.scene import Face, Plane
from solver.options import SolveOptions

# The boxes hang in the air, so what their faces would add has no truth.
SETTINGS = Settings(reconstruction=Options(face_lines=False, solve=SolveOptions(time_limit_s=20.0)), pictures=True)


@pytest.fixture(scope="module")
def result(drawn, made_truth):
    return measure("boxes", drawn, reference_of(made_truth), SETTINGS)


@pytest.fixture(scope="module")
def scene(drawn):
    return reconstruct(drawn, SETTINGS.reconstruction)


def true_scale(scene, made_truth):
    """Found over true depth, from the scene's lines on the larger box."""
    reference = reference_of(made_truth)
    return score_depth(scene, reference.edges.pixels, reference.edges.depth, scene.lines.component == 0).scale


def test_the_boxes_are_measured_as_right(result):
    whole = result.whole
    assert whole.rotation_error < 0.2
    assert whole.decisions.chosen_real > 50
    assert whole.decisions.chosen_fake <= 2
    largest, everything = whole.depth.component_0, whole.depth.everything
    assert largest.lines.precision_2 > 0.98
    assert largest.lines.recall_5 > 0.3  # one of the two boxes, which nothing connects to the other
    assert everything.lines.with_depth > largest.lines.with_depth
    assert largest.dense.precision_5 > 0.95
    assert everything.dense.with_depth > largest.dense.with_depth
    assert everything.confidence is not None
    assert largest.confidence is not None
    assert sum(tenth.points for tenth in whole.depth.calibration) == everything.lines.with_depth
    assert whole.plane_score.right_lines == whole.plane_score.lines > 10
    assert 0 < whole.plane_score.found_pixels <= whole.plane_score.pixels
    assert whole.marked is None


def test_every_row_of_table_1_is_there(result):
    assert {name: tuple(runs) for name, runs in result.methods.items()} == {"paper": PAPER_ROWS, "gain": GAIN_ROWS}
    for formulation, row in (("paper", BASELINE), ("gain", "none")):
        decisions = result.methods[formulation][row].decisions
        assert decisions.tree_share > 0.95
    assert result.methods["gain"]["none"].status == "optimal"


def test_the_baseline_counts_its_tree_over_all_crossings(result):
    decisions = result.methods["paper"][BASELINE].decisions
    assert decisions.missed_real == 0
    assert decisions.tree_real + decisions.tree_fake == result.statistics.lines - 1


def test_families_are_left_out_by_their_letters():
    assert SETTINGS.options("paper", "B+C+P").without == frozenset()
    assert SETTINGS.options("paper", "B+P").without == {"cycles"}
    assert SETTINGS.options("gain", "none").without == {"cycles", "boundary", "planarity"}
    assert SETTINGS.options("paper", "B").boundary_reward == 10
    assert SETTINGS.options("gain", "B").boundary_reward == 1
    assert (
        Settings(reconstruction=Options(solve=SolveOptions(mu_boundary=3.0))).options("gain", "B").boundary_reward == 3
    )


def test_nothing_known_is_nothing_measured(drawn):
    result = measure("boxes", drawn, Reference(), replace(SETTINGS, pictures=False))
    assert result.statistics is None
    assert result.methods == {}
    assert (result.whole.decisions, result.whole.depth, result.whole.rotation_error) == (None, None, None)
    assert result.whole.lines > 20
    assert badness(result) is None


def test_york_urban_measures_coverage_and_labels(made, york_folder):
    result = measure_photo(find_dataset(york_folder).cases[0], Settings())
    assert result.error is None
    assert result.whole.rotation_error < 0.2
    marked = result.whole.marked
    assert marked.right_axes == marked.lines == len(made.axis)
    assert 0.8 < marked.covered / marked.length <= 1


def test_a_missing_photo_is_an_error_in_the_result(tmp_path):
    case = Case("gone", "labels", tmp_path / "gone.jpg", tmp_path / "gone.json")
    result = measure_photo(case, Settings())
    assert "gone" in result.error
    assert result.whole is None
    assert "\n" not in result.error


def test_the_record_is_json_without_pictures(result):
    text = json.dumps(result.document(), allow_nan=False)
    assert "jpeg" not in text
    assert "svg" not in text
    assert json.loads(text)["whole"]["decisions"]["chosen_real"] == result.whole.decisions.chosen_real


def test_faces_tell_the_depth_of_what_they_cover(scene):
    rays = world_rays(np.array([[400.0, 500.0], [10.0, 10.0]]), scene.camera.matrix, scene.rotation)
    ray = rays[0]
    near, far = ray * 5 / ray[1], ray * 9 / ray[1]  # where the ray meets the planes y = 5 and y = 9

    def square(centre, size):
        ring = np.array([[-1, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1]]) * size
        return centre + ring

    def depths(*faces):
        pixels = np.array([[400.0, 500.0], [10.0, 10.0]])
        planes = [(Plane(n, 1, float(ring[0, 1]), ()), Face(n, ring, holes)) for n, (ring, *holes) in enumerate(faces)]
        return face_depths(scene, pixels, planes)

    assert depths((square(far, 0.5),), (square(near, 0.5),))[0] == pytest.approx(5 / ray[1])
    assert depths((square(far, 0.5),), (square(near, 0.5), square(near, 0.2)))[0] == pytest.approx(9 / ray[1])
    assert np.isnan(depths((square(-near, 0.5),))[0])
    assert np.isnan(depths((square(near, 0.5),))[1])


def test_a_wrong_scale_costs_the_dense_recall(scene, made_truth):
    dense = reference_of(made_truth).dense
    scale = true_scale(scene, made_truth)
    found = dense_depths(scene, dense.pixels, scene.lines.component == 0)
    assert score(found, dense.depth, scale).recall_5 > 0.3
    assert score(found, dense.depth, scale * 1.2).recall_5 < 0.02


def test_planes_at_a_wrong_place_are_wrong(scene, made_truth):
    scale = true_scale(scene, made_truth)
    right = score_planes(scene, made_truth, scale)
    assert right.right_lines == right.lines > 0
    assert score_planes(scene, made_truth, scale * 1.1).right_lines == 0
    assert score_planes(scene, made_truth, scale * 1.015).right_lines == right.lines
    moved = replace(
        scene,
        planes=tuple(Plane(p.id, p.axis, p.offset * 1.03, p.lines) for p in scene.planes),
    )
    wrong = score_planes(moved, made_truth, scale)
    assert (wrong.right_lines, wrong.found_pixels) == (0, 0)
    assert wrong.pixels == right.pixels


def test_the_page_shows_the_worst_photos_first_and_needs_nothing_else(result):
    bad = replace(
        result, name="<bad & ugly>",
        whole=replace(result.whole, decisions=replace(result.whole.decisions, chosen_fake=500)),
    )  # fmt: skip
    results = [result, bad] + [replace(result, name=f"copy {n}") for n in range(12)]
    assert [each.name for each in worst(results)] == ["<bad & ugly>", "boxes"] + [f"copy {n}" for n in range(8)]
    text = page("boxes", results, all_tables(results, SETTINGS))
    assert "<bad" not in text
    assert "&lt;bad &amp; ugly&gt;" in text
    assert "http:" not in text
    assert text.count("data:image/jpeg;base64,") == 10
    assert "Table 1, formulation paper" in text
    assert text.count("plan, as found") == 10
    assert f"{result.whole.depth.everything.lines.recall_5:.0%}" in text


def test_what_the_picture_marks_is_what_was_decided(result):
    decisions = result.whole.decisions
    assert len(result.picture.fake_taken) == decisions.chosen_fake
    assert len(result.picture.real_missed) == decisions.missed_real
    assert all(0 <= x <= result.picture.width for x, *_ in result.picture.lines)


def test_lines_are_found_once_and_connected_twice(drawn):
    found = find_lines(drawn)
    assert found.camera.source == "file"
    assert len(found.segments) > 30
