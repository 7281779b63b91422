"""The photo side of the page: drawing, ends that are dragged, many things at once, keys in place of the pointer."""

import itertools

import numpy as np
import pytest

from tests.linecad.editing.browser.test_page_edits import by_id, decided, free_place, longest

pytestmark = pytest.mark.thorough  # every day the server is asked what the page asks it (test_server.py)


def beside(state, axis="z", away=45.0):
    """Both ends of a line that could be drawn beside the longest one of an axis, px."""
    start, end = (np.array(each) for each in longest(state, axis)["segment"])
    across = np.array([[0, -1], [1, 0]]) @ (end - start) / np.linalg.norm(end - start)
    return 0.8 * start + 0.2 * end + away * across, 0.2 * start + 0.8 * end + away * across


def drag(screen, start, end, button="left"):
    screen.page.mouse.move(*start)
    screen.page.mouse.down(button=button)
    screen.page.mouse.move(*end, steps=4)
    screen.page.mouse.up(button=button)
    screen.settle()


def drawn(state):
    return [each for each in state["lines"] if each["origin"] == "drawn"]


def selected(screen):
    return screen.run("linecad.store.selection")


def inspector(screen):
    return screen.page.locator("#inspector").inner_text()


class TestDrawing:
    def test_a_drawn_line_is_selected_and_its_axis_can_be_changed_at_once(self, screen):
        start, end = map(screen.on_screen, beside(screen.state))
        screen.press("d")
        drag(screen, start, end)
        screen.wait("linecad.store.selection !== null")
        (line,) = drawn(screen.state)
        assert selected(screen) == {"kind": "line", "id": line["id"]}
        assert "drawn by you" in inspector(screen)
        screen.press("y")
        (line,) = drawn(screen.state)
        assert (line["axis"], selected(screen)["id"]) == ("y", line["id"])

    def test_a_line_far_off_every_axis_is_asked_about_and_not_bent(self, screen):
        """It was turned by up to 15 degrees to the nearest axis without a word."""
        before = screen.served.ask("state")
        start, end = beside(screen.state)
        middle, turn = (start + end) / 2, np.radians(14.0)
        rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
        ends = [screen.on_screen(middle + rotation @ (at - middle)) for at in (start, end)]
        screen.press("d")
        drag(screen, *ends)
        screen.wait("linecad.draft.question !== null")
        assert "Along which axis does this line run?" in inspector(screen)
        assert screen.served.ask("state")["lines"] == before["lines"]
        shown = screen.run("linecad.draft.question.ends")
        assert [screen.on_screen(at) for at in shown] == [pytest.approx(at, abs=1) for at in ends]
        screen.press("Control+z")  # back to the first end
        assert screen.run("[linecad.draft.points.length, linecad.draft.question]") == [1, None]
        screen.press("Control+Shift+z")
        screen.press("Escape")
        drag(screen, *ends)
        screen.wait("linecad.draft.question !== null")
        screen.press("z")
        screen.wait("linecad.store.selection !== null")
        assert [each["axis"] for each in drawn(screen.state)] == ["z"]

    def test_the_page_says_what_an_end_snaps_to_before_it_is_clicked(self, screen):
        line = longest(screen.state, "x")
        near = np.add(screen.on_screen(line["segment"][0]), [3, 2])
        screen.press("d")
        screen.page.mouse.move(*near)
        screen.wait("linecad.draft.start !== null")
        snap = screen.run("linecad.draft.start.snapped[0]")
        assert snap["is_end"]
        screen.settle()
        assert f"end of line {snap['line']}" in inspector(screen)
        painted = screen.painted("#overlay-canvas")
        screen.page.mouse.click(*near)
        end = by_id(screen.state, "lines", snap["line"])["segment"]
        point = screen.run("linecad.draft.points[0]")
        assert np.linalg.norm(np.subtract(end, point), axis=1).min() < 1e-6
        assert painted > 300  # words and a knob

    def test_with_ctrl_nothing_snaps(self, screen):
        line = longest(screen.state, "x")
        near = np.add(screen.on_screen(line["segment"][0]), [3, 2])
        screen.press("d")
        screen.page.keyboard.down("Control")
        screen.page.mouse.click(*near)
        screen.page.keyboard.up("Control")
        assert screen.run("linecad.draft.points[0]") == pytest.approx(screen.in_photo(near), abs=1e-3)


