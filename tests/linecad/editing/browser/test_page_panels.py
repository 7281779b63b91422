"""The page's panels in a browser: lengths, groups, legends, notes, small windows, themes, what a reload keeps."""

import json
from itertools import pairwise

import numpy as np
import pytest

pytestmark = pytest.mark.thorough  # every day the parts that decide are asked (test_groups.py, test_telling.py)

READ = "import('/page/lengths.js').then(({ readLength }) => %s.map((text) => readLength(text)))"
CONTRAST = """() => {
  const parse = (colour) => {
    const numbers = colour.match(/[\\d.]+/g).map(Number);
    return colour.startsWith("color(srgb") ? [...numbers.slice(0, 3).map((at) => 255 * at), numbers[3] ?? 1]
      : [...numbers.slice(0, 3), numbers[3] ?? 1];
  };
  const over = (top, below) => below.map((at, k) => (k < 3 ? top[k] * top[3] + at * (1 - top[3]) : 1));
  const backOf = (each) => {
    const layers = [];
    for (let at = each; at; at = at.parentElement) layers.push(parse(getComputedStyle(at).backgroundColor));
    return layers.reverse().reduce((below, top) => over(top, below), [255, 255, 255, 1]);
  };
  const light = ([r, g, b]) => {
    const linear = (at) => (at <= 0.04045 ? at / 12.92 : ((at + 0.055) / 1.055) ** 2.4);
    const [x, y, z] = [r, g, b].map((at) => linear(at / 255));
    return 0.2126 * x + 0.7152 * y + 0.0722 * z;
  };
  const found = [];
  for (const each of document.querySelectorAll("body *")) {
    const words = [...each.childNodes].filter((node) => node.nodeType === 3 && node.data.trim()).length > 0;
    if (!words || each.closest(":disabled, noscript, svg") || !each.checkVisibility()) continue;
    const back = backOf(each);
    const ink = over(parse(getComputedStyle(each).color), back);
    const [high, low] = [light(ink), light(back)].sort((a, b) => b - a);
    const name = `${each.tagName} ${each.className} ${each.textContent.trim().slice(0, 30)}`;
    found.push([(high + 0.05) / (low + 0.05), name]);
  }
  return found;
}"""
CUT_OFF = """() => {
  const wide = document.documentElement.clientWidth;
  const clipped = (each, { left, right, top, bottom }) => {
    for (let at = each.parentElement; at && at !== document.body; at = at.parentElement) {
      const style = getComputedStyle(at);
      const box = at.getBoundingClientRect();
      if (style.overflowX === "hidden" && (right > box.right + 1 || left < box.left - 1)) return true;
      if (style.overflowY === "hidden" && (bottom > box.bottom + 1 || top < box.top - 1)) return true;
    }
    return right > wide + 1 || left < -1;
  };
  const all = [...document.querySelectorAll("button, input, summary, output:not(:empty), .pane-bar label")];
  return all
    .filter((each) => each.checkVisibility())
    .filter((each) => clipped(each, each.getBoundingClientRect()))
    .map((each) => each.outerHTML.slice(0, 80));
}"""
OVERLAPPING = """() => {
  const names = [
    ".bar button", ".bar output:not(:empty)", ".pane-bar button", ".tools button", ".inspector p", ".inspector .legend",
  ];
  const all = [...document.querySelectorAll(names.join())].filter((each) => each.checkVisibility());
  const pairs = [];
  all.forEach((one, index) => all.slice(index + 1).forEach((other) => {
    if (one.contains(other) || other.contains(one)) return;
    const [a, b] = [one.getBoundingClientRect(), other.getBoundingClientRect()];
    const across = Math.min(a.right, b.right) - Math.max(a.left, b.left);
    const down = Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top);
    if (across > 1 && down > 1) pairs.push([one.outerHTML.slice(0, 60), other.outerHTML.slice(0, 60)]);
  }));
  return pairs;
}"""


