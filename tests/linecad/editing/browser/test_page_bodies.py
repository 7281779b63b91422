"""Bodies on the page: selected in both views, and what a person says of them by real clicks, drags and keys."""

import re

import numpy as np
import pytest

from linecad.io.scene_file import read_scene

pytestmark = pytest.mark.thorough  # every day the server is asked what the page asks it (test_bodies.py)

NEAR, FAR = 0, 1  # the bodies of the made scene, the larger first


@pytest.fixture
def told(screen):
    """The page with nothing said, the panel shut, and the second body known; its rebuilds have ended afterwards."""
    screen.run("linecad.bodies.panel.open(false)")
    screen.run("linecad.store.set({ body: null, bodyHover: null })")
    screen.wait("linecad.store.solve.state === 'idle'")
    assert [body["id"] for body in screen.state["bodies"]] == [NEAR, FAR]
    yield screen
    screen.page.keyboard.press("Escape")
    screen.page.mouse.move(2, 2)
    screen.wait("linecad.store.solve.state === 'idle'")
    screen.settle()


def lines_of(state, body, *axes):
    """Lines of a body, the longest in the photo first."""
    found = [line for line in state["lines"] if line["body"] == body and line["ends"] and line["axis"] in axes]
    return sorted(found, key=lambda line: -np.linalg.norm(np.subtract(*line["segment"])))


def lonely_place(state, line):
    """A place on a line that is farthest from all other lines."""
    start, end = np.array(line["segment"])
    places = start + np.linspace(0.1, 0.9, 81)[:, None] * (end - start)
    away = np.full(len(places), np.inf)
    for other in state["lines"]:
        if other["id"] == line["id"]:
            continue
        first, last = np.array(other["segment"])
        along = last - first
        share = np.clip((places - first) @ along / (along @ along), 0, 1)[:, None]
        away = np.minimum(away, np.linalg.norm(places - first - share * along, axis=1))
    return places[away.argmax()]


def click_line(screen, line):
    screen.click(lonely_place(screen.state, line))


def depth_at(state, line, pixel):
    """The camera depth at which a line passes nearest to the ray of a pixel."""
    K, R = np.array(state["K"]), np.array(state["R_cam_from_world"])
    ray = np.linalg.inv(K) @ [*pixel, 1.0] @ R
    start, end = np.array(line["ends"])
    along = (end - start) / np.linalg.norm(end - start)
    across = ray - (ray @ along) * along
    return across @ (start - (start @ along) * along) / (across @ across)


def crossing_of(first, second):
    one, other = (np.cross(*np.insert(line["segment"], 2, 1, axis=1)) for line in (first, second))
    through = np.cross(one, other)
    return through[:2] / through[2]


def line_now(state, line):
    return next(each for each in state["lines"] if each["id"] == line["id"])


def farness(state, body=FAR):
    """The camera depth of the middle of the longest line of a body."""
    line = lines_of(state, body, "x", "y", "z")[0]
    return depth_at(state, line, np.mean(line["segment"], axis=0))


def facts(screen):
    return [fact["op"] for fact in screen.served.ask("state")["facts"]]


def bar(screen):
    return screen.page.locator("#gesture").inner_text()


def wait_for_effect(screen):
    screen.wait("linecad.bodies.gestures.effect !== null")


def test_a_click_on_a_line_selects_its_body_in_both_views(told):
    told.press("b")
    click_line(told, lines_of(told.state, FAR, "z")[0])
    assert told.run("linecad.bodies.bodies.selected") == FAR
    panel = told.page.locator("#bodies-panel")
    assert "a foot on the ground with the ground" in panel.inner_text()
    assert panel.locator(f"[data-body='{FAR}']").get_attribute("aria-pressed") == "true"
    lit = told.painted("#bodies-canvas")
    model = told.page.locator("#model-canvas").screenshot()
    told.page.mouse.move(2, 2)
    told.press("Escape")
    told.press("Escape")
    assert told.run("linecad.bodies.bodies.selected") is None
    assert told.painted("#bodies-canvas") < lit / 4
    assert told.page.locator("#model-canvas").screenshot() != model


