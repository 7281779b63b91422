from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from exporters.colours import line_colour
from exporters.formats import export
from exporters.picture import faces as picture_faces
from exporters.picture import scene as picture
from exporters.picture import views as picture_views
from exporters.picture.canvas import Canvas, drawable, text_width
from linecad.directions import axis_name
from linecad.scene import CONFIDENCES, Camera, DepthMapReport, Intersections, Plane

GREY = (0.5, 0.5, 0.5)
LEFT, TOP, PHOTO_WIDTH = 44, 166, 1560  # px: where the photo stands in a picture of a 4 : 3 photo


@pytest.fixture(scope="module")
def drawn(scene, photo, tmp_path_factory):
    path = tmp_path_factory.mktemp("picture") / "a.png"
    export(scene, path, photo)
    return np.asarray(Image.open(path), dtype=float) / 255


@pytest.fixture(scope="module")
def drawn_without_photo(scene, tmp_path_factory):
    path = tmp_path_factory.mktemp("picture") / "a.png"
    export(scene, path)
    return np.asarray(Image.open(path), dtype=float) / 255


def at(drawn, scene, pixel):
    """The colour where a pixel of the photo is shown."""
    x, y = (np.asarray(pixel) + 0.5) * PHOTO_WIDTH / scene.camera.width - 0.5
    return drawn[round(y) + TOP, round(x) + LEFT]


def far_from_crossings(scene, pixel):
    return np.linalg.norm(scene.intersections.pixel - pixel, axis=1).min() > 15


def crossed_once(scene, number, pixel):
    """Whether no other line is drawn at this point of line `number`."""
    start, end = scene.lines.segment[:, 0], scene.lines.segment[:, 1]
    along = end - start
    share = np.clip(((pixel - start) * along).sum(axis=1) / (along**2).sum(axis=1), 0, 1)
    distance = np.linalg.norm(start + share[:, None] * along - pixel, axis=1)
    return (np.delete(distance, number) > 8).all()


@pytest.mark.parametrize("is_boundary", [True, False])
def test_lines_are_drawn_on_the_photo_in_the_colour_of_their_axis(drawn, scene, is_boundary):
    lines = scene.lines
    seen = set()
    for number in np.flatnonzero(lines.is_boundary == is_boundary):
        middle = lines.segment[number].mean(axis=0)
        inside = (middle > 0).all() and (middle < (scene.camera.width - 1, scene.camera.height - 1)).all()
        if inside and far_from_crossings(scene, middle) and crossed_once(scene, number, middle):
            colour = line_colour(int(lines.axis[number]), True)
            assert at(drawn, scene, middle) == pytest.approx(colour, abs=0.35 if not is_boundary else 0.02)
            seen.add(int(lines.axis[number]))
    assert seen == {0, 1, 2}


def width_of(drawn, scene, number):
    """How many pixels of the line's colour lie across it, at a third of its length."""
    start, end = scene.lines.segment[number]
    along = (end - start) / np.linalg.norm(end - start)
    across = np.array([-along[1], along[0]])
    point = start + (end - start) / 3
    colour = np.array(line_colour(int(scene.lines.axis[number]), True))
    samples = [at(drawn, scene, point + step * across) for step in np.arange(-8, 8, 0.25)]
    return sum(np.abs(sample - colour).max() < 0.2 for sample in samples)


def test_boundaries_are_thicker(drawn, scene):
    lines = scene.lines
    (facade_edge,) = np.flatnonzero(np.linalg.norm(lines.ends[:, 0] - lines.ends[:, 1], axis=1) == 8)[:1]
    (belt,) = np.flatnonzero(~lines.is_boundary & (lines.axis == 0))[:1]
    assert width_of(drawn, scene, facade_edge) > 2 * width_of(drawn, scene, belt)


def test_real_crossings_are_yellow_discs_and_fake_ones_magenta_crosses(drawn, scene):
    crossings = scene.intersections
    for pixel, real in zip(crossings.pixel, crossings.real, strict=True):
        red, green, blue = at(drawn, scene, pixel)
        assert green > 0.6 if real else green < 0.4
        assert blue < 0.3 if real else blue > 0.4
        assert red > 0.7


def test_faces_are_tinted_by_the_axis_of_their_plane(drawn_without_photo, scene):
    facade = next(face for plane, face in scene.faces if face.id == 0)
    point = facade.outline[0] + (1.0, 0.0, 1.0)
    pixel = (scene.camera.matrix @ scene.rotation @ point)[:2] / (scene.rotation @ point)[2]
    red, green, blue = at(drawn_without_photo, scene, pixel)
    assert green > max(red, blue) + 0.02