@pytest.fixture
def screen(screen):
    """The shared page; its lists are closed and its groups as they were when a test ends, however it does."""
    yield screen
    screen.run(
        """() => {
          for (const name of ["groups", "notes"]) {
            const button = document.getElementById(name);
            if (button.getAttribute("aria-expanded") === "true") button.click();
          }
          linecad.store.set({ unseen: new Set(), locked: new Set() });
        }"""
    )


MENU = """() => [...document.querySelectorAll("#export-list button")].filter((each) => {
  const name = each.querySelector("b");
  const menu = document.querySelector("#export-list").getBoundingClientRect();
  const text = document.createRange();
  text.selectNode(each.lastChild);
  const [left, right] = [name.getBoundingClientRect(), text.getBoundingClientRect()];
  const isInside = right.right <= menu.right + 1 && menu.right <= document.documentElement.clientWidth + 1;
  return name.scrollWidth > name.clientWidth || left.right > right.left || !isInside;
}).map((each) => each.textContent)"""


def set_state(screen, change):
    """Show the state as it would be after `change`, a function of JavaScript that alters a copy."""
    screen.run(
        f"""() => {{
          const {{ store }} = linecad;
          const state = structuredClone(store.state);
          ({change})(state);
          store.set({{ state }});
        }}"""
    )
    screen.settle()


def by_hand(screen):
    """The server's own state again."""
    screen.run("linecad.editing.refresh()")
    screen.settle()


def line_in_model(screen):
    return next(each for each in screen.state["lines"] if each["ends"])


class TestLengths:
    @pytest.mark.parametrize(
        ("text", "metres"),
        [
            ("3.5", 3.5), ("3,5", 3.5), (" 3,5 m ", 3.5), ("350cm", 3.5), ("3500 mm", 3.5), ("12 ft", 3.6576),
            ("3'6\"", 1.0668), ("3\u2032 6 1/2\u2033", 1.0795), ("3 ft 6 in", 1.0668), ("6 1/2 in", 0.1651),
            ("1,234.5", 1234.5), ("1.234,5", 1234.5), ("0,125", 0.125), ("0.2 km", 200.0),
        ],
    )  # fmt: skip
    def test_commas_and_units_are_understood(self, screen, text, metres):
        """`3,5` once became 35 m."""
        (read,) = screen.run(READ % "[%r]" % text)
        assert read == {"metres": pytest.approx(metres)}

    @pytest.mark.parametrize(
        "text", ["1,234", "abc", "-3", "3,5,6", "1e3", "3 m 20", "1/0 in", "0", "200 km", "3.5.1 m"]
    )
    def test_what_can_be_read_in_two_ways_or_in_none_is_refused_in_one_line(self, screen, text):
        (read,) = screen.run(READ % "[%r]" % text)
        assert list(read) == ["error"]
        assert "\n" not in read["error"]

    def test_a_comma_gives_the_scale_it_says_and_the_length_can_be_forgotten(self, screen):
        line = line_in_model(screen)
        open_length(screen, line["id"])
        field = screen.page.get_by_label("Length", exact=True)
        field.fill("3,5")
        assert screen.page.locator("#length-read").inner_text() == "= 3.5 m"
        field.press("Enter")
        screen.wait("linecad.store.state.metres_per_unit !== null")
        units = np.linalg.norm(np.subtract(*line["ends"]))
        assert screen.served.ask("state")["metres_per_unit"] * units == pytest.approx(3.5, rel=1e-6)
        assert "known to be 3.5 m" in screen.page.locator("#inspector").inner_text()
        open_length(screen, line["id"])
        screen.button("Forget it").click()
        screen.wait("linecad.store.state.metres_per_unit === null")

    def test_nothing_is_sent_while_it_cannot_be_read(self, screen):
        open_length(screen, line_in_model(screen)["id"])
        screen.page.get_by_label("Length", exact=True).fill("three")
        assert "is no length" in screen.page.locator("#length-read").inner_text()
        assert screen.button("Set the scale").is_disabled()
        screen.page.keyboard.press("Enter")
        assert screen.page.locator("#length-dialog").is_visible()
        screen.button("Cancel").click()
        assert screen.served.ask("state")["undo"] == 0

    def test_a_length_that_sets_nothing_says_so_at_once(self, screen):
        """On a weak group it promised the scale of all other lines."""
        line = line_in_model(screen)
        set_state(screen, f"(state) => (state.lines.find(({{ id }}) => id === {line['id']}).sets_scale = false)")
        open_length(screen, line["id"])
        text = screen.page.locator("#length-dialog").inner_text()
        assert "is a guess" in text
        assert "sets no scale now" in text
        assert screen.button("Keep it").is_visible()
        screen.button("Cancel").click()
        by_hand(screen)


