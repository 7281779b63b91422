"""The page in a browser: corrections by real clicks and keys, undo and redo, solving, labelling, export."""

import signal

import numpy as np
import pytest

from exporters.formats import export
from linecad.camera.photo import read_photo
from linecad.io.scene_file import read_scene

pytestmark = pytest.mark.thorough  # every day the server is asked what the page asks it (test_server.py)

STEPS = 30


def apart(crossings, least=60.0):
    """Those crossings, of a state, that a click at the fitted view cannot mistake for another."""
    pixels = np.array([each["pixel"] for each in crossings])
    away = np.linalg.norm(pixels[:, None] - pixels, axis=2) + np.where(np.eye(len(pixels)), np.inf, 0)
    return [each for each, near in zip(crossings, away.min(axis=1), strict=True) if near > least]


def by_id(state, kind, number):
    return next(each for each in state[kind] if each["id"] == number)


def free_place(state, line, least=0.25):
    """A place on a line that is far from crossings, and from its ends by a share of its length."""
    near = np.array([each["pixel"] for each in state["crossings"]])
    shares = np.linspace(least, 1 - least, 101)[:, None]
    places = (1 - shares) * line["segment"][0] + shares * np.array(line["segment"][1])
    return places[np.linalg.norm(places[:, None] - near, axis=2).min(axis=1).argmax()]


def longest(state, axis):
    lines = [each for each in state["lines"] if each["axis"] == axis and each["ends"]]
    return max(lines, key=lambda each: np.linalg.norm(np.subtract(*each["segment"])))


def decided(state):
    return {each["id"]: each["label"] for each in state["crossings"] if each["label"]}


def test_a_click_turns_a_crossing_from_real_to_fake_and_back(screen):
    crossing = next(each for each in apart(screen.state["crossings"]) if each["real"])
    for value in ("fake", "real"):
        screen.click(crossing["pixel"])
        assert by_id(screen.state, "crossings", crossing["id"])["label"] == value
        assert decided(screen.served.ask("state")) == {crossing["id"]: value}
    assert "as you said" in screen.page.locator("#inspector").inner_text()


def test_the_inspector_says_why_a_crossing_is_real_or_not(screen):
    words = {
        "chosen": "chosen by the program",
        "not chosen": "left out by the program",
        "small group": "fewer than four",
    }
    seen = set()
    screen.press("v")  # to select and not to correct
    for crossing in apart(screen.state["crossings"]):
        if crossing["reason"] in words and crossing["reason"] not in seen:
            seen.add(crossing["reason"])
            screen.click(crossing["pixel"])
            assert words[crossing["reason"]] in screen.page.locator("#inspector").inner_text()
    assert "chosen" in seen


def test_a_click_draws_its_mark_as_drawing_everything_does(screen):
    crossing = next(each for each in apart(screen.state["crossings"]) if each["real"])
    screen.run("linecad.photo.change((viewport) => viewport.zoom(2))")
    screen.run("(pixel) => linecad.photo.change((viewport) => viewport.centre(pixel))", crossing["pixel"])
    read = """() => {
      const canvas = document.querySelector("#drawing-canvas");
      const [x, y] = [canvas.width >> 1, canvas.height >> 1];
      const { data } = canvas.getContext("2d").getImageData(x - 30, y - 30, 60, 60);
      // A colour that is hardly there is rounded far: what counts is how much of it is seen.
      return [...data].map((value, at) => (at % 4 === 3 ? value : (value * data[at - (at % 4) + 3]) / 255));
    }"""
    screen.run(read)  # the first reading changes how the browser draws
    screen.run("linecad.photo.redraw('drawing')")
    screen.settle()
    before = np.array(screen.run(read))
    screen.click(crossing["pixel"])
    clicked = np.array(screen.run(read))
    screen.run("linecad.photo.redraw('drawing')")
    screen.settle()
    anew = np.array(screen.run(read))
    assert np.count_nonzero(clicked != before) > 50
    # A stroke that is cut at the border differs by a shade; a missing mark would by 100 and more.
    assert np.abs(clicked - anew).max() <= 40


def test_keys_say_what_the_crossing_under_the_pointer_is(screen):
    crossing = apart(screen.state["crossings"])[0]
    screen.page.mouse.move(*screen.on_screen(crossing["pixel"]))
    for key, value in (("f", "fake"), ("u", "unsure"), ("r", "real"), ("g", None)):
        screen.press(key)
        assert by_id(screen.served.ask("state"), "crossings", crossing["id"])["label"] == value


