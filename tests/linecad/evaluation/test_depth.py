"""The measures against cases made by hand."""

import numpy as np
import pytest

from linecad.evaluation.depth import REACH, line_depths, score_depth
from linecad.geometry import world_rays
from linecad.scene import Camera, Intersections, Lines, Scene, SolveReport

CAMERA = Camera(1000, 800, np.array([[500.0, 0, 500], [0, 500, 400], [0, 0, 1]]), "file")
FRONTAL = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])  # x right, y away, z up


def scene_of(depths):
    """Level lines, each across the photo from u = 100 to u = 900, at rows 100, 200, ... and the given depths."""
    count = len(depths)
    segment = np.array([[[100.0, 100.0 + 100 * i], [900.0, 100.0 + 100 * i]] for i in range(count)])
    ends = np.array(depths, float)[:, None, None] * world_rays(segment, CAMERA.matrix, FRONTAL)
    lines = Lines(
        id=range(count), axis=np.zeros(count), segment=segment, ends=ends, is_boundary=np.zeros(count, bool),
        component=np.zeros(count), confidence=["proven"] * count,
    )  # fmt: skip
    none = Intersections(lines=[], kind=[], pixel=[], real=[], in_tree=[], weight=[])
    report = SolveReport("none", "paper", "optimal", 0.0, 0.0, 0.0, 0.0)
    return Scene("a.jpg", CAMERA, FRONTAL, lines, none, (), report)


def points_on(scene, at=500.0):
    return np.column_stack([np.full(len(scene.lines), at), scene.lines.segment[:, 0, 1]])


def test_a_right_scene_scores_everything_whatever_its_scale():
    scene = scene_of([4, 5, 6, 7])
    score = score_depth(scene, points_on(scene), 3.7 * np.array([4.0, 5, 6, 7]))
    assert (score.points, score.with_depth) == (4, 4)
    assert (score.recall_2, score.recall_5, score.precision_2, score.precision_5) == (1, 1, 1, 1)


def test_errors_of_1_4_and_10_per_cent_are_counted_by_their_limits():
    true = np.array([4.0, 5, 6, 7, 8, 9])
    scene = scene_of(true * [1, 1, 1, 1.01, 1.04, 1.10])
    score = score_depth(scene, points_on(scene), true)
    assert score.precision_2 == pytest.approx(4 / 6)
    assert score.precision_5 == pytest.approx(5 / 6)
    assert (score.recall_2, score.recall_5) == (score.precision_2, score.precision_5)


def test_points_without_a_line_lower_the_recall_alone():
    scene = scene_of([4, 5])
    pixels = np.concatenate([points_on(scene), [[500.0, 450.0], [50.0, 100.0]]])  # beside, and past the end
    score = score_depth(scene, pixels, np.array([4.0, 5, 4, 4]))
    assert (score.points, score.with_depth) == (4, 2)
    assert (score.recall_5, score.precision_5) == (0.5, 1.0)


def test_no_point_on_a_line_scores_nothing():
    score = score_depth(scene_of([4]), np.array([[500.0, 700.0]]), np.array([4.0]))
    assert (score.points, score.with_depth, score.recall_5, score.precision_5) == (1, 0, 0.0, 0.0)


def test_masked_lines_do_not_score():
    scene = scene_of([4, 5])
    score = score_depth(scene, points_on(scene), np.array([4.0, 5]), np.array([True, False]))
    assert (score.with_depth, score.recall_5) == (1, 0.5)


@pytest.mark.parametrize(("below", "seen"), [(REACH - 0.1, True), (REACH + 0.1, False)])
def test_a_line_is_seen_within_reach(below, seen):
    scene = scene_of([4])
    found = line_depths(scene, np.array([[500.0, 100 + below]]), np.ones(1, bool))
    assert np.isfinite(found[0]) == seen


def test_the_nearest_line_tells_the_depth():
    scene = scene_of([4, 5])
    scene = Scene(
        "a.jpg", CAMERA, FRONTAL,
        Lines(
            id=[0, 1], axis=[0, 0], segment=scene.lines.segment[[0, 0]] + np.array([0, 3.0])[:, None, None],
            ends=scene.lines.ends, is_boundary=[False] * 2, component=[0, 0], confidence=["proven"] * 2,
        ),
        scene.intersections, (), scene.solve,
    )  # fmt: skip
    found = line_depths(scene, np.array([[500.0, 100.5]]), np.ones(2, bool))
    assert found[0] == pytest.approx(4, rel=0.01)


@pytest.mark.parametrize("at", [100.0, 350.0, 900.0])
def test_depth_along_a_receding_line_is_that_of_its_point(made, at):
    # A line along y: its depth is different at every pixel.
    line = int(np.flatnonzero(made.axis == 1)[0])
    share = at / 1000
    point = (1 - share) * made.ends[line, 0] + share * made.ends[line, 1]
    image = made.camera.matrix @ made.frame.rotation @ point
    lines = Lines([0], [1], made.pixels[[line]], made.ends[[line]], [False], [0], ["proven"])
    base = scene_of([4])
    scene = Scene("a.jpg", made.camera, made.frame.rotation, lines, base.intersections, (), base.solve)
    found = line_depths(scene, (image[:2] / image[2])[None], np.ones(1, bool))
    assert found[0] == pytest.approx(image[2])
