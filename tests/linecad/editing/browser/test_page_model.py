"""The model in the browser: plan and fronts, faces, measures, how sure it is, parts of the photo, what is exported."""

import json

import cv2
import numpy as np
import pytest

from linecad.cli.main import main

pytestmark = pytest.mark.thorough  # every day the server is asked (test_wanted.py, test_faces.py, test_cell_layer.py)


def facade_of(state):
    """The facade with the most lines, and its largest face."""
    plane = max((each for each in state["planes"] if each["is_facade"]), key=lambda each: len(each["lines"]))
    return plane, max(plane["faces"], key=lambda face: np.ptp(face["outline"], axis=0).prod(where=[True, True, True]))


def seen(screen, points):
    """Where points of the world are on the stage of the model."""
    script = "(points) => points.map((point) => linecad.model.toScreen(point))"
    return np.array(screen.run(script, np.array(points).reshape(-1, 3).tolist()))


def place_on_face(screen, face, on_model=False):
    """A place on the screen where a face, and no line or crossing, is under the pointer."""
    found = screen.run(
        """async ([id, onModel]) => {
          const { faceAlong, sightOfPhoto, sightOfModel } = await import("/page/sights.js");
          const { thingsAt } = await import("/page/picking.js");
          const { store, photo, model } = linecad;
          const stage = onModel ? model.stage : photo.stage;
          const sight = onModel ? sightOfModel(model) : sightOfPhoto(store, photo.viewport);
          const clear = (at) => (onModel ? !model.lineAt(at) : thingsAt(store, photo.viewport, at).length === 0);
          for (let y = 60; y < stage.clientHeight - 120; y += 3)
            for (let x = 130; x < stage.clientWidth - 20; x += 3)
              if (faceAlong(store, sight.along([x, y]))?.face.id === id && clear([x, y])) return [x, y];
          return null;
        }""",
        [face["id"], on_model],
    )
    assert found, "the face is nowhere to be seen"
    box = screen.page.locator("#model-canvas" if on_model else "#overlay-canvas").bounding_box()
    return box["x"] + found[0], box["y"] + found[1]


def test_the_plan_looks_straight_down_without_perspective(screen):
    state = screen.state
    uprights = [line["ends"] for line in state["lines"] if line["ends"] and line["axis"] == "z"]
    free = seen(screen, uprights)
    assert np.linalg.norm(free[::2] - free[1::2], axis=1).min() > 1
    screen.button("Plan").click()
    screen.settle()
    flat = seen(screen, uprights)
    assert np.linalg.norm(flat[::2] - flat[1::2], axis=1).max() < 0.01
    assert screen.button("Plan").get_attribute("aria-pressed") == "true"
    square = seen(screen, [[0, 5, 0], [1, 5, 0], [1, 6, 3], [0, 20, -1]])
    step = square[1, 0] - square[0, 0]
    assert step > 1
    assert square == pytest.approx(square[0] + step * np.array([[0, 0], [1, 0], [1, -1], [0, -15]]), abs=0.01)


def test_a_drag_moves_the_plan_and_free_turns_again(screen):
    screen.press("Shift+P")
    box = screen.page.locator("#model-canvas").bounding_box()
    before = seen(screen, [[0, 5, 0], [2, 9, 1]])
    screen.page.mouse.move(box["x"] + 200, box["y"] + 300)
    screen.page.mouse.down()
    screen.page.mouse.move(box["x"] + 240, box["y"] + 310, steps=3)
    screen.page.mouse.up()
    assert seen(screen, [[0, 5, 0], [2, 9, 1]]) == pytest.approx(before + np.array([40, 10]), abs=0.01)
    screen.page.mouse.move(box["x"] + 200, box["y"] + 300)
    place = screen.run("linecad.model.orbit.sight([200, 300])[0]")
    screen.page.mouse.wheel(0, -300)
    assert screen.run("linecad.model.orbit.sight([200, 300])[0]")[:2] == pytest.approx(place[:2], abs=1e-6)
    screen.button("Free").click()
    azimuth = screen.run("linecad.model.orbit.azimuth")
    screen.page.mouse.move(box["x"] + 200, box["y"] + 300)
    screen.page.mouse.down()
    screen.page.mouse.move(box["x"] + 260, box["y"] + 300, steps=3)
    screen.page.mouse.up()
    assert screen.run("linecad.model.orbit.azimuth") > azimuth
    screen.press("Shift+P")
    screen.button("Through the camera").click()
    assert screen.button("Plan").get_attribute("aria-pressed") == "false"
    assert screen.run("linecad.model.orbit.flat") is None


