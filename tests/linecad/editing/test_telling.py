"""Labelling begins with the crossings whose answers put the most lines right."""

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from linecad.decide.bodies import Bodies
from linecad.editing import telling
from linecad.editing.telling import Order, by_worth
from linecad.line_graph import Segments

# A house of four lines, a wing of three, the windscreen of a car of two, and a line that is not in the model.
PART = np.array([0, 0, 0, 0, 1, 1, 1, 2, 2, 3])
LENGTH = np.array([100.0, 90, 80, 70, 60, 50, 40, 5, 4, 20])
PROBABILITY = np.array([0.9, 0.9, 0.9, 0.9, 0.2, 0.2, 0.2, 0.1, 0.1, 0.0])
EDGES = np.array([[0, 7], [0, 1], [2, 6], [0, 4], [7, 8], [3, 9], [1, 8]])


@pytest.fixture
def parted(monkeypatch):
    monkeypatch.setattr(telling, "find_blocks", in_parts)
    return graph_of(EDGES)


def in_parts(*_):
    return Bodies(PART, 4, np.ones(len(PART), bool))


def graph_of(edges, length=LENGTH):
    ends = np.stack([np.zeros((10, 2)), np.column_stack([length, np.zeros(10)])], axis=1)
    return SimpleNamespace(edges=edges, segments=Segments(ends, np.zeros(10, int)))


def undecided(graph):
    return np.zeros(len(graph.edges), bool)


def test_the_wing_comes_before_a_windscreen_and_what_is_sure_comes_last(parted):
    order = by_worth(parted, undecided(parted), PROBABILITY).tolist()
    # The wing by its longest line, then again; the line outside; the car, twice; what joins lines of one part.
    assert order == [3, 2, 5, 0, 6, 4, 1]


@pytest.mark.usefixtures("parted")
def test_a_question_is_worth_half_when_asked_again():
    graph = graph_of(np.array([[0, 4], [1, 5], [2, 6], [3, 4], [0, 9]]))  # 120, 60, 30 and 15 px of wing, 20 outside
    assert by_worth(graph, undecided(graph), PROBABILITY).tolist() == [0, 3, 1, 4, 2]


@pytest.mark.usefixtures("parted")
def test_two_lines_outside_the_model_tell_nothing():
    outside = np.where(np.arange(10) < 7, PROBABILITY, 0.0)
    graph = graph_of(np.array([[8, 9], [0, 4]]), np.where(np.arange(10) < 8, LENGTH, 1000.0))
    assert by_worth(graph, undecided(graph), outside).tolist() == [1, 0]


@given(st.lists(st.tuples(st.integers(0, 9), st.integers(0, 9)).filter(lambda pair: pair[0] != pair[1]), max_size=30))
def test_each_crossing_is_there_once(pairs):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(telling, "find_blocks", in_parts)
        graph = graph_of(np.array(pairs, int).reshape(-1, 2))
        order = by_worth(graph, undecided(graph), PROBABILITY)
    assert sorted(order.tolist()) == list(range(len(pairs)))


def test_the_order_is_found_once_for_a_model(parted, monkeypatch):
    order, ids = Order(), tuple(range(100, 107))
    scene = SimpleNamespace(lines=SimpleNamespace(probability=np.array([0.5])))
    monkeypatch.setattr(telling, "rows_in_scene", lambda *_: np.zeros(10, int))
    first = order.of(parted, ids, scene, {})
    assert sorted(first) == list(ids)
    monkeypatch.setattr(telling, "by_worth", lambda *_: pytest.fail("found again"))
    assert order.of(parted, ids, scene, {}) is first
    # Two crossings went with a line, three came with another one: these come first.
    others = (98, *ids[2:], 99, 200)
    rest = [crossing for crossing in first if crossing in others]
    assert order.of(graph_of(EDGES), others, scene, {}) == (98, 99, 200, *rest)
    assert order.of(graph_of(EDGES), ids, scene, {}) == first  # undo


@pytest.mark.usefixtures("parted")
def test_before_a_model_the_order_depends_on_nothing_that_was_there_before():
    order, ids = Order(), tuple(range(7))
    order.of(graph_of(EDGES), ids, None, {})
    fewer = graph_of(EDGES[:5])
    assert order.of(fewer, ids[:5], None, {}) == Order().of(fewer, ids[:5], None, {})
