"""What a person knows about faces, in a browser: lassos, windows by two corners, rows of them, walls by edges."""

import numpy as np
import pytest
import shapely

from linecad.corrections.edits import NoWindow, Region, WallByEdges, Window
from linecad.corrections.file import SUFFIX, read_corrections

pytestmark = pytest.mark.thorough  # every day the server is asked what the page asks it (test_face_edits.py)

ON_GROUND = ((300, 940), (700, 940), (700, 1040), (300, 1040))  # px of the sample street


def corrections(screen):
    """The edits in the file, once all are written."""
    while not screen.served.ask("progress")["saved"]:
        screen.page.wait_for_timeout(20)
    return read_corrections(screen.served.photo.with_name(screen.served.photo.name + SUFFIX)).edits


def project(state, points):
    seen = np.array(points) @ (np.array(state["K"]) @ np.array(state["R_cam_from_world"])).T
    return seen[:, :2] / seen[:, 2:]


def walls(state):
    """The walls of the model, the largest in the photo first, with their outlines, px."""
    found = []
    for plane in state["planes"]:
        for face in plane["faces"]:
            if plane["axis"] != "z" and face["opening"] is None:
                found.append((plane, shapely.Polygon(project(state, face["outline"])).buffer(0)))
    return sorted(found, key=lambda each: -each[1].area)


def drag(screen, places):
    mouse = screen.page.mouse
    mouse.move(*screen.on_screen(places[0]))
    mouse.down()
    for place in places[1:]:
        mouse.move(*screen.on_screen(place), steps=4)
    mouse.up()
    screen.settle()


def box_in(shape, share):
    """Two opposite corners about the middle of a shape."""
    middle = np.array(shape.representative_point().coords[0])
    reach = share * np.sqrt(shape.area)
    return middle - reach, middle + reach


def test_a_lasso_says_what_a_part_of_the_photo_shows(screen):
    take(screen, "Shift+A", "ground")
    screen.press("Shift+A")  # once more: sky
    assert screen.page.locator("#inspector [aria-pressed=true]").inner_text() == "Sky"
    drag(screen, [(60, 60), (260, 60), (260, 160), (60, 160)])
    (edit,) = corrections(screen)
    assert isinstance(edit, Region)
    assert edit.shows == "sky"
    drawn = shapely.Polygon([(60, 60), (260, 60), (260, 160), (60, 160)])
    assert shapely.Polygon(edit.polygon).symmetric_difference(drawn).area < 0.02 * drawn.area
    assert [area["is"] for area in screen.state["areas"]] == ["sky"]
    screen.press("Control+z")
    assert corrections(screen) == ()
    assert screen.state["areas"] == []


def test_clicks_are_corners_of_an_area_that_enter_closes(screen):
    take(screen, "Shift+A", "ground")
    for place in ON_GROUND[:3]:
        screen.click(place)
    screen.press("Enter")
    (edit,) = corrections(screen)
    assert isinstance(edit, Region)
    assert len(edit.polygon) == 3
    assert edit.shows == "ground"


def test_two_corners_are_no_area_and_stay_until_there_are_more(screen):
    """Enter cleared them without a word."""
    take(screen, "Shift+A", "ground")
    for place in ON_GROUND[:2]:
        screen.click(place)
    screen.press("Enter")
    assert "three corners" in screen.page.locator("#messages").inner_text()
    assert screen.run("linecad.actions.faces.outline.length") == 2
    screen.click(ON_GROUND[2])
    screen.press("Enter")
    (edit,) = corrections(screen)
    assert len(edit.polygon) == 3


def test_news_over_the_photo_catches_no_click(screen):
    take(screen, "Shift+A", "ground")
    screen.run(
        "linecad.actions.messages.tell('News that is long enough to lie over much of the photo, and stays a while')"
    )
    box = screen.page.locator("#messages .message").bounding_box()
    screen.page.mouse.click(box["x"] + 20, box["y"] + box["height"] / 2)
    assert screen.run("linecad.actions.faces.outline.length") == 1
    screen.page.locator("#messages .message button").click()
    assert screen.page.locator("#messages .message").count() == 0
    screen.press("Escape")


