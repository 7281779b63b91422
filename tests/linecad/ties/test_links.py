"""Links: every body hangs on another, outwards from the reference, by what ties it best."""

import numpy as np
import pytest

from linecad.ties import links as module
from linecad.ties.candidates import Candidate
from linecad.ties.depth_ties import MapPlaces
from linecad.ties.links import LARGEST_MARGIN, LOG_ODDS, WITH_MAP_LOG_ODDS, Link, find_links
from linecad.ties.pieces import Pieces

BODY = np.array([0, 0, 1, 2])  # of four pieces; the ground is the fifth
SIZE = (20, 15, 30, 3)


@pytest.fixture(autouse=True)
def _weights(monkeypatch):
    monkeypatch.setattr(module, "above_chance", lambda candidate: candidate.features["weight"])


def pieces(*candidates):
    return Pieces(np.repeat(np.arange(4), SIZE), BODY, list(candidates))


def tie(first, second, weight, log_ratio=0.0, kind="bundle"):
    return Candidate(kind, (first, second), log_ratio, -1, {"weight": weight})


def links(*candidates, scale=(0.0, 0.0, 0.0, 0.0), margin=(9.0, 4.0, 1.0), reference=0, mapped=None):
    return find_links(pieces(*candidates), np.array(scale), np.array(margin), reference, mapped)


def test_bodies_hang_on_what_ties_them_best():
    found = links(tie(1, 2, 5.0), tie(2, 3, 4.0), tie(0, 3, 2.0))
    assert [(link.body, link.to, link.piece, link.other) for link in found] == [(1, 0, 2, 1), (2, 1, 3, 2)]
    assert all(list(link.features) == list(LOG_ODDS) for link in found)


def test_links_start_at_the_reference():
    found = links(tie(1, 2, 5.0), tie(2, 3, 4.0), reference=2)
    assert [(link.body, link.to) for link in found] == [(1, 2), (0, 1)]


def test_a_candidate_of_other_places_ties_nothing():
    found = links(tie(1, 2, 5.0, log_ratio=0.1))
    assert [(link.body, link.to, link.features["weight"]) for link in found] == [(1, 0, 0.0), (2, 0, 0.0)]
    there = links(tie(1, 2, 5.0, log_ratio=0.1), scale=(0.0, -0.1, 0.0, 0.0))
    assert there[0].features["weight"] == pytest.approx(np.log1p(5.0))


def test_what_nothing_ties_hangs_on_the_reference():
    found = links()
    assert [(link.body, link.to, link.piece, link.other) for link in found] == [(1, 0, 2, 0), (2, 0, 3, 0)]
    for name in ("weight", "weight of all", "kinds", "weakest", "by a bundle", "by the ground"):
        assert found[0].features[name] == 0.0, name


def test_features_of_a_link():
    found = links(tie(1, 2, 5.0), tie(0, 2, 3.0, kind="plane"), tie(2, 3, 4.0), margin=(9.0, 400.0, 1.0))
    first, second = (link.features for link in found)
    assert first["margin"] == LARGEST_MARGIN
    assert first["root of margin"] == pytest.approx(np.sqrt(LARGEST_MARGIN))
    assert first["lines of the body"] == pytest.approx(np.log(30))
    assert (first["lines of the piece"], first["lines of the other"]) == pytest.approx((np.log(30), np.log(15)))
    assert first["weight"] == pytest.approx(np.log1p(8.0)), "the best of each kind"
    assert first["kinds"] == 2.0
    assert (first["by a bundle"], first["by the ground"]) == (1.0, 0.0)
    assert second["weight"] == pytest.approx(np.log1p(4.0 * 3 / 15)), "three lines are no wall"
    assert second["weakest"] == pytest.approx(np.log1p(0.8))
    assert second["bodies"] == pytest.approx(np.log(4))


def test_two_feet_on_one_ground_tie_their_bodies():
    feet = tie(0, 4, 3.0, -0.5, "ground"), tie(2, 4, 2.0, -0.51, "ground")
    found = links(*feet)[0]
    assert (found.to, found.features["by the ground"]) == (0, 1.0)
    assert found.features["weight"] == pytest.approx(np.log1p(2.0))
    apart = links(feet[0], tie(2, 4, 2.0, -0.6, "ground"))[0]
    assert apart.features["weight"] == 0.0


def test_a_map_tells_of_the_bodies_that_it_shows():
    mapped = MapPlaces(np.zeros(3), 0.0, 0.0, np.zeros(3, bool), np.array([0.0, -0.03, np.nan]), 0.02, 3.0)
    found = links(tie(1, 2, 5.0), mapped=mapped)
    assert all(list(link.features) == list(WITH_MAP_LOG_ODDS) for link in found)
    assert (found[0].features["map's word"], found[0].features["off the map"]) == pytest.approx((3.0, 1.5))
    assert (found[1].features["map's word"], found[1].features["off the map"]) == (0.0, 0.0)


def test_probability_is_the_logistic_of_the_features(monkeypatch):
    monkeypatch.setattr(module, "LOG_ODDS", {"margin": 2.0})
    monkeypatch.setattr(module, "AT_ONCE", -1.0)
    monkeypatch.setattr(module, "WITH_MAP_LOG_ODDS", {"margin": 2.0, "off the map": -3.0})
    monkeypatch.setattr(module, "WITH_MAP_AT_ONCE", 0.0)
    assert Link(1, 0, 2, 0, {"margin": 0.5}).probability == pytest.approx(0.5)
    assert Link(1, 0, 2, 0, {"margin": 1.5, "off the map": 1.0}).probability == pytest.approx(0.5)


def test_evidence_makes_a_link_surer():
    """What the table says on the whole: no evidence at all is worth less than much."""
    none, much = links()[0], links(tie(1, 2, 9.0), tie(0, 2, 9.0, kind="plane"), margin=(9.0, 15.0, 1.0))[0]
    assert much.probability > none.probability + 0.2


def test_a_photo_without_bodies_has_no_links():
    assert find_links(Pieces(np.full(3, -1), np.zeros(0, int), []), np.zeros(1), np.zeros(1), 0) == []
