from dataclasses import replace

import numpy as np
import pytest

from exporters.drawings.choice import Choice
from exporters.drawings.content import guessed_planes
from exporters.drawings.plan import build_plan
from exporters.drawings.records import CAMERA, OPENINGS, WALLS
from exporters.model import build_model
from linecad.model.choice import keep_drawn


def plan_of(scene, **chosen):
    return build_plan(build_model(scene, origin="ground"), Choice(**chosen))


def on(drawing, layer):
    return [stroke for stroke in drawing.strokes if stroke.layer.name.removesuffix("_GUESS") == layer.name]


def pairs(strokes):
    return {frozenset(map(tuple, np.round(stroke.points, 6).tolist())) for stroke in strokes}


def test_the_wall_has_gaps_where_its_windows_are(plan):
    gaps = [(1.5, 2.7), (4.8, 6.0), (8.4, 9.6)]
    solid = [(0.0, 1.5), (2.7, 4.8), (6.0, 8.4), (9.6, 12.0)]
    assert pairs(on(plan, WALLS)) == {frozenset({(a, 0.0), (b, 0.0)}) for a, b in solid}
    assert {frozenset({(a, 0.0), (b, 0.0)}) for a, b in gaps} <= pairs(on(plan, OPENINGS))
    assert len(on(plan, OPENINGS)) == 3 * 3  # with a stroke across the wall at both ends


def test_the_camera_stands_before_the_wall_with_its_cone(plan, facade):
    mark = next(stroke for stroke in on(plan, CAMERA) if stroke.is_closed)
    assert np.allclose(mark.points.mean(axis=0), [-6.5, -15.0])
    rays = [stroke.points for stroke in on(plan, CAMERA) if not stroke.is_closed]
    assert len(rays) == 2
    width, focal = facade.camera.width, facade.camera.focal
    left, right = [np.arctan2(*(ray[1] - ray[0])) for ray in rays]
    assert left < right
    assert abs((right - left) - 2 * np.arctan(width / 2 / focal)) < 0.05  # the principal point is off the middle


def test_two_walls_meet_at_a_right_angle(scene):
    walls = pairs(on(plan_of(scene), WALLS))
    assert frozenset({(0.0, 0.0), (0.0, 6.0)}) in walls


def test_walls_of_guesses_are_dashed_and_counted(scene, told):
    low = replace(told.lines, probability=np.full(len(told.lines), 0.2))
    drawing = plan_of(replace(scene, lines=low))
    assert all(stroke.layer.is_dashed for stroke in on(drawing, WALLS))
    assert any("walls, whose place is probably wrong" in label.text for label in drawing.labels)
    assert not any(stroke.layer.is_dashed for stroke in on(plan_of(scene), WALLS))


@pytest.mark.parametrize("probability", [0.9, 0.2])
@pytest.mark.parametrize("detail", ["openings", "none"])
def test_walls_whose_lines_are_left_out_as_details_are_as_sure_as_with_them(scene, told, detail, probability):
    lines = replace(told.lines, probability=np.full(len(told.lines), probability))
    whole = replace(scene, lines=replace(lines, role=["detail"] * (len(lines) - 1) + ["outline"]))
    drawn = keep_drawn(whole, detail)
    assert len(drawn.lines) == 1
    own = [{stroke.layer.name for stroke in on(plan_of(each), WALLS)} for each in (whole, drawn)]
    assert own[0] == own[1]
    assert guessed_planes(build_model(drawn)) == guessed_planes(build_model(whole))


def test_walls_are_as_sure_as_their_details_where_no_line_stays(scene, told):
    lines = replace(told.lines, probability=np.full(len(told.lines), 0.2), role=["detail"] * len(told.lines))
    drawn = keep_drawn(replace(scene, lines=lines), "none")
    assert len(drawn.lines) == 0
    assert all(stroke.layer.is_dashed for stroke in on(plan_of(drawn), WALLS))


def test_the_plan_measures_the_facade_and_the_way_to_the_camera(plan):
    across = {plan.unit.text(each.length) for each in plan.dimensions if not each.is_upright}
    up = {plan.unit.text(each.length) for each in plan.dimensions if each.is_upright}
    assert {"12.00", "6.50", "18.50"} == across
    assert "15.00" in up


def test_the_chosen_facade_is_level(scene):
    side = pairs(on(plan_of(scene, facade=1), WALLS))
    assert frozenset({(0.0, 0.0), (6.0, 0.0)}) in side