def test_a_window_by_two_corners_becomes_rows_and_columns_by_one_more_drag(screen):
    plane, shape = walls(screen.state)[0]
    low, high = box_in(shape, 0.05)
    take(screen, "Shift+W", "window")
    drag(screen, [low, high])
    (edit,) = corrections(screen)
    assert isinstance(edit, Window)
    assert (edit.columns, edit.rows) == (1, 1)
    assert np.abs(np.array(edit.corners) - [low, high]).max() < 1.5  # px of a photo that is shown smaller
    middle = (low + high) / 2
    along = np.array([3 * (high - low)[0], 0.0])
    drag(screen, [middle, middle + along])
    one, several = corrections(screen)
    assert several.corners == one.corners
    assert several.wall == one.wall
    assert several.columns > 1
    screen.press("ArrowRight")
    assert corrections(screen)[-1].columns == several.columns + 1
    assert plane["axis"] in ("x", "y")


def test_the_same_key_again_makes_doors(screen):
    _, shape = walls(screen.state)[0]
    take(screen, "Shift+W", "window")
    screen.press("Shift+W")
    drag(screen, [*box_in(shape, 0.05)])
    assert corrections(screen)[0].kind == "door"


def test_no_wall_no_window(screen):
    screen.press("Shift+W")
    drag(screen, [(3, 3), (9, 12)])
    assert corrections(screen) == ()
    assert "No wall of the model is here" in screen.page.locator("#messages").inner_text()


def test_a_wall_by_four_lines(screen):
    plane, _ = walls(screen.state)[0]
    lines = [each for each in screen.state["lines"] if each["id"] in plane["lines"]]
    upright = [each for each in lines if each["axis"] == "z"][:2]
    level = [each for each in lines if each["axis"] != "z"][:2]
    screen.press("Shift+E")
    for line in (*upright, *level):
        screen.click(clear_place(screen.state, line))
    (edit,) = corrections(screen)
    assert isinstance(edit, WallByEdges)
    assert {anchor.ends for anchor in edit.lines} == {tuple(map(tuple, line["segment"])) for line in (*upright, *level)}


def clear_place(state, line):
    """A place on a line that is far from all others."""
    shares = np.linspace(0.1, 0.9, 81)[:, None]
    places = (1 - shares) * line["segment"][0] + shares * np.array(line["segment"][1])
    others = shapely.MultiLineString([each["segment"] for each in state["lines"] if each["id"] != line["id"]])
    return places[shapely.distance(shapely.points(places), others).argmax()]


def test_undo_takes_back_a_corner_before_what_was_sent(screen):
    take(screen, "Shift+A", "ground")
    for place in ON_GROUND:
        screen.click(place)
    screen.press("Control+z")
    screen.press("Enter")
    (edit,) = corrections(screen)
    assert len(edit.polygon) == 3
    screen.press("Control+z")
    assert corrections(screen) == ()


def test_escape_leaves_what_is_being_drawn_and_then_the_tool(screen):
    screen.press("Shift+A")
    screen.click((60, 60))
    screen.press("Escape")
    assert screen.run("linecad.store.tool") == "area"
    screen.press("Escape")
    assert screen.run("linecad.store.tool") == "correct"


def test_a_click_on_a_window_and_del_takes_it_away(screen):
    _, shape = walls(screen.state)[0]
    take(screen, "Shift+W", "window")
    drag(screen, [*box_in(shape, 0.05)])
    solve(screen)
    (pane,) = panes(screen.state)
    middle = project(screen.state, pane).mean(axis=0)
    screen.click(middle)
    assert "Del takes it away" in screen.page.locator("#inspector").inner_text()
    screen.press("Delete")
    edit = corrections(screen)[-1]
    assert isinstance(edit, NoWindow)
    assert np.abs(np.array(edit.at) - middle).max() < 3
    solve(screen)
    assert panes(screen.state) == []


def panes(state):
    faces = [face for plane in state["planes"] for face in plane["faces"]]
    return [face["outline"] for face in faces if face["opening"] is not None]


def solve(screen):
    screen.press("s")
    screen.wait("linecad.store.solve.state === 'idle' && linecad.store.state.solve.fresh")
    screen.settle()


def take(screen, key, word):
    """A tool, and what it makes."""
    screen.press(key)
    screen.page.locator(f"#inspector [data-word={word}]").click()
