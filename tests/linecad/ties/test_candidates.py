"""Candidates: which kind a ratio is of, that it is one candidate, and what its features say."""

from dataclasses import replace

import numpy as np
import pytest

import linecad.ties.candidates
from linecad.ties.bundles import find_bundles
from linecad.ties.candidates import (
    FARTHEST,
    GAP_UNIT,
    KINDS,
    MOST_EXCESS,
    MOST_RANK,
    SAME_RATIO,
    find_candidates,
)
from linecad.ties.colours import TYPICAL
from linecad.ties.feet import MOST_LOG_ODDS, Foot
from linecad.ties.levels import MOST
from linecad.ties.looks import Looks
from linecad.ties.planes import INDUCED, SharedPlane
from linecad.ties.table import AT_ONCE, LOG_ODDS
from linecad.ties.walls import find_walls, reach_below
from linecad.ties.weights import log_odds_of

GAP = 2.0 * 3000 / 10  # px between the walls of a row


@pytest.fixture(scope="module")
def row(build_town, build_row):
    """A row of two walls at 10, joined by so many courses."""
    return lambda bars, collinear=True, **more: build_town(*build_row(bars, **more), collinear=collinear)


@pytest.fixture(scope="module")
def stepped(build_town, build_wall):
    """Two walls of the same heights, the second set back: its place can be known by levels alone."""
    random = np.random.default_rng(5)
    heights = np.linspace(-3.0, 3.0, 12) + random.uniform(-0.2, 0.2, 12)
    across = np.linspace(-4.0, -1.5, 12)
    return build_town(build_wall(1, 9.5, across, heights), build_wall(1, 12.0, across + 5.0, heights))


def connected(setting):
    """The same with fits that connect everything."""
    return replace(setting, fits=replace(setting.fits, group=np.zeros_like(setting.fits.group)))


def candidates_of(setting):
    return find_candidates(setting, Looks(setting))


def of_kind(candidates, kind):
    return [candidate for candidate in candidates if candidate.kind == kind]


@pytest.fixture(scope="module")
def grounded(brick_lane, build_setting):
    """Two walls on one pavement; their bodies are 0.3 and -0.2 too large."""
    seen, _ = brick_lane
    return build_setting(seen, moved=(0.3, -0.2), pixels=seen.sight.pixels)


def scenes(row, stepped, grounded, build_setting):
    return [
        grounded,
        build_setting(row(1), moved=(0.3, -0.2)),
        build_setting(row(0), moved=(0.3, -0.2)),
        build_setting(row(3, at=(10.0, 11.0))),
        build_setting(stepped, moved=(0.1, 0.0)),
        build_setting(row(0, level=True, collinear=False), moved=(0.2, 0.0)),
    ]


def test_what_crossings_ask_for_is_a_bundle_and_its_plane_a_feature(row, build_setting):
    found = candidates_of(build_setting(row(2), moved=(0.3, -0.2)))
    (bundle,) = of_kind(found, "bundle")
    assert (bundle.bodies, bundle.normal) == ((0, 1), -1)
    assert bundle.log_ratio == pytest.approx(-0.5)
    assert of_kind(found, "plane") == []
    assert bundle.features["plane of it"] == 1.0, "the crossings are in the plane of both walls"
    assert bundle.features["plane beside"] == 0.0


def test_a_plane_that_no_crossing_implies_stands_beside_the_bundle(row, build_setting):
    setting = build_setting(row(2))
    graph = replace(setting.graph, coordinate=np.zeros_like(setting.graph.coordinate))
    (bundle,) = of_kind(candidates_of(replace(setting, graph=graph)), "bundle")
    assert (bundle.features["plane of it"], bundle.features["plane beside"]) == (0.0, 1.0)


def test_a_plane_elsewhere_is_a_candidate_beside_the_bundle(row, build_setting):
    seen = row(3, at=(10.0, 11.0))  # a bar before the farther wall asks for one depth, where both walls are one plane
    setting = build_setting(seen, body=seen.part)
    odd = replace(setting.graph, log_ratio=setting.graph.log_ratio + 0.3 * (np.diff(seen.part[seen.graph.edges])[:, 0]))
    found = candidates_of(replace(setting, graph=odd))
    (bundle,), (plane,) = of_kind(found, "bundle"), of_kind(found, "plane")
    assert bundle.log_ratio == pytest.approx(np.log(1.1) + 0.3)
    assert (bundle.features["plane of it"], bundle.features["plane beside"]) == (0.0, 0.0)
    assert (plane.log_ratio, plane.normal) == (pytest.approx(np.log(1.1)), 1)


