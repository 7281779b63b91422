"""Streets between gardens: what lies and stands before walls, and what must stay free."""

import numpy as np
import pytest

from linecad.arrays import Bool, Float
from linecad.dataset.choice import manhattan
from linecad.dataset.furniture import add_bush, add_hedge
from linecad.dataset.gardens import Forecourt, _add_before_wall, _add_boundary, _lay_grounds
from linecad.dataset.make import draw_draft, measure
from linecad.dataset.modelling import UP, Model, Wall
from linecad.dataset.scenes import draw_scene

LENGTH, DEEP, LEVEL = 14.0, 5.0, 0.1  # m
DOOR = (6.0, 7.1)


@pytest.fixture
def forecourt() -> Forecourt:
    model = Model()
    model.start_body("building")
    wall = Wall(model, np.array([2.0, 3.0, 0.0]), np.array([0.0, 1.0, 0.0]), np.array([1.0, 0.0, 0.0]))
    model.start_body("ground")
    return Forecourt(wall, LENGTH, DEEP, LEVEL)


def in_wall(forecourt: Forecourt) -> Float:
    """(Q, 4, 3) corners along the wall, up from the ground, and out of the wall."""
    return forecourt.wall.model.quads(np.zeros(3))[:, :, [1, 2, 0]] - [3.0, LEVEL, 2.0]


def of_kind(model: Model, *kinds: str) -> Bool:
    found: Bool = np.isin(np.array(model.kinds)[model.body], kinds)
    return found


@pytest.mark.parametrize("seed", range(20))
def test_the_way_to_the_door_is_free(forecourt: Forecourt, seed: int) -> None:
    rng = np.random.default_rng(seed)
    _add_boundary(forecourt, DOOR, rng)
    _add_before_wall(forecourt, DOOR, rng)
    solid = in_wall(forecourt)[of_kind(forecourt.wall.model, "furniture")]
    before = (solid[:, :, 0].min(axis=1) < DOOR[1]) & (solid[:, :, 0].max(axis=1) > DOOR[0])
    assert len(solid) + of_kind(forecourt.wall.model, "tree").sum() > 0
    assert not before.any()


@pytest.mark.parametrize("seed", range(20))
def test_grounds_lie_between_the_wall_and_the_street(forecourt: Forecourt, seed: int) -> None:
    _lay_grounds(forecourt, DOOR, np.random.default_rng(seed))
    ground = in_wall(forecourt)
    assert len(ground) > 0
    assert ground.reshape(-1, 3).min(axis=0) == pytest.approx(np.zeros(3), abs=0.01)
    assert ground[:, :, 0].max() <= LENGTH + 1e-9
    assert ground[:, :, 1].max() <= 0.15
    assert ground[:, :, 2].max() <= DEEP + 0.08 + 1e-9  # the stone along a strip stands outside it


def test_no_two_grounds_lie_at_one_height(forecourt: Forecourt) -> None:
    for seed in range(30):
        _lay_grounds(forecourt, DOOR, np.random.default_rng(seed))
        model = forecourt.wall.model
        quads = in_wall(forecourt)
        level = quads[np.ptp(quads[:, :, 1], axis=1) < 1e-9]
        heights = level[:, 0, 1][level[:, 0, 1] < 0.025]
        assert len(np.unique(heights.round(6))) == len(heights)
        model.corners.clear()
        model.materials.clear()
        model.body.clear()


def test_hedges_and_bushes_have_no_edges() -> None:
    model, rng = Model(), np.random.default_rng(3)
    model.start_body("tree")
    sides = (4 * np.eye(3)[0], 1.2 * UP, 0.5 * np.eye(3)[1])
    add_hedge(model, np.array([1.0, 2.0, 0.0]), sides, (0.3, 0.4, 0.2), rng)
    add_bush(model, np.array([9.0, 2.0, 0.0]), np.array([0.3, 0.3, 0.5]), (0.3, 0.4, 0.2), rng)
    assert model.ends == []
    quads = model.quads(np.zeros(3))
    hedge = quads[quads[:, :, 0].max(axis=1) < 6.0].reshape(-1, 3)
    assert (hedge.min(axis=0) > [0.7, 1.7, -0.3]).all()
    assert (hedge.max(axis=0) < [5.3, 2.8, 1.5]).all()


def test_scenes_are_manhattan_and_of_many_kinds_of_ground() -> None:
    grounds = set()
    for seed in range(4):
        model, view = draw_scene("garden", np.random.default_rng([5, seed, 0]))
        edges, body = model.edges()
        built = np.isin(np.array(model.kinds)[body], ["building", "ground", "furniture"])
        assert manhattan(edges[built] - view.eye).all()
        grounds |= {model.materials[quad] for quad in np.flatnonzero(of_kind(model, "ground")).tolist()}
    assert len(grounds) > 20
    assert len({material.pattern for material in grounds}) >= 5


def test_a_draft_is_the_same_each_time_and_shows_houses_ground_and_hedges() -> None:
    draft = draw_draft(200, 0, "garden")
    again = draw_draft(200, 0, "garden")
    assert (np.array(draft.model.corners) == np.array(again.model.corners)).all()
    truth = measure(draft, 480, 270)
    assert truth.name == "garden-0000"
    shown = np.bincount(truth.body[truth.ids[truth.ids >= 0]], minlength=len(draft.model.kinds))
    kinds = np.array(draft.model.kinds)
    share = {kind: shown[kinds == kind].sum() / truth.ids.size for kind in ("building", "ground")}
    assert share["building"] > 0.3
    assert share["ground"] > 0.1
