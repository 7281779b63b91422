"""Other places of bodies: each is asked for by evidence, and worth what the program says of it."""

from types import SimpleNamespace

import numpy as np
import pytest

from linecad.ties.alternatives import MOST, SAME_PLACE, _clusters, other_places
from linecad.ties.evidence import find_evidence
from linecad.ties.placing import place_bodies
from linecad.ties.weights import above_chance
from solver.bodies.ties import Ties
from solver.options import SolveOptions


@pytest.fixture(scope="module")
def street(build_town, build_row):
    """Two walls of equal heights, the second set back; a course of the first passes before it."""
    first, second = build_row(1, at=(9.5, 12.0), level=True, end=1.7)
    return build_town(first, second[:8] + second[12:], yaw=-0.05)


@pytest.fixture(scope="module")
def places(street):
    return place_bodies(find_evidence(street.graph, street.sight, SolveOptions()), SolveOptions())


@pytest.fixture(scope="module")
def body(places):
    """The body that is not the reference."""
    return 1 - places.evidence.reference


def test_each_is_asked_for_by_what_it_names(places, body):
    found = other_places(places, body)
    assert 0 < len(found) <= MOST
    log_scale = places.placement.log_scale
    for place in found:
        assert place.reasons
        there = np.where(place.moved, log_scale + place.move, log_scale)
        for reason in place.reasons:
            first, second = reason.bodies
            assert there[first] - there[second] == pytest.approx(reason.log_ratio, abs=2 * SAME_PLACE)
            assert above_chance(reason) > 0


def test_each_is_worth_what_the_ties_say(places, body):
    log_scale = places.placement.log_scale
    for place in other_places(places, body):
        there = np.where(place.moved, log_scale + place.move, log_scale)
        assert place.worth == pytest.approx(places.ties.value(there) - places.ties.value(log_scale))


def test_they_are_different_places_and_the_best_comes_first(places, body):
    found = other_places(places, body)
    moves = [place.move for place in found]
    for number, move in enumerate(moves):
        assert abs(move) > SAME_PLACE
        assert all(abs(move - other) > SAME_PLACE for other in moves[:number])
    worth = [place.worth for place in found]
    assert worth == sorted(worth, reverse=True)
    assert worth[0] <= 0, "the program has found the best"


def test_where_walls_would_be_in_one_plane_is_one_of_them(places, body, street):
    """The course that passes before the second wall would meet it there."""
    by = np.log(12.0 / 9.5) * (1 if street.part[places.evidence.setting.lines[body][0]] == 0 else -1)
    kinds = {
        reason.kind
        for place in other_places(places, body)
        if abs(place.move - by) < 2 * SAME_PLACE
        for reason in place.reasons
    }
    assert kinds & {"bundle", "plane"}


def test_the_reference_stays(places):
    assert other_places(places, places.evidence.reference) == []


def test_a_block_that_two_ties_hold_to_the_reference_moves_as_a_whole():
    """Bodies 1 and 2 belong together; each is tied to the reference too, and no single cut parts them from it."""
    ties = Ties(
        np.array([[0, 1], [0, 2], [1, 2]]), np.zeros(3), np.full(3, 0.02), np.array([2.0, 2.0, 9.0]), np.full(3, -1)
    )
    clusters = _clusters(SimpleNamespace(ties=ties, log_scale=np.zeros(3)))
    assert [np.flatnonzero(cluster).tolist() for cluster in clusters] == [[1, 2], [0, 1, 2]]
