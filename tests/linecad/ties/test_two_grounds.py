"""Bodies whose sides stand on two grounds by their feet: where they are parted, and what ties them no more."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from linecad.ties import two_grounds as module
from linecad.ties.bodies import RigidBodies
from linecad.ties.candidates import Candidate
from linecad.ties.looks import Looks
from linecad.ties.pieces import Pieces
from linecad.ties.seams import LOG_ODDS as SEAM
from linecad.ties.seams import Seam
from linecad.ties.table import AT_ONCE, LOG_ODDS
from linecad.ties.two_grounds import APART, CLEAR, MOST_SURE, Parted, clearly_apart, part_by_feet, without_feet

DOUBTFUL = dict.fromkeys(SEAM, 0.0)
OUTER, INNER = Seam(np.arange(5), np.arange(5, 8), DOUBTFUL), Seam(np.arange(5, 7), np.array([7]), DOUBTFUL)
SURE, LIKELY, UNLIKELY = 3.0, 1.0, -1.0  # log-odds of feet


def foot(piece, log_ratio, log_odds, ground=3):
    rest = {"clear": (log_odds - AT_ONCE["ground"]) / LOG_ODDS["ground"]["clear"]}
    return Candidate("ground", (piece, ground), log_ratio, -1, rest)


@pytest.fixture
def parted(build_town, build_row, build_setting, monkeypatch):
    """The body of each of eight lines, of one body or of two, with three pieces that have such feet."""
    row = build_town(*build_row(3))
    setting = build_setting(row, body=np.zeros(len(row.part), int))

    def part(*feet, seams=(OUTER, INNER), real=(), edges=(), kind="T"):
        monkeypatch.setattr(module, "find_seams", lambda *_: list(seams))
        monkeypatch.setattr(module, "find_ground", lambda *_: list(feet))
        joined = SimpleNamespace(edges=np.array(edges, int).reshape(-1, 2), weight=np.ones(len(edges)))
        joined.kind = np.full(len(edges), kind)
        monkeypatch.setattr(module, "agreeing", lambda *_: np.ones(len(edges), bool))
        whole = replace(setting, graph=joined, log_depth=np.zeros(8), bodies=RigidBodies(np.zeros(8, int), 1))
        return part_by_feet(whole, Looks(setting), np.array(real, int).reshape(-1, 2))

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


def test_other_lines_go_with_the_side_that_crossings_tie_them_to(parted):
    """The larger side of the outer seam is parted; its smaller side hangs on the part that got another number."""
    outer, inner = Seam(np.arange(6), np.array([6, 7]), DOUBTFUL), Seam(np.arange(3), np.arange(3, 6), DOUBTFUL)
    feet = (foot(0, 2.5, SURE), foot(1, 2.8, SURE))
    found = parted(*feet, seams=(outer, inner), edges=[(5, 6), (6, 7)])
    assert found.bodies.body.tolist() == [0, 0, 0, 1, 1, 1, 1, 1]
    assert parted(*feet, seams=(outer, inner), edges=[(2, 6), (6, 7)]).bodies.body.tolist() == [0, 0, 0, 1, 1, 1, 0, 0]


def test_other_lines_do_not_go_with_what_was_parted_off_before(parted):
    """Line 2 seems to meet the smaller side of the outer seam too, which stands elsewhere."""
    inner = Seam(np.arange(2), np.arange(3, 5), DOUBTFUL)
    feet = [foot(piece, height, SURE, 4) for piece, height in ((1, 2.5), (2, 2.8), (3, 3.1))]
    found = parted(*feet, seams=(OUTER, inner), edges=[(2, 6), (2, 7), (2, 4)])
    assert found.at == (OUTER, inner)
    assert found.bodies.body.tolist() == [0, 0, 2, 2, 2, 1, 1, 1]


def test_a_crossing_called_real_holds_both_sides(parted):
    feet = (foot(0, 2.5, SURE), foot(1, 2.8, SURE))
    assert parted(*feet, real=[(2, 6)]).bodies.count == 1
    assert parted(*feet, real=[(2, 4), (6, 7)]).bodies.count == 2


@pytest.mark.parametrize(
    ("edges", "count"),
    [([(0, 6), (1, 7)], 1), ([(0, 6), (1, 6), (2, 6)], 2), ([(6, 0), (6, 1), (7, 1)], 1), ([(0, 1), (6, 7)], 2)],
    ids=["two and two", "a post before a wall", "either way round", "within the sides"],
)
def test_sides_whose_lines_pass_through_each_other_are_one_wall(parted, edges, count):
    feet = (foot(0, 2.5, SURE), foot(1, 2.8, SURE))
    assert parted(*feet, edges=edges, kind="X").bodies.count == count
    assert parted(*feet, edges=edges).bodies.count == 2  # lines that end at others may lie behind them


def test_feet_part_no_seam_that_all_else_holds(parted):
    sound = Seam(np.arange(5), np.arange(5, 8), DOUBTFUL | {"supported": 1.0, "plane beside": 1.0, "shade": 2.0})
    assert without_feet(sound) > MOST_SURE
    assert parted(foot(0, 2.5, SURE), foot(1, 2.8, SURE), seams=[sound]).bodies.count == 1


def test_what_is_clear_is_the_square_of_both_chances():
    chance = np.sqrt(0.5)
    one, apart = np.array([[0.0, 2.5, chance]]), np.array([[1.0, 2.8, chance]])
    assert clearly_apart(one, apart) == pytest.approx(0.25)
    assert clearly_apart(one, np.vstack([apart, [1.0, 2.5, 0.4]])) == pytest.approx(0.25 - 0.08)
    assert clearly_apart(one, one) == pytest.approx(-0.25)
    assert clearly_apart(one[:0], one) == 0.0
    assert CLEAR < 0.25


def joint(kind, bodies, log_ratio=0.0):
    return Candidate(kind, bodies, log_ratio, -1, {})


def test_what_seems_to_join_both_sides_ties_them_no_more():
    body = np.array([1, 1, 1, 2, 2, 3, 3, 0])
    sides = Parted(RigidBodies(body, 4), (OUTER,))  # bodies 1 and 2 are of the larger side, 3 and 0 of the other
    kept = [joint("bundle", (1, 2)), joint("level", (1, 3)), joint("ground", (1, 4)), joint("bundle", (0, 3))]
    kept += [joint("bundle", (1, 3), 0.15), joint("plane", (2, 3), -0.1)]
    gone = [joint("bundle", (1, 3)), joint("plane", (2, 3)), joint("bundle", (0, 1))]
    assert sides.keep_apart([*kept, *gone], body) == kept
    pieces = Pieces(body, np.arange(4), [*kept, *gone])
    assert sides.keep_pieces_apart(pieces).candidates == kept
    assert Parted(RigidBodies(body, 4), ()).keep_apart([*kept, *gone], body) == [*kept, *gone]


def test_seams_are_looked_for_anew_where_bodies_or_crossings_are_others(parted, monkeypatch):
    found = parted()
    whole = found.whole
    others = replace(whole, bodies=RigidBodies(np.arange(8), 8))
    whole.graph.informative = np.ones(0, bool)
    monkeypatch.setattr(module, "find_seams", lambda *_: [INNER])
    assert found.seams_of(whole, None) == [OUTER, INNER]
    assert found.seams_of(others, None) == [INNER]
    fewer = replace(whole, graph=SimpleNamespace(informative=np.zeros(1, bool)))
    assert found.seams_of(fewer, None) == [INNER]