def open_length(screen, line):
    screen.run("(id) => linecad.store.set({ selection: { kind: 'line', id } })", line)
    screen.press("m")


class TestStrip:
    def test_keys_act_on_the_crossing_that_the_strip_shows(self, screen):
        """The strip showed the selected crossing, and the key changed the one under the pointer."""
        one, other = apart(screen)
        screen.run("(id) => linecad.store.set({ selection: { kind: 'crossing', id } })", one["id"])
        screen.page.mouse.move(*screen.on_screen(other["pixel"]))
        screen.settle()
        assert names(other) in screen.page.locator("#inspector").inner_text()
        screen.press("u")
        labels = {each["id"]: each["label"] for each in screen.served.ask("state")["crossings"]}
        assert (labels[one["id"]], labels[other["id"]]) == (None, "unsure")

    def test_keys_for_lines_leave_a_line_alone_that_the_strip_does_not_show(self, screen):
        line, crossing = line_in_model(screen), apart(screen)[0]
        screen.run("(id) => linecad.store.set({ selection: { kind: 'line', id } })", line["id"])
        screen.page.mouse.move(*screen.on_screen(crossing["pixel"]))
        screen.settle()
        assert names(crossing) in screen.page.locator("#inspector").inner_text()
        screen.press("Delete")
        assert screen.served.ask("state")["undo"] == 0
        screen.page.mouse.move(2, 2)
        screen.settle()
        assert f"Line {line['id']}" in screen.page.locator("#inspector").inner_text()
        screen.press("Delete")
        assert screen.served.ask("state")["undo"] == 1


def names(crossing):
    return f"of lines {crossing['lines'][0]} ("


def apart(screen):
    """Two crossings that no other is near to, of different lines of the main group."""
    main = {each["id"] for each in screen.state["lines"] if each["component"] == 0}
    found = [each for each in screen.state["crossings"] if main.issuperset(each["lines"])]
    pixels = np.array([each["pixel"] for each in found])
    away = np.linalg.norm(pixels[:, None] - pixels, axis=2) + 1e9 * np.eye(len(found))
    order = np.argsort(-away.min(axis=1))
    first = found[order[0]]
    second = next(found[k] for k in order[1:] if found[k]["lines"][0] != first["lines"][0])
    return first, second


