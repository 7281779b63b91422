"""A map as a witness: how far its word goes, what it ties, where it puts what nothing else ties."""

from dataclasses import replace

import numpy as np
import pytest

import linecad.ties.depth_ties
from linecad.ties.candidates import Candidate
from linecad.ties.depth_kind import DepthReading
from linecad.ties.depth_samples import WallVotes
from linecad.ties.depth_ties import (
    LEAST_WORD,
    DepthWitness,
    estimate_width,
    follow_map,
    hear,
    report_of,
    ties_to_map,
)
from linecad.ties.depth_words import BodyWords
from linecad.ties.table import AT_ONCE, LOG_ODDS
from solver.bodies.search import place
from solver.bodies.ties import Ties
from solver.options import SolveOptions

MOVED = (0.3, -0.2, 0.1)
LARGE = 1000  # lines: of a body that counts in full
NONE = Ties(np.zeros((0, 2)), [], [], [], [])


def candidate(bodies, log_ratio, log_odds, kind="bundle"):
    """One whose ratio is right with these log-odds."""
    name = max(LOG_ODDS[kind], key=lambda one: abs(LOG_ODDS[kind][one]))
    return Candidate(kind, bodies, log_ratio, -1, {name: (log_odds - AT_ONCE[kind]) / LOG_ODDS[kind][name]})


def evidence(rng, width, bodies=60, wrong=0.2):
    """The log scales of a map of that width, and candidates of which four in five are right, as they say."""
    truth = rng.uniform(-0.5, 0.5, bodies)
    found = []
    for first in range(bodies):
        for second in rng.choice(bodies, 2, replace=False).tolist():
            if first != second:
                off = rng.laplace(0, 0.4) if rng.random() < wrong else 0.0
                found.append(candidate((first, second), truth[first] - truth[second] + off, np.log(1 / wrong - 1)))
    return truth + width * rng.standard_cauchy(bodies), found


def witness(log_scale, width=0.02, weight=4.0, worth=4.0, ground=None):
    """That a map asks bodies for so much, each by one wall."""
    asked = np.array(log_scale, float)
    told = np.isfinite(asked)
    reading = DepthReading("z", 0.0, 0.0, 0.0, asked, WallVotes(np.flatnonzero(told), asked[told], np.ones(told.sum())))
    return DepthWitness(reading, width, 4.0, weight, BodyWords(asked, np.where(told, worth, 0.0)), width, ground)


def followed(log_scale, ties=NONE, size=None, reference=0, **fields):
    """Where bodies stand that a map asks to grow so much, with other ties, by the program and the map."""
    size = np.full(len(log_scale), LARGE) if size is None else np.array(size)
    heard = witness(log_scale, **fields)
    every = ties.joined(ties_to_map(heard, size))
    placement = place(every, len(size) + 2, reference, SolveOptions())
    return follow_map(heard, every, placement, reference, size)


def tie(first, second, log_ratio, weight=9.0):
    return Ties([[first, second]], [log_ratio], [0.02], [weight], [-1])


@pytest.fixture(scope="module")
def moved(avenue_walls, build_setting):
    seen, _ = avenue_walls
    return build_setting(seen, MOVED)


@pytest.fixture(scope="module")
def exact(avenue_walls, build_depth_map):
    seen, surfaces = avenue_walls
    return build_depth_map(seen.sight, surfaces, scale=5.0)


def test_without_a_map_there_is_no_witness(moved):
    assert hear(moved, [], None) == ""


def test_an_exact_map_is_heard(moved, exact):
    heard = hear(moved, [], exact)
    assert heard.reading.kind == "z"
    np.testing.assert_allclose(heard.reading.log_scale, np.log(5.0) - np.array(MOVED), atol=1e-3)
    assert heard.width > 0
    assert heard.weight > 0


def test_what_makes_no_sense_is_a_reason(moved, exact):
    flat = replace(exact, values=np.where(exact.valid, 3.0, 0.0))
    said = hear(moved, [], flat)
    assert said == "it holds one depth throughout"
    report = report_of(flat, said, None)
    assert (report.file, report.left_out, report.kind, report.scale) == ("map.npz", said, None, None)