def test_holes_are_not_tinted(drawn_without_photo, scene):
    wall = next(face for plane, face in scene.faces if face.id == 1)
    point = wall.holes[0].mean(axis=0)
    pixel = (scene.camera.matrix @ scene.rotation @ point)[:2] / (scene.rotation @ point)[2]
    assert np.ptp(at(drawn_without_photo, scene, pixel)) < 0.02


def test_the_photo_is_shown(drawn, drawn_without_photo, scene, photo):
    x, y = 1200, 60  # sky
    shade = photo[y - 20 : y + 20, x - 20 : x + 20].mean(axis=(0, 1)) / 255
    shown = np.mean(
        [at(drawn, scene, (x + dx, y + dy)) for dx in range(-20, 20, 4) for dy in range(-20, 20, 4)], axis=0
    )
    faded = 0.7 * (0.5 * shade + 0.5 * shade @ [0.299, 0.587, 0.114]) + 0.3
    assert shown == pytest.approx(faded, abs=0.02)
    assert np.ptp(at(drawn_without_photo, scene, (x, y))) < 0.02


def texts(canvas):
    return [text.text for text in canvas.texts]


def test_a_picture_without_photo_says_so(scene):
    canvas = Canvas(800, 600, GREY)
    picture._draw_photo(canvas, scene, None)
    assert "photo not given" in texts(canvas)


def test_the_title_counts(scene):
    canvas = Canvas(2400, 300, GREY)
    picture._draw_title(canvas, scene)
    title, facts = texts(canvas)
    assert title == "Hauschen ?.jpg: 60 lines (51 boundaries), 6 planes, 9 faces"
    real = int(scene.intersections.real.sum())
    assert f"{len(scene.intersections)} crossings: {real} real, {len(scene.intersections) - real} fake" in facts
    assert "26 along x, 6 along y, 28 along z" in facts


def test_long_facts_end_before_the_border_and_a_gap_that_nothing_proves_is_unknown(scene):
    unproven = replace(scene.solve, solver="graduated non-convexity", status="robust fit", bound=np.inf, gap=np.inf)
    canvas = Canvas(1500, 300, GREY)
    picture._draw_title(canvas, replace(scene, solve=unproven))
    facts = canvas.texts[-1]
    assert "gap unknown" in facts.text
    assert facts.x + text_width(facts.text, facts.size) < 1500


def test_the_font_has_what_is_drawn():
    assert drawable("Größe 家, 3 %") == "Gro?e ?, 3 %"


def view(scene, name, right, up, size=(800, 500)):
    canvas = Canvas(*size, GREY)
    picture_views.draw_view(canvas, scene, name, right, up)
    return canvas


@pytest.mark.parametrize(("name", "right", "up"), picture_views.VIEWS)
def test_views_have_their_axes_and_a_scale_with_its_unit(scene, free_unit, name, right, up):
    told = texts(view(scene, name, right, up))
    assert f"{name} view" in told
    assert {"xyz"[right], "xyz"[up]} <= set(told)
    assert any(text.endswith(" m") for text in told)
    assert any(text.endswith((" units", " unit")) for text in texts(view(free_unit, name, right, up)))
    assert not any("outside" in text for text in told)


@pytest.mark.parametrize("size", [(800, 500), (400, 900)])
def test_both_axes_have_one_scale(size):
    low, high = np.array([-3.0, 2.0]), np.array([5.0, 4.0])
    projection = picture_views._projection(Canvas(*size, GREY), low, high)
    corner, across, along = projection.pixels(np.array([[0, 0], [1, 0], [0, 1]]))
    assert across - corner == pytest.approx([projection.scale, 0])
    assert along - corner == pytest.approx([0, -projection.scale])
    for point in (low, high):
        pixel = projection.pixels(point)
        assert ((pixel > 0) & (pixel < size)).all()


def test_an_outlier_does_not_shrink_the_view_and_is_counted(scene):
    ends = scene.lines.ends.copy()
    ends[3] *= 1000
    far = replace(scene, lines=replace(scene.lines, ends=ends))
    told = texts(view(far, "top", 0, 1))
    assert "1 line reaches outside" in told
    near = texts(view(scene, "top", 0, 1))
    assert [text for text in told if text.endswith(" m")] == [text for text in near if text.endswith(" m")]