class TestGroups:
    def test_a_hidden_group_is_gone_in_both_views_and_cannot_be_met(self, screen):
        before, faces = screen.painted("#drawing-canvas"), screen.page.locator("#model-canvas").screenshot()
        crossing = apart(screen)[0]
        screen.button("Groups").click()
        screen.page.get_by_role("button", name="Hide Main group").click()
        screen.settle()
        assert screen.painted("#drawing-canvas") < 0.5 * before
        assert screen.page.locator("#model-canvas").screenshot() != faces
        screen.page.mouse.move(*screen.on_screen(crossing["pixel"]))
        screen.settle()
        assert screen.run("linecad.store.hover") is None
        assert screen.served.ask("state")["undo"] == 0
        screen.page.get_by_role("button", name="Hide Main group").click()
        screen.button("Groups").click()
        screen.settle()
        assert screen.painted("#drawing-canvas") == pytest.approx(before, rel=0.005)

    def test_a_locked_group_is_not_edited(self, screen):
        line = next(each for each in screen.state["lines"] if each["component"] == 0)
        crossing = next(each for each in screen.state["crossings"] if line["id"] in each["lines"])
        lock = screen.page.get_by_role("button", name="Lock Main group")
        screen.button("Groups").click()
        lock.click()
        for edit in (
            {"op": "label", "crossing": crossing["id"], "value": "fake"},
            {"op": "delete", "line": line["id"]},
            {"op": "join", "lines": [line["id"], line["id"] + 1]},
        ):
            assert screen.run("(edit) => linecad.editing.edit(edit)", edit) is False
        screen.page.get_by_text("Main group is locked").first.wait_for()
        assert screen.served.ask("state")["undo"] == 0
        lock.click()
        assert screen.run("(edit) => linecad.editing.edit(edit)", {"op": "delete", "line": line["id"]}) is True
        screen.button("Groups").click()

    def test_a_name_is_written_kept_and_undone(self, screen):
        screen.button("Groups").click()
        screen.page.get_by_role("button", name="Rename Main group").click()
        field = screen.page.get_by_label("Name of Main group")
        field.fill("The house")
        field.press("Enter")
        screen.settle()
        assert screen.served.ask("state")["groups"][0]["name"] == "The house"
        assert screen.button("Hide The house").is_visible()
        screen.press("Control+z")
        assert screen.served.ask("state")["groups"][0]["name"] == "Main group"
        screen.button("Groups").click()


class TestLegendsAndNotes:
    def test_legends_tell_what_dashes_are_and_fold_away(self, screen):
        for side, text in (("photo", "dashed: its depth is a guess"), ("model", "dashed and pale: depth is a guess")):
            legend = screen.page.locator(f"#{side}-legend")
            assert not legend.get_by_text(text).is_visible()
            legend.locator("summary").click()
            assert legend.get_by_text(text).is_visible()
            legend.locator("summary").click()

    def test_guesses_are_dashed_and_pale_in_the_model(self, screen):
        sure = screen.page.locator("#model-canvas").screenshot()
        pieces = screen.run(
            """() => import("/page/dashes.js").then(({ dashed }) => {
              const line = { ends: [[0, 0, 0], [4, 0, 0]], axis: "x" };
              return dashed(line, 8).map(({ ends, axis }) => [ends[0][0], ends[1][0], axis]);
            })"""
        )
        assert pieces[0][0] == 0
        assert pieces[-1][1] == pytest.approx(4)
        assert all(piece[1] > piece[0] and piece[2] == "x" for piece in pieces)
        assert all(before[1] < after[0] for before, after in pairwise(pieces))
        all_guesses = """(state) => {
          for (const line of state.lines) line.guess = true;
          for (const plane of state.planes) for (const face of plane.faces) face.guess = true;
        }"""
        set_state(screen, all_guesses)
        assert screen.page.locator("#model-canvas").screenshot() != sure
        by_hand(screen)

    def test_the_number_on_the_button_is_that_of_the_list_and_the_worst_is_first(self, screen):
        button = screen.button("Notes")
        set_state(screen, "(state) => (state.notes = ['Right tower: depth is a guess', 'the rest'])")
        button.click()
        told = screen.page.locator("#note-list > ul > li")
        assert told.all_inner_texts() == ["Right tower: depth is a guess", "the rest"]
        assert button.locator(".count").inner_text() == str(told.count())
        assert not screen.page.locator("#note-list details li").first.is_visible()  # what the program did
        button.click()
        by_hand(screen)
        assert button.locator(".count").inner_text() == str(len(screen.state["notes"]))