def test_a_map_that_contradicts_what_crossings_hold_is_left_out(moved, exact):
    """Sure ratios of all pairs that the map misses by a factor of two."""
    others = np.array(MOVED) * -1 + [0.0, 0.7, -0.7]
    sure = [candidate((a, b), others[a] - others[b], 9.0) for a, b in ((0, 1), (0, 2), (1, 2))]
    said = hear(moved, 5 * sure, exact)
    assert isinstance(said, str)
    assert "off the bodies of this photo" in said
    agreeing = [candidate((a, b), MOVED[b] - MOVED[a], 9.0) for a, b in ((0, 1), (0, 2), (1, 2))]
    assert isinstance(hear(moved, 5 * agreeing, exact), DepthWitness)


@pytest.mark.parametrize("width", [0.01, 0.03, 0.08])
def test_the_width_is_about_that_of_the_errors(width):
    found = [estimate_width(*evidence(np.random.default_rng(seed), width)) for seed in range(9)]
    assert 0.7 < np.median(found) / width < 1.5
    assert min(found) / width > 0.4
    assert max(found) / width < 2.5


def test_a_map_that_waves_inside_bodies_is_not_sharp_about_them(moved, exact):
    rightly = [candidate((a, b), MOVED[b] - MOVED[a], 9.0) for a, b in ((0, 1), (0, 2), (1, 2))]
    waves = np.exp(0.05 * np.random.default_rng(0).standard_normal(exact.values.shape))
    wavy = replace(exact, values=exact.values * waves**2)
    assert hear(moved, 9 * rightly, wavy).width > 1.3 * hear(moved, 9 * rightly, exact).width
    wild = replace(exact, values=exact.values * waves**5)
    said = hear(moved, 9 * rightly, wild)
    assert isinstance(said, str)
    assert "off the " in said


def test_bodies_of_which_the_map_tells_nothing_do_not_count():
    asked, candidates = evidence(np.random.default_rng(3), 0.02)
    known = [one for one in candidates if max(one.bodies) < 40]
    asked[40:] = np.nan
    assert estimate_width(asked, candidates) == estimate_width(asked, known)


def test_feet_say_nothing_of_the_width():
    asked, candidates = evidence(np.random.default_rng(3), 0.02)
    feet = [candidate((body, 60), 0.9, 9.0, "ground") for body in range(60)]
    assert estimate_width(asked, [*feet, *candidates]) == estimate_width(asked, candidates)


def test_without_evidence_the_width_is_that_of_published_networks():
    assert 0.01 < estimate_width(np.zeros(3), []) < 0.04
    assert estimate_width(np.full(3, np.nan), [candidate((0, 1), 0.1, 5.0)]) == estimate_width(np.zeros(3), [])


def test_a_narrower_map_is_worth_more(moved, exact):
    rightly = [candidate((a, b), MOVED[b] - MOVED[a], 9.0) for a, b in ((0, 1), (0, 2), (1, 2))]
    wrongly = [replace(one, log_ratio=one.log_ratio + 0.1) for one in rightly]
    narrow, wide = (hear(moved, 3 * candidates, exact) for candidates in (rightly, wrongly))
    assert narrow.width < wide.width
    assert narrow.worth > wide.worth


def test_a_map_is_worth_more_where_crossings_contradict_each_other(moved, exact):
    """The two have one worth; against ties of crossings that nobody doubts it weighs less."""
    random = np.random.default_rng(1)
    doubtful = replace(moved, graph=replace(moved.graph, log_ratio=random.normal(0, 1, len(moved.graph.edges))))
    agreeing, contradicting = hear(moved, [], exact), hear(doubtful, [], exact)
    assert agreeing.worth == contradicting.worth
    assert agreeing.weight < contradicting.weight