def test_a_wall_beside_a_facade_that_holds_most_lines_is_no_outlier(scene):
    points = scene.lines.ends.reshape(-1, 3)
    low, high = picture_views._bounds(points)
    assert low.tolist() == points.min(axis=0).tolist()
    assert high.tolist() == points.max(axis=0).tolist()


def test_lines_of_smaller_components_are_paler_in_the_views(scene):
    whole = view(replace(scene, planes=()), "front", 0, 2)
    parts = replace(scene, planes=(), lines=replace(scene.lines, component=np.ones(len(scene.lines))))
    pale = view(parts, "front", 0, 2)
    red = np.array(line_colour(0, True)) * 255
    assert (np.abs(whole.pixels[60:400, 60:] - red).max(axis=2) < 2).any()
    assert not (np.abs(pale.pixels[60:400, 60:] - red).max(axis=2) < 2).any()


def test_weak_lines_are_counted_in_the_title_and_dashed_in_the_photo(scene):
    count = len(scene.lines)
    weak = replace(scene, planes=(), lines=replace(scene.lines, confidence=np.full(count, "weak")))
    canvas = Canvas(2400, 300, GREY)
    picture._draw_title(canvas, weak)
    assert f"{count} lines weak: dashed, pale" in texts(canvas)[1]
    coloured = []
    for each in (replace(scene, planes=()), weak):
        panel = Canvas(1600, 1200, GREY)
        picture._draw_segments(panel, each, each.lines.segment)
        blue = np.array(line_colour(2, True)) * 255
        coloured.append((np.abs(panel.pixels - blue).max(axis=2) < 2).sum())
    assert 0.3 * coloured[0] < coloured[1] < 0.8 * coloured[0]


