"""The page in a browser: what it shows, and how one moves in it."""

import cv2
import numpy as np
import pytest

WITHOUT_WEBGL = """
const real = HTMLCanvasElement.prototype.getContext;
HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
  return kind === "webgl2" ? null : real.call(this, kind, ...rest);
};
"""


def test_it_shows_the_photo_where_the_viewport_says(screen):
    photo = cv2.imread(str(screen.served.photo))
    u, v = 400, 500  # inside a cell of the near box, where the photo is even
    shown = screen.run(
        """([u, v]) => {
          const canvas = document.querySelector("#photo-canvas");
          const [x, y] = linecad.photo.viewport.toScreen([u, v]).map((at) => Math.round(at * devicePixelRatio));
          return [...canvas.getContext("2d").getImageData(x, y, 1, 1).data].slice(0, 3);
        }""",
        [u, v],
    )
    around = photo[v - 4 : v + 5, u - 4 : u + 5].reshape(-1, 3)
    assert np.abs(np.median(around, axis=0) - shown).max() < 12


def test_it_names_the_counts_of_the_state(screen):
    state = screen.state
    assert len(state["lines"]) > 20
    real = sum(crossing["real"] for crossing in state["crossings"])
    assert screen.page.locator("[data-layer=real] .count").inner_text() == str(real)
    assert f"{len(state['lines'])} lines" in screen.page.locator("#inspector").inner_text()


def test_the_model_is_drawn(screen):
    picture = screen.page.locator("#model-canvas").screenshot()
    pixels = cv2.imdecode(np.frombuffer(picture, np.uint8), cv2.IMREAD_COLOR).astype(int)
    assert (np.abs(pixels - pixels[5, 5]).max(axis=2) > 30).mean() > 0.03  # lines and faces before the paper


