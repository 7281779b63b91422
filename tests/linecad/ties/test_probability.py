"""How sure the place of each line is: from 0 to 1, 0 for lines of no body, more where more speaks for it."""

from dataclasses import replace

import numpy as np
import pytest

from linecad.ties.bodies import RigidBodies
from linecad.ties.depth_ties import MapPlaces
from linecad.ties.probability import (
    AT_ONCE,
    LARGEST_MARGIN,
    LOG_ODDS,
    WITH_MAP_LOG_ODDS,
    features,
    probabilities,
)
from solver.bodies.ties import Placement

NO_BODY = 3  # the first lines of the second wall


@pytest.fixture
def placed(build_town, build_row, build_setting):
    """Two walls in their places, but for a few lines of the second that are of no body."""
    seen = build_town(*build_row(2))
    body = seen.part.copy()
    body[24 : 24 + NO_BODY] = -1
    return build_setting(seen, body=body)


def placement(*margin):
    return Placement(
        log_scale=np.zeros(len(margin)), counted=np.zeros(0, bool), objective=0.0, bound=0.0, gap=0.0,
        status="optimal", nodes=1, solver="none", margin=np.array(margin),
    )  # fmt: skip


def known(setting, margins=(6.0, 2.0), reference=0, depth=None):
    return features(setting, placement(*margins), reference, setting.log_depth if depth is None else depth)


def sure(setting, margins=(6.0, 2.0), reference=0, depth=None, held=1.0):
    depth = setting.log_depth if depth is None else depth
    return probabilities(setting, placement(*margins), reference, depth, np.full(len(depth), held))


def test_every_feature_has_log_odds(placed):
    assert list(known(placed)) == list(LOG_ODDS)


def test_probability_is_the_logistic_of_the_features(placed):
    log_odds = AT_ONCE + sum(LOG_ODDS[name] * value for name, value in known(placed).items())
    body = placed.bodies.body
    np.testing.assert_allclose(sure(placed)[body >= 0], (1 / (1 + np.exp(-log_odds)))[body >= 0])
    assert (sure(placed) >= 0).all()
    assert (sure(placed) <= 1).all()


def test_lines_of_no_body_are_sure_of_nothing(placed):
    alone = placed.bodies.body < 0
    assert alone.sum() == NO_BODY
    assert (sure(placed)[alone] == 0).all()
    assert (sure(placed)[~alone] > 0).all()
    assert all((value[alone] == 0).all() for value in known(placed).values())


def test_a_line_is_as_sure_as_its_body_and_as_it_is_held_there(placed):
    np.testing.assert_allclose(sure(placed, held=0.3), 0.3 * sure(placed))


@pytest.mark.parametrize("reference", [0, 1])
def test_the_reference_is_at_least_as_sure_as_others_of_its_margin(build_town, build_row, build_setting, reference):
    setting = build_setting(build_town(*build_row(0)))
    body = setting.bodies.body
    found = sure(setting, (5.0, 5.0), reference)
    assert found[body == reference].min() >= found[body != reference].max()


def test_a_body_is_surer_the_larger_its_margin(placed):
    second = placed.bodies.body == 1
    little, more, most = (sure(placed, (8.0, margin))[second] for margin in (0.0, 2.0, 8.0))
    assert (little < more).all()
    assert (more < most).all()


def test_a_margin_counts_up_to_an_end(placed):
    at_end = known(placed, (LARGEST_MARGIN, LARGEST_MARGIN))
    beyond = known(placed, (1000.0, LARGEST_MARGIN))
    assert all((at_end[name] == beyond[name]).all() for name in LOG_ODDS)


def test_features_of_lines(placed):
    first, second = (placed.bodies.body == body for body in range(2))
    found = known(placed, (9.0, 4.0), reference=1)
    for name, of_first, of_second in (
        ("of the reference", 0.0, 1.0),
        ("margin", 9.0, 4.0),
        ("root of margin", 3.0, 2.0),
        ("lines of the body", np.log(24), np.log(24 - NO_BODY)),
        ("share of the reference", 21 / 45, 21 / 45),
        ("together", 1.0, 1.0),
        ("agreement of all", 1.0, 1.0),
        ("bodies", np.log(3), np.log(3)),
    ):
        assert found[name][first] == pytest.approx(of_first), name
        assert found[name][second] == pytest.approx(of_second), name