def test_a_click_on_a_face_selects_its_body(told):
    told.press("b")
    places = told.run(
        """(far) => {
          const found = [];
          for (let u = 20; u < 1260; u += 12) for (let v = 20; v < 900; v += 12) {
            const hit = linecad.bodies.pointer.faceOfPhoto([u, v]);
            if (hit?.face.body === far) found.push([u, v]);
          }
          return found;
        }""",
        FAR,
    )
    lines = np.array([line["segment"] for line in told.state["lines"]]).reshape(-1, 2)
    far_from_ends = max(places, key=lambda place: np.linalg.norm(lines - place, axis=1).min())
    told.click(far_from_ends)
    assert told.run("linecad.bodies.bodies.selected") == FAR


def test_a_row_of_the_list_lights_its_body_up(told):
    told.press("b")
    row = told.page.locator(f"#bodies-panel [data-body='{FAR}']")
    assert "Body B" in row.inner_text()
    dark = told.painted("#bodies-canvas")
    row.hover()
    told.settle()
    assert told.painted("#bodies-canvas") > dark + 500
    row.click()
    told.settle()
    assert told.run("linecad.bodies.bodies.selected") == FAR


def test_two_edges_meet_where_they_cross_in_the_photo(told):
    state = told.state
    pairs = [
        (far, near)
        for far in lines_of(state, FAR, "z")[:4]
        for near in lines_of(state, NEAR, "x", "y")[:4]
        if depth_at(state, far, crossing_of(far, near)) > 0 and depth_at(state, near, crossing_of(far, near)) > 0
    ]
    far, near = min(pairs, key=lambda pair: np.linalg.norm(crossing_of(*pair) - [640, 480]))
    told.press("b")
    click_line(told, far)
    told.press("Shift+M")
    assert "Click the edge of another body" in bar(told)
    told.page.mouse.move(*told.on_screen(lonely_place(state, near)))
    wait_for_effect(told)
    assert "Body" in told.page.locator("#gesture .effect").inner_text()
    assert facts(told) == [], "what is shown is not taken yet"
    click_line(told, near)
    assert facts(told) == ["meet"]
    now, pixel = told.state, crossing_of(far, near)
    depths = [depth_at(now, line_now(now, line), pixel) for line in (far, near)]
    assert depths[0] == pytest.approx(depths[1], rel=0.02)
    told.wait("linecad.store.solve.state === 'idle'")
    told.press("Control+z")
    assert farness(told.state) == pytest.approx(farness(state))


def test_two_level_lines_are_at_the_same_height(told):
    state = told.state
    far, near = lines_of(state, FAR, "x", "y")[0], lines_of(state, NEAR, "x", "y")[0]
    heights = [line["ends"][0][2] for line in (far, near)]
    if heights[0] * heights[1] < 0:
        near = next(line for line in lines_of(state, NEAR, "x", "y") if line["ends"][0][2] * heights[0] > 0)
    told.press("b")
    told.press("Shift+H")
    click_line(told, far)
    click_line(told, near)
    assert facts(told) == ["plane"]
    assert told.served.ask("state")["facts"][0]["normal"] == "z"
    now = told.state
    first, second = (line_now(now, line)["ends"][0][2] for line in (far, near))
    assert first == pytest.approx(second, rel=0.02)


def test_what_holds_already_is_said_to_move_nothing(told):
    """It moved nothing and said nothing."""
    told.press("b")
    click_line(told, lines_of(told.state, FAR, "z")[0])
    told.press("Shift+D")
    told.wait("linecad.bodies.gestures.now?.places")
    told.run("linecad.bodies.gestures.moveTo(1e-8)")
    told.press("Enter")
    told.page.get_by_text("That holds already").wait_for()
    assert facts(told) == ["place"]


def test_two_upright_lines_are_in_one_plane_and_a_key_turns_it(told):
    state = told.state
    far = lines_of(state, FAR, "z")[0]
    near = next(line for line in lines_of(state, NEAR, "z") if line["ends"][0][1] * far["ends"][0][1] > 0)
    told.press("b")
    told.press("Shift+J")
    click_line(told, far)
    told.page.mouse.move(*told.on_screen(lonely_place(state, near)))
    wait_for_effect(told)
    for axis in ("x", "y"):
        told.press(axis)
        assert f"Across {axis}." in bar(told)
    told.press("Enter")
    assert [fact["normal"] for fact in told.served.ask("state")["facts"]] == ["y"]
    now = told.state
    first, second = (line_now(now, line)["ends"][0][1] for line in (far, near))
    assert first == pytest.approx(second, rel=0.02)