def test_walls_that_nothing_joins_are_tied_by_their_plane(row, build_setting):
    (plane,) = of_kind(candidates_of(build_setting(row(0), moved=(0.3, -0.2))), "plane")
    assert (plane.bodies, plane.normal) == ((0, 1), 1)
    assert plane.log_ratio == pytest.approx(-0.5)


@pytest.mark.parametrize(("rank", "overlap"), [(0, 0.75), (1, 0.0)])
def test_how_far_walls_stand_one_above_the_other_tells_of_main_planes(row, build_setting, monkeypatch, rank, overlap):
    known = SharedPlane((0, 1), -0.5, 1, 10.0, (0.5, 0.25), (5, 5), rank, 0.75)
    monkeypatch.setattr(linecad.ties.candidates, "find_shared_planes", lambda _: [known])
    (plane,) = of_kind(candidates_of(build_setting(row(0), moved=(0.3, -0.2))), "plane")
    assert plane.features["overlap"] == overlap
    (bundle,) = of_kind(candidates_of(build_setting(row(2), moved=(0.3, -0.2))), "bundle")
    assert bundle.features["overlap"] == pytest.approx(0.25 * overlap)  # as far as it is the bodies' plane


@pytest.mark.parametrize(("by", "planes"), [(0.9 * INDUCED, 0), (1.1 * INDUCED, 1)])
def test_a_plane_that_the_fit_made_is_no_candidate(row, build_setting, by, planes):
    setting = build_setting(row(0), moved=(by,))
    assert len(of_kind(candidates_of(connected(setting)), "plane")) == planes
    assert len(of_kind(candidates_of(setting), "plane")) == 1


def test_levels_tie_what_stands_apart(stepped, build_setting):
    found = of_kind(candidates_of(build_setting(stepped, moved=(0.1, 0.0))), "level")
    assert found[0].log_ratio == pytest.approx(-0.1, abs=0.005)
    assert found[0].normal == -1
    assert found[0].features["matches"] == pytest.approx(np.log(11))  # of twelve courses one is at eye level
    assert len(found) <= MOST
    assert found[0].features["level lead"] > 2
    assert found[0].features["same eaves"] == 1.0


def test_levels_at_the_ratio_of_a_plane_are_its_feature(row, build_setting):
    (plane,) = of_kind(found := candidates_of(build_setting(row(0, level=True), moved=(0.3,))), "bundle")
    assert all(abs(other.log_ratio - plane.log_ratio) >= SAME_RATIO for other in of_kind(found, "level"))
    assert plane.features["same eaves"] == 1.0
    assert plane.features["level excess"] == MOST_EXCESS


def test_kinds_give_way_to_those_before_them(row, stepped, grounded, build_setting):
    """A plane or a level at the ratio of a bundle, and a level at that of a plane, are no candidates of their own."""
    for setting in scenes(row, stepped, grounded, build_setting):
        found = candidates_of(setting)
        for one in found:
            for other in found:
                if (
                    "ground" not in (one.kind, other.kind)
                    and one.bodies == other.bodies
                    and KINDS.index(one.kind) < KINDS.index(other.kind)
                ):
                    assert abs(one.log_ratio - other.log_ratio) >= SAME_RATIO


def test_every_feature_has_log_odds_and_is_finite(row, stepped, grounded, build_setting):
    found = [one for setting in scenes(row, stepped, grounded, build_setting) for one in candidates_of(setting)]
    assert {candidate.kind for candidate in found} == set(KINDS) == set(AT_ONCE) == set(LOG_ODDS)
    for candidate in found:
        assert list(candidate.features) == list(LOG_ODDS[candidate.kind])
        assert np.isfinite(list(candidate.features.values())).all()