class TestHandles:
    @pytest.fixture
    def line(self, screen):
        """The longest line along z, selected."""
        line = longest(screen.state, "z")
        screen.press("v")
        screen.click(free_place(screen.state, line))
        assert selected(screen) == {"kind": "line", "id": line["id"]}
        return line

    def test_an_end_is_dragged_along_its_line(self, screen, line):
        start, end = (np.array(each) for each in line["segment"])
        wanted = end + 0.4 * (start - end)
        viewport = screen.run("({...linecad.photo.viewport})")
        drag(screen, screen.on_screen(end), np.add(screen.on_screen(wanted), [5, 0]))
        now = by_id(screen.served.ask("state"), "lines", line["id"])["segment"]
        assert now[0] == pytest.approx(line["segment"][0])
        along = (end - start) / np.linalg.norm(end - start)
        place = (np.array(now[1]) - start) @ along
        assert np.linalg.norm(start + place * along - now[1]) < 1e-6
        assert place == pytest.approx(0.6 * np.linalg.norm(end - start), abs=30)  # it may have snapped
        assert screen.run("({...linecad.photo.viewport})") == viewport  # the photo has not moved
        assert screen.run("linecad.draft.stretched") is None
        screen.press("Control+z")
        assert by_id(screen.served.ask("state"), "lines", line["id"]) == line

    def test_a_click_on_an_end_drags_nothing(self, screen, line):
        screen.click(line["segment"][1])
        assert screen.served.ask("state")["undo"] == 0

    def test_an_end_that_is_dragged_past_the_other_is_put_back_with_a_reason(self, screen, line):
        start, end = (np.array(each) for each in line["segment"])
        screen.page.mouse.move(*screen.on_screen(end))
        screen.page.mouse.down()
        screen.page.mouse.move(*screen.on_screen(start + 0.02 * (start - end)), steps=4)
        screen.page.wait_for_timeout(500)  # the last question is answered
        screen.page.mouse.up()
        screen.settle()
        screen.page.get_by_text("the line would be shorter than").wait_for()
        assert screen.served.ask("state")["undo"] == 0
        assert screen.run("linecad.draft.stretched") is None

    def test_keys_hold_an_end_and_let_it_go(self, screen, line):
        screen.press("w")
        screen.page.mouse.move(*screen.on_screen(line["segment"][1]))
        screen.press("Shift+C")
        screen.press("Shift+Enter")
        for _ in range(4):
            screen.press("ArrowUp")
        screen.press("Escape")  # lets go, and changes nothing
        assert screen.served.ask("state")["undo"] == 0
        screen.run("(pixel) => linecad.photo.change((viewport) => viewport.centre(pixel))", line["segment"][1])
        screen.press("Shift+C")
        screen.page.mouse.move(*screen.on_screen(line["segment"][1]))
        screen.press("Shift+C")
        screen.press("Shift+Enter")
        for _ in range(4):
            screen.press("ArrowUp")
        screen.press("Enter")
        state = screen.served.ask("state")
        assert state["undo"] == 1
        assert by_id(state, "lines", line["id"])["segment"] != line["segment"]