def test_a_foot_shows_its_effect_before_it_is_taken(told):
    state = told.state
    wall = lines_of(state, FAR, "z")[0]
    lower = max(wall["segment"], key=lambda end: end[1])
    told.press("b")
    told.press("Shift+G")
    click_line(told, wall)
    told.click([lower[0], lower[1] + 40])
    wait_for_effect(told)
    assert "%" in told.page.locator("#gesture .effect").inner_text()
    assert told.run("Object.keys(linecad.bodies.gestures.moves).length") >= 1
    told.press("Escape")
    assert facts(told) == []
    assert told.page.locator("#gesture").is_hidden()
    told.press("Shift+G")  # with the line that is selected still
    for key in ("ArrowDown", "ArrowDown", "ArrowDown"):
        told.press(key)
    wait_for_effect(told)
    told.press("Enter")
    assert facts(told) == ["foot"]


def test_two_lines_are_not_connected(told):
    state = told.state
    told.press("b")
    click_line(told, lines_of(state, FAR, "z")[0])
    told.press("Shift+X")
    click_line(told, lines_of(state, NEAR, "z")[0])
    assert facts(told) == ["cut"]
    row = told.page.locator("#bodies-panel .facts li")
    assert "not connected: Body B, Body A" in row.inner_text()
    row.get_by_role("button", name="Withdraw").click()
    told.settle()
    assert facts(told) == []


def test_a_key_goes_through_other_places_and_enter_takes_one(told):
    told.press("b")
    told.press("Shift+PageDown")
    told.press("Shift+PageDown")
    assert told.run("linecad.bodies.bodies.selected") == FAR
    places = told.served.ask(f"places/{FAR}")
    told.press("Shift+N")
    if not places:
        assert "Nothing speaks for another place" in bar(told)
        return
    wait_for_effect(told)
    assert f"Place 1 of {len(places)}" in bar(told)
    if len(places) > 1:
        told.press("Shift+N")
        wait_for_effect(told)
        assert f"Place 2 of {len(places)}" in bar(told)
    index = min(1, len(places) - 1)
    before = farness(told.state)
    told.press("Enter")
    assert facts(told) == ["place"]
    assert np.log(farness(told.state) / before) == pytest.approx(places[index]["move"], abs=0.02)


def test_keys_alone_move_a_body(told):
    before = farness(told.state)
    told.press("b")
    told.press("Shift+PageDown")
    told.press("Shift+PageDown")
    told.press("Shift+D")
    told.wait("linecad.bodies.gestures.now.places !== null")
    for _ in range(5):
        told.press("ArrowUp")
    told.press("Shift+ArrowDown")
    wait_for_effect(told)
    told.press("Enter")
    assert facts(told) == ["place"]
    assert np.log(farness(told.state) / before) == pytest.approx(0.049, abs=0.01)


def test_a_body_is_moved_before_its_other_places_are_known(told):
    """Arrows and Enter did nothing until they were, and nothing told so."""
    with told.holding("/places/") as held:
        told.press("b")
        told.press("Shift+PageDown")
        told.press("Shift+PageDown")
        told.press("Shift+D")
        for _ in range(5):
            told.press("ArrowUp")
        wait_for_effect(told)
        told.press("Enter")
        assert facts(told) == ["place"]
        assert held() > 0


