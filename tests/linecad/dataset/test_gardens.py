"""Streets with front gardens: what lies and stands before walls, and what must stay free."""

import numpy as np
import pytest

from linecad.arrays import Bool, Float
from linecad.dataset.choice import manhattan
from linecad.dataset.facades import draw_style
from linecad.dataset.furniture import add_bush, add_hedge
from linecad.dataset.gardens import (
    BELOW,
    FAR,
    Forecourt,
    _add_before_wall,
    _add_boundary,
    _add_landing,
    _add_plot,
    _height,
    _lay_grounds,
    build_gardens,
)
from linecad.dataset.houses import add_building
from linecad.dataset.make import draw_draft, measure
from linecad.dataset.modelling import UP, Model, Wall
from linecad.dataset.scenes import draw_scene

LENGTH, LEVEL = 14.0, 0.1  # m
DOOR, PATH = (6.0, 7.1), (5.5, 7.6)
DEPTHS = (0.3, 0.9, 2.0, 5.0)


def build_forecourt(deep: float) -> Forecourt:
    model = Model()
    model.start_body("building")
    wall = Wall(model, np.array([2.0, 3.0, 0.0]), np.array([0.0, 1.0, 0.0]), np.array([1.0, 0.0, 0.0]))
    model.start_body("ground")
    return Forecourt(wall, LENGTH, deep, LEVEL, DOOR, PATH)


def in_wall(forecourt: Forecourt) -> Float:
    """(Q, 4, 3) corners along the wall, up from the ground, and out of the wall."""
    return forecourt.wall.model.quads(np.zeros(3))[:, :, [1, 2, 0]] - [3.0, LEVEL, 2.0]


def of_kind(model: Model, *kinds: str) -> Bool:
    found: Bool = np.isin(np.array(model.kinds)[model.body], kinds)
    return found


@pytest.mark.parametrize("deep", DEPTHS)
@pytest.mark.parametrize("seed", range(8))
def test_what_stands_before_a_wall_keeps_clear_of_the_door_and_the_street(deep: float, seed: int) -> None:
    forecourt, rng = build_forecourt(deep), np.random.default_rng(seed)
    if deep > 1.7:
        _add_boundary(forecourt, rng)
    _add_before_wall(forecourt, rng)
    solid = in_wall(forecourt)[of_kind(forecourt.wall.model, "furniture")]
    assert not ((solid[:, :, 0].min(axis=1) < DOOR[1] + 0.5) & (solid[:, :, 0].max(axis=1) > DOOR[0] - 0.5)).any()
    assert solid[:, :, 2].max(initial=0.0) <= deep
    leaves = in_wall(forecourt)[of_kind(forecourt.wall.model, "tree")]
    assert leaves[:, :, 2].max(initial=0.0) < deep + 0.25
    assert leaves[:, :, 1].min(initial=0.0) >= -1e-9


def test_boundaries_and_things_before_walls_do_not_meet() -> None:
    for seed in range(20):
        lone, rng = build_forecourt(2.0), np.random.default_rng(seed)
        _add_before_wall(lone, rng)
        things = in_wall(lone)[of_kind(lone.wall.model, "furniture")]
        other = build_forecourt(2.0)
        _add_boundary(other, rng)
        boundary = in_wall(other)[of_kind(other.wall.model, "furniture")]
        assert things[:, :, 2].max(initial=0.0) < boundary[:, :, 2].min(initial=9.0)


@pytest.mark.parametrize("deep", DEPTHS)
@pytest.mark.parametrize("seed", range(8))
def test_grounds_cover_a_forecourt_once(deep: float, seed: int) -> None:
    forecourt = build_forecourt(deep)
    _lay_grounds(forecourt, 0.0, True, np.random.default_rng(seed))
    quads = in_wall(forecourt)
    ground = quads[np.abs(quads[:, :, 1]).max(axis=1) < 1e-9]
    place = np.random.default_rng(0).uniform([0, 0], [LENGTH, deep], (300, 2))[:, None]
    low, high = ground[:, :, [0, 2]].min(axis=1), ground[:, :, [0, 2]].max(axis=1)
    assert ((place > low) & (place < high)).all(axis=2).sum(axis=1) == pytest.approx(np.ones(300))
    assert quads[:, :, 2].max() <= deep + 1e-9
    before_door = (quads[:, :, 0].max(axis=1) > PATH[0] + 1e-9) & (quads[:, :, 0].min(axis=1) < PATH[1] - 1e-9)
    assert quads[before_door][:, :, 1].max() < 1e-9, "no edging lies before the door"


@pytest.mark.parametrize("shared", [0.0, 1.5, 2.0, 4.0])
def test_the_border_to_a_forecourt_that_adjoins_is_drawn_once(shared: float) -> None:
    forecourt = build_forecourt(2.0)
    _lay_grounds(forecourt, shared, True, np.random.default_rng(0))
    ends = np.array(forecourt.wall.model.ends)[:, :, [1, 0]] - [3.0, 2.0]
    near = ends[(np.abs(ends[:, :, 0]) < 1e-9).all(axis=1)]
    length = np.abs(np.diff(near[:, :, 1], axis=1))
    assert length[length > 0.1].sum() == pytest.approx(max(0.0, 2.0 - shared)), "shorter ones are of the edging"


