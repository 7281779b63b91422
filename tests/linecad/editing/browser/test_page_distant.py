"""The page in a browser: what a solve changed far from the edits is told, shown and refused."""

import pytest

pytestmark = pytest.mark.thorough  # every day the server is asked what it says of such changes (test_server.py)

# A solve whose changes are far away, as the server tells it: no photo of a test has one for sure.
FAR = """(ids) => {
  const { store } = linecad;
  const change = (each) => (ids.includes(each.id) ? { ...each, changed: true, far: true } : each);
  const crossings = store.state.crossings.map(change);
  store.set({ state: { ...store.state, crossings } });
}"""


def test_distant_changes_are_shown_and_refused_in_one_step(screen):
    some = [each for each in screen.state["crossings"] if each["real"]][:2]
    ids = [each["id"] for each in some]
    notice = screen.page.locator("#notices")
    assert "far from what you edited" not in notice.inner_text()
    screen.run(FAR, ids)
    assert "2 crossings changed far from what you edited" in notice.inner_text()
    screen.button("Show them").click()
    screen.settle()
    assert sorted(screen.run("linecad.store.many.crossings")) == sorted(ids)
    screen.button("Refuse them").click()
    screen.settle()
    screen.wait("linecad.store.solve.state === 'idle'")
    screen.settle()
    labels = {each["id"]: each["label"] for each in screen.served.ask("state")["crossings"] if each["id"] in ids}
    assert labels == dict.fromkeys(ids, "fake")
    assert "far from what you edited" not in notice.inner_text()
    screen.press("Control+z")
    assert all(each["label"] is None for each in screen.served.ask("state")["crossings"] if each["id"] in ids)
    assert screen.complaints == []
