"""Pieces: bodies parted at their seams, whether the local search leaves these where they stand, and their feet."""

from dataclasses import replace

import numpy as np
import pytest

from linecad.ties import pieces as module
from linecad.ties.bodies import RigidBodies
from linecad.ties.candidates import Candidate
from linecad.ties.looks import Looks
from linecad.ties.pieces import Pieces, find_pieces, part_bodies, ties_between_bodies, with_pieces_heard
from linecad.ties.seams import Seam, find_seams
from linecad.ties.table import AT_ONCE, LOG_ODDS
from linecad.ties.weights import CHANCE, weigh_candidates
from solver.bodies.ties import Ties

NESTED = [Seam(np.arange(5), np.arange(5, 8), {}), Seam(np.arange(5, 7), np.array([7]), {})]


@pytest.fixture(scope="module")
def one_body(build_town, build_row, build_setting):
    row = build_town(*build_row(3))
    return build_setting(row, body=np.zeros(len(row.part), int))


def test_seams_part_bodies_and_leave_other_bodies_whole():
    piece, body = part_bodies(RigidBodies(np.array([0, 0, 0, 0, 0, 0, 0, 0, -1, 1, 1]), 2), NESTED)
    assert body.tolist() == [0, 0, 0, 1]
    groups = [set(np.flatnonzero(piece == number).tolist()) for number in range(4)]
    assert groups == [set(range(5)), {5, 6}, {7}, {9, 10}]
    assert piece[8] == -1


def test_without_seams_pieces_are_the_bodies():
    bodies = RigidBodies(np.array([1, 0, -1, 1]), 2)
    piece, body = part_bodies(bodies, [])
    assert piece.tolist() == bodies.body.tolist()
    assert body.tolist() == [0, 1]


def test_no_bodies_have_no_pieces():
    piece, body = part_bodies(RigidBodies(np.full(3, -1), 0), [])
    assert piece.tolist() == [-1, -1, -1]
    assert body.tolist() == []


def test_what_ties_the_sides_of_a_seam_is_found_at_the_ratio_that_they_have(one_body):
    seams = find_seams(one_body, Looks(one_body))
    found = find_pieces(one_body, seams, Looks(one_body))
    assert found.size.sum() == len(one_body.log_depth)
    assert found.of(seams[0].larger).tolist() != found.of(seams[0].smaller).tolist()
    bundles = [each for each in found.candidates if each.kind == "bundle"]
    assert bundles
    assert min(abs(each.log_ratio) for each in bundles) < 1e-6


TWO = np.array([0, 1, 0, 2])  # the bodies of pieces 0 to 2, and the ground


def between(*rows, piece=(0, 1, 2)):
    """What ties bodies 0 and 1 where pieces of 40 lines have such candidates: (pieces, log ratio, log-odds) each."""
    told = [Candidate("bundle", pieces, ratio, -1, worth_features(log_odds)) for pieces, ratio, log_odds in rows]
    return ties_between_bodies(Pieces(np.repeat(piece, 40), TWO[:-1], told), 2)


def worth_features(log_odds):
    name = max(LOG_ODDS["bundle"], key=lambda one: abs(LOG_ODDS["bundle"][one]))
    return {name: (log_odds - AT_ONCE["bundle"]) / LOG_ODDS["bundle"][name]}


def test_what_ties_pieces_ties_their_bodies_at_the_same_ratio():
    ties, told = between(((0, 1), 0.3, 2.0), ((1, 2), 0.2, 3.0), ((2, 3), -0.1, 4.0))
    assert ties.bodies.tolist() == [[0, 2], [0, 1], [0, 1]]
    assert ties.log_ratio.tolist() == [-0.1, -0.2, 0.3]
    assert ties.weight.tolist() == pytest.approx([4.0 - CHANCE, 3.0 - CHANCE, 2.0 - CHANCE])
    assert [(each.bodies, each.log_ratio) for each in told] == [((0, 2), -0.1), ((0, 1), -0.2), ((0, 1), 0.3)]


def test_what_ties_pieces_of_one_body_ties_no_bodies():
    ties, told = between(((0, 2), 0.0, 5.0))
    assert len(ties) == len(told) == 0
    assert len(between()[0]) == 0


def test_a_body_without_pieces_is_not_the_ground():
    told = [Candidate("bundle", (0, 1), 0.3, -1, worth_features(2.0))]
    ties, _ = ties_between_bodies(Pieces(np.zeros(40, int), np.array([0]), told), 2)
    assert ties.bodies.tolist() == [[0, 2]]


def test_of_pieces_that_ask_for_one_ratio_the_heaviest_tells():
    ties, told = between(((0, 1), 0.300, 2.0), ((1, 2), -0.305, 3.0))
    assert ties.log_ratio.tolist() == [0.305]
    assert ties.weight.tolist() == pytest.approx([3.0 - CHANCE])
    assert len(told) == 1