class TestMany:
    def enclose(self, screen, left, top, right, bottom):
        screen.press("v")
        drag(screen, screen.on_screen((left, top)), screen.on_screen((right, bottom)))

    def inside(self, state, left, top, right, bottom):
        def holds(pixel):
            return left <= pixel[0] <= right and top <= pixel[1] <= bottom

        lines = {each["id"] for each in state["lines"] if all(map(holds, each["segment"]))}
        return lines, {each["id"] for each in state["crossings"] if holds(each["pixel"])}

    BOX = (300.5, 200.5, 900.5, 800.5)

    def test_a_rectangle_selects_what_it_holds_also_what_is_not_drawn(self, screen):
        self.enclose(screen, *self.BOX)
        lines, crossings = self.inside(screen.state, *self.BOX)
        many = screen.run("linecad.store.many")
        assert (set(many["lines"]), set(many["crossings"])) == (lines, crossings)
        assert len(crossings) > 3
        assert f"{len(lines)} lines, {len(crossings)} crossings" in inspector(screen)
        screen.press("Escape")
        assert screen.run("linecad.store.many") is None

    def test_one_key_labels_all_and_one_undo_takes_it_back(self, screen):
        self.enclose(screen, *self.BOX)
        _, crossings = self.inside(screen.state, *self.BOX)
        for key, value in (("f", "fake"), ("u", "unsure"), ("r", "real")):
            screen.press(key)
            assert decided(screen.served.ask("state")) == dict.fromkeys(crossings, value)
        screen.press("g")
        assert decided(screen.served.ask("state")) == {}
        assert screen.served.ask("state")["undo"] == 4
        screen.press("Control+z")
        assert decided(screen.served.ask("state")) == dict.fromkeys(crossings, "real")

    def test_what_is_shown_at_once_is_what_the_server_answers(self, screen):
        before = screen.served.ask("state")
        lines, crossings = self.inside(before, *self.BOX)
        edits = [{"op": "label", "crossing": each, "value": "fake"} for each in sorted(crossings)]
        edits += [{"op": "delete", "line": line} for line in sorted(lines)]
        script = """async ([state, edit]) => (await import("/page/editing.js")).expected(state, edit)"""
        shown = screen.run(script, [before, {"op": "many", "edits": edits}])
        answer = screen.served.ask("edit", {"base_version": before["version"], "edit": {"op": "many", "edits": edits}})
        assert [each["id"] for each in shown["lines"]] == [each["id"] for each in answer["lines"]]
        labels = {each["id"]: each["label"] for each in shown["crossings"]}
        assert labels == {each["id"]: each["label"] for each in answer["crossings"]}
        assert "fake" in labels.values()

    def test_all_lines_get_an_axis_or_go_in_one_step(self, screen):
        before = screen.served.ask("state")
        self.enclose(screen, *self.BOX)
        lines, _ = self.inside(before, *self.BOX)
        screen.press("Delete")
        state = screen.served.ask("state")
        assert {each["id"] for each in before["lines"]} - {each["id"] for each in state["lines"]} == lines
        assert state["undo"] == 1
        screen.press("Control+z")
        assert screen.served.ask("state")["lines"] == before["lines"]

    def test_shift_adds_and_takes_away(self, screen):
        lines = [longest(screen.state, axis) for axis in "xz"]
        screen.press("v")
        screen.click(free_place(screen.state, lines[0]))
        screen.page.keyboard.down("Shift")
        screen.click(free_place(screen.state, lines[1]))
        assert screen.run("linecad.store.many") == {"lines": [each["id"] for each in lines], "crossings": []}
        screen.click(free_place(screen.state, lines[0]))
        screen.page.keyboard.up("Shift")
        assert selected(screen) == {"kind": "line", "id": lines[1]["id"]}
        assert screen.run("linecad.store.many") is None