def test_thirty_edits_are_undone_and_redone_exactly(screen):
    chosen = apart(screen.state["crossings"], 40.0)[:10]
    assert len(chosen) == 10
    places = [screen.on_screen(crossing["pixel"]) for crossing in chosen]
    states = [decided(screen.served.ask("state"))]
    for _ in range(3):
        for place in places:
            screen.page.mouse.click(*place)
        screen.settle()
        states.append(decided(screen.served.ask("state")))
        assert decided(screen.state) == states[-1] != states[-2]
    assert screen.state["undo"] == 3 * len(places) == STEPS
    for key, name, expected in (("Control+z", "Undo", states[-2::-1]), ("Control+Shift+z", "Redo", states[1:])):
        for state in expected:
            for _ in places:
                screen.page.keyboard.press(key)
            screen.settle()
            assert decided(screen.state) == state == decided(screen.served.ask("state"))
        assert screen.button(name).is_disabled()


def test_keys_change_the_axis_of_a_line_and_delete_it(screen):
    line = longest(screen.state, "z")
    screen.press("v")
    screen.click(free_place(screen.state, line))
    assert screen.run("linecad.store.selection") == {"kind": "line", "id": line["id"]}
    screen.press("x")
    assert by_id(screen.served.ask("state"), "lines", line["id"])["axis"] == "x"
    screen.press("Control+z")
    assert by_id(screen.served.ask("state"), "lines", line["id"])["axis"] == "z"
    screen.press("Delete")
    assert line["id"] not in [each["id"] for each in screen.served.ask("state")["lines"]]
    assert line["id"] not in [each["id"] for each in screen.state["lines"]]
    screen.button("Undo").click()
    screen.settle()
    assert by_id(screen.state, "lines", line["id"])["axis"] == "z"


def test_a_key_goes_through_the_frames(new_screen, start, two_frames):
    screen = new_screen(start(photo=two_frames))
    screen.open()
    assert screen.state["frames"] == screen.served.ask("state")["frames"] == 2
    # The rightmost, since no line reaches across the vanishing point of its axis, as one in the middle would along y.
    level = [each for each in screen.state["lines"] if each["axis"] == "x2" and each["ends"]]
    line = max(level, key=lambda each: np.mean(each["segment"], axis=0)[0])
    screen.press("v")
    screen.click(free_place(screen.state, line))
    assert screen.run("linecad.store.selection") == {"kind": "line", "id": line["id"]}
    next_frame = screen.button("Next frame")
    for axis, label in (("x", "frame 1 of 2"), ("x2", "frame 2 of 2")):
        screen.press("q")
        assert by_id(screen.served.ask("state"), "lines", line["id"])["axis"] == axis
        assert label in next_frame.inner_text()
    next_frame.click()
    screen.settle()
    assert by_id(screen.state, "lines", line["id"])["axis"] == "x"
    screen.press("y")
    screen.press("q")
    assert by_id(screen.served.ask("state"), "lines", line["id"])["axis"] == "y2"
    assert screen.button("Axis y").get_attribute("aria-pressed") == "true"
    screen.press("z")
    screen.press("q")
    assert by_id(screen.served.ask("state"), "lines", line["id"])["axis"] == "z"
    assert "any frame" in next_frame.inner_text()
    # A line that is being drawn: x, then the x of the second frame.
    screen.press("d")
    below = np.array([0.0, 12.0])  # px
    start_at, end_at = (screen.on_screen(end + below) for end in np.array(line["segment"]))
    screen.page.mouse.move(*start_at)
    screen.page.mouse.down()
    screen.page.mouse.move(*end_at, steps=3)
    screen.press("x")
    screen.press("q")
    screen.wait("linecad.draft.proposal?.axis === 'x2'")
    # What is drawn is told when the page paints next.
    screen.wait("document.querySelector('#inspector').innerText.includes('Along x2, fixed')")
    screen.page.mouse.up()
    screen.settle()
    assert [each["axis"] for each in screen.state["lines"] if each["origin"] == "drawn"] == ["x2"]


def test_a_photo_of_one_frame_has_no_next_one(screen):
    line = longest(screen.state, "x")
    screen.press("v")
    screen.click(free_place(screen.state, line))
    assert screen.state["frames"] == 1
    assert screen.button("Next frame").count() == 0
    screen.press("q")
    assert by_id(screen.state, "lines", line["id"])["axis"] == "x"
    assert screen.served.ask("state")["undo"] == 0
    assert "All lines are of one frame" in screen.page.locator("body").inner_text()