def test_a_drag_in_the_model_is_one_fact_and_leaves_the_photo_as_it_is(told):
    state = told.state
    told.press("b")
    line = lines_of(state, FAR, "z")[0]
    click_line(told, line)
    told.press("Shift+D")
    told.wait("linecad.bodies.gestures.now?.snaps !== undefined")
    box = told.page.locator("#model-canvas").bounding_box()
    seen = told.run(
        "(line) => [0, 0.3].map((log) => linecad.model.toScreen("
        "[0, 1, 2].map((k) => Math.exp(log) * (line.ends[0][k] + line.ends[1][k]) / 2)))",
        line,
    )
    start, end = ([box["x"] + at[0], box["y"] + at[1]] for at in seen)
    assert np.linalg.norm(np.subtract(start, end)) > 8
    told.page.mouse.move(*start)
    told.page.keyboard.down("Alt")  # nothing is to catch it
    told.page.mouse.down()
    told.page.mouse.move(*np.add(start, end) / 2)
    told.page.mouse.move(*end)
    assert told.run("linecad.bodies.gestures.now.log") == pytest.approx(0.3, abs=0.08)
    told.page.mouse.up()
    told.page.keyboard.up("Alt")
    told.settle()
    assert facts(told) == ["place"]
    now = told.state
    assert np.log(farness(now) / farness(state)) == pytest.approx(0.3, abs=0.1)
    assert [each["segment"] for each in now["lines"]] == [each["segment"] for each in state["lines"]]


def test_a_drag_of_the_foot_in_the_photo_moves_the_body(told):
    state = told.state
    told.press("b")
    line = lines_of(state, FAR, "z")[0]
    click_line(told, line)
    told.press("Shift+D")
    told.wait("linecad.bodies.gestures.now?.snaps !== undefined")
    place = lonely_place(state, line)
    told.page.mouse.move(*told.on_screen(place))
    told.page.mouse.down()
    for step in (8, 20, 32):
        told.page.mouse.move(*told.on_screen([place[0], place[1] + step]))
    told.page.mouse.up()
    told.settle()
    assert facts(told) == ["place"]
    assert farness(told.state) != pytest.approx(farness(state), rel=1e-3)


def test_facts_that_cannot_all_hold_light_up_and_either_can_be_dropped(told):
    state = told.state
    far, near = (lines_of(state, body, "x", "y", "z")[0]["id"] for body in (FAR, NEAR))
    for ratio in (0.2, 0.7):
        told.run("(edit) => linecad.editing.edit(edit)", {"op": "place", "line": far, "to": near, "log_ratio": ratio})
    told.settle()
    told.press("b")
    assert len(told.state["contradiction"]["facts"]) == 2
    rows = told.page.locator("#bodies-panel .facts li.contradicted")
    assert rows.count() == 2
    notice = told.page.locator("#notices .message.error")
    assert notice.get_by_role("button", name="Withdraw").count() == 2
    notice.get_by_role("button", name="Withdraw").first.click()
    told.settle()
    told.wait("linecad.store.state.contradiction === null")
    assert told.page.locator("#notices .message.error").count() == 0
    kept = told.served.ask("state")["facts"]
    assert [fact["log_ratio"] for fact in kept] == [0.7]


def test_what_moved_is_shown_for_a_moment_and_listed(told):
    told.press("b")
    far, near = (lines_of(told.state, body, "x", "y", "z")[0]["id"] for body in (FAR, NEAR))
    told.run("(edit) => linecad.editing.edit(edit)", {"op": "place", "line": far, "to": near, "log_ratio": 0.9})
    told.settle()
    assert [move["body"] for move in told.state["moved"]] == [FAR]
    assert told.run("linecad.bodies.view.flashing") == 1
    told.wait("linecad.store.solve.state === 'idle'")
    told.wait("linecad.bodies.view.flashing === 0")
    assert "Body B" in told.page.locator("#bodies-panel .moved").inner_text(), "the list outlives the rebuild"
    assert told.run("linecad.bodies.said.distant") == 0


