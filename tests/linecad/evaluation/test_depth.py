"""The measures against cases made by hand."""

from dataclasses import replace

import numpy as np
import pytest

from linecad.evaluation.depth import (
    NO_LINE,
    REACH,
    dense_depths,
    depths_of,
    line_depths,
    nearest_lines,
    score,
    score_depth,
)
from linecad.scene import Face, Lines, Plane, Scene


def points_on(scene, at=500.0):
    return np.column_stack([np.full(len(scene.lines), at), scene.lines.segment[:, 0, 1]])


def test_a_right_scene_scores_everything_whatever_its_scale(scene_of):
    scene = scene_of([4, 5, 6, 7])
    got = score_depth(scene, points_on(scene), 3.7 * np.array([4.0, 5, 6, 7]))
    assert (got.points, got.with_depth) == (4, 4)
    assert (got.recall_2, got.recall_5, got.precision_2, got.precision_5) == (1, 1, 1, 1)


def test_errors_of_1_4_and_10_per_cent_are_counted_by_their_limits(scene_of):
    true = np.array([4.0, 5, 6, 7, 8, 9])
    scene = scene_of(true * [1, 1, 1, 1.01, 1.04, 1.10])
    got = score_depth(scene, points_on(scene), true)
    assert got.precision_2 == pytest.approx(4 / 6)
    assert got.precision_5 == pytest.approx(5 / 6)
    assert (got.recall_2, got.recall_5) == (got.precision_2, got.precision_5)


def test_points_without_a_line_lower_the_recall_alone(scene_of):
    scene = scene_of([4, 5, 6])
    pixels = np.concatenate(
        [points_on(scene), [[500.0, 450.0], [50.0, 100.0], [500.0, 110.0]]]
    )  # beside, past the end, 10 px away
    got = score_depth(scene, pixels, np.array([4.0, 5, 6, 4, 4, 4]))
    assert (got.points, got.with_depth) == (6, 3)
    assert (got.recall_5, got.precision_5) == (0.5, 1.0)


def test_no_point_on_a_line_scores_nothing(scene_of):
    got = score_depth(scene_of([4]), np.array([[500.0, 700.0]]), np.array([4.0]))
    assert (got.points, got.with_depth, got.recall_5, got.precision_5) == (1, 0, 0.0, 0.0)
    assert got.scale is None


def test_two_points_are_not_right_by_their_own_median(scene_of):
    scene = scene_of([4, 5])
    found = line_depths(scene, points_on(scene), np.ones(2, bool))
    assert score(found, np.array([4.0, 5])).recall_5 == 0
    assert score(found, np.array([4.0, 5]), scale=1.0).recall_5 == 1


def test_what_lies_behind_the_camera_has_no_depth():
    assert score(np.array([4.0, 5, 6, -7]), np.array([4.0, 5, 6, 7])).with_depth == 3


def test_masked_lines_do_not_score(scene_of):
    scene = scene_of([4, 5, 6, 7])
    found = score_depth(scene, points_on(scene), np.array([4.0, 5, 6, 7]), np.array([True, True, True, False]))
    assert (found.with_depth, found.recall_5) == (3, 0.75)


@pytest.mark.parametrize(("below", "seen"), [(REACH - 0.1, True), (REACH + 0.1, False)])
def test_a_line_is_seen_within_reach(scene_of, below, seen):
    scene = scene_of([4])
    found = line_depths(scene, np.array([[500.0, 100 + below]]), np.ones(1, bool))
    assert np.isfinite(found[0]) == seen


def test_the_nearest_line_tells_the_depth(scene_of):
    scene = scene_of([4, 5])
    scene = Scene(
        "a.jpg", scene.camera, scene.rotation,
        Lines(
            id=[0, 1], axis=[0, 0], segment=scene.lines.segment[[0, 0]] + np.array([0, 3.0])[:, None, None],
            ends=scene.lines.ends, is_boundary=[False] * 2, component=[0, 0], confidence=["proven"] * 2,
        ),
        scene.intersections, (), scene.solve,
    )  # fmt: skip
    found = line_depths(scene, np.array([[500.0, 100.5]]), np.ones(2, bool))
    assert found[0] == pytest.approx(4, rel=0.01)


@pytest.mark.parametrize("at", [100.0, 350.0, 900.0])
def test_depth_along_a_receding_line_is_that_of_its_point(scene_of, made, at):
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


def test_a_line_tells_which_points_it_gives_a_depth(scene_of):
    scene = scene_of([4, 5, 6])
    pixels = np.array([[500.0, 301.0], [500.0, 150.0], [500.0, 99.0]])
    assert nearest_lines(scene, pixels, np.ones(3, bool)).tolist() == [2, NO_LINE, 0]
    assert nearest_lines(scene, pixels, np.array([True, True, False])).tolist() == [NO_LINE, NO_LINE, 0]
    assert depths_of(scene, pixels, np.array([2, NO_LINE, 0])) == pytest.approx([6, np.nan, 4], nan_ok=True, rel=0.01)


def test_faces_fill_where_no_line_is_and_those_of_other_lines_do_not(scene_of):
    scene = scene_of([4, 5, 6])
    ring = np.array([[-10.0, 8, -10], [10, 8, -10], [10, 8, 10], [-10, 8, 10]])  # behind all that the photo shows
    scene = replace(scene, planes=(Plane(0, 1, 8.0, (2,), (Face(0, ring),)),))
    pixels = np.array([[500.0, 100.0], [500.0, 150.0]])
    assert dense_depths(scene, pixels) == pytest.approx([4, 8])
    assert dense_depths(scene, pixels, np.array([True, False, True])) == pytest.approx([4, 8])
    assert dense_depths(scene, pixels, np.array([True, True, False])) == pytest.approx([4, np.nan], nan_ok=True)


def test_a_line_joined_from_pieces_is_where_they_are(scene_of):
    """Not where nothing was seen between them, and also where a piece is that its segment does not lie on."""
    scene = scene_of([4])
    (left, row), (right, _) = scene.lines.segment[0]
    pieces = np.array([[[left, row], [left + 100, row]], [[left + 200, row + 6], [right, row + 6]]])
    joined = replace(scene, lines=replace(scene.lines, pieces=(pieces,)))
    pixels = np.array([[left + 50, row], [left + 150, row], [left + 250, row + 8]])
    assert nearest_lines(scene, pixels, np.ones(1, bool)).tolist() == [0, 0, NO_LINE]
    assert nearest_lines(joined, pixels, np.ones(1, bool)).tolist() == [0, NO_LINE, 0]