def test_a_line_is_split_where_it_is_clicked_and_joined_again(screen):
    line = longest(screen.state, "z")
    place = free_place(screen.state, line)
    ids = {each["id"] for each in screen.state["lines"]}
    screen.press("k")
    screen.click(place)
    pieces = [each for each in screen.state["lines"] if each["origin"] == "split"]
    assert len(pieces) == 2
    ends = np.array([each["segment"] for each in pieces])
    assert np.linalg.norm(ends - place, axis=2).min(axis=1).max() < 2  # both begin where the click was
    screen.press("j")
    for piece in pieces:
        far = max(piece["segment"], key=lambda end: np.linalg.norm(np.subtract(end, place)))
        screen.click(0.7 * np.array(place) + 0.3 * np.array(far))
    joined = [each for each in screen.state["lines"] if each["origin"] == "joined"]
    assert len(joined) == 1
    assert np.sort(np.array(joined[0]["segment"]), axis=0) == pytest.approx(np.sort(line["segment"], axis=0), abs=1)
    screen.press("Control+z")
    screen.press("Control+z")
    assert {each["id"] for each in screen.state["lines"]} == ids


def test_a_line_is_drawn_with_undo_inside_it_and_a_proposed_axis(screen):
    state = screen.state
    line = longest(state, "z")
    top, bottom = (np.array(end) for end in line["segment"])
    beside = np.array([45.0, 0.0])  # px to the right of an edge along z, where another one is plausible
    start, end = (screen.on_screen(0.8 * one + 0.2 * other + beside) for one, other in ((top, bottom), (bottom, top)))
    screen.press("d")
    screen.page.mouse.click(*start)
    assert screen.run("linecad.draft.points.length") == 1
    screen.press("Control+z")
    assert screen.run("linecad.draft.points.length") == 0
    assert screen.served.ask("state")["undo"] == 0
    screen.press("Control+Shift+z")
    screen.page.mouse.move(*end, steps=4)
    screen.wait("linecad.draft.proposal !== null")
    assert screen.run("linecad.draft.proposal.axis") == "z"
    screen.page.mouse.click(*end)
    screen.wait("linecad.store.state.lines.some(({ origin }) => origin === 'drawn')")  # it is proposed, then sent
    screen.settle()
    drawn = [each for each in screen.state["lines"] if each["origin"] == "drawn"]
    assert [each["axis"] for each in drawn] == ["z"]
    assert len(screen.state["lines"]) == len(state["lines"]) + 1
    # The same by a drag, with the axis that a key fixes.
    screen.press("Control+z")
    screen.page.mouse.move(*start)
    screen.page.mouse.down()
    screen.page.mouse.move(*end, steps=3)
    screen.press("y")
    screen.page.mouse.up()
    screen.settle()
    assert [each["axis"] for each in screen.state["lines"] if each["origin"] == "drawn"] == ["y"]


def test_a_known_length_sets_the_scale(screen):
    line = longest(screen.state, "z")
    screen.press("v")
    screen.click(free_place(screen.state, line))
    screen.press("m")
    screen.page.get_by_label("Length", exact=True).fill("7,5 m")
    screen.page.get_by_role("button", name="Set the scale").click()
    screen.wait("linecad.store.state.metres_per_unit !== null")
    units = np.linalg.norm(np.subtract(*line["ends"]))
    assert screen.served.ask("state")["metres_per_unit"] * units == pytest.approx(7.5, rel=1e-3)
    assert "7.50 m" in screen.page.locator("#inspector").inner_text()


def test_lines_drawn_along_the_axes_give_the_frame(screen):
    screen.press("a")
    for axis in ("z", "x"):
        screen.press(axis)
        lines = [each for each in screen.state["lines"] if each["axis"] == axis and each["ends"]]
        lines.sort(key=lambda each: -np.linalg.norm(np.subtract(*each["segment"])))
        first = lines[0]
        away = [np.abs(np.subtract(each["segment"][0], first["segment"][0])).sum() for each in lines[:12]]
        for line in (first, lines[int(np.argmax(away))]):
            start, end = (screen.on_screen(pixel) for pixel in line["segment"])
            screen.page.mouse.move(*start)
            screen.page.mouse.down()
            screen.page.mouse.move(*end, steps=3)
            screen.page.mouse.up()
    assert [line["axis"] for line in screen.run("linecad.draft.lines")] == ["z", "z", "x", "x"]
    screen.press("Control+z")
    screen.press("Control+z")
    assert screen.run("linecad.draft.lines.length") == 3
    screen.press("Control+Shift+z")
    screen.press("Control+Shift+z")
    before = np.array(screen.state["R_cam_from_world"])
    screen.press("Enter")
    screen.wait("linecad.store.tool === 'correct'")
    state = screen.served.ask("state")
    assert state["undo"] == 1
    turned = before.T @ np.array(state["R_cam_from_world"])
    assert np.degrees(np.arccos((np.trace(turned) - 1) / 2)) < 3
    assert (turned != np.eye(3)).any()


