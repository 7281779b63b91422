"""The same measures of everything and of component 0, on scenes of level lines whose depths are chosen."""

from dataclasses import replace

import numpy as np
import pytest

from linecad.evaluation.references import Points
from linecad.evaluation.scopes import judge, score_scene
from linecad.scene import Face, Plane

TRUE = np.array([4.0, 5, 6, 7, 8, 9, 10])


def points_on(scene, depth=TRUE):
    return Points(np.column_stack([np.full(len(depth), 500.0), scene.lines.segment[:, 0, 1]]), depth)


def wall(scene, plane_depth, line):
    """The scene with a wall behind all that the photo shows, in the plane of a line."""
    ring = np.array([[-1.0, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1]]) * 3 * plane_depth + [0, plane_depth, 0]
    return replace(scene, planes=(Plane(0, 1, plane_depth, (line,), (Face(0, ring),)),))


def test_each_scope_has_its_own_scale(scene_of):
    # Four lines of component 1, twice as far as they should be, against three of component 0.
    scene = scene_of(TRUE * [1, 1, 1, 2, 2, 2, 2], component=[0, 0, 0, 1, 1, 1, 1])
    score = score_scene(scene, points_on(scene), None)
    assert score.component_0.lines.scale == pytest.approx(1)
    assert (score.component_0.lines.recall_5, score.component_0.lines.precision_5) == (pytest.approx(3 / 7), 1)
    assert score.everything.lines.scale == pytest.approx(2)
    assert (score.everything.lines.recall_5, score.everything.lines.precision_5) == (pytest.approx(4 / 7),) * 2
    assert (score.everything.dense, score.component_0.dense) == (None, None)


def test_faces_count_in_the_scope_of_their_lines(scene_of):
    scene = wall(scene_of(TRUE, component=[0, 0, 0, 0, 0, 0, 1]), 20.0, 6)
    beside = Points(np.array([[500.0, 150.0], [500.0, 250.0], [500.0, 350.0]]), np.full(3, 20.0))
    everywhere = Points(np.concatenate([points_on(scene).pixels, beside.pixels]), np.append(TRUE, beside.depth))
    score = score_scene(scene, points_on(scene), everywhere)
    assert (score.everything.dense.with_depth, score.everything.dense.recall_2) == (10, 1)
    assert (score.component_0.dense.with_depth, score.component_0.dense.recall_2) == (6, 0.6)


def test_faces_of_component_0_are_measured_by_the_scale_of_its_lines(scene_of):
    scene = wall(scene_of(TRUE), 20.0, 0)
    beside = Points(np.array([[500.0, 150.0], [500.0, 250.0], [500.0, 350.0]]), np.full(3, 10.0))
    score = score_scene(scene, points_on(scene), beside)
    assert score.component_0.dense.recall_5 == 0
    assert score.everything.dense.recall_5 == 1  # by their own median: there is nothing else


def test_without_lines_that_tell_a_scale_nothing_of_component_0_is_right(scene_of):
    scene = wall(scene_of(TRUE, component=[1] * 7, probability=[0.5] * 7), 20.0, 0)
    score = score_scene(scene, points_on(scene), points_on(scene))
    assert score.component_0.lines.scale is None
    assert (score.component_0.dense.with_depth, score.component_0.dense.recall_5) == (0, 0)
    assert score.everything.lines.recall_5 == 1
    assert (score.everything.confidence, score.component_0.confidence, score.calibration) == (None, None, None)


def test_a_scene_without_probabilities_has_no_confidence(scene_of):
    scene = scene_of(TRUE)
    score = score_scene(scene, points_on(scene), None)
    assert (score.everything.confidence, score.component_0.confidence, score.calibration) == (None, None, None)


def test_each_point_has_the_probability_of_the_line_that_gives_its_depth(scene_of):
    scene = scene_of(TRUE * [1, 1, 1, 1, 1, 1, 1.2], probability=np.linspace(0.1, 0.7, 7))
    at = points_on(scene)
    pixels = np.array([[500.0, 301.0], [500.0, 150.0], [500.0, 699.0]])  # on line 2, on none, on line 6
    stated, right = judge(scene, Points(pixels, np.array([6.0, 6, 10])), np.ones(7, bool), 1.0)
    assert stated == pytest.approx([0.3, 0.7])
    assert right.tolist() == [True, False]
    assert judge(scene, at, np.ones(7, bool), None) is None


def test_confidence_and_calibration_are_measured_by_the_scale_of_component_0(scene_of):
    # By the median of everything, the wrong lines of component 1 would be the right ones.
    scene = scene_of(
        TRUE * [1, 1, 1, 2, 2, 2, 2],
        component=[0, 0, 0, 1, 1, 1, 1],
        probability=[0.95, 0.95, 0.95, 0.1, 0.1, 0.1, 0.95],
    )
    score = score_scene(scene, points_on(scene), None)
    assert [(tenth.points, tenth.right) for tenth in score.calibration if tenth.points] == [(3, 0), (4, 3)]
    everything, largest = score.everything.confidence, score.component_0.confidence
    assert everything.recall_area == largest.recall_area == pytest.approx(0.95 * 3 / 7)
    assert (everything.sure_recall, everything.sure_precision) == (pytest.approx(3 / 7), pytest.approx(3 / 4))
    assert (largest.sure_recall, largest.sure_precision) == (pytest.approx(3 / 7), 1)
    assert largest.precision_area == pytest.approx(3 / 7)
    assert everything.precision_area == pytest.approx(3 / 7 * 3 / 4)