def test_features_of_two_bodies(build_town, build_row, build_setting):
    first, second = build_row(0)
    (plane,) = of_kind(candidates_of(build_setting(build_town(first, second[:18]))), "plane")
    known = plane.features
    assert known["near"] == pytest.approx(np.exp(-GAP / 100), rel=0.05)
    assert known["not far"] == pytest.approx(np.exp(-GAP / 800), rel=0.01)
    assert (known["lines of the smaller"], known["lines of the larger"]) == pytest.approx((np.log(18), np.log(24)))
    assert (known["fewest lines"], known["most lines"]) == pytest.approx((np.log(18), np.log(24)))
    assert known["levels"] == pytest.approx(np.log1p(5))  # of the six courses of the second one is at eye level
    assert known["colour"] == TYPICAL
    assert (known["smaller share"], known["larger share"]) == (1.0, 1.0)
    assert known["planes near"] == pytest.approx(np.exp(-GAP / 150), rel=0.05)
    assert known["planes not far"] == pytest.approx(np.exp(-GAP / 600), rel=0.01)
    assert (known["rank"], known["horizontal"]) == (0.0, 0.0)


def test_features_of_a_bundle(row, build_setting, monkeypatch):
    setting = build_setting(row(2))
    (bundle,) = find_bundles(setting)
    counted = replace(
        bundle, log_odds=6.0, of_all=8.0, matched=5, fewest=7, corners=3, pieces=1, gap=4 * GAP_UNIT, from_both=True
    )
    monkeypatch.setattr(linecad.ties.candidates, "find_bundles", lambda _: [counted])
    (found,) = of_kind(candidates_of(setting), "bundle")
    expected = {
        "log-odds": np.log(6.0),
        "of all": 0.75,
        "all log-odds": np.log(8.0),
        "matched": np.log(5),
        "fewest lines": np.log(7),
        "corners": np.log(4),
        "pieces": np.log(2),
        "gap": 2.0,
        "from both": 1.0,
    }
    assert {name: found.features[name] for name in expected} == pytest.approx(expected)


def test_the_planes_at_the_ratio_of_a_bundle_count_by_their_larger_share(row, build_setting, monkeypatch):
    setting = build_setting(row(2))
    shares = [
        (1, 0.0, (0.2, 0.9), 0.9),
        (1, 0.01, (0.5, 0.6), 0.8),
        (0, 0.0, (0.4, 0.3), 0.0),
        (2, 0.0, (0.1, 0.1), 0.0),
        (0, 0.02, (1, 1), 1.0),
    ]
    planes = [SharedPlane((0, 1), ratio, normal, 1.0, share, (5, 5), 0, over) for normal, ratio, share, over in shares]
    monkeypatch.setattr(linecad.ties.candidates, "find_shared_planes", lambda _: planes)
    (bundle,) = of_kind(candidates_of(setting), "bundle")
    assert (bundle.features["plane of it"], bundle.features["plane beside"]) == (0.5, 0.3)
    assert bundle.features["overlap"] == 0.4  # 0.8 of 0.5; not of the plane at another ratio


@pytest.mark.parametrize(("by", "apart"), [(0.4, 0.4), (-0.4, 0.4), (1.7, FARTHEST)])
def test_apart_has_no_sign_and_an_end(row, build_setting, by, apart):
    (bundle,) = of_kind(candidates_of(build_setting(row(2), moved=(0.0, by))), "bundle")
    assert bundle.features["apart"] == pytest.approx(apart)


def test_support_comes_from_the_fits(row, build_setting):
    setting = connected(build_setting(row(2), moved=(0.2,)))
    (bundle,) = of_kind(candidates_of(setting), "bundle")
    assert (bundle.features["supported"], bundle.features["connected"]) == (0.0, 1.0)
    setting.fits.depth[0, setting.lines[0]] -= 0.2  # one of four fits has it as the crossings ask
    (bundle,) = of_kind(candidates_of(replace(setting)), "bundle")
    assert (bundle.features["supported"], bundle.features["connected"]) == (0.25, 1.0)


def test_one_body_has_no_candidates(row, build_setting):
    seen = row(0)
    assert candidates_of(build_setting(seen, body=np.zeros_like(seen.part))) == []


def test_feet_tie_bodies_to_the_ground_which_is_one_more_body(grounded, brick_lane):
    found = of_kind(candidates_of(grounded), "ground")
    first = [next(one for one in found if one.bodies[0] == body) for body in range(2)]
    below = np.log(brick_lane[1])
    assert [one.bodies for one in first] == [(0, 2), (1, 2)]
    # The scale of the ground is the log of the camera's height above it: what a body must grow by, less that.
    assert [one.log_ratio for one in first] == pytest.approx([-below - 0.3, -below + 0.2], abs=0.03)
    assert {one.normal for one in found} == {-1}