def test_through_the_camera_the_faces_carry_their_own_part_of_the_photo(screen):
    screen.run(
        """() => {
          const { state } = linecad.store;
          const sure = (plane) => ({ ...plane, faces: plane.faces.map((face) => ({ ...face, guess: false })) });
          linecad.store.set({ state: { ...state, planes: state.planes.map(sure) } }); // guesses are pale
        }"""
    )
    screen.button("Through the camera").click()
    for name in ("x", "y", "z"):
        screen.page.locator(f"[data-layer={name}]").click()
    screen.settle()
    picture = screen.page.locator("#model-canvas").screenshot()
    shown = cv2.imdecode(np.frombuffer(picture, np.uint8), cv2.IMREAD_COLOR)
    photo = cv2.imread(str(screen.served.photo))
    scale = min(shown.shape[1] / photo.shape[1], shown.shape[0] / photo.shape[0])
    size = (round(photo.shape[1] * scale), round(photo.shape[0] * scale))
    left, top = ((whole - part) // 2 for whole, part in zip(shown.shape[1::-1], size, strict=True))
    part = shown[top : top + size[1], left : left + size[0]].astype(int)
    small = cv2.resize(photo, size, interpolation=cv2.INTER_AREA).astype(int)
    textured = small.max(axis=2) < 200  # the boxes; the ground around them is lighter, and no face
    textured[-80:] = False  # the axes are drawn there
    assert textured.mean() > 0.05
    assert (np.abs(part - small).max(axis=2)[textured] < 25).mean() > 0.7


def test_the_wheel_keeps_what_is_under_the_pointer(screen):
    place = (screen.stage["x"] + 211, screen.stage["y"] + 333)
    screen.page.mouse.move(*place)
    before, scale = screen.in_photo(place), screen.run("linecad.photo.viewport.scale")
    for _ in range(3):
        screen.page.mouse.wheel(0, -240)
    screen.settle()
    assert screen.run("linecad.photo.viewport.scale") > 2 * scale
    assert screen.in_photo(place) == pytest.approx(before, abs=1e-6)


def test_the_wheel_goes_far_beyond_one_to_one(screen):
    place = (screen.stage["x"] + 300, screen.stage["y"] + 300)
    screen.page.mouse.move(*place)
    before = screen.in_photo(place)
    for _ in range(8):
        screen.page.mouse.wheel(0, -1000)
    screen.settle()
    assert screen.run("linecad.photo.viewport.scale") >= 32
    assert screen.in_photo(place) == pytest.approx(before, abs=1e-6)


def test_a_drag_and_the_space_bar_move_the_photo(screen):
    place = screen.stage["x"] + 300, screen.stage["y"] + 40
    pixel = screen.in_photo(place)
    for tool, held in (("c", ""), ("d", " ")):
        screen.press(tool)
        if held:
            screen.page.keyboard.down(held)
        start = screen.on_screen(pixel)
        screen.page.mouse.move(*start)
        screen.page.mouse.down()
        screen.page.mouse.move(start[0] + 70, start[1] + 45, steps=3)
        screen.page.mouse.up()
        if held:
            screen.page.keyboard.up(held)
        assert screen.on_screen(pixel) == pytest.approx((start[0] + 70, start[1] + 45), abs=1e-6)
    assert screen.run("linecad.draft.points.length") == 0


def test_keys_zoom_move_and_fit(screen):
    fitted = screen.run("({...linecad.photo.viewport})")
    screen.press("+")
    screen.press("+")
    assert screen.run("linecad.photo.viewport.scale") == pytest.approx(fitted["scale"] * 1.25**2)
    screen.press("ArrowRight")
    screen.press("ArrowDown")
    screen.press("0")
    assert screen.run("({...linecad.photo.viewport})") == pytest.approx(fitted)


def test_a_layer_goes_and_comes_back(screen):
    # After the first reading the browser draws the canvas by other means, and edges differ by a shade.
    screen.painted("#drawing-canvas")
    all_of_it = screen.painted("#drawing-canvas")
    same = pytest.approx(all_of_it, rel=0.005)
    screen.page.locator("[data-layer=z]").click()
    screen.settle()
    assert 0 < screen.painted("#drawing-canvas") < 0.95 * all_of_it
    screen.press("6")
    assert screen.painted("#drawing-canvas") == same
    screen.page.keyboard.down("h")
    screen.settle()
    assert screen.painted("#drawing-canvas") == 0
    screen.page.keyboard.up("h")
    screen.settle()
    assert screen.painted("#drawing-canvas") == same


def test_without_a_depth_map_there_is_nothing_of_one(screen):
    assert screen.page.locator("#layers [data-layer]").count() == 8
    assert screen.page.locator("#help-columns dd", has_text="depth map").count() == 0
    for key in ("8", "9"):
        screen.press(key)
    assert screen.painted("#depth-canvas") == 0
    assert screen.page.locator("#depth-legend").is_hidden()
    assert not [url for url in screen.requests if "/api/depth/" in url]


@pytest.mark.thorough
def test_the_depth_map_and_where_the_model_differs_from_it_lie_over_the_photo(new_screen, start, tmp_path, map_of_made):
    np.savez(tmp_path / "map.npz", depth=map_of_made.values)
    screen = new_screen(start("--depth", str(tmp_path / "map.npz"), "--option", "depth-kind=z"))
    screen.open()
    asked = [url for url in screen.requests if "/api/depth/" in url]
    assert (asked, screen.painted("#depth-canvas")) == ([], 0)

    screen.press("8")
    screen.wait("!document.querySelector('#depth-legend').hidden")
    wait_for_depth(screen)
    whole = screen.painted("#depth-canvas")
    legend = screen.page.locator("#depth-legend")
    assert "near" in legend.inner_text()
    assert "map.npz: z" in legend.inner_text()
    scale = screen.run("linecad.photo.viewport.scale")
    assert whole == pytest.approx(1600 * 1200 * scale**2, rel=0.02)

    screen.press("8")
    assert screen.painted("#depth-canvas") == 0
    assert legend.is_hidden()
    screen.button("Map and model").click()
    wait_for_depth(screen)
    assert 0.1 * whole < screen.painted("#depth-canvas") < 0.9 * whole
    assert "20 % nearer" in legend.inner_text()
    screen.page.keyboard.down("h")
    screen.settle()
    assert screen.painted("#depth-canvas") == 0
    screen.page.keyboard.up("h")

    asked = len([url for url in screen.requests if url.endswith("/api/depth/difference")])
    before = screen.state["depth_map"]["difference"]
    screen.press("s")
    screen.wait(f"linecad.store.state.depth_map.difference > {before}")
    wait_for_depth(screen)
    assert len([url for url in screen.requests if url.endswith("/api/depth/difference")]) == asked + 1

    screen.run(
        """() => {
          const { store } = linecad;
          const depth_map = { text: "depth map map.npz left out: it is flat", depth: 9, difference: null };
          store.set({ state: { ...store.state, depth_map } });
        }"""
    )
    screen.settle()
    assert screen.button("Map and model").is_disabled()
    assert screen.painted("#depth-canvas") == 0
    assert legend.is_hidden()


def wait_for_depth(screen):
    """Until what is asked for is painted."""
    screen.wait(
        """(({ canvases }) => {
          const { width, height } = canvases.depth;
          return canvases.depth.getContext("2d").getImageData(0, 0, width, height).data.some((value) => value > 0);
        })(linecad.photo)"""
    )
    screen.settle()


def test_marks_have_one_size_at_every_zoom(screen):
    crossings = screen.state["crossings"]
    pixels = np.array([each["pixel"] for each in crossings])
    alone = [np.partition(np.linalg.norm(pixels - pixel, axis=1), 1)[1] for pixel in pixels]  # px to the next one
    crossing = max(zip(alone, crossings, strict=True), key=lambda pair: pair[0] if pair[1]["real"] else 0)[1]
    for layer in ("fake", "changed", "x", "y", "z", "faces"):
        screen.page.locator(f"[data-layer={layer}]").click()
    count = """(pixel) => {
      const [x, y] = linecad.photo.viewport.toScreen(pixel);
      const canvas = document.querySelector("#drawing-canvas").getContext("2d");
      const { data } = canvas.getImageData(x - 9, y - 9, 19, 19);
      return data.filter((value, index) => index % 4 === 3 && value > 100).length;
    }"""
    sizes = []
    for scale in (4.0, 40.0):
        screen.run(
            "([pixel, scale]) => linecad.photo.change((viewport) => viewport.centre(pixel, scale))",
            [crossing["pixel"], scale],
        )
        screen.settle()
        sizes.append(screen.run(count, crossing["pixel"]))
    assert sizes[0] > 30
    assert abs(sizes[0] - sizes[1]) <= 6


def test_hover_and_selection_go_from_the_photo_to_the_model_and_back(screen):
    solved = [each for each in screen.state["lines"] if each["ends"]]
    line = max(solved, key=lambda each: np.linalg.norm(np.subtract(*each["segment"])))
    # A place on the line that no crossing is near.
    near = np.array([each["pixel"] for each in screen.state["crossings"]])
    shares = np.linspace(0.05, 0.95, 181)[:, None]
    places = (1 - shares) * line["segment"][0] + shares * np.array(line["segment"][1])
    best = places[np.linalg.norm(places[:, None] - near, axis=2).min(axis=1).argmax()]
    screen.press("v")
    screen.page.mouse.move(*screen.on_screen(best))
    screen.settle()
    assert screen.run("linecad.store.hover") == {"kind": "line", "id": line["id"]}
    lit = screen.run("linecad.model.litCount")
    screen.click(best)
    assert f"Line {line['id']}" in screen.page.locator("#inspector").inner_text()
    screen.page.mouse.move(screen.stage["x"] + 3, screen.stage["y"] + 3)
    screen.settle()
    assert screen.run("linecad.model.litCount") == lit == 2
    screen.press("Escape")
    assert screen.run("linecad.model.litCount") == 0

    middle = [sum(at) / 2 for at in zip(*line["ends"], strict=True)]
    box = screen.page.locator("#model-canvas").bounding_box()
    x, y = screen.run("(point) => linecad.model.toScreen(point)", middle)
    screen.page.mouse.click(box["x"] + x, box["y"] + y)
    screen.settle()
    found = screen.run("linecad.store.selectedLine")
    # Another line may lie there in this view; then that one is selected, and lies there too.
    at = screen.run("(ends) => ends.map((end) => linecad.model.toScreen(end))", found["ends"])
    assert distance_to((x, y), at) < 8
    assert screen.painted("#overlay-canvas") > 0


def distance_to(point, ends):
    a, b = map(np.array, ends)
    share = np.clip((point - a) @ (b - a) / ((b - a) @ (b - a)), 0, 1)
    return float(np.linalg.norm(a + share * (b - a) - point))


def test_the_model_turns_moves_zooms_and_fits(screen):
    box = screen.page.locator("#model-canvas").bounding_box()
    middle = (box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    orbit = """() => {
      const { azimuth, elevation, distance, target } = linecad.model.orbit;
      return { azimuth, elevation, distance, target };
    }"""
    fitted = screen.run(orbit)
    screen.page.mouse.move(*middle)
    screen.page.mouse.down()
    screen.page.mouse.move(middle[0] + 50, middle[1], steps=2)
    screen.page.mouse.up()
    screen.page.mouse.wheel(0, -300)
    screen.settle()
    turned = screen.run(orbit)
    assert turned["azimuth"] > fitted["azimuth"]
    assert turned["distance"] < fitted["distance"]
    screen.page.keyboard.press("Shift+ArrowLeft")
    assert screen.run(orbit)["target"] != turned["target"]
    screen.button("Fit the model").click()
    again = screen.run(orbit)
    assert again.pop("target") == pytest.approx(fitted.pop("target"))
    assert again == pytest.approx(fitted)


def test_without_webgl_the_photo_side_works_and_the_model_says_why(new_screen, shared_screen):
    screen = new_screen(shared_screen.served, script=WITHOUT_WEBGL)
    screen.open()
    assert "WebGL 2" in screen.page.locator("#model-note").inner_text()
    assert screen.painted("#photo-canvas") > 0
    assert screen.painted("#drawing-canvas") > 0
    screen.press("+")


def test_without_its_token_the_page_says_what_to_do(new_screen, shared_screen):
    screen = new_screen(shared_screen.served)
    screen.page.goto(screen.served.origin)
    screen.page.get_by_text("Open the whole address that linecad edit printed").wait_for()


def test_every_button_has_a_name_and_every_key_is_in_the_help(screen):
    nameless = """() => {
      const name = (each) => each.getAttribute("aria-label") ?? each.labels?.[0]?.textContent ?? each.textContent;
      const all = [...document.querySelectorAll("button, input, canvas[tabindex], [role=separator]")];
      return all.filter((each) => !name(each).trim()).map((each) => each.outerHTML);
    }"""
    assert screen.run(nameless) == []
    screen.press("?")
    text = screen.page.locator("#help-dialog").inner_text()
    for tool in ("Correct", "Select", "Draw", "Split", "Join", "Axes"):
        assert f"{tool}:" in text
    screen.press("Escape")
    assert not screen.page.locator("#help-dialog").is_visible()


def test_a_second_tab_only_looks_until_it_takes_over(screen, new_screen):
    second = new_screen(screen.served, beside=screen)
    second.open()
    second.page.get_by_text("open in another tab").wait_for()
    crossing = second.state["crossings"][0]
    second.click(crossing["pixel"])
    assert second.state["crossings"][0]["label"] is None
    second.button("Edit here").click()
    second.wait("linecad.store.owner")
    second.page.get_by_text("open in another tab").wait_for(state="detached")
    screen.page.get_by_text("open in another tab").wait_for()  # within the five seconds after which it asks again
    screen.button("Edit here").click()
    screen.wait("linecad.store.owner")


def test_a_selected_line_tells_how_sure_its_depth_is(screen):
    told = screen.run(
        """(probability) => {
          const { store } = linecad;
          const line = store.state.lines.find(({ ends }) => ends);
          line.probability = probability;
          store.set({ selection: { kind: "line", id: line.id } });
          return document.querySelector("#inspector").innerText;
        }""",
        0.834,
    )
    assert "depth 83 % sure" in told


def test_a_selected_line_says_when_the_depth_map_placed_it(screen):
    told = screen.run(
        """() => [false, true].map((by_depth_map) => {
          const { store } = linecad;
          const line = store.state.lines.find(({ ends }) => ends);
          line.by_depth_map = by_depth_map;
          store.set({ selection: null });
          store.set({ selection: { kind: "line", id: line.id } });
          return document.querySelector("#inspector").innerText.includes("placed by the depth map");
        })"""
    )
    assert told == [False, True]