def test_a_landing_lies_before_the_door() -> None:
    forecourt = build_forecourt(2.0)
    _add_landing(forecourt, np.random.default_rng(0))
    quads = in_wall(forecourt)
    assert quads[:, :, 0].min() < DOOR[0] < DOOR[1] < quads[:, :, 0].max()
    assert 0.05 < quads[:, :, 1].max() < 0.2


def test_windows_lie_below_the_eaves() -> None:
    rng = np.random.default_rng(4)
    for _ in range(40):
        model, style = Model(), draw_style(rng)
        height = _height(style, rng)
        add_building(model, (3.0, 12.0), (4.0, 18.0), (0.0, height), {"-x", "-y"}, rng, style)
        assert np.array(model.openings)[:, :, 2].max() < height


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_a_plot_has_its_house_behind_its_forecourt(sign: float) -> None:
    for seed in range(10):
        model, rng = Model(), np.random.default_rng(seed)
        model.start_body("ground")
        deep = _add_plot(model, sign, (6.0, 0.1), (10.0, 24.0), 0.0, rng)
        quads = sign * model.quads(np.zeros(3))[:, :, 0]
        house, ground = quads[of_kind(model, "building")], quads[of_kind(model, "ground")]
        assert house.min() > 6.0 + deep - 0.9, "balconies stand off a wall"
        assert deep == 0 or ground.min() == pytest.approx(6.0)
        assert deep == 0 or ground.max() == pytest.approx(6.0 + deep)


@pytest.mark.parametrize("level", [0.03, 0.15])
def test_a_house_stands_on_the_ground_between_the_plots(level: float) -> None:
    for seed in range(10):
        model, rng = Model(), np.random.default_rng(seed)
        _add_plot(model, 1.0, (6.0, level), (10.0, 24.0), None, rng)
        house = model.quads(np.zeros(3))[of_kind(model, "building")]
        assert house[:, :, 2].min() == pytest.approx(level - BELOW)


def test_houses_that_adjoin_another_have_one_facade() -> None:
    def facing(shared: float | None, seed: int) -> int:
        model = Model()
        _add_plot(model, 1.0, (6.0, 0.1), (10.0, 24.0), shared, np.random.default_rng(seed))
        corners = np.array(model.openings)
        return int((np.ptp(corners[:, :, 1], axis=1) < 1e-9).sum())

    assert all(facing(0.0, seed) == 0 for seed in range(10))
    assert any(facing(None, seed) > 0 for seed in range(10))


def test_houses_that_end_a_street_stand_on_the_road_beyond_all_traffic() -> None:
    ends = 0
    for seed in range(12):
        model, _, _ = build_gardens(np.random.default_rng(seed))
        quads, body, kinds = model.quads(np.zeros(3)), np.array(model.body), np.array(model.kinds)
        for number in np.flatnonzero(kinds == "building").tolist():
            own = quads[body == number]
            if own[:, :, 0].min() < 0 < own[:, :, 0].max():
                ends += 1
                assert own[:, :, 2].min() == pytest.approx(0.0)
                assert own[:, :, 1].max() > FAR
                cars = quads[np.isin(body, np.flatnonzero(kinds == "car"))]
                assert cars[:, :, 1].max(initial=0.0) < own[:, :, 1].min()
    assert ends > 3


def test_hedges_and_bushes_have_no_edges_and_stand_on_the_ground() -> None:
    model, rng = Model(), np.random.default_rng(3)
    model.start_body("tree")
    sides = (4 * np.eye(3)[0], 1.2 * UP, 0.5 * np.eye(3)[1])
    add_hedge(model, np.array([1.0, 2.0, 0.1]), sides, (0.3, 0.4, 0.2), rng)
    add_bush(model, np.array([9.0, 2.0, 0.1]), np.array([0.3, 0.3, 0.5]), (0.3, 0.4, 0.2), rng)
    assert model.ends == []
    quads = model.quads(np.zeros(3))
    assert quads[:, :, 2].min() >= 0.1 - 1e-9
    hedge = quads[quads[:, :, 0].max(axis=1) < 6.0].reshape(-1, 3)
    assert (hedge.min(axis=0)[:2] > [0.7, 1.7]).all()
    assert (hedge.max(axis=0) < [5.3, 2.8, 1.6]).all()


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


def test_a_draft_is_the_same_each_time_and_shows_houses_ground_and_plants() -> None:
    draft = draw_draft(200, 0, "garden")
    again = draw_draft(200, 0, "garden")
    assert (np.array(draft.model.corners) == np.array(again.model.corners)).all()
    truth = measure(draft, 480, 270)
    assert truth.name == "garden-0000"
    shown = np.bincount(truth.body[truth.ids[truth.ids >= 0]], minlength=len(draft.model.kinds))
    kinds = np.array(draft.model.kinds)
    share = {kind: shown[kinds == kind].sum() / truth.ids.size for kind in ("building", "ground", "tree")}
    assert share["building"] > 0.3
    assert share["ground"] > 0.1
    assert share["tree"] > 0.001