def test_agreement_counts_the_crossings_that_tell(placed):
    graph = placed.graph
    i, j = graph.edges.T
    depth = placed.log_depth.copy()
    line = 15  # a course that reaches the second wall
    depth[line] += 0.02  # beyond what a crossing may be off
    own = int(((i == line) | (j == line)).sum())
    found = known(placed, depth=depth)
    assert found["agreement of all"][0] == pytest.approx(1 - own / len(graph.edges))
    assert found["agreement of the line"][line] == pytest.approx(1 / (own + 2))
    other = int(i[j == line][0]) if (j == line).any() else int(j[i == line][0])
    degree = int(((i == other) | (j == other)).sum())
    assert found["agreement of the line"][other] == pytest.approx(degree / (degree + 2))
    silent = replace(placed, graph=replace(graph, informative=np.zeros(len(graph.edges), bool)))
    assert known(silent, depth=depth)["agreement of the line"][line] == 0.5
    assert known(silent, depth=depth)["agreement of all"][line] == 0.0


def test_lines_that_leave_their_body_in_the_fits_are_less_sure(placed):
    before = sure(placed)
    placed.fits.depth[:2, 5] += 1.0
    after = sure(placed)
    assert known(placed)["together"][5] == 0.5
    assert after[5] < before[5]
    assert np.delete(after, 5).tolist() == np.delete(before, 5).tolist()


def test_lines_move_relative_to_the_fit_to_all(placed):
    depth = np.linspace(0.0, 3.0, len(placed.bodies.body))
    fits = replace(placed.fits, depth=np.tile(depth, (len(placed.fits.depth), 1)))
    together = known(replace(placed, log_depth=depth, fits=fits))["together"]
    assert (together[placed.bodies.body >= 0] == 1).all()


def by_map(*misfit, width=0.02, worth=3.0):
    """What a map made of two bodies that are so far off it."""
    return MapPlaces(np.zeros(2), 0.0, np.zeros(2, bool), np.array(misfit), width, worth)


def test_every_feature_has_log_odds_with_a_map_too(placed):
    found = features(placed, placement(6.0, 2.0), 0, placed.log_depth, by_map(0.0, 0.0))
    assert list(found) == list(WITH_MAP_LOG_ODDS)
    assert set(found) - set(known(placed)) == {"map's word", "off the map"}


def test_a_map_speaks_of_the_bodies_that_it_tells_of(placed):
    """The margins are those of the ground and of the map too."""
    first, second = (placed.bodies.body == body for body in range(2))
    places = placement(6.0, 2.0, 1.0, 4.0)
    found = features(placed, places, 0, placed.log_depth, by_map(-0.03, np.nan))
    assert set(found["map's word"][first].tolist()) == {3.0}
    assert found["off the map"][first] == pytest.approx(1.5), "widths, whether too far or too near"
    for name in ("map's word", "off the map"):
        assert not found[name][~first].any()
    before = features(placed, places, 0, placed.log_depth)
    assert all((found[name] == before[name]).all() for name in LOG_ODDS if "map" not in name)
    assert second.any()


def test_how_far_off_the_map_counts_up_to_an_end(placed):
    places = placement(6.0, 2.0, 1.0)
    far, farther = (
        features(placed, places, 0, placed.log_depth, by_map(0.0, off))["off the map"] for off in (0.5, 50.0)
    )
    assert (far == farther).all()
    assert 1 < far.max() < 25


def test_the_map_counts_as_the_table_says(placed, monkeypatch):
    places, second = placement(6.0, 2.0, 1.0), placed.bodies.body == 1
    monkeypatch.setitem(WITH_MAP_LOG_ODDS, "map's word", 0.5)
    monkeypatch.setitem(WITH_MAP_LOG_ODDS, "off the map", -0.4)
    silent, near, far = (
        probabilities(placed, places, 0, placed.log_depth, np.ones(len(placed.log_depth)), mapped)
        for mapped in (by_map(np.nan, np.nan), by_map(0.0, 0.0), by_map(0.0, 0.08))
    )
    assert (silent < near)[placed.bodies.body >= 0].all()
    assert (far < near)[second].all()
    assert (far == near)[~second].all()


def test_a_photo_without_bodies_has_no_sure_line(placed):
    none = replace(placed, bodies=RigidBodies(np.full(len(placed.bodies.body), -1), 0))
    assert sure(none, (0.0,)).tolist() == [0.0] * len(placed.bodies.body)