def test_solving_shows_what_changed_and_undo_goes_back_across_it(screen):
    before = screen.served.ask("state")
    crossing = next(each for each in apart(before["crossings"]) if each["real"])
    screen.click(crossing["pixel"])
    screen.page.get_by_text("Your corrections are not in the model yet").wait_for()
    screen.button("Solve again").click()
    screen.page.get_by_text("Solved:").wait_for()
    state = screen.served.ask("state")
    assert by_id(state, "crossings", crossing["id"])["real"] is False
    changed = [each["id"] for each in state["crossings"] if each["changed"]]
    assert crossing["id"] in changed
    assert screen.page.locator("[data-layer=changed] .count").inner_text() == str(len(changed))
    screen.press("Control+z")
    assert {each["id"]: each["real"] for each in screen.state["crossings"]} == {
        each["id"]: each["real"] for each in before["crossings"]
    }


def edit(served, **what):
    """An edit as the page sends it; the new state."""
    return served.ask("edit", {"base_version": served.ask("state")["version"], "edit": what})


def test_a_contradiction_is_named_and_lit_up(screen, made):
    """Two uprights of one facade met by a line along it and by one into the depth: both cannot be."""
    state = screen.state
    upright = {each["id"]: each for each in state["lines"] if each["axis"] == "z"}
    met = {}  # by the line along x: the uprights that it really meets
    for crossing in state["crossings"]:
        for one, other in (crossing["lines"], crossing["lines"][::-1]):
            if crossing["real"] and one in upright and by_id(state, "lines", other)["axis"] == "x":
                met.setdefault(other, []).append((upright[one]["segment"][0][0], one, crossing["id"]))
    pairs = sorted(max(met.values(), key=len))
    (_, left, first), (_, right, second) = pairs[0], pairs[-1]
    away = made.camera.matrix @ made.frame.rotation[:, 1]  # the vanishing point of y
    start, goal = free_place(state, upright[left]), away[:2] / away[2]
    across = np.mean([end[0] for end in upright[right]["segment"]]) + 12
    end = start + (goal - start) * (across - start[0]) / (goal[0] - start[0])
    state = edit(screen.served, op="draw", ends=[(start - (goal - start) * 0.02).tolist(), end.tolist()], axis="y")
    drawn = next(each["id"] for each in state["lines"] if each["origin"] == "drawn")
    new = {tuple(sorted(each["lines"])): each for each in state["crossings"]}
    others = [new[tuple(sorted((upright_id, drawn)))] for upright_id in (left, right)]
    for crossing in (first, second, others[0]["id"]):
        edit(screen.served, op="label", crossing=crossing, value="real")
    screen.run("linecad.editing.refresh()")
    # Fitted, a more important crossing beside it is drawn in its place.
    screen.run("(pixel) => linecad.photo.change((viewport) => viewport.centre(pixel, 16))", others[1]["pixel"])
    screen.page.mouse.move(*screen.on_screen(others[1]["pixel"]))
    screen.press("r")
    screen.press("Escape")
    screen.press("0")
    plain = screen.painted("#overlay-canvas")
    screen.press("s")

    screen.wait("linecad.store.state.contradiction !== null")
    screen.settle()
    contradiction = screen.state["contradiction"]
    assert set(contradiction["crossings"]) == {first, second, others[0]["id"], others[1]["id"]}
    assert drawn in contradiction["lines"]
    assert screen.page.get_by_text(contradiction["text"]).is_visible()
    assert screen.painted("#overlay-canvas") > plain + 1000
    screen.button("Show it").click()
    assert screen.run("linecad.store.selection.kind") == "crossing"
    screen.button("Undo the last change").click()
    screen.page.get_by_text(contradiction["text"]).wait_for(state="detached")