def tint_of(scene, word):
    """How far a face takes the colour of the panel away from grey, with all lines at that confidence."""
    lines = replace(scene.lines, confidence=np.full(len(scene.lines), word))
    panel = Canvas(scene.camera.width // 4, scene.camera.height // 4, GREY)
    picture_faces.draw_faces(panel, replace(scene, lines=lines), np.array([0.25, 0.25]))
    return np.ptp(panel.pixels.astype(int), axis=2).mean()


def test_faces_are_the_stronger_the_surer_they_are(scene):
    assert tint_of(scene, "proven") > 1.2 * tint_of(scene, "supported") > 1.4 * tint_of(scene, "weak") > 0


def test_the_confidence_of_a_plane_is_that_of_most_of_its_lines(scene):
    plane = scene.planes[0]
    first, *others = plane.lines
    words = dict.fromkeys(others, "supported") | {first: "proven"}
    assert picture_faces.word_of(plane, words, CONFIDENCES) == "supported"
    two = replace(plane, lines=(first, others[0]))
    assert picture_faces.word_of(two, words, CONFIDENCES) == "supported"


def test_a_ground_without_lines_is_as_sure_as_most_lines_of_the_scene():
    ground = Plane(99, 2, -2.0, ())
    for most, fewest in (("proven", "weak"), ("weak", "proven")):
        assert picture_faces.word_of(ground, {0: most, 1: most, 2: fewest}, CONFIDENCES) == most


def with_probability(scene, probability):
    return replace(scene, lines=replace(scene.lines, probability=np.full(len(scene.lines), probability)))


def test_probabilities_are_counted_in_the_title_and_explained_in_the_legend(told):
    canvas = Canvas(2400, 300, GREY)
    picture._draw_title(canvas, told)
    assert "depths right within 5 %: 20 sure, 20 likely, 20 guess" in texts(canvas)[1]
    legend = Canvas(2400, 300, GREY)
    picture._draw_legend(legend, picture._legend(picture_faces.words_of(told.lines)[1], 3))
    assert texts(legend)[-3:] == ["sure (0.9)", "likely (0.5)", "guess"]
    last = legend.texts[-1]
    assert last.x + text_width(last.text, last.size) < 2400


@pytest.mark.parametrize(("directions", "rows"), [(3, 1), (5, 2), (13, 2), (43, 3)])
def test_a_legend_of_many_frames_has_rows_that_fit(told, directions, rows):
    found = picture._legend(picture_faces.words_of(told.lines)[1], directions)
    assert len(found) == rows
    legend = Canvas(2400, 300, GREY)
    picture._draw_legend(legend, found)
    names = [axis_name(axis) for axis in range(directions)]
    assert [text for text in texts(legend) if text.split()[0] in names][6:] == names[3:]
    assert sorted({each.y for each in legend.texts}) == [300 - 48 - 42 * row for row in reversed(range(rows))]
    for each in legend.texts:
        assert each.x + text_width(each.text, each.size) <= 2400 - 44


def test_the_picture_grows_with_the_rows_of_its_legend(told, tmp_path):
    heights = []
    for turns in ((), (0.2, 0.4, 0.6)):
        export(replace(told, turns=turns), tmp_path / "a.png")
        with Image.open(tmp_path / "a.png") as drawn:
            heights.append(drawn.height)
    assert heights[1] == heights[0] + picture._ROW


def test_lines_have_the_more_gaps_the_less_likely_their_depth_is(scene):
    blue = np.array(line_colour(2, True)) * 255
    coloured = []
    for probability in (0.95, 0.6, 0.1):
        panel = Canvas(1600, 1200, GREY)
        picture._draw_segments(panel, with_probability(scene, probability), scene.lines.segment)
        coloured.append((np.abs(panel.pixels - blue).max(axis=2) < 2).sum())
    assert 0.95 * coloured[0] > coloured[1] > 1.15 * coloured[2] > 0


def test_faces_are_the_stronger_the_likelier_their_lines_are(scene):
    tints = []
    for probability in (0.95, 0.6, 0.1):
        panel = Canvas(scene.camera.width // 4, scene.camera.height // 4, GREY)
        picture_faces.draw_faces(panel, with_probability(scene, probability), np.array([0.25, 0.25]))
        tints.append(np.ptp(panel.pixels.astype(int), axis=2).mean())
    assert tints[0] > 1.2 * tints[1] > 1.4 * tints[2] > 0


def test_guesses_are_paler_in_the_views_whatever_their_component(scene):
    red = np.array(line_colour(0, True)) * 255
    parts = replace(scene, planes=(), lines=replace(scene.lines, component=np.ones(len(scene.lines))))
    for probability, is_full in ((0.6, True), (0.4, False)):
        pixels = view(with_probability(parts, probability), "front", 0, 2).pixels[60:400, 60:]
        assert (np.abs(pixels - red).max(axis=2) < 2).any() == is_full


USED = DepthMapReport("rear wall.npz", "", kind="z", shift=0.0, scale=0.4, width=0.012)
LEFT_OUT = DepthMapReport("rear wall.npz", "it holds one depth throughout")


def rim(scene, by_map):
    """How many px of the photo have the colour of the rim, where these lines (N,) are placed by a depth map."""
    lines = replace(scene.lines, by_depth_map=by_map)
    panel = Canvas(1600, 1200, GREY)
    picture._draw_segments(panel, replace(scene, lines=lines), lines.segment)
    return np.abs(panel.pixels - np.array(picture._BY_MAP) * 255).max(axis=2) < 2


def test_a_line_that_a_depth_map_alone_places_has_a_rim_and_no_other(scene):
    nothing = np.zeros(len(scene.lines), bool)
    assert not rim(scene, nothing).any()
    number = int(np.argmax(np.linalg.norm(scene.lines.segment[:, 1] - scene.lines.segment[:, 0], axis=1)))
    one = nothing.copy()
    one[number] = True
    y, x = np.nonzero(rim(scene, one))
    start, end = scene.lines.segment[number]
    along = (end - start) / np.linalg.norm(end - start)
    place, beside = np.abs((np.column_stack([x, y]) - start) @ np.array([along, (-along[1], along[0])]).T).T
    beside = beside[(place > 10) & (place < np.linalg.norm(end - start) - 10)]  # its ends are round
    assert len(beside) > 100
    assert beside.min() > 2
    assert beside.max() < 9


def heading(scene, report):
    canvas = Canvas(2400, 300, GREY)
    picture._draw_depth_map(canvas, report, scene.lines)
    (text,) = canvas.texts
    assert text.x + text_width(text.text, text.size) < 2400
    has_sample = (np.abs(canvas.pixels - np.array(picture._BY_MAP) * 255).max(axis=2) < 2).any()
    return text.text, has_sample


def test_the_heading_tells_what_a_depth_map_placed_beside_a_sample_of_the_mark(scene):
    by_map = np.arange(len(scene.lines)) < 12
    told = heading(replace(scene, lines=replace(scene.lines, by_depth_map=by_map)), USED)
    assert told == ("12 lines placed by the depth map   ·   " + USED.text, True)
    assert heading(scene, USED)[0].startswith("0 lines placed")


def test_the_heading_tells_why_a_depth_map_was_left_out(scene):
    assert heading(scene, LEFT_OUT) == (LEFT_OUT.text, False)


def test_the_picture_of_a_scene_with_a_map_is_one_line_higher(scene, drawn_without_photo, tmp_path):
    export(replace(scene, depth_map=LEFT_OUT), tmp_path / "a.png")
    with Image.open(tmp_path / "a.png") as picture_with_map:
        assert picture_with_map.height == len(drawn_without_photo) + picture._ROW


@pytest.mark.parametrize(("start", "end"), [((-1e7, 50.0), (1e7, 50.0)), ((50.0, 20.0), (50.0, 80.0))])
def test_dashes_stay_in_the_panel_and_cover_about_half(start, end):
    panel = Canvas(100, 100, GREY)
    before = panel.pixels.copy()
    picture_faces.draw_dashed(panel, list(start), list(end), (12.0, 9.0), (0.0, 0.0, 0.0), 1)
    length = min(np.hypot(*np.subtract(end, start)), 100)
    changed = (panel.pixels != before).any(axis=2)
    covered = max(changed.any(axis=0).sum(), changed.any(axis=1).sum())
    assert 0.5 * length < covered < 0.85 * length


def test_a_line_outside_the_panel_has_no_dashes():
    panel = Canvas(100, 100, GREY)
    before = panel.pixels.copy()
    picture_faces.draw_dashed(panel, [-50.0, 200.0], [50.0, 200.0], (12.0, 9.0), (0.0, 0.0, 0.0), 1)
    assert (panel.pixels == before).all()


@pytest.mark.parametrize(("longest", "length"), [(7.3, 5), (5.0, 5), (0.19, 0.1), (23, 20), (1000, 1000)])
def test_the_scale_bar_has_a_round_length(longest, length):
    assert picture_views._round_length(longest) == pytest.approx(length)


@pytest.mark.parametrize(("width", "height"), [(64, 64), (3000, 90), (90, 3000), (4000, 3000)])
def test_photos_of_any_shape_fill_their_place(scene, tmp_path, width, height):
    factor = np.array([width, height]) / (scene.camera.width, scene.camera.height)
    camera = Camera(width, height, [[width, 0, width / 2], [0, width, height / 2], [0, 0, 1]], "default")
    lines = replace(scene.lines, segment=scene.lines.segment * factor)
    empty = Intersections(lines=[], kind=[], pixel=[], real=[], in_tree=[], weight=[])
    photo = np.full((height, width, 3), (30, 60, 200), np.uint8)
    export(replace(scene, camera=camera, lines=lines, intersections=empty), tmp_path / "a.png", photo)
    with Image.open(tmp_path / "a.png") as drawn:
        assert drawn.width == 2400
        assert 600 < drawn.height < 3000


@pytest.mark.parametrize("aspect", [0.01, 0.5, 1.0, 1.5, 1.89, 1.91, 30.0])
@pytest.mark.parametrize("top", [picture._TOP, picture._TOP + picture._ROW])
def test_nothing_is_laid_over_anything_else(aspect, top):
    photo, views, height = picture._layout(aspect, top)
    assert min(box.top for box in (photo, *views)) == top
    boxes = [photo, *views]
    for box in boxes:
        assert box.left >= 0
        assert box.left + box.width <= 2400
        assert box.top + box.height <= height - 80  # the legend
    for number, one in enumerate(boxes):
        for other in boxes[number + 1 :]:
            apart_across = one.left + one.width <= other.left or other.left + other.width <= one.left
            apart_down = one.top + one.height <= other.top or other.top + other.height <= one.top
            assert apart_across or apart_down


def test_a_face_that_reaches_behind_the_camera_is_cut_off():
    ring = np.array([[-1.0, 0, -5], [1, 0, -5], [1, 0, 5], [-1, 0, 5]])
    before = picture_faces._before(ring, 0.5)
    assert before[:, 2].min() == 0.5
    assert before[:, 2].max() == 5
    assert len(before) == 4
    assert len(picture_faces._before(ring - (0, 0, 10), 0.5)) == 0


def test_a_window_keeps_what_is_drawn_inside():
    canvas = Canvas(100, 100, (0, 0, 0))
    window = canvas.window(20, 30, 40, 50)
    window.line((-100, 25), (200, 25), (1, 1, 1), 3)
    window.tint([[np.array([[-50, -50], [500, -50], [500, 500], [-50, 500]])]], (0, 1, 0), 0.5)
    outside = np.ones((100, 100), bool)
    outside[30:80, 20:60] = False
    assert (canvas.pixels[outside] == 0).all()
    assert (canvas.pixels[~outside] != 0).any(axis=1).all()