class TestWindows:
    @pytest.mark.parametrize("size", [(1440, 900), (1024, 768), (800, 600), (390, 844)])
    def test_nothing_is_cut_off_and_nothing_overlaps(self, screen, size):
        """Sliders and buttons were cut off at 1024 and 800 px, and at 390 px texts lay on each other."""
        before = screen.page.viewport_size
        screen.page.set_viewport_size({"width": size[0], "height": size[1]})
        screen.settle()
        screen.settle()
        try:
            assert screen.run(CUT_OFF) == []
            assert screen.run(OVERLAPPING) == []
            screen.press("e")
            assert screen.run(MENU) == []
            screen.press("Escape")
            assert screen.run("linecad.photo.viewport.width") > 0.35 * min(size[0], 800)
        finally:
            screen.page.set_viewport_size(before)
            screen.settle()

    def test_messages_do_not_pile_up_nor_cover_the_menu(self, screen):
        screen.run(
            """() => {
              return import("/page/messages.js").then(({ Messages }) => {
                const messages = new Messages();
                for (let n = 0; n < 6; n++) messages.tell(`message ${n} that is as wide as it may be`);
              });
            }"""
        )
        assert screen.page.locator("#messages .message").all_inner_texts()[-1].startswith("message 5")
        assert screen.page.locator("#messages .message").count() == 2
        screen.press("e")
        covered = screen.run(
            """() => [...document.querySelectorAll("#export-list button")].filter((each) => {
              const { left, top, width, height } = each.getBoundingClientRect();
              return !each.contains(document.elementFromPoint(left + width / 2, top + height / 2));
            }).length"""
        )
        assert covered == 0
        screen.press("Escape")


class TestThemes:
    @pytest.mark.parametrize("scheme", ["light", "dark"])
    def test_the_theme_is_that_of_the_system_and_texts_have_the_contrast_of_wcag_aa(self, screen, scheme):
        screen.page.emulate_media(color_scheme=scheme)
        screen.settle()
        assert screen.run("document.documentElement.dataset.theme") == scheme
        assert screen.run("linecad.store.theme") == scheme
        try:
            for prepare in ("", "label", "groups", "notes"):
                if prepare:
                    screen.page.locator("#label-mode" if prepare == "label" else f"#{prepare}").click()
                screen.settle()
                for legend in ("photo", "model"):
                    screen.run(f"document.querySelector('#{legend}-legend').open = true")
                low = [each for each in screen.run(CONTRAST) if each[0] < 4.5]
                assert low == []
                if prepare:
                    screen.page.locator("#label-mode" if prepare == "label" else f"#{prepare}").click()
        finally:
            screen.run("for (const each of document.querySelectorAll('.legend-box')) each.open = false")
            screen.page.emulate_media(color_scheme="light")

    def test_the_switch_overrules_the_system_until_both_say_the_same(self, screen):
        paper = screen.page.locator("#model-canvas").screenshot()
        screen.button("Dark").click()
        screen.settle()
        assert screen.run("localStorage.getItem('linecad-theme')") == "dark"
        assert screen.run("getComputedStyle(document.body).color") == "rgb(236, 236, 242)"
        assert screen.page.locator("#model-canvas").screenshot() != paper
        screen.button("Dark").click()
        assert screen.run("localStorage.getItem('linecad-theme')") is None
        assert screen.run("document.documentElement.dataset.theme") == "light"