def test_what_moved_unasked_is_put_back(told):
    told.press("b")
    before = farness(told.state) / farness(told.state, NEAR)
    wall = lines_of(told.state, NEAR, "z")[0]
    lower = max(wall["segment"], key=lambda end: end[1])
    foot = {"op": "foot", "line": wall["id"], "pixel": [lower[0], lower[1] + 60]}
    told.run("(edit) => linecad.editing.edit(edit)", foot)
    told.settle()
    moved = told.state["moved"]
    assert FAR in [move["body"] for move in moved], "it stands on the ground that the foot has moved"
    assert farness(told.state) / farness(told.state, NEAR) != pytest.approx(before, rel=0.02)
    assert told.run("linecad.bodies.said.distant") == 0
    # Whoever moves the ground asks for all that stands on it: say that the server thinks otherwise.
    told.run(
        """() => {
          const { state } = linecad.store;
          const moved = state.moved.map((move) => ({ ...move, asked: false }));
          linecad.editing.accept({ ...state, moved });
        }"""
    )
    assert told.run("linecad.bodies.said.distant") == len(moved)
    row = told.page.locator("#bodies-panel .moved li", has_text="Body B")
    row.get_by_role("button", name="Put back").click()
    told.settle()
    assert facts(told) == ["foot", "place"]
    assert farness(told.state) / farness(told.state, NEAR) == pytest.approx(before, rel=0.01)
    assert told.page.locator("#bodies-panel .moved li", has_text="Body B").count() == 0


def test_the_rebuild_behind_a_fact_takes_nothing_away(told):
    told.press("b")
    line = lines_of(told.state, FAR, "z")[0]
    click_line(told, line)
    told.run("linecad.photo.change((viewport) => viewport.zoom(1.5, [300, 300]))")
    told.page.locator("#messages button").evaluate_all("(all) => all.forEach((each) => each.click())")
    view = told.run("[linecad.photo.viewport.x, linecad.photo.viewport.scale, linecad.model.orbit.distance]")
    told.page.locator("#bodies-panel [data-gesture=move]").focus()
    far, near = (lines_of(told.state, body, "x", "y", "z")[0]["id"] for body in (FAR, NEAR))
    told.run("(edit) => linecad.editing.edit(edit)", {"op": "place", "line": far, "to": near, "log_ratio": 0.4})
    told.wait("linecad.store.solve.state === 'running'")
    told.wait("linecad.store.solve.state === 'idle'")
    told.settle()
    told.wait("linecad.store.state.solve.fresh")
    assert told.run("linecad.bodies.bodies.selected") == told.run(
        "(id) => linecad.store.lines.get(id).body", line["id"]
    )
    assert told.run("linecad.store.tool") == "body"
    assert told.run("linecad.store.selection") == {"kind": "line", "id": line["id"]}
    assert told.run("[linecad.photo.viewport.x, linecad.photo.viewport.scale, linecad.model.orbit.distance]") == view
    assert told.run("document.activeElement.dataset.gesture") == "move"
    assert told.page.locator("#messages .message").count() == 0


def test_an_export_waits_for_the_scene_behind_a_fact(told, tmp_path):
    """It held the scene before, and nobody was told."""
    state = told.state
    line, to = (lines_of(state, body, "x", "y")[0] for body in (FAR, NEAR))
    told.press("e")
    edit = {"op": "place", "line": line["id"], "to": to["id"], "log_ratio": 0.25}
    with told.page.expect_download() as download:
        told.run(
            """async (edit) => {
              await linecad.editing.edit(edit);
              document.querySelector("[data-format=json]").click();
            }""",
            edit,
        )
        told.page.get_by_text("JSON is written when the model holds your corrections").wait_for()
    download.value.save_as(tmp_path / "now.json")
    told.page.get_by_text("Saved boxes.json.", exact=True).wait_for()
    told.wait("linecad.store.solve.state === 'idle'")
    scene, now = read_scene(tmp_path / "now.json"), told.served.ask("state")
    assert now["solve"]["fresh"]
    moved = scene.lines.row_by_look["xyz".index(line["axis"]), np.array(line["segment"]).tobytes()]
    np.testing.assert_allclose(scene.lines.ends[moved], line_now(now, line)["ends"])
    assert not np.allclose(scene.lines.ends[moved], line["ends"], rtol=0.01)
    told.press("Control+z")


