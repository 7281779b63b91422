"""Pictures of found and true places: where true places come from, and what is drawn where."""

import re
import xml.etree.ElementTree as ET

import numpy as np
import pytest

from linecad.evaluation.gallery import (
    FALL,
    HEIGHT,
    RIGHT_COLOUR,
    TURN,
    UNKNOWN_COLOUR,
    WIDTH,
    WRONG_COLOUR,
    draw_places,
    plan_view,
    side_view,
    true_ratios,
)
from linecad.evaluation.references import Points, Reference, reference_of
from linecad.geometry import project
from linecad.scene import Lines

TRUE = np.array([4.0, 5, 6, 7])


def survey(scene, rows, depth):
    """Points on the level lines of some rows, at u = 300 and u = 600."""
    v = scene.lines.segment[rows, 0, 1]
    pixels = np.concatenate([np.column_stack([np.full(len(rows), u), v]) for u in (300.0, 600.0)])
    return Reference(edges=Points(pixels, np.tile(np.array(depth, float), 2)))


def panels(svg):
    """The numbers of each path of the four panels, by colour."""
    found = []
    for panel in ET.fromstring(svg).findall("svg"):
        strokes = panel.findall("path")
        found.append({p.get("stroke"): np.array(re.findall(r"-?[\d.]+", p.get("d")), float) for p in strokes})
    return found


def test_points_tell_the_ratio_of_the_lines_they_lie_on(scene_of):
    scene = scene_of(TRUE)
    ratio = true_ratios(scene, survey(scene, [0, 2], [4.0, 3.0]))
    assert ratio == pytest.approx([1, np.nan, 2, np.nan], nan_ok=True)


def test_a_made_photo_tells_the_ratio_of_every_line_under_its_right_axis(made, made_truth, scene_of):
    base = scene_of(TRUE)
    count = len(made.axis)
    factor = np.linspace(0.5, 2, count)
    axis = made.axis.copy()
    axis[0] = (axis[0] + 1) % 3
    lines = Lines(
        range(count), axis, made.pixels, made.ends * factor[:, None, None], [False] * count, [0] * count,
        ["proven"] * count,
    )  # fmt: skip
    scene = type(base)("a.jpg", made.camera, made.frame.rotation, lines, base.intersections, (), base.solve)
    ratio = true_ratios(scene, reference_of(made_truth))
    assert np.isnan(ratio[0])
    assert np.isfinite(ratio[1:]).all()
    assert ratio[1:] == pytest.approx(factor[1:], rel=1e-3)


def test_where_nothing_is_known_nothing_is_drawn(scene_of):
    scene = scene_of(TRUE)
    assert np.isnan(true_ratios(scene, Reference())).all()
    assert draw_places(scene, Reference(), 1.0) is None


def test_lines_are_coloured_by_what_is_known_and_drawn_at_their_true_place(scene_of):
    # All depths are doubled, which is the scale; the third is 40 % too far, the last is not surveyed.
    scene = scene_of(2 * TRUE * [1, 1, 1.4, 1])
    svg = draw_places(scene, survey(scene, [0, 1, 2], TRUE[:3]), 2.0)
    assert "2 right, 1 wrong, 1 unknown" in svg
    plan, true, side, side_true = panels(svg)
    for found, there in ((plan, true), (side, side_true)):
        assert found[RIGHT_COLOUR] == pytest.approx(there[RIGHT_COLOUR])
        assert UNKNOWN_COLOUR in found
        assert UNKNOWN_COLOUR not in there
    right, wrong = true[RIGHT_COLOUR].reshape(-1, 2), true[WRONG_COLOUR].reshape(-1, 2)
    # In the plan the lines are level, each as far above the one before it as it is deeper: at true places by 1 each.
    assert right[2, 1] - wrong[0, 1] == pytest.approx(right[0, 1] - right[2, 1], abs=0.2)
    misplaced = plan[WRONG_COLOUR].reshape(-1, 2)
    assert right[2, 1] - misplaced[0, 1] == pytest.approx(3.4 * (right[0, 1] - right[2, 1]), abs=0.5)


def test_all_true_places_are_inside_the_panel_and_lines_that_miss_it_are_left_out(scene_of):
    scene = scene_of(TRUE * [1, 1, 1, 50])
    plan, true, *_ = panels(draw_places(scene, survey(scene, [0, 1, 2, 3], TRUE), 1.0))
    assert WRONG_COLOUR not in plan
    for numbers in (true[WRONG_COLOUR], true[RIGHT_COLOUR]):
        at = numbers.reshape(-1, 2)
        assert ((at > 0) & (at < [WIDTH, HEIGHT])).all()


def test_the_plan_is_seen_from_above_and_the_side_turned_to_the_right(made):
    assert (np.array([[1.0, 2, 3]]) @ plan_view()).tolist() == [[1, -2]]
    rotation = made.frame.rotation
    view = side_view(rotation)
    towards = np.cross(view[:, 0], view[:, 1])  # into the picture, its y running downwards
    ahead = np.append(rotation[2, :2], 0.0) / np.linalg.norm(rotation[2, :2])
    level = np.append(towards[:2], 0.0) / np.linalg.norm(towards[:2])
    assert towards[2] == pytest.approx(-np.sin(FALL))
    assert np.arccos(ahead @ level) == pytest.approx(TURN)
    assert view.T @ view == pytest.approx(np.eye(2))
    assert project(np.array([[0.0, 5, 1]]), made.camera.matrix, rotation)[0, 1] < made.camera.height / 2  # up is up
    assert (np.array([0.0, 0, 1]) @ view)[1] < 0