def test_each_body_has_one_tie_to_the_map():
    size = np.array([LARGE, LARGE, 12, LARGE])
    ties = ties_to_map(witness([0.5, np.nan, 0.2, -0.1]), size)
    assert ties.bodies.tolist() == [[0, 5], [2, 5], [3, 5]], "body 4 is the ground"
    assert ties.log_ratio.tolist() == [0.5, 0.2, -0.1]
    assert np.asarray(ties.yields).all()
    assert ties.weight[0] == ties.weight[2] > ties.weight[1] > 0, "crumbs count less"
    assert len(set(ties.tolerance.tolist())) == 1
    wide = ties_to_map(witness([0.5, np.nan, 0.2, -0.1], width=0.04), size)
    assert wide.tolerance[0] == pytest.approx(2 * ties.tolerance[0])


def test_a_tie_weighs_what_the_word_about_its_body_is_worth():
    ties = ties_to_map(witness([0.5, 0.2, 0.1], worth=[4.0, 6.0, -0.5]), np.full(3, LARGE))
    assert ties.weight.tolist() == [4.0, 6.0, LEAST_WORD], "walls that each say something else are hardly a word"


def test_what_is_heard_has_words_of_the_walls_and_the_ground(avenue_walls, moved, build_depth_map, build_ground):
    seen, surfaces = avenue_walls
    heard = hear(moved, [], build_depth_map(seen.sight, [*surfaces, build_ground(1.6, None)], scale=5.0))
    np.testing.assert_allclose(heard.words.log_scale, np.log(5.0) - np.array(MOVED), atol=1e-3)
    assert (heard.words.worth > 1).all()
    assert heard.ground == pytest.approx(np.log(1.6 * 5.0), abs=0.01)


def test_what_stands_on_a_ground_that_the_map_ties_is_placed_by_the_map():
    foot = tie(1, 2, -0.3)
    found = followed([0.0, np.nan], foot, ground=0.4)
    assert found.log_scale.tolist() == pytest.approx([0.0, 0.1], abs=1e-6)
    assert found.by_map.tolist() == [False, True]


def test_a_part_of_a_body_has_the_word_of_that_body():
    more = witness([0.5, 0.2], worth=[4.0, 6.0]).with_part_of(0)
    assert more.words.log_scale.tolist() == more.reading.log_scale.tolist() == [0.5, 0.2, 0.5]
    assert more.words.worth.tolist() == [4.0, 6.0, 4.0]


def test_the_ground_that_the_map_shows_is_tied_to_it():
    ties = ties_to_map(witness([0.5, 0.2], ground=0.7, weight=3.0), np.full(2, LARGE))
    assert ties.bodies.tolist() == [[0, 3], [1, 3], [2, 3]]
    assert ties.log_ratio.tolist() == [0.5, 0.2, 0.7]
    assert ties.weight[2] == pytest.approx(3.0)


def test_a_false_foot_yields_to_a_map_that_shows_the_ground():
    """Two houses stand on it; the foot of one is found 30 % off."""
    feet = tie(0, 2, -0.4, weight=3.5).joined(tie(1, 2, -0.3, weight=3.0))
    with_ground, without = (followed([0.0, 0.2], feet, ground=ground) for ground in (0.4, None))
    assert with_ground.log_scale[1] == pytest.approx(0.2, abs=0.04)
    assert without.log_scale[1] == pytest.approx(0.1, abs=0.04)


def test_a_word_that_is_worth_little_ties_nothing():
    assert len(ties_to_map(witness([0.5, 0.2], weight=0.1), np.array([LARGE, LARGE]))) == 0


@pytest.mark.parametrize("weight", [0.1, 4.0])
def test_bodies_that_nothing_ties_stand_where_the_map_has_them(weight):
    """Whether or not its word was worth enough for the program."""
    found = followed([1.3, 0.8, np.nan, 1.5], weight=weight)
    assert found.log_scale.tolist() == pytest.approx([0.0, -0.5, 0.0, 0.2], abs=1e-9)
    assert found.of_map == pytest.approx(1.3)
    assert found.by_map.tolist() == [False, True, False, True]
    np.testing.assert_allclose(found.misfit, [0, 0, np.nan, 0], atol=1e-9)