def test_ties_to_the_ground_come_first(row, build_setting, monkeypatch):
    setting = build_setting(row(2))
    feet = [Foot(wall.body, 0.5, 0.9, wall, 0.0, 0.0, 0.0) for wall in find_walls(setting)]
    monkeypatch.setattr(linecad.ties.candidates, "find_feet", lambda *_: feet)
    found = candidates_of(setting)
    assert [(one.kind, one.bodies) for one in found] == [("ground", (0, 2)), ("ground", (1, 2)), ("bundle", (0, 1))]


def test_without_pixels_nothing_stands_on_the_ground(grounded):
    blind = replace(grounded, sight=replace(grounded.sight, pixels=None))
    assert of_kind(candidates_of(blind), "ground") == []


def test_one_body_may_stand_on_the_ground(grounded):
    alone = replace(grounded, bodies=replace(grounded.bodies, body=np.zeros_like(grounded.bodies.body), count=1))
    assert {one.bodies for one in candidates_of(alone)} == {(0, 1)}


@pytest.fixture
def features_of_foot(grounded, monkeypatch):
    """The features of the candidate that a foot of the front wall makes, with what is known of it."""

    def features(rank=1, **known):
        wall = next(wall for wall in find_walls(grounded) if wall.body == 0)
        wall = replace(wall, plane=replace(wall.plane, rank=rank, share=0.75))
        usual = {"body": 0, "log_height": 0.5, "probability": 0.5, "others": 0.0, "against": 0.1, "unseen": 0.2}
        foot = Foot(wall=wall, **{**usual, **known})
        monkeypatch.setattr(linecad.ties.candidates, "find_feet", lambda *_: [foot])
        (found,) = of_kind(candidates_of(grounded), "ground")
        assert (found.bodies, found.log_ratio) == ((0, 2), -0.5)
        return found.features

    return features


def test_features_of_a_foot(features_of_foot):
    known = features_of_foot(probability=0.8, others=0.6, against=0.3, unseen=0.05)
    expected = {
        "clear": np.log(4.0),
        "others": 0.6,
        "against": 0.3,
        "unseen": 0.05,
        "share": 0.75,
        "lines of the wall": np.log(14),
        "lines of the body": np.log(14),
        "rank": 1.0,
        "other foot": 0.0,
        "likelier unseen": 0.0,
    }
    assert {name: known[name] for name in expected} == pytest.approx(expected)
    assert known["wide"] == pytest.approx(np.log(3.2 * 3000 / 9.0 / GAP_UNIT + 1), abs=0.05), "the camera is turned"


def test_a_foot_that_is_likelier_hidden_is_worth_less(features_of_foot):
    seen, hidden = features_of_foot(probability=0.4, unseen=0.39), features_of_foot(probability=0.4, unseen=0.41)
    assert (seen["likelier unseen"], hidden["likelier unseen"]) == (0.0, 1.0)
    assert LOG_ODDS["ground"]["likelier unseen"] < 0


@pytest.mark.parametrize(("times", "below"), [(1.01, 0.0), (0.99, 0.0), (0.9, 1.0)])
def test_a_foot_above_the_lower_ends_of_its_wall_is_told(grounded, monkeypatch, times, below):
    wall = next(wall for wall in find_walls(grounded) if wall.body == 0)
    foot = Foot(0, float(np.log(times * reach_below(grounded, wall).max())), 0.5, wall, 0.0, 0.1, 0.2)
    monkeypatch.setattr(linecad.ties.candidates, "find_feet", lambda *_: [foot])
    (found,) = of_kind(candidates_of(grounded), "ground")
    assert found.features["lines below"] == below
    others = log_odds_of(replace(found, features=found.features | {"lines below": 0.0}))
    assert log_odds_of(found) == pytest.approx(others - 0.9711 * below)


@pytest.mark.parametrize(("against", "is_other"), [(0.49, 0.0), (0.51, 1.0)])
def test_a_foot_that_another_is_clearer_than_is_said_to_be_so(features_of_foot, against, is_other):
    assert features_of_foot(against=against)["other foot"] == is_other


@pytest.mark.parametrize(("probability", "clear"), [(0.0, -MOST_LOG_ODDS), (1.0, MOST_LOG_ODDS), (0.5, 0.0)])
def test_no_feature_of_a_foot_runs_away(features_of_foot, probability, clear):
    known = features_of_foot(rank=50, probability=probability, others=7.0)
    assert (known["clear"], known["others"], known["rank"]) == (pytest.approx(clear), 1.0, MOST_RANK)