def test_without_seams_pieces_see_what_bodies_see(one_body):
    parted = replace(one_body, bodies=RigidBodies(np.arange(len(one_body.log_depth)) % 2, 2))
    found = find_pieces(parted, [], Looks(parted))
    ties, _ = ties_between_bodies(found, 2)
    wholes = weigh_candidates(found.candidates, parted.bodies.size)
    assert len(ties) > 0
    assert sorted(ties.log_ratio.tolist()) == sorted(wholes.log_ratio.tolist())


def stays(ties, monkeypatch):
    """Of the outer and the inner seam of NESTED, with these ties between pieces of one body and the ground."""
    piece, body = part_bodies(RigidBodies(np.zeros(8, int), 1), NESTED)
    monkeypatch.setattr(module, "weigh_candidates", lambda *_: ties)
    found = with_pieces_heard(NESTED, Pieces(piece, body, []), np.array([0.3, -0.2]))
    assert [list(seam.features) for seam in found] == [["stays", "one ground"]] * 2
    return [seam.features["stays"] for seam in found]


def ties(*rows):
    """Of (first, second, log ratio, weight) each."""
    count = len(rows)
    first, second, ratio, weight = np.array(rows, float).reshape(-1, 4).T
    bodies = np.column_stack([first, second]).astype(int)
    return Ties(bodies, ratio, np.full(count, 0.02), weight, np.full(count, -1))


def test_sides_stay_where_all_ties_hold(monkeypatch):
    assert stays(ties((0, 1, 0.0, 5.0), (1, 2, 0.0, 5.0)), monkeypatch) == [1.0, 1.0]
    assert stays(ties(), monkeypatch) == [1.0, 1.0]


def test_a_side_that_the_ground_calls_elsewhere_does_not_stay(monkeypatch):
    """The ground lies 0.5 below the first piece, and 0.7 below the last by its own feet."""
    last = ((0, 1, 0.0, 5.0), (1, 2, 0.0, 3.0), (0, 3, 0.5, 4.0), (1, 3, 0.5, 4.0))
    assert stays(ties(*last, (2, 3, 0.7, 2.0)), monkeypatch) == [1.0, 1.0]
    outer, inner = stays(ties(*last, (2, 3, 0.7, 4.0)), monkeypatch)
    assert inner == 0.0
    assert outer == pytest.approx(2 / 3), "of the three lines of the smaller side two stay"


def test_the_seams_of_a_setting_stay_as_they_are_in_a_sound_body(one_body):
    seams = find_seams(one_body, Looks(one_body))
    found = with_pieces_heard(seams, find_pieces(one_body, seams, Looks(one_body)), np.zeros(2))
    assert [seam.features["stays"] for seam in found] == [1.0] * len(seams)
    assert [replace(seam, features={}).larger.tolist() for seam in found] == [seam.larger.tolist() for seam in seams]


def foot(piece, log_ratio, clear):
    """Of a piece; the ground is piece 3."""
    known = dict.fromkeys(LOG_ODDS["ground"], 0.0) | {"clear": clear}
    return Candidate("ground", (piece, 3), log_ratio, -1, known)


def grounds(*candidates):
    """Of the outer seam of NESTED, of piece 0 before 1 and 2, and of the inner, of 1 before 2."""
    piece, body = part_bodies(RigidBodies(np.zeros(8, int), 1), NESTED)
    found = with_pieces_heard(NESTED, Pieces(piece, body, list(candidates)), np.zeros(2))
    return [seam.features["one ground"] for seam in found]


def chance(clear):
    return 1 / (1 + np.exp(-AT_ONCE["ground"] - LOG_ODDS["ground"]["clear"] * clear))


BOTH = (chance(3.0) * chance(2.0)) ** 2


def test_feet_at_one_height_are_on_one_ground():
    assert grounds(foot(0, 0.5, 3.0), foot(2, 0.51, 2.0)) == [pytest.approx(BOTH), 0.0]


@pytest.mark.parametrize("height", [0.4, 0.546, 0.6])
def test_feet_at_two_heights_are_on_two_grounds(height):
    assert grounds(foot(1, 0.5, 3.0), foot(2, height, 2.0)) == [0.0, pytest.approx(-BOTH)]


def test_of_several_feet_the_clearest_two_of_either_kind_tell():
    [found, _] = grounds(foot(0, 0.5, 3.0), foot(0, 0.9, 1.0), foot(1, 0.5, -1.0), foot(2, 0.9, 2.0))
    assert found == pytest.approx((chance(1.0) * chance(2.0)) ** 2 - BOTH)


@pytest.mark.parametrize("height", [0.531, 0.544])
def test_between_one_ground_and_two_feet_tell_nothing(height):
    assert grounds(foot(0, 0.5, 3.0), foot(1, height, 3.0)) == [0.0, 0.0]


def test_without_feet_on_both_sides_there_is_nothing_to_tell():
    level = Candidate("level", (0, 1), 0.5, -1, dict.fromkeys(LOG_ODDS["level"], 9.0))
    assert grounds() == [0.0, 0.0]
    assert grounds(foot(0, 0.5, 3.0), foot(0, 0.9, 3.0), level) == [0.0, 0.0]