@pytest.mark.parametrize("key", ["Shift+P", "Shift+F", "Shift+O", "t"])
def test_in_every_view_the_sight_through_a_place_meets_what_is_seen_there(screen, key):
    ends = [line["ends"][0] for line in screen.state["lines"] if line["ends"]][:30]
    screen.run("() => { const { model } = linecad; model.change((orbit) => orbit.orbit(30, 20)); }")
    screen.press(key)
    places = seen(screen, ends)
    script = "(places) => places.map((at) => linecad.model.orbit.sight(at))"
    for point, (origin, direction) in zip(ends, screen.run(script, places.tolist()), strict=True):
        away, along = np.subtract(point, origin), np.array(direction) / np.linalg.norm(direction)
        assert away @ along > 0
        assert np.linalg.norm(np.cross(away, along)) < 1e-4 * np.linalg.norm(away)


def test_a_click_on_a_face_lights_its_plane_on_both_sides_and_its_front_is_straight(screen):
    plane, face = facade_of(screen.state)
    screen.press("v")
    empty = screen.painted("#overlay-canvas")
    screen.page.mouse.click(*place_on_face(screen, face))
    screen.settle()
    assert screen.run("linecad.store.selection") == {"kind": "face", "id": face["id"]}
    text = screen.page.locator("#inspector").inner_text()
    assert f"plane {plane['id']} at {plane['axis']}" in text
    assert f"{len(plane['lines'])} line" in text
    assert screen.run("linecad.model.litCount") >= 2 * len(plane["lines"]) + 3
    assert screen.painted("#overlay-canvas") > empty
    screen.press("Shift+F")
    across = np.array([face["outline"][0], np.array(face["outline"][0]) + plane["normal"]])
    ends = seen(screen, across)
    assert np.linalg.norm(ends[0] - ends[1]) < 0.01
    corners = seen(screen, face["outline"])
    stage = screen.page.locator("#model-canvas").bounding_box()
    assert (corners >= 0).all()
    assert (corners <= [stage["width"], stage["height"]]).all()
    screen.press("Escape")
    assert screen.run("linecad.model.litCount") == 0


def test_a_click_on_a_face_of_the_model_selects_it(screen):
    _, face = facade_of(screen.state)
    screen.page.mouse.click(*place_on_face(screen, face, on_model=True))
    screen.settle()
    assert screen.run("linecad.store.selection") == {"kind": "face", "id": face["id"]}
    screen.press("7")
    screen.page.mouse.click(*place_on_face_anywhere(screen))
    assert screen.run("linecad.store.selection") is None


def place_on_face_anywhere(screen):
    """A place of the model where no line is; its faces are off."""
    box = screen.page.locator("#model-canvas").bounding_box()
    at = screen.run(
        """() => {
          for (let y = 60; y < 500; y += 5)
            for (let x = 150; x < 400; x += 5) if (!linecad.model.lineAt([x, y])) return [x, y];
        }"""
    )
    return box["x"] + at[0], box["y"] + at[1]


def test_of_a_selected_line_the_front_of_its_plane_is_shown(screen):
    plane, _ = facade_of(screen.state)
    line = next(each for each in screen.state["lines"] if each["id"] in plane["lines"] and each["axis"] == "z")
    screen.run("(id) => linecad.store.set({ selection: { kind: 'line', id } })", line["id"])
    screen.button("Front").click()
    ends = seen(screen, [line["ends"][0], np.array(line["ends"][0]) + plane["normal"], line["ends"][1]])
    assert np.linalg.norm(ends[0] - ends[1]) < 0.01
    assert ends[2] - ends[0] == pytest.approx([0, ends[2, 1] - ends[0, 1]], abs=0.01)