class TestCrossings:
    def test_they_thin_out_until_one_zooms_in(self, screen):
        count = "linecad.store.state.crossings.filter((one) => linecad.store.drawsCrossing(one, {scale})).length"
        fit = screen.run("linecad.photo.viewport.scale")
        total = len(screen.state["crossings"])
        counts = [screen.run(count.format(scale=scale)) for scale in (fit, 2 * fit, 8 * fit, 64)]
        assert counts == sorted(counts)
        assert counts[0] < 0.9 * total
        assert counts[-1] == total

    def test_no_two_that_are_drawn_cover_each_other(self, screen):
        drawn = screen.run(
            """() => {
              const { store, photo } = linecad;
              return store.state.crossings.filter((one) => store.drawsCrossing(one, photo.viewport.scale));
            }"""
        )
        pixels = np.array([each["pixel"] for each in drawn])
        away = np.linalg.norm(pixels[:, None] - pixels, axis=2) + np.where(np.eye(len(pixels)), np.inf, 0)
        assert away.min() * screen.run("linecad.photo.viewport.scale") >= 20 - 1e-6

    def test_the_more_important_of_two_that_are_close_is_drawn(self, screen):
        order = screen.run(
            """async () => {
              const { reaches } = await import("/page/thinning.js");
              const line = (id, length) => ({ id, segment: [[0, 0], [length, 0]] });
              const lines = [line(1, 100), line(2, 100), line(3, 9)];
              const at = (id, lines, u) => ({ id, lines, pixel: [u, 0] });
              const found = reaches([at(7, [1, 3], 0), at(8, [1, 2], 3), at(9, [2, 3], 400)], lines);
              return [7, 8, 9].map((id) => found.get(id));
            }"""
        )
        assert order[1] == order[2] > 3 >= order[0]

    def test_a_click_beside_a_mark_selects_the_line_and_flips_nothing(self, screen):
        """Up to 10 px beside a crossing a click that meant its line turned the crossing."""
        state = screen.state
        scale = screen.run("linecad.photo.viewport.scale")
        for crossing in state["crossings"]:
            line = by_id(state, "lines", crossing["lines"][0])
            start, end = np.array(line["segment"])
            along = (end - start) / np.linalg.norm(end - start)
            foot = start + ((crossing["pixel"] - start) @ along) * along
            place = foot + 9 / scale * along
            others = [np.linalg.norm(np.subtract(each["pixel"], place)) * scale for each in state["crossings"]]
            inside = 0 < (place - start) @ along < np.linalg.norm(end - start)
            if inside and np.linalg.norm(foot - crossing["pixel"]) * scale < 2 and sorted(others)[:2][-1] > 12:
                break
        else:
            pytest.fail("no crossing stands alone")
        screen.click(place)
        assert screen.served.ask("state")["undo"] == 0
        assert selected(screen)["kind"] == "line"
        screen.click(crossing["pixel"])
        assert decided(screen.served.ask("state")) == {crossing["id"]: "fake" if crossing["real"] else "real"}

    def test_what_is_not_drawn_cannot_be_clicked(self, screen):
        hidden = screen.run(
            """() => {
              const { store, photo } = linecad;
              const { scale } = photo.viewport;
              const draws = (one) => store.drawsCrossing(one, scale);
              const near = (one) => (other) =>
                Math.hypot(one.pixel[0] - other.pixel[0], one.pixel[1] - other.pixel[1]) * scale < 12;
              const { crossings } = store.state;
              return crossings.find((one) => !draws(one) && !crossings.filter(draws).some(near(one)))?.pixel ?? null;
            }"""
        )
        assert hidden is not None
        screen.click(hidden)
        assert screen.served.ask("state")["undo"] == 0


class TestMoving:
    def test_a_horizontal_wheel_and_a_trackpad_move_the_photo(self, screen):
        screen.page.mouse.move(screen.stage["x"] + 300, screen.stage["y"] + 300)
        screen.press("+")
        screen.press("+")
        before = screen.run("({...linecad.photo.viewport})")
        screen.page.mouse.wheel(60, 0)
        screen.settle()
        now = screen.run("({...linecad.photo.viewport})")
        assert (now["x"], now["y"], now["scale"]) == (before["x"] - 60, before["y"], before["scale"])
        screen.page.wait_for_timeout(300)  # another gesture
        # In one go: a slow machine would put a pause between them, after which the last is a wheel's.
        screen.run(
            """() => {
              const canvas = document.querySelector("#overlay-canvas");
              for (const deltaY of [4, 20, 70])
                canvas.dispatchEvent(new WheelEvent("wheel", { deltaY, bubbles: true, cancelable: true }));
            }"""
        )
        screen.settle()
        now = screen.run("({...linecad.photo.viewport})")
        assert (now["y"], now["scale"]) == (before["y"] - 94, before["scale"])
        screen.page.wait_for_timeout(300)
        screen.page.mouse.wheel(0, -120)
        screen.settle()
        assert screen.run("linecad.photo.viewport.scale") > before["scale"]

    def test_two_fingers_zoom_where_they_are_and_draw_nothing(self, screen):
        screen.press("d")
        before = screen.run("linecad.photo.viewport.scale")
        touch = """(steps) => {
          const canvas = document.querySelector("#overlay-canvas");
          const { left, top } = canvas.getBoundingClientRect();
          canvas.setPointerCapture = () => {};
          for (const [type, pointerId, x, y] of steps) {
            const at = { clientX: left + x, clientY: top + y, pointerId, pointerType: "touch", bubbles: true };
            canvas.dispatchEvent(new PointerEvent(type, { ...at, isPrimary: pointerId === 11 }));
          }
        }"""
        middle = (300, 300)
        kept = screen.run("(at) => linecad.photo.viewport.toPhoto(at)", middle)
        steps = [("pointerdown", 11, 280, 300), ("pointerdown", 12, 320, 300)]
        steps += [("pointermove", 11, 260, 300), ("pointermove", 12, 340, 300)]
        steps += [("pointerup", 11, 260, 300), ("pointerup", 12, 340, 300)]
        screen.run(touch, steps)
        screen.settle()
        assert screen.run("linecad.photo.viewport.scale") == pytest.approx(2 * before)
        assert screen.run("(at) => linecad.photo.viewport.toPhoto(at)", middle) == pytest.approx(kept, abs=1e-6)
        assert screen.run("linecad.draft.points.length") == 0


