"""What the page is sent of a state. That page/answers.js makes the state of it again: browser/test_page_answers.py."""

import json

import pytest

from linecad.editing.answers import ITEMS, KEPT, Answers

STATE = {
    "version": 3,
    "undo": 1,
    "lines": [{"id": 4, "axis": "x", "ends": None}, {"id": 7, "axis": "z", "ends": [1.5]}],
    "crossings": [{"id": 9, "real": True}],
    "planes": [],
    "bodies": [],
}


@pytest.fixture
def answers():
    return Answers()


def test_who_has_nothing_is_sent_all(answers):
    assert answers.answer(STATE) == {**STATE, "answer": 1}


def test_who_has_the_state_before_is_sent_what_differs(answers):
    known = answers.answer(STATE)["answer"]
    moved = [STATE["lines"][0], {"id": 7, "axis": "z", "ends": [2.5]}]
    told = answers.answer({**STATE, "version": 4, "lines": moved}, known)
    changed = {"changed": [{"id": 7, "ends": [2.5]}]}
    assert told == {"answer": 2, "differs_from": 1, "fields": {"version": 4}, "items": {"lines": changed}}


def test_items_that_come_go_or_turn_around_are_told_by_the_order_of_all(answers):
    known = answers.answer(STATE)["answer"]
    lines = [STATE["lines"][1], {"id": 2, "axis": "y", "ends": None}]
    told = answers.answer({**STATE, "lines": lines}, known)
    assert told["items"] == {"lines": {"ids": [7, 2], "changed": [lines[1]]}}


def test_who_speaks_of_a_state_that_is_forgotten_is_sent_all(answers):
    known = answers.answer(STATE)["answer"]
    for _ in range(KEPT):
        answers.answer(STATE)
    assert answers.answer(STATE, known) == {**STATE, "answer": KEPT + 2}


@pytest.mark.parametrize("has", [0, 99])
def test_who_speaks_of_a_state_that_never_was_is_sent_all(answers, has):
    assert answers.answer(STATE, has) == {**STATE, "answer": 1}


class TestServer:
    def test_a_word_about_bodies_is_answered_by_what_it_changes(self, page):
        page.solve()
        known = page.state()
        to, line = (next(line["id"] for line in known["lines"] if line["body"] == body) for body in (0, 1))
        edit = {"op": "place", "line": line, "to": to, "log_ratio": 0.4}
        told = page.post("edit", base_version=page.version, has=page.answer, edit=edit).json()
        assert told["differs_from"] == page.answer
        assert "crossings" not in told["items"]
        moved = {line["id"] for line in told["items"]["lines"]["changed"]}
        assert moved == {line["id"] for line in known["lines"] if line["body"] == 1 and line["ends"]}
        assert len(json.dumps(told)) < len(json.dumps(known)) / 5

    def test_a_model_that_came_meanwhile_is_told_as_a_difference(self, page):
        page.state()
        has = page.answer
        page.solve()
        told = page.get(f"state?has={has}").json()
        assert told["differs_from"] == has
        assert told["items"].keys() <= set(ITEMS)
        assert told["fields"]["solve"]["status"] == "optimal"

    @pytest.mark.parametrize("has", ["", "-1", "1e3", "9" * 40])
    def test_what_is_no_number_of_an_answer_is_answered_by_all(self, page, has):
        assert page.get(f"state?has={has}").json()["lines"]

    def test_a_scene_is_built_behind_the_answer_to_a_fact(self, page, monkeypatch):
        """Not before it: it would take the processor from who draws it."""
        page.solve()
        state, order = page.state(), []
        to, line = (next(line["id"] for line in state["lines"] if line["body"] == body) for body in (0, 1))
        monkeypatch.setattr(page.solving, "start", lambda _task: order.append("start"))
        monkeypatch.setattr(
            "linecad.editing.server.document_of",
            lambda *_: order.append("answer") or STATE,
        )
        page.post("edit", base_version=page.version, edit={"op": "place", "line": line, "to": to, "log_ratio": 0.4})
        assert order == ["answer", "start"]
