"""What is said of bodies, applied to found lines: it goes with the lines that it names."""

import numpy as np
import pytest

from linecad.corrections.annotations import facts_of
from linecad.corrections.corrected import ToldFact
from linecad.corrections.edits import (
    Cut,
    Delete,
    Foot,
    Join,
    Meet,
    OnePlane,
    PlaceAt,
    SetFrame,
    Split,
    WallByEdges,
    Withdraw,
)
from linecad.corrections.words import said
from linecad.graph.build import build_line_graph


@pytest.fixture
def meet(anchor):
    return Meet((anchor(0), anchor(5)))


def notes(applied, *edits):
    lines = applied(*edits)
    return lines.facts, lines.notes


def test_facts_name_lines_by_their_ids(applied, anchor, meet):
    place = PlaceAt(anchor(2), anchor(7), 0.25)
    foot = Foot(anchor(1), (40.0, 50.0))
    assert applied(meet, place, foot).facts == (ToldFact(meet, (0, 5)), ToldFact(place, (2, 7)), ToldFact(foot, (1,)))


def test_lines_of_a_part_go_with_it_and_those_that_are_gone_are_left_out(applied, anchor):
    part = (anchor(2), anchor(3), anchor(4))
    place = PlaceAt(anchor(2), anchor(7), 0.25, part)
    assert applied(place).facts == (ToldFact(place, (2, 7), part=(2, 3, 4)),)
    lines = applied(Delete(anchor(3)), place)
    assert (lines.facts, lines.notes) == ((ToldFact(place, (2, 7), part=(2, 4)),), ())
    assert applied(place, Delete(anchor(4))).facts == (ToldFact(place, (2, 7), part=(2, 3)),)
    assert (lines.parts, lines.cuts) == ({part}, frozenset())
    assert applied(place).differs_at_once(applied())
    assert not applied(place).differs_in_places(applied()), "which lines are one body depends on it"
    assert said(place).startswith("a part of it stands here at (")


def test_what_is_taken_back_is_not_said_any_more(applied, anchor, meet):
    other = Cut((anchor(2), anchor(7)))
    facts, noted = notes(applied, meet, other, Withdraw(meet))
    assert (facts, noted) == ((ToldFact(other, (2, 7)),), ())
    assert notes(applied, meet, Withdraw(meet), meet)[0] == (ToldFact(meet, (0, 5)),), "and may be said again"


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda anchor: (Withdraw(Cut((anchor(0), anchor(5)))),), "was not said"),
        (lambda anchor: (Cut((anchor(0), anchor(5))), Cut((anchor(0), anchor(5)))), "said already"),
        (lambda anchor: (OnePlane((anchor(4), anchor(4)), 2),), "takes two lines"),
        (lambda anchor: (Delete(anchor(0)), Meet((anchor(0), anchor(5)))), "any more"),
    ],
)
def test_what_says_nothing_is_a_note(applied, anchor, make, message):
    facts, noted = notes(applied, *make(anchor))
    assert len(noted) == 1
    assert message in noted[0]
    assert len(facts) <= 1


def test_a_fact_goes_with_the_piece_that_is_nearest(made, applied, anchor, meet):
    """A line that is split is named by its middle; that of the shorter cut lies in the larger piece."""
    ends, count = made.pixels[0], len(made.axis)
    for share, piece in ((0.3, count + 1), (0.7, count)):
        at = tuple((ends[0] + share * (ends[1] - ends[0])).tolist())
        assert applied(meet, Split(anchor(0), at)).facts == (ToldFact(meet, (piece, 5)),)


def test_a_fact_goes_with_a_joined_line_and_not_with_a_deleted_one(made, applied, anchor, meet):
    point, whole = tuple(made.pixels[0].mean(axis=0).tolist()), anchor(0)
    first = type(whole)((whole.ends[0], point), whole.axis)
    second = type(whole)((point, whole.ends[1]), whole.axis)
    count = len(made.axis)
    lines = applied(Split(whole, point), Meet((first, anchor(5))), Join((first, second)))
    assert [told.lines for told in lines.facts] == [(count + 2, 5)]
    lines = applied(Split(whole, point), Meet((first, second)), Join((first, second)))
    assert lines.facts == (), "of a line and itself nothing is said"
    assert applied(meet, Delete(anchor(5))).facts == ()


def test_what_was_said_with_another_frame_is_left_out(made, applied, anchor, meet):
    drawn = SetFrame(tuple(anchor(int(np.flatnonzero(made.axis == axis)[k])) for axis in range(3) for k in range(2)))
    facts, noted = notes(applied, meet, drawn)
    assert facts == ()
    assert "along other axes" in noted[0]


def test_the_graph_has_them_by_its_nodes(made, applied, anchor, meet):
    lines = applied(meet, Cut((anchor(2), anchor(7))))
    graph = build_line_graph(lines.segments, made.camera, made.frame)
    facts, noted = facts_of(graph, lines)
    assert [told.lines for told in facts] == [(0, 5), (2, 7)]
    assert noted == ()
    without = graph.subset(np.array([number for number in range(len(graph.segments)) if number != 5]))
    facts, noted = facts_of(without, lines)
    assert [told.lines for told in facts] == [(2, 6)]
    assert "1 of 2 things that were said of bodies are left out" in noted[0]


def test_lines_that_differ_in_facts_alone_are_told(applied, anchor, meet):
    free, with_fact, with_cut = applied(), applied(meet), applied(Cut((anchor(2), anchor(7))))
    assert free.differs_in_places(with_fact)
    assert not free.differs_in_places(with_cut)
    assert free.differs_in_facts(with_cut)
    assert not free.differs_in_facts(applied(Delete(anchor(3))))


def test_facts_in_words(anchor, meet):
    pair = (anchor(0), anchor(5))
    words = [said(fact).partition(" at (")[0] for fact in (meet, OnePlane(pair, 2), OnePlane(pair, 0), Cut(pair))]
    assert words == ["these meet", "same height", "one plane", "not connected"]
    assert said(Foot(anchor(0), (1.0, 2.0))).startswith("stands on the ground at (")
    assert said(PlaceAt(*pair, 0.1)).startswith("stands here at (")


def test_a_wall_by_its_edges_implies_that_they_lie_in_one_plane(made, applied, anchor):
    upright = np.flatnonzero(made.axis == 2)[:2].tolist()
    level = np.flatnonzero(made.axis == 0)[:2].tolist()
    lines = applied(WallByEdges(tuple(map(anchor, (*upright, *level)))))
    assert lines.facts == ()
    assert [told.lines for told in lines.implied] == [(upright[0], other) for other in (upright[1], *level)]
    assert {told.fact.normal for told in lines.implied} == {1}
    assert all(told.is_implied for told in lines.all_facts)
