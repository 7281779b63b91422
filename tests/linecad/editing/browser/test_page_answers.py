"""The page makes of what differs the very state that the server has."""

import json

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from linecad.editing.answers import ITEMS, Answers

pytestmark = pytest.mark.thorough  # every day the server's side of it is tested (test_answers.py)

VALUES = st.one_of(st.none(), st.booleans(), st.integers(-5, 5), st.lists(st.floats(-9, 9), max_size=2))
FIELDS = st.fixed_dictionaries({"version": st.integers(0, 3), "solve": st.dictionaries(st.sampled_from("ab"), VALUES)})


@st.composite
def states(draw):
    """States with a few items of few ids, so that two of them have many in common."""
    state = draw(FIELDS)
    for name in ITEMS:
        ids = draw(st.lists(st.integers(0, 6), unique=True, max_size=5))
        state[name] = [{"id": own, "axis": draw(VALUES), "ends": draw(VALUES)} for own in ids]
    return state


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(states(), states())
def test_a_difference_makes_the_state_again(screen, before, state):
    answers = Answers()
    known = answers.answer(before)
    told = answers.answer(state, known["answer"])
    made = screen.page.evaluate(
        "async (told) => (await import('/page/answers.js')).stateOf(...told)", [told, json.loads(json.dumps(known))]
    )
    assert made == json.loads(json.dumps({**state, "answer": told["answer"]}))


def test_edits_undone_and_models_leave_the_page_with_the_state_of_the_server(screen):
    """Whatever order answers come in, nothing is missed."""
    screen.wait("linecad.store.solve.state === 'idle'")
    to, line = (next(one["id"] for one in screen.state["lines"] if one["body"] == body) for body in (0, 1))
    label = {"op": "label", "crossing": screen.state["crossings"][0]["id"], "value": "unsure"}
    edits = [
        {"op": "place", "line": line, "to": to, "log_ratio": 0.3},
        label,
        {"op": "delete", "line": screen.state["lines"][-1]["id"]},
        {"op": "draw", "ends": [[40, 60], [140, 60]], "axis": "x", "reach": 0},
    ]
    for edit in edits:
        screen.run(f"linecad.editing.edit({json.dumps(edit)})")
        compare(screen)
    for _ in edits:
        screen.run("linecad.editing.undo()")
        compare(screen)


def compare(screen):
    """Once what was built behind the last answer has been heard of."""
    screen.settle()
    while (told := screen.served.ask("progress"))["solve"]["state"] == "running":
        screen.page.wait_for_timeout(50)
    screen.wait(f"linecad.store.solve.state === 'idle' && linecad.store.state.version === {told['version']}")
    now = {"answer": None, "saved": None, "solve": None}
    mine, told = screen.page.evaluate("linecad.store.state"), screen.served.ask("state")
    assert mine | now == told | now


def test_a_search_is_over_when_its_model_is_here(screen):
    """The page never shows an old model as the result of a search that has ended."""
    screen.wait("linecad.store.solve.state === 'idle'")
    before = screen.served.ask("progress")["solve"]["solved_version"]
    with screen.holding("/api/state") as held:
        screen.button("Solve again").click()
        while not held():
            screen.page.wait_for_timeout(20)
        assert screen.served.ask("progress")["solve"]["state"] == "idle"
        assert screen.run("linecad.store.solve.state") == "running"
    screen.wait("linecad.store.solve.state === 'idle'")
    assert screen.state["solve"]["solved_version"] > before
