"""Bodies whose sides stand on two grounds by their feet: where they are parted, and what ties them no more."""

from dataclasses import replace

import numpy as np
import pytest

from linecad.ties import two_grounds as module
from linecad.ties.bodies import RigidBodies
from linecad.ties.candidates import Candidate
from linecad.ties.looks import Looks
from linecad.ties.pieces import Pieces
from linecad.ties.seams import Seam
from linecad.ties.table import AT_ONCE, LOG_ODDS
from linecad.ties.two_grounds import APART, CLEAR, Parted, clearly_apart, part_by_feet

OUTER, INNER = Seam(np.arange(5), np.arange(5, 8), {}), Seam(np.arange(5, 7), np.array([7]), {})
SURE, LIKELY, UNLIKELY = 3.0, 1.0, -1.0  # log-odds of feet


def foot(piece, log_ratio, log_odds, ground=3):
    rest = {"clear": (log_odds - AT_ONCE["ground"]) / LOG_ODDS["ground"]["clear"]}
    return Candidate("ground", (piece, ground), log_ratio, -1, rest)


@pytest.fixture
def parted(build_town, build_row, build_setting, monkeypatch):
    """The body of each of eight lines, of one body or of two, with three pieces that have such feet."""
    row = build_town(*build_row(3))
    setting = build_setting(row, body=np.zeros(len(row.part), int))

    def part(*feet, body=(0,) * 8):
        monkeypatch.setattr(module, "find_seams", lambda *_: [INNER, OUTER])
        monkeypatch.setattr(module, "find_ground", lambda *_: list(feet))
        bodies = RigidBodies(np.array(body), max(body) + 1)
        return part_by_feet(replace(setting, bodies=bodies), Looks(setting))

    return part


def test_sides_with_clear_feet_at_two_heights_are_two_bodies(parted):
    found = parted(foot(0, 2.5, SURE), foot(1, 2.5 + APART, SURE))
    assert found.bodies.body.tolist() == [0] * 5 + [1] * 3
    assert found.bodies.count == 2
    assert found.at == (OUTER,)


def test_a_side_can_be_parted_again(parted):
    found = parted(foot(0, 2.5, SURE), foot(1, 2.8, SURE), foot(2, 3.1, SURE))
    assert found.bodies.body.tolist() == [0] * 5 + [1] * 2 + [2]
    assert found.at == (OUTER, INNER)


@pytest.mark.parametrize(
    "feet",
    [
        [],
        [foot(0, 2.5, SURE)],
        [foot(0, 2.5, SURE), foot(1, 2.5 + 0.9 * APART, SURE)],
        [foot(0, 2.5, UNLIKELY), foot(1, 2.8, SURE)],
        [foot(0, 2.5, SURE), foot(1, 2.8, SURE), foot(1, 2.51, SURE)],
    ],
    ids=["none", "of one side", "a kerb apart", "an unlikely one", "others agree"],
)
def test_a_body_stays_one_where_feet_are_not_clearly_apart(parted, feet):
    found = parted(*feet)
    assert found.bodies.body.tolist() == [0] * 8
    assert found.at == ()


def test_what_is_clear_is_the_square_of_both_chances():
    chance = np.sqrt(0.5)
    one, apart = np.array([[0.0, 2.5, chance]]), np.array([[1.0, 2.8, chance]])
    assert clearly_apart(one, apart) == pytest.approx(0.25)
    assert clearly_apart(one, np.vstack([apart, [1.0, 2.5, 0.4]])) == pytest.approx(0.25 - 0.08)
    assert clearly_apart(one, one) == pytest.approx(-0.25)
    assert clearly_apart(one[:0], one) == 0.0
    assert CLEAR < 0.25


def joint(kind, bodies):
    return Candidate(kind, bodies, 0.0, -1, {})


def test_what_seems_to_join_both_sides_ties_them_no_more():
    body = np.array([1, 1, 1, 2, 2, 3, 3, 0])
    sides = Parted(RigidBodies(body, 4), (OUTER,))  # bodies 1 and 2 are of the larger side, 3 and 0 of the other
    kept = [joint("bundle", (1, 2)), joint("level", (1, 3)), joint("ground", (1, 4)), joint("bundle", (0, 3))]
    gone = [joint("bundle", (1, 3)), joint("plane", (2, 3)), joint("bundle", (0, 1))]
    assert sides.keep_apart([*kept, *gone], body) == kept
    pieces = Pieces(body, np.arange(4), [*kept, *gone])
    assert sides.keep_pieces_apart(pieces).candidates == kept
    assert Parted(RigidBodies(body, 4), ()).keep_apart([*kept, *gone], body) == [*kept, *gone]