def line_ends_alone(screen, count):
    """Ends of lines, with their lines, that no other end is near in the photo."""
    lines = [line for line in screen.state["lines"] if line["ends"] and line["component"] == 0]
    ends = np.array([line["segment"] for line in lines]).reshape(-1, 2)
    apart = np.linalg.norm(ends[:, None] - ends, axis=2) + 1e9 * np.eye(len(ends))
    corners = np.array([screen.run("(p) => linecad.photo.viewport.toScreen(p)", end.tolist()) for end in ends])
    inside = (corners > 30).all(axis=1) & (corners[:, 0] < 700) & (corners[:, 1] < 500)
    order = np.argsort(-np.where(inside, apart.min(axis=1), 0))[:count]
    return [(lines[at // 2], at % 2, ends[at]) for at in order.tolist()]


def test_two_clicks_measure_between_ends_and_the_distance_sets_the_scale(screen):
    (one, first, start), (other, second, end) = line_ends_alone(screen, 2)
    screen.press("i")
    screen.page.mouse.move(*(np.array(screen.on_screen(start)) + 4))
    screen.settle()
    assert "Here: end of a line" in screen.page.locator("#inspector").inner_text()
    for pixel in (start, end):
        screen.page.mouse.click(*(np.array(screen.on_screen(pixel)) + np.array([3, -3])))
        screen.settle()
    parts = np.abs(np.array(one["ends"][first]) - other["ends"][second])
    units = float(np.linalg.norm(parts))
    text = screen.page.locator("#inspector").inner_text()
    assert f"{units:.4g} units" in text
    assert f"x {parts[0]:.4g} · y {parts[1]:.4g} · z {parts[2]:.4g} units" in text
    assert "the scale is not known" in text
    assert screen.page.locator("#model-measure").inner_text() == f"{units:.4g} units"
    screen.press("m")
    screen.page.get_by_label("Length", exact=True).fill("12.5")
    screen.page.get_by_role("button", name="Set the scale").click()
    screen.wait("linecad.store.state.metres_per_unit !== null")
    screen.settle()
    assert screen.state["metres_per_unit"] * units == pytest.approx(12.5, rel=1e-9)
    assert "12.5 m" in screen.page.locator("#inspector").inner_text()
    assert screen.page.locator("#model-measure").inner_text() == "12.5 m"
    saved = screen.served.photo.with_name(f"{screen.served.photo.name}.corrections.json")
    screen.wait("linecad.store.saved")
    (edit,) = json.loads(saved.read_text(encoding="utf-8"))["edits"]
    assert (edit["op"], edit["metres"], ["line" in point for point in edit["points"]]) == ("distance", 12.5, [True] * 2)
    screen.press("Escape")
    assert screen.page.locator("#model-measure").is_hidden()
    screen.press("Control+z")
    assert screen.state["metres_per_unit"] is None


def test_points_of_faces_are_measured_in_the_model(screen):
    plane, face = facade_of(screen.state)
    screen.run("(id) => linecad.store.set({ selection: { kind: 'face', id } })", face["id"])
    screen.press("Shift+F")
    screen.press("i")
    place = place_on_face(screen, face, on_model=True)
    screen.page.mouse.click(*place)
    screen.settle()
    ((point),) = screen.run("linecad.store.measure.points")
    assert point["what"] in ("face", "edge of a face", "line")
    assert np.dot(point["point"], plane["normal"]) == pytest.approx(plane["offset"], abs=0.2)
    box = screen.page.locator("#model-canvas").bounding_box()
    assert seen(screen, [point["point"]])[0] + [box["x"], box["y"]] == pytest.approx(place, abs=8)
    screen.page.mouse.click(box["x"] + 5, box["y"] + box["height"] / 2)
    assert screen.page.get_by_text("Nothing of the model is there").is_visible()
    assert len(screen.run("linecad.store.measure.points")) == 1


def test_in_the_front_of_a_face_its_own_corners_are_measured(screen):
    plane, face = facade_of(screen.state)
    screen.run("(id) => linecad.store.set({ selection: { kind: 'face', id } })", face["id"])
    screen.press("Shift+F")
    screen.press("i")
    measured = screen.run(
        """async (outline) => {
          const { pointAt, sightOfModel } = await import("/page/sights.js");
          const { store, model } = linecad;
          const near = ([x, y]) => [x + 3, y - 3];
          return outline.map((corner) => pointAt(store, sightOfModel(model), near(model.toScreen(corner))));
        }""",
        face["outline"],
    )
    own = {each["id"] for each in plane["faces"]}
    for point in measured:
        on = point["on"]
        assert on.get("line") in plane["lines"] or on.get("face") in own
        assert np.dot(point["point"], plane["normal"]) == pytest.approx(plane["offset"], rel=1e-6)


def test_a_distance_that_sets_no_scale_is_refused_with_a_reason(screen):
    line = next(line for line in screen.state["lines"] if line["ends"])
    points = [{"point": line["ends"][0], "on": {"line": line["id"]}, "what": "end of a line"} for _ in range(2)]
    screen.press("i")
    screen.run("(points) => linecad.store.set({ measure: { points, near: null } })", points)
    screen.press("m")
    screen.page.get_by_label("Length", exact=True).fill("2")
    screen.page.get_by_role("button", name="Set the scale").click()
    screen.page.get_by_text("two points are one").wait_for()
    screen.complaints.remove(next(each for each in screen.complaints if "422" in each))  # the browser's own
    assert screen.served.ask("state")["undo"] == 0


def test_the_parts_of_the_photo_lie_over_it_with_a_legend(screen):
    assert screen.painted("#depth-canvas") == 0
    screen.press("Shift+L")
    screen.wait("!document.querySelector('#depth-legend').hidden")
    screen.wait(
        """(({ canvases }) => {
          const { width, height } = canvases.depth;
          return canvases.depth.getContext("2d").getImageData(0, 0, width, height).data.some((value) => value > 0);
        })(linecad.photo)"""
    )
    legend = screen.page.locator("#depth-legend").inner_text()
    for kind in screen.state["cells"]["kinds"]:
        assert kind["name"] in legend
    wall = next(kind["colour"] for kind in screen.state["cells"]["kinds"] if kind["name"] == "wall")
    _, face = facade_of(screen.state)
    x, y = place_on_face(screen, face)
    at = [x - screen.stage["x"], y - screen.stage["y"]]
    shown = screen.run(
        "([x, y]) => [...linecad.photo.canvases.depth.getContext('2d').getImageData(x, y, 1, 1).data].slice(0, 3)", at
    )
    assert shown == pytest.approx([int(wall[k : k + 2], 16) for k in (1, 3, 5)], abs=3)
    screen.button("Parts").click()
    screen.settle()
    assert screen.painted("#depth-canvas") == 0


def test_colours_tell_how_sure_lines_are_with_a_legend(screen):
    legend = screen.page.locator(".sure-legend")
    assert legend.is_hidden()
    for name in ("real", "fake", "changed", "faces"):
        screen.page.locator(f"[data-layer={name}]").click()
    screen.press("Shift+S")
    assert legend.is_visible()
    lines = [line for line in screen.state["lines"] if line["ends"]]
    best = max(line["probability"] for line in lines)
    colours = screen.run(
        """async () => {
          const { colourOf } = await import("/page/sure.js");
          return linecad.store.state.lines.filter(({ ends }) => ends).map((line) => colourOf(linecad.store, line));
        }"""
    )
    sure = {colour for line, colour in zip(lines, colours, strict=True) if line["probability"] == best}
    unsure = {colour for line, colour in zip(lines, colours, strict=True) if line["probability"] < 0.5}
    assert len(sure) == 1
    assert sure.isdisjoint(unsure)
    picture = cv2.imdecode(
        np.frombuffer(screen.page.locator("#drawing-canvas").screenshot(), np.uint8), cv2.IMREAD_COLOR
    )
    (colour,) = sure
    bgr = [int(colour[at : at + 2], 16) for at in (5, 3, 1)]
    assert (np.abs(picture.astype(int) - bgr).max(axis=2) < 12).sum() > 500
    screen.press("Shift+S")
    assert legend.is_hidden()


def test_the_slider_hides_what_is_less_sure_as_the_files_do(screen):
    sure = sorted(line["probability"] for line in screen.state["lines"] if line["ends"])
    screen.page.get_by_label("How sure the depth of lines must be").fill("0.8")
    assert sure[0] < 0.8 < sure[-1]
    screen.wait("linecad.store.shown !== null")
    shown = screen.served.ask("shown", {"confidence": 0.8})
    assert set(screen.run("[...linecad.store.shown.lines]")) == set(shown["lines"])
    assert set(screen.run("[...linecad.store.shown.faces]")) == set(shown["faces"])
    hidden = next(line for line in screen.state["lines"] if line["ends"] and line["id"] not in shown["lines"])
    assert not screen.run("(id) => linecad.store.showsLine(linecad.store.lines.get(id))", hidden["id"])
    screen.page.keyboard.press("Escape")
    screen.run("document.activeElement.blur()")
    for _ in range(2):
        screen.press("[")
    assert screen.run("linecad.store.choice.confidence") == pytest.approx(0.7)
    for _ in range(12):
        screen.press("]")
    screen.page.get_by_text("choose a smaller confidence").wait_for()
    assert screen.run("linecad.store.shown.lines.size") == 0
    screen.page.get_by_role("button", name="Show all").click()
    screen.page.get_by_text("choose a smaller confidence").wait_for(state="detached")
    assert screen.run("linecad.store.shown") is None


def download(screen, name, path):
    screen.press("e")
    with screen.page.expect_download() as waiting:
        screen.page.locator(f"[data-format='{name}']").click()
    waiting.value.save_as(path)
    return path.read_bytes()


def test_exports_hold_what_is_shown_and_are_those_of_the_command(screen, tmp_path):
    download(screen, "json", tmp_path / "whole.json")
    photo = ["--photo", str(screen.served.photo), "--quiet"]
    screen.page.get_by_label("How sure the depth of lines must be").fill("0.6")
    screen.page.get_by_label("Detail").select_option("openings")
    line = next(each for each in screen.state["lines"] if each["component"] == 1)
    screen.run("(id) => linecad.store.set({ selection: { kind: 'line', id } })", line["id"])
    screen.page.get_by_label("Groups of lines").select_option("main")
    screen.wait("linecad.store.choice.groups === 'main'")
    screen.run("document.activeElement.blur()")
    more = ["--confidence", "0.6", "--detail", "openings", "--groups", "main"]
    command = ["export", str(tmp_path / "whole.json"), *photo, *more, "-o", str(tmp_path / "scene.dxf")]
    assert main(command) == 0
    of_page = download(screen, "dxf", tmp_path / "page.dxf")
    assert of_page == (tmp_path / "scene.dxf").read_bytes()
    screen.press("e")
    assert screen.page.get_by_text("Files hold what is shown").is_visible()
    screen.page.get_by_role("menuitem", name="Show all").click()
    assert screen.run("linecad.store.choice.groups") == "all"
    screen.press("Escape")


def test_the_group_of_the_selection_is_shown_and_exported_as_the_main_one(screen, tmp_path):
    download(screen, "json", tmp_path / "whole.json")
    own = next(each for each in screen.state["lines"] if each["ends"] and each["component"] == 1)
    screen.run("(id) => linecad.store.set({ selection: { kind: 'line', id } })", own["id"])
    screen.page.get_by_label("Groups of lines").select_option("own")
    screen.wait("linecad.store.shown !== null")
    screen.run("document.activeElement.blur()")
    shown = set(screen.run("[...linecad.store.shown.lines]"))
    assert shown == {each["id"] for each in screen.state["lines"] if each["ends"] and each["component"] == 1}
    u, v = screen.run("linecad.store.choice.main")
    command = ["export", str(tmp_path / "whole.json"), "--groups", "main", "--main", f"{u},{v}", "--quiet"]
    assert main([*command, "--photo", str(screen.served.photo), "-o", str(tmp_path / "scene.dxf")]) == 0
    assert download(screen, "dxf", tmp_path / "page.dxf") == (tmp_path / "scene.dxf").read_bytes()


def test_the_elevation_is_that_of_the_selected_facade(screen, tmp_path):
    download(screen, "json", tmp_path / "whole.json")
    facades = [plane for plane in screen.state["planes"] if plane["is_facade"]][:2]
    drawn = set()
    for plane in facades:
        screen.run("(id) => linecad.store.set({ selection: { kind: 'face', id } })", plane["faces"][0]["id"])
        told = screen.page.locator(".exported").text_content()
        assert f"Elevations are of the selected facade, plane {plane['id']}." in told
        of_page = download(screen, "elevation.svg", tmp_path / "page.svg")
        command = ["elevation", str(tmp_path / "whole.json"), "--plane", str(plane["id"]), "--quiet"]
        assert main([*command, "--photo", str(screen.served.photo), "-o", str(tmp_path / "out.svg")]) == 0
        assert of_page == (tmp_path / "out.svg").read_bytes()
        drawn.add(of_page)
    assert len(drawn) == 2
    screen.run("linecad.store.set({ selection: null })")
    assert "Elevations are of the largest facade" in screen.page.locator(".exported").text_content()
    command = ["elevation", str(tmp_path / "whole.json"), "--photo", str(screen.served.photo), "--quiet"]
    assert main([*command, "-o", str(tmp_path / "out.svg")]) == 0
    assert download(screen, "elevation.svg", tmp_path / "page.svg") == (tmp_path / "out.svg").read_bytes()
