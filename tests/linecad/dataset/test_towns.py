"""Streets of several frames: what is promised of them, and that other scenes did not change."""

import hashlib

import numpy as np
import pytest

from linecad.dataset.frames import SAME_FRAME, _find_turns, _nearest
from linecad.dataset.make import DatasetOptions, draw_draft, measure, plan_scenes
from linecad.dataset.scenes import SceneKind, draw_scene
from linecad.dataset.towns import LARGEST_TURN, MEDIAN_TURN, _turn
from linecad.dataset.truth import NOTHING


def test_neighbours_turn_as_measured() -> None:
    rng = np.random.default_rng(1)
    turns = np.abs([_turn(0.0, rng) for _ in range(4000)])
    assert np.median(turns) == pytest.approx(MEDIAN_TURN, rel=0.06)
    assert turns.max() == LARGEST_TURN


def test_a_town_has_several_frames_and_sloped_roofs() -> None:
    draft = draw_draft(5, 1, "town")
    truth = measure(draft, 480, 270)
    assert draft.name == truth.name == "town-0001"
    assert truth.frames is not None
    shown = np.bincount(truth.frames.quad[truth.ids[truth.ids >= 0]] + 1)[1:]
    assert (shown > 0.02 * shown.sum()).sum() >= 3
    assert ((truth.frames.quad_slope > 0.4) & (truth.frames.quad_slope < 1.0)).any()
    assert truth.frames.turn[0] == 0
    assert np.abs(truth.frames.turn).max() <= np.pi / 4


def test_walls_two_degrees_apart_and_one_between_are_all_in_frames() -> None:
    turns = np.radians([0.0, 0.9, 1.9, 40.0])
    frames = _find_turns(turns, np.array([5.0, 1.0, 4.0, 2.0]))
    assert (_nearest(turns, frames, np.full(4, SAME_FRAME)) != NOTHING).all()
    assert len(frames) == 3


def test_a_plan_of_one_kind_has_scenes_of_it_alone() -> None:
    plan = plan_scenes(DatasetOptions(scenes=12, seed=1), "town")
    assert plan.names[11] == "town-0011"
    assert plan.source == "town"


@pytest.mark.parametrize(
    ("kind", "expected"),
    [("street", "e28438d6c3a061e6"), ("courtyard", "2022f2d4854e1354"), ("room", "657318812d34d306")],
)
def test_scenes_of_other_kinds_are_what_they_were(kind: SceneKind, expected: str) -> None:
    model, _ = draw_scene(kind, np.random.default_rng([7, 0, 0]))
    found = hashlib.sha256((np.round(np.array(model.corners), 6) + 0.0).tobytes()).hexdigest()[:16]
    assert found == expected