class TestKeys:
    def test_keys_go_from_the_longest_line_to_the_next_and_back(self, screen):
        def length(line):
            return np.linalg.norm(np.subtract(*line["segment"]))

        order = sorted(screen.state["lines"], key=lambda line: (-length(line), line["id"]))
        for number in range(3):
            screen.press("PageDown")
            assert selected(screen)["id"] == order[number]["id"]
        screen.press("PageUp")
        assert selected(screen)["id"] == order[1]["id"]
        screen.press("Escape")
        screen.press("PageUp")
        assert selected(screen)["id"] == order[-1]["id"]

    @pytest.mark.parametrize(("key", "x", "y"), [("ArrowRight", 1, 0), ("ArrowUp", 0, -1)])
    def test_with_shift_an_arrow_selects_the_nearest_line_that_way(self, screen, key, x, y):
        middles = {line["id"]: np.mean(line["segment"], axis=0) for line in screen.state["lines"]}
        first = min(middles, key=lambda line: middles[line] @ (x, y))
        screen.run("(id) => linecad.store.set({ selection: { kind: 'line', id } })", first)
        seen = [first]
        for _ in range(3):
            screen.press(f"Shift+{key}")
            seen.append(selected(screen)["id"])
        for one, other in itertools.pairwise(seen):
            step = middles[other] - middles[one]
            assert step @ (x, y) >= abs(step @ (-y, x))
            assert one != other

    def test_a_line_is_drawn_by_keys_alone(self, screen):
        start, end = beside(screen.state)
        screen.press("d")
        screen.press("Shift+C")
        self.go(screen, start)
        screen.press("Enter")
        assert screen.run("linecad.draft.points.length") == 1
        self.go(screen, end)
        screen.press("Enter")
        screen.wait("linecad.store.selection !== null")
        (line,) = drawn(screen.state)
        assert line["axis"] == "z"
        scale = screen.run("linecad.photo.viewport.scale")
        for at in (start, end):
            assert np.linalg.norm(np.subtract(line["segment"], at), axis=1).min() * scale < 22  # it may have snapped
        screen.press("Escape")
        assert screen.run("linecad.photo.crosshair") is None

    def test_the_cross_hair_clicks_crossings_too(self, screen):
        fit = screen.run("linecad.photo.viewport.scale")
        crossing = next(
            each
            for each in screen.state["crossings"]
            if each["real"] and screen.run("([one, scale]) => linecad.store.drawsCrossing(one, scale)", [each, fit])
        )
        screen.press("Shift+C")
        self.go(screen, crossing["pixel"])
        screen.press("Enter")
        assert decided(screen.served.ask("state")) == {crossing["id"]: "fake"}

    def go(self, screen, pixel):
        """Move the cross-hair to a pixel, roughly and then px by px."""
        for step, shift in ((12, ""), (1, "Shift+")):
            at = screen.run("linecad.photo.crosshair")
            wanted = screen.run("(pixel) => linecad.photo.viewport.toScreen(pixel)", list(pixel))
            arrows = (("ArrowLeft", "ArrowRight"), ("ArrowUp", "ArrowDown"))
            for away, keys in zip(np.subtract(wanted, at), arrows, strict=True):
                for _ in range(int(abs(away) / step + 0.5)):
                    screen.page.keyboard.press(shift + keys[int(away > 0)])
        screen.settle()