def test_labelling_goes_from_one_crossing_to_the_next(screen):
    screen.press("l")
    order = screen.state["labelling"]["order"]
    for number, (key, value) in enumerate((("r", "real"), ("f", "fake"), ("u", "unsure"))):
        screen.wait(f"linecad.store.selection?.id === {order[number]}")
        at = screen.on_screen(by_id(screen.state, "crossings", order[number])["pixel"])
        stage = screen.stage
        assert at == pytest.approx((stage["x"] + stage["width"] / 2, stage["y"] + stage["height"] / 2), abs=1)
        screen.press(key)
        screen.wait(f"linecad.store.state.labelling.done === {number + 1}")
        assert by_id(screen.served.ask("state"), "crossings", order[number])["label"] == value
    screen.page.keyboard.type("rr")  # faster than the server answers
    screen.settle()
    state = screen.served.ask("state")
    assert [by_id(state, "crossings", each)["label"] for each in order[3:6]] == ["real", "real", None]
    assert f"5 of {len(order)} labelled" in screen.page.locator("#inspector").inner_text()
    screen.press("l")
    assert screen.run("linecad.store.labelling") is False


def test_an_export_is_the_file_that_linecad_export_writes(screen, tmp_path):
    for name in ("json", "dxf", "glb"):
        screen.press("e")
        with screen.page.expect_download() as download:
            screen.page.locator(f"[data-format={name}]").click()
        assert download.value.suggested_filename == f"boxes.{name}"
        download.value.save_as(tmp_path / f"page.{name}")
    scene = read_scene(tmp_path / "page.json")
    lines = screen.served.ask("state")["lines"]
    known, solved = ([each["segment"] for each in lines if each["ends"] or every] for every in (True, False))
    # What faces added is in the file, also as a piece of a line, and nothing that a person can correct.
    of_page = np.flatnonzero(~scene.lines.by_face).tolist()
    pieces = [[each.tolist() for each in scene.lines.segments_of(row)] for row in of_page]
    assert sorted(solved) == sorted(each for own in pieces for each in own if each in known)
    assert all(any(each in solved for each in own) for own in pieces)
    photo = read_photo(screen.served.photo, screen.served.photo.with_suffix(".json"), None)
    for name in ("dxf", "glb"):
        export(scene, tmp_path / f"command.{name}", photo.pixels)
        assert (tmp_path / f"page.{name}").read_bytes() == (tmp_path / f"command.{name}").read_bytes()


def test_a_reload_and_a_killed_server_bring_everything_back(new_screen, start):
    first = new_screen(start())
    first.open()
    for crossing in apart(first.state["crossings"])[:3]:
        first.click(crossing["pixel"])
    said = decided(first.state)
    assert len(said) == 3
    first.page.reload()
    first.page.wait_for_selector("body[data-ready=yes]")
    assert decided(first.state) == said
    assert first.run("linecad.store.owner")
    first.page.get_by_text("Saved", exact=True).wait_for()
    first.served.end(signal.SIGKILL)
    second = new_screen(start(photo=first.served.photo))
    second.page.goto(second.served.address)
    second.page.wait_for_selector("body[data-ready=yes]")
    assert decided(second.state) == said
    # What is asked first tells it for some seconds, the tab then for as long as it holds: one of them at a time.
    first.run("linecad.actions.undo()")
    first.page.locator("#notices").get_by_text("does not answer").wait_for()
    first.run("linecad.actions.undo()")
    first.page.wait_for_timeout(200)
    assert first.page.get_by_text("does not answer").count() == 1
    first.page.goto("about:blank")
    # It refuses what is asked after its end, and what is under way then is reset.
    gone = ("ERR_CONNECTION_REFUSED", "ERR_CONNECTION_RESET")
    first.complaints = [text for text in first.complaints if not any(each in text for each in gone)]


def test_a_search_tells_how_far_it_is_and_stop_keeps_the_best(new_screen, start, long_search):
    slow = new_screen(
        start("--option", "extension=200", "--option", "formulation=gain", "--time-limit", "120", photo=long_search)
    )
    slow.page.goto(slow.served.address)
    slow.wait("globalThis.linecad?.store.solve.state === 'running'")
    slow.page.get_by_text("bound").wait_for()
    assert "gap" in slow.page.locator("#solve-text").inner_text()
    slow.button("Stop").click()
    slow.wait("linecad.store.state.solve.status !== null")
    assert slow.state["solve"]["status"] == "interrupted"
    assert any(line["ends"] for line in slow.state["lines"])
