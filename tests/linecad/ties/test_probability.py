"""How sure the place of each line is: from 0 to 1, 0 for lines of no body, less where seams and links may fail."""

from dataclasses import replace

import numpy as np
import pytest

from linecad.ties import links, seams
from linecad.ties.bodies import RigidBodies
from linecad.ties.links import Link
from linecad.ties.pieces import Pieces
from linecad.ties.probability import AT_ONCE, LEAST_PIECES, LOG_ODDS, chances, line_features, main_lines, probabilities
from linecad.ties.seams import Seam

NO_BODY = 3  # the first lines of the second wall
WITHIN = 0.04  # of a share of the draws


@pytest.fixture
def placed(build_town, build_row, build_setting):
    """Two walls in their places, but for a few lines of the second that are of no body."""
    seen = build_town(*build_row(2))
    body = seen.part.copy()
    body[24 : 24 + NO_BODY] = -1
    return build_setting(seen, body=body)


def pieces_of(setting):
    body = setting.bodies.body
    return Pieces(body, np.arange(body.max() + 1), [])


def sure(setting, depth=None, chance=(1.0, 1.0)):
    depth = setting.log_depth if depth is None else depth
    return probabilities(setting, depth, pieces_of(setting), np.array(chance))


def test_every_feature_has_log_odds(placed):
    assert list(line_features(placed, placed.log_depth, pieces_of(placed))) == list(LOG_ODDS)


def test_a_line_is_as_sure_as_its_piece_and_as_it_is_there(placed):
    known = line_features(placed, placed.log_depth, pieces_of(placed))
    log_odds = AT_ONCE + sum(LOG_ODDS[name] * value for name, value in known.items())
    body = placed.bodies.body
    expected = np.where(body == 0, 0.3, 0.9) / (1 + np.exp(-log_odds))
    np.testing.assert_allclose(sure(placed, chance=(0.3, 0.9))[body >= 0], expected[body >= 0])


def test_lines_of_a_photo_with_more_pieces_are_surer(placed):
    few = pieces_of(placed)
    some, many = (replace(few, body=np.append(few.body, [1] * more)) for more in (LEAST_PIECES - 2, LEAST_PIECES))
    known = [line_features(placed, placed.log_depth, pieces)["pieces"] for pieces in (few, some, many)]
    assert [set(each.tolist()) for each in known] == [{np.log1p(LEAST_PIECES + more)} for more in (0, 0, 2)]
    sure_of = [
        probabilities(placed, placed.log_depth, pieces, np.ones(pieces.count))[placed.bodies.body >= 0]
        for pieces in (few, some, many)
    ]
    assert (sure_of[0] == sure_of[1]).all()
    assert (sure_of[2] > sure_of[1]).all()
    assert sure_of[0].max() > 0.9  # however few there are


def test_lines_of_no_body_are_sure_of_nothing(placed):
    alone = placed.bodies.body < 0
    assert alone.sum() == NO_BODY
    assert (sure(placed)[alone] == 0).all()
    assert (sure(placed)[~alone] > 0.5).all()


def test_a_photo_without_bodies_has_no_sure_line(placed):
    none = replace(placed, bodies=RigidBodies(np.full(len(placed.bodies.body), -1), 0))
    pieces = Pieces(none.bodies.body, np.zeros(0, int), [])
    chance = chances(pieces, [], [], np.zeros(len(none.log_depth)))
    assert probabilities(none, none.log_depth, pieces, chance).tolist() == [0.0] * len(placed.log_depth)


def test_lines_that_crossings_contradict_are_less_sure(placed):
    graph = placed.graph
    depth = placed.log_depth.copy()
    line = 15  # a course that reaches the second wall
    depth[line] += 0.02  # beyond what a crossing may be off
    pieces = pieces_of(placed)
    known, before = line_features(placed, depth, pieces), line_features(placed, placed.log_depth, pieces)
    assert known["agreement"][line] < 0.5 < before["agreement"][line]
    assert sure(placed, depth)[line] < sure(placed)[line] - 0.05
    silent = replace(placed, graph=replace(graph, informative=np.zeros(len(graph.edges), bool)))
    assert line_features(silent, depth, pieces)["agreement"][line] == 0.5


def test_lines_that_leave_their_body_in_the_fits_are_less_sure(placed):
    before = sure(placed)
    placed.fits.depth[:2, 5] += 1.0
    after = sure(placed)
    assert line_features(placed, placed.log_depth, pieces_of(placed))["together"][5] == 0.5
    assert after[5] < before[5]
    assert np.delete(after, 5).tolist() == np.delete(before, 5).tolist()


def test_lines_move_relative_to_the_fit_to_all(placed):
    depth = np.linspace(0.0, 3.0, len(placed.bodies.body))
    fits = replace(placed.fits, depth=np.tile(depth, (len(placed.fits.depth), 1)))
    together = line_features(replace(placed, log_depth=depth, fits=fits), depth, pieces_of(placed))["together"]
    assert (together[placed.bodies.body >= 0] == 1).all()


def test_the_main_lines_are_those_that_most_of_the_photo_shows(placed):
    graph = placed.graph
    inside = placed.bodies.body[graph.edges]
    first = (inside == 0).all(axis=1)
    main = main_lines(placed, first)
    assert main.any()
    assert (placed.bodies.body[main] == 0).all()
    assert not main_lines(placed, np.zeros(len(graph.edges), bool))[placed.bodies.body < 0].any()


# Pieces of three bodies: the reference in two halves, two more that hang on its second half.
PIECES = Pieces(np.repeat(np.arange(4), 10), np.array([0, 0, 1, 2]), [])


@pytest.fixture
def stated(monkeypatch):
    """Seams and links that say themselves how likely they hold."""
    for module in (seams, links):
        monkeypatch.setattr(module, "AT_ONCE", 0.0)
        monkeypatch.setattr(module, "LOG_ODDS", {"stated": 1.0})

    def odds(probability):
        return {"stated": float(np.log(max(probability, 1e-12)) - np.log(max(1 - probability, 1e-12)))}

    def chance(seam, first, second, length=(10.0, 9.0, 0.0, 0.0)):
        halves = Seam(np.arange(10), np.arange(10, 20), odds(seam))
        hung = [Link(1, 0, 2, 1, odds(first)), Link(2, 1, 3, 2, odds(second))]
        return chances(PIECES, [halves], hung, np.repeat(length, 10))

    return chance


def test_what_holds_is_right(stated):
    assert stated(1.0, 1.0, 1.0).tolist() == [1.0] * 4


def test_chances_multiply_along_the_links(stated):
    assert stated(1.0, 0.8, 0.5) == pytest.approx([1.0, 1.0, 0.8, 0.4], abs=WITHIN)


def test_bodies_stand_wrong_with_the_half_that_they_hang_on(stated):
    assert stated(0.6, 1.0, 1.0) == pytest.approx([1.0, 0.6, 0.6, 0.6], abs=WITHIN)


def test_the_scale_is_that_of_most_of_component_0(stated):
    """Where the other half and what hangs on it are most of the photo, the reference's first half is in doubt."""
    assert stated(0.6, 1.0, 1.0, (10.0, 9.0, 5.0, 5.0)) == pytest.approx([0.6, 1.0, 1.0, 1.0], abs=WITHIN)


def test_chances_are_the_same_each_time(stated):
    assert stated(0.7, 0.8, 0.5).tobytes() == stated(0.7, 0.8, 0.5).tobytes()