class TestReload:
    def test_a_reload_brings_zoom_tool_layers_and_the_view_of_the_model_back(self, new_screen, shared_screen):
        screen = new_screen(shared_screen.served)
        screen.open()
        screen.run("linecad.photo.change((viewport) => viewport.centre([700, 500], 3))")
        screen.run("linecad.model.change((orbit) => orbit.orbit(100, 20))")
        for key in ("d", "4", "p"):
            screen.press(key)
        screen.button("Groups").click()
        screen.button("Lock Main group").click()
        screen.page.locator("#photo-opacity").fill("40")
        seen = """() => {
          const { store, photo, model } = linecad;
          const { viewport } = photo;
          const { azimuth, elevation, distance, inCamera } = model.orbit;
          return {
            middle: viewport.toPhoto([viewport.width / 2, viewport.height / 2]).map((at) => Math.round(at)),
            scale: viewport.scale, tool: store.tool, layers: store.layers, texture: store.texture,
            locked: [...store.lockedGroups], orbit: [azimuth, elevation, distance, inCamera],
            opacity: photo.canvases.photo.style.opacity,
          };
        }"""
        before = screen.run(seen)
        assert (before["tool"], before["scale"], before["layers"]["x"]) == ("draw", 3, False)
        assert (before["locked"], before["opacity"]) == ([0], "0.4")
        screen.page.reload()
        screen.page.wait_for_selector("body[data-photo=shown]")
        screen.settle()
        assert screen.run(seen) == before
        kept = screen.run(
            "JSON.stringify(Object.entries(sessionStorage).filter(([key]) => key.startsWith('linecad-view')))"
        )
        assert screen.served.address.split("#")[1] not in kept

    @pytest.mark.parametrize("kept", ["{", '{"version": 0, "tool": "draw"}'])
    def test_what_another_version_kept_is_left_alone(self, new_screen, shared_screen, kept):
        script = f"globalThis.sessionStorage?.setItem('linecad-view:boxes.png:1600x1200', {json.dumps(kept)})"
        screen = new_screen(shared_screen.served, script=f"if (location.protocol === 'http:') {script}")
        screen.open()
        assert screen.run("linecad.store.tool") == "correct"

    def test_the_tab_that_only_looks_follows_the_other_one(self, screen, new_screen):
        """After a takeover it showed what had been there before."""
        second = new_screen(screen.served, beside=screen)
        second.open()
        second.page.get_by_text("open in another tab").wait_for()
        crossing = screen.state["crossings"][0]["id"]
        screen.run("(crossing) => linecad.editing.edit({ op: 'label', crossing, value: 'unsure' })", crossing)
        second.wait("linecad.store.state.labelling.done === 1")  # within the five seconds after which it asks again
        assert second.run("linecad.store.owner") is False

    def test_an_old_tab_says_what_to_do_and_nothing_of_a_token(self, new_screen, shared_screen):
        screen = new_screen(shared_screen.served)
        screen.page.goto(f"{screen.served.origin}/#of-the-server-before")
        notice = screen.page.locator("#notices .message")
        notice.wait_for()
        text = notice.inner_text()
        assert "was started again" in text
        assert "close this tab" in text
        assert "token" not in text
        screen.complaints = [each for each in screen.complaints if "401" not in each]


def test_progress_names_the_stage_and_the_bar_does_not_claim_to_be_done(screen):
    """It stood at a closed gap while faces were still being built."""
    screen.run(
        """() => {
          const search = { objective: 5, bound: 5, gap: 0, seconds: 0.1 };
          const solve = { state: "running", stage: "building planes and faces", ...search };
          linecad.actions.hasAsked = true; // by hand, and not behind a fact
          linecad.store.set({ solve });
        }"""
    )
    text = screen.page.locator("#solve-text").inner_text()
    assert text.startswith("building planes and faces · ")
    assert screen.page.locator("#solve-progress").get_attribute("value") is None
    screen.wait("linecad.store.solve.state === 'idle'")
    by_hand(screen)
    screen.wait("linecad.store.busy === 0")


def test_labelling_begins_with_what_tells_most(screen):
    screen.press("l")
    assert screen.run("linecad.store.selection.id") == screen.state["labelling"]["order"][0]
    screen.press("n")
    assert screen.run("linecad.store.selection.id") == screen.state["labelling"]["order"][1]
    screen.press("l")