@pytest.fixture
def parted(told):
    """The page where the lower half of the larger body may stand by itself: in the made scene all holds together."""
    own = [line for line in told.state["lines"] if line["body"] == NEAR and line["ends"]]
    own.sort(key=lambda line: np.mean(line["ends"], axis=0)[2])
    lines = [line["id"] for line in own[: len(own) // 2]]
    with told.answering(f"/parts/{NEAR}", [{"lines": lines, "probability": 0.3}]):
        yield told, lines


def middle_depths(state, numbers):
    """The camera depth of the middle of each of some lines."""
    found = {}
    for number in numbers:
        line = next(each for each in state["lines"] if each["id"] == number)
        found[number] = depth_at(state, line, np.mean(line["segment"], axis=0))
    return found


def test_a_part_of_the_largest_body_is_moved_by_keys_and_the_rest_stays(parted):
    told, lines = parted
    before = told.state
    rest = [line["id"] for line in before["lines"] if line["body"] == NEAR and line["ends"] and line["id"] not in lines]
    told.press("b")
    told.press("Shift+PageDown")
    told.press("Shift+D")
    assert told.run("linecad.bodies.gestures.now") is None, "the largest body as a whole stays"
    told.press("Shift+K")
    told.wait("linecad.bodies.gestures.parts.chosen !== null")
    assert told.run("linecad.bodies.bodies.linesOf.get(linecad.bodies.bodies.part).length") == len(lines)
    assert "Part of Body A" in told.run("linecad.bodies.bodies.nameOf(linecad.bodies.bodies.part)")
    told.press("Shift+D")
    told.wait("linecad.bodies.gestures.now?.snaps !== undefined")
    for _ in range(5):
        told.press("ArrowUp")
    wait_for_effect(told)
    assert "Part of Body A" in bar(told)
    assert list(told.run("linecad.bodies.gestures.moves")) == [str(len(before["bodies"]) + 1)]
    told.press("Enter")
    assert facts(told) == ["place"]
    now = told.state
    was, there = middle_depths(before, lines + rest), middle_depths(now, lines + rest)
    stays = np.median([there[line] / was[line] for line in rest])  # a scene built anew may have another unit
    for line in lines:
        assert np.log(there[line] / was[line] / stays) == pytest.approx(0.05, abs=0.02)
    for line in rest:
        assert there[line] == pytest.approx(stays * was[line], rel=0.01)
    body = {line["id"]: line["body"] for line in now["lines"]}
    assert {body[line] for line in lines} == {FAR + 1}
    assert {body[line] for line in rest} == {NEAR}
    assert told.run("linecad.bodies.gestures.parts.chosen") is None
    shown = told.page.locator("#bodies-panel .facts li").inner_text()
    # The letters follow the shares of the photo, and the scene behind the fact may be built by now.
    assert re.match("a part of it stands here: Body (A, Body C|C, Body A)", shown)


def test_parts_are_chosen_in_the_panel_and_lie_over_the_photo(parted):
    told, lines = parted
    told.press("b")
    told.press("Shift+PageDown")
    row = told.page.locator("#bodies-panel .parts button")
    row.wait_for()
    assert f"{len(lines)} lines, belongs here: 30 %" in row.inner_text()
    row.click()
    told.settle()
    assert told.run("linecad.bodies.gestures.parts.chosen.lines") == lines
    row = told.page.locator("#bodies-panel .parts button")
    row.wait_for()
    assert row.get_attribute("aria-pressed") == "true"
    told.press("Shift+N")
    told.wait("linecad.bodies.gestures.now?.places !== null")
    assert "Place 1 of" in bar(told) or "Nothing speaks for another place" in bar(told)
    told.press("Escape")
    told.press("Shift+K")
    assert told.run("linecad.bodies.gestures.parts.chosen") is None, "behind the last part comes the whole body"
    told.press("Shift+K")
    told.wait("linecad.bodies.gestures.parts.chosen !== null")
    told.press("Shift+PageDown")
    assert told.run("linecad.bodies.gestures.parts.chosen") is None, "another body has other parts"
    assert told.run("linecad.bodies.bodies.linesOf.has(linecad.bodies.bodies.part)") is False


def test_what_holds_together_has_no_part(told):
    told.press("Shift+K")
    assert "Click a body first" in told.page.locator("#messages").inner_text()
    told.press("b")
    told.press("Shift+PageDown")
    told.press("Shift+PageDown")
    told.press("Shift+K")
    told.page.get_by_text("This body holds together well").wait_for()