@pytest.mark.parametrize("weight", [0.1, 4.0])
def test_what_a_tie_holds_moves_with_its_body(weight):
    """The map tells of body 1, of 2 too but a bit otherwise, and of 3 not at all."""
    held = tie(1, 2, 0.3).joined(tie(2, 3, -0.1))
    found = followed([0.0, 0.5, 0.21, np.nan], held, size=[LARGE, LARGE, 10, 50], weight=weight)
    assert found.log_scale[1] - found.log_scale[2] == pytest.approx(0.3, abs=1e-9)
    assert found.log_scale[2] - found.log_scale[3] == pytest.approx(-0.1, abs=1e-9)
    assert found.log_scale[1] == pytest.approx(0.5, abs=0.01)
    assert found.by_map.tolist() == [False, True, True, True]


@pytest.mark.parametrize("weight", [0.1, 4.0])
def test_what_ties_hold_to_the_reference_stays(weight):
    """Also where the map is off by less than the tie's tolerance."""
    for off in (0.0, 0.013, -0.018):
        found = followed([0.0, 0.4 + off, 0.9], tie(0, 1, -0.4), weight=weight)
        assert found.log_scale[:2].tolist() == pytest.approx([0.0, 0.4], abs=1e-9)
        assert found.by_map.tolist() == [False, False, True]


def test_the_reference_may_be_any_body():
    found = followed([0.1, 0.6, -0.2], reference=1, weight=0.1)
    assert found.log_scale.tolist() == pytest.approx([-0.5, 0.0, -0.8])
    assert found.by_map.tolist() == [True, False, True]


def test_a_map_that_is_silent_about_the_largest_body_is_left_out(avenue_walls, build_setting, build_depth_map):
    """What is placed is placed relative to it."""
    seen, surfaces = avenue_walls
    setting = build_setting(seen)
    largest = setting.bodies.size.argmax()
    without = build_depth_map(seen.sight, [surface for body, surface in enumerate(surfaces) if body != largest])
    said = hear(setting, [], without)
    assert isinstance(said, str)
    assert said.startswith("it says nothing of the largest body")
    others = [one for one in range(3) if one != largest]
    without = build_depth_map(seen.sight, [surfaces[largest], surfaces[others[0]]])
    assert isinstance(hear(setting, [], without), DepthWitness)


def test_misfits_are_what_bodies_are_off_the_map():
    found = followed([0.0, 0.45, 0.4, 0.4], tie(0, 1, -0.4).joined(tie(0, 2, -0.4)).joined(tie(0, 3, -0.4)), weight=0.1)
    assert found.of_map == pytest.approx(0.0, abs=1e-9)
    assert found.misfit.tolist() == pytest.approx([0.0, 0.05, 0.0, 0.0], abs=1e-9)


def test_the_report_of_a_map_that_was_used(moved, exact):
    heard = hear(moved, [], exact)
    size = moved.bodies.size
    ties = ties_to_map(heard, size)
    placement = place(ties, len(size) + 2, 0, SolveOptions())
    report = report_of(exact, heard, follow_map(heard, ties, placement, 0, size))
    assert (report.file, report.left_out, report.kind, report.shift) == ("map.npz", "", "z", 0.0)
    assert report.scale == pytest.approx(5.0 / np.exp(MOVED[0]), rel=1e-3)
    assert report.width == heard.width


def test_the_map_is_a_body_beyond_the_ground(monkeypatch):
    """The ground stays where feet put it, also where the map alone ties houses."""
    monkeypatch.setattr(linecad.ties.depth_ties, "LEAST_WORTH", 0.0)
    found = followed([0.0, 0.3], tie(0, 2, 0.7), weight=0.1)
    assert found.log_scale.tolist() == pytest.approx([0.0, 0.3], abs=1e-9)
    assert found.by_map.tolist() == [False, True]
    assert found.ground == pytest.approx(-0.7)


def test_the_ground_goes_with_the_bodies_on_it():
    """Nothing but the map ties the house on the ground to the reference: the ground moves as the house does."""
    found = followed([0.0, 0.3], tie(1, 2, 0.7), weight=0.1)
    assert found.log_scale.tolist() == pytest.approx([0.0, 0.3], abs=1e-9)
    assert found.log_scale[1] - found.ground == pytest.approx(0.7)
