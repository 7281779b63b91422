"""Hidden parts of faces take the face's own colours, and nothing else of a texture changes."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
import shapely

from exporters.format_options import TEXTURES
from exporters.formats import FORMATS, export
from exporters.model import build_model
from exporters.textures.behind import PLAIN, fill_behind
from exporters.textures.build import build_textures
from exporters.textures.layout import MARGIN, build_layout, view_of
from exporters.textures.rectify import paint_pages
from linecad.scene import Face, Plane

WALL, WINDOW, HEDGE = (200, 150, 120), (20, 20, 30), (20, 220, 20)
DEPTH = 10.0
FADED = 0.01  # of the photo's width: what lies farther from a hidden part keeps its colours


def ring(left, bottom, right, top):
    return np.array([[left, DEPTH, bottom], [right, DEPTH, bottom], [right, DEPTH, top], [left, DEPTH, top]])


@pytest.fixture(scope="module")
def facade(scene):
    """Makes a scene of one wall straight before the camera, with these hidden parts."""

    def make(hidden):
        face = Face(0, ring(-4, -3, 4, 3), (ring(2, 0, 3, 2),), "wall", tuple(hidden))
        return replace(
            scene, rotation=np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]), planes=(Plane(0, 1, 10.0, (), (face,)),)
        )

    return make


@pytest.fixture(scope="module")
def hedge():
    """The left half of the wall's foot, which a hedge hides."""
    return ring(-4, -3, 0, -1)


@pytest.fixture(scope="module")
def photo(facade, hedge):
    """A wall of one colour with dark windows, and a hedge that reaches beyond its left and lower edges."""
    bare = facade(())
    picture = np.full((bare.camera.height, bare.camera.width, 3), 255, np.uint8)
    paint(picture, bare, ring(-4, -3, 4, 3), WALL)
    for left in (-3.5, -2.5, -1.5, -0.5):
        paint(picture, bare, ring(left, -1.5, left + 0.5, 0), WINDOW)
    wide = hedge.copy()
    wide[[0, 3], 0] -= 1
    wide[:2, 2] -= 1
    paint(picture, bare, wide, HEDGE)
    return picture


def paint(picture, scene, corners, colour):
    ray = corners @ scene.rotation.T @ scene.camera.matrix.T
    cv2.fillPoly(picture, [np.round(ray[:, :2] / ray[:, 2:] * 16).astype(np.int32)], colour, cv2.LINE_AA, 4)


def painted(scene, photo, row=0):
    """The pixels of the patch of a face with its margin, and the patch."""
    model, view = build_model(scene), view_of(scene)
    layout = build_layout(model, view, 4096)
    (page,), _ = paint_pages(model, layout, view, photo)
    patch = layout.patches[row]
    top, left = patch.top - MARGIN, patch.left - MARGIN
    return page[top : patch.top + patch.rows + MARGIN, left : patch.left + patch.columns + MARGIN], patch


def is_colour(pixels, colour, tolerance=12):
    return np.abs(pixels.astype(int) - colour).max(axis=-1) <= tolerance


def greenness(pixels):
    """How much more green than red and blue, of 255."""
    return pixels[..., 1].astype(int) - pixels[..., [0, 2]].max(axis=-1)


def distance_from(patch, corners, shape):
    """(rows, columns) texels of a patch with its margin to a rectangle of the face."""
    low, high = np.sort(patch.texels(corners)[[0, 2]], axis=0)
    rows, columns = np.indices(shape) + 0.5
    x = np.maximum(np.maximum(low[0] - columns, columns - high[0]), 0)
    y = np.maximum(np.maximum(low[1] - rows, rows - high[1]), 0)
    return np.hypot(x, y)


def test_what_hides_a_part_is_not_painted_and_the_rest_is_as_before(facade, hedge, photo):
    before, patch = painted(facade(()), photo)
    after, _ = painted(facade([hedge]), photo)
    assert is_colour(before, HEDGE).mean() > 0.1
    assert greenness(after).max() < 0
    away = distance_from(patch, hedge, before.shape[:2])
    assert is_colour(after[away == 0], WALL).all()  # no window is spread over it
    rest = away > FADED * photo.shape[1] + 2  # a texel here is a pixel
    assert 0.4 < rest.mean() < 1
    assert (after[rest] == before[rest]).all()
    assert is_colour(after[rest], WINDOW).any()


def test_the_colours_about_a_hidden_part_pass_into_each_other(facade, hedge, photo):
    pixels, patch = painted(facade([hedge]), photo)
    x, y = patch.texels(np.array([-3.25, DEPTH, -1.0])).astype(int)  # a window goes on behind the hedge
    column = pixels[y - 40 : y + 5, x].astype(int)
    assert is_colour(column[0], WINDOW)
    assert is_colour(column[-1], WALL)
    steps = np.abs(np.diff(column, axis=0)).max(axis=1)
    assert steps.max() < 0.25 * np.ptp(column, axis=0).max()


def test_a_face_that_is_wholly_hidden_is_plain(facade, photo):
    pixels, _ = painted(facade([ring(-4, -3, 4, 3)]), photo)
    assert is_colour(pixels, PLAIN, 0).all()


def test_a_wall_goes_on_in_its_own_colours_behind_a_nearer_face(facade, hedge, photo):
    near = hedge * 0.9  # in the photo the same
    scene = facade([hedge])
    before = Plane(1, 1, 0.9 * DEPTH, (), (Face(1, near),))
    pixels, patch = painted(replace(scene, planes=(*scene.planes, before)), photo, 0)
    behind = distance_from(patch, hedge, pixels.shape[:2]) == 0
    assert behind.mean() > 0.1
    assert is_colour(pixels[behind], WALL).mean() > 0.99
    assert greenness(pixels).max() < 0
    bare = facade(())
    plain, _ = painted(replace(bare, planes=(*bare.planes, before)), photo, 0)
    assert is_colour(plain[behind], PLAIN, 0).mean() > 0.9  # nobody told that it goes on there


@pytest.mark.parametrize("hidden", [(-4, -3, -2, -1), (-4, -3, 0, -2), (-3, -2.5, -1, -1.5)])
def test_nothing_of_the_nearer_face_is_painted_on_the_wall_behind_it(hidden, facade, hedge, photo):
    scene = facade([ring(*hidden)])
    before = Plane(1, 1, 0.9 * DEPTH, (), (Face(1, hedge * 0.9),))
    pixels, _ = painted(replace(scene, planes=(*scene.planes, before)), photo, 0)
    assert greenness(pixels).max() < 0
    assert is_colour(pixels, WALL).mean() > 0.3


def test_how_much_of_a_face_is_shown_does_not_count_what_another_hides(facade, hedge, photo):
    near = Plane(1, 1, 0.9 * DEPTH, (), (Face(1, hedge * 0.9),))
    counts = []
    for hidden in ((), (hedge,)):
        scene = facade(hidden)
        scene = replace(scene, planes=(*scene.planes, near))
        model, view = build_model(scene), view_of(scene)
        counts.append(paint_pages(model, build_layout(model, view, 4096), view, photo)[1])
    assert counts[1] == pytest.approx(counts[0], rel=0.01)
    model, view = build_model(facade((hedge,))), view_of(facade((hedge,)))
    (shown,) = paint_pages(model, build_layout(model, view, 4096), view, photo)[1]
    assert shown == pytest.approx(counts[0][0], rel=0.01)


def test_the_little_that_is_in_plain_view_colours_all_the_rest(facade, photo):
    pixels, _ = painted(facade([ring(-4, -3, 4, 1.0), ring(-4, 1.0, 3.8, 3)]), photo)
    assert is_colour(pixels, WALL).mean() > 0.9


def test_hidden_parts_may_overlap_and_leave_the_photo(facade, hedge, photo):
    whole, _ = painted(facade([hedge]), photo)
    parts, _ = painted(facade([ring(-4, -3, -1, -1), ring(-2, -3, 0, -1), ring(40, -3, 60, 0)]), photo)
    assert (parts == whole).all()


def test_light_that_changes_along_a_wall_goes_on_behind_what_hides_it(facade):
    scene = facade([ring(-4, -3, 4, -1)])
    photo = np.empty((scene.camera.height, scene.camera.width, 3), np.uint8)
    photo[:] = np.linspace(50, 250, scene.camera.width)[:, None]
    pixels, patch = painted(scene, photo)
    x, y = patch.texels(np.array([[-3.0, DEPTH, -2.5], [3.0, DEPTH, -2.5]])).astype(int).T
    left, right = pixels[y, x, 0].astype(int)
    seen_left, seen_right = pixels[patch.top + 40, x, 0].astype(int)
    assert right - left > 0.5 * (seen_right - seen_left) > 20


@pytest.mark.parametrize("shape", [(17, 9000), (9000, 17), (1, 1), (17, 18)])
def test_patches_of_any_shape_are_filled(shape):
    colours = np.full((*shape, 3), HEDGE, np.uint8)
    cover = np.zeros(shape, np.uint8)
    cover[:, : (shape[1] + 1) // 2] = 255
    colours[cover == 0] = WALL
    fill_behind(colours, cover, np.ones(shape, np.bool_))
    assert is_colour(colours, WALL if shape != (1, 1) else PLAIN, 0).all()


def test_without_a_cover_nothing_changes():
    colours = np.random.default_rng(1).integers(0, 256, (50, 40, 3), np.uint8)
    before = colours.copy()
    fill_behind(colours, np.zeros((50, 40), np.uint8), np.ones((50, 40), np.bool_))
    assert (colours == before).all()


@pytest.mark.parametrize("suffix", [suffix for suffix, row in FORMATS.items() if TEXTURES[0] in row.options])
def test_every_format_with_textures_has_the_filled_ones(facade, hedge, photo, tmp_path, suffix):
    scene = facade([hedge])
    export(scene, tmp_path / f"a{suffix}", photo)
    (page,) = build_textures(scene, photo, 4096).pages
    assert any(page.data in path.read_bytes() for path in tmp_path.rglob("*") if path.is_file())
    assert page.data != build_textures(facade(()), photo, 4096).pages[0].data
    assert page.data == build_textures(scene, photo, 4096).pages[0].data


def test_what_its_own_wall_hides_of_a_pane_takes_nothing_of_the_rest(row):
    photo = np.random.default_rng(3).integers(0, 256, (row.camera.height, row.camera.width, 3), np.uint8)
    pane = next(face for plane in row.planes for face in plane.faces if face.id == 10)
    wall = next(face for plane in row.planes for face in plane.faces if face.kind == "wall")
    hole = wall.holes[2] * (pane.outline[0, 1] / wall.holes[2][0, 1])  # as it shows on the plane of the pane
    flat = [shapely.Polygon(ring[:, [0, 2]]) for ring in (pane.outline, hole)]
    behind = flat[0] - flat[1]
    assert 0.02 < behind.area / flat[0].area < 0.5
    strip = np.insert(np.array(behind.exterior.coords)[:-1], 1, pane.outline[0, 1], axis=1)
    before, after = (patch_of(scene, photo, 10) for scene in (row, with_hidden(row, 10, strip)))
    assert (before == after).all()
    assert not is_colour(after, PLAIN, 0).any()
    # A thing that hides the pane, beside its wall, still is not painted on it.
    middle = pane.outline.mean(axis=0)
    thing = middle + 0.5 * (pane.outline - middle)
    assert (patch_of(with_hidden(row, 10, strip, thing), photo, 10) != before).any()


def with_hidden(scene, identity, *hidden):
    """A scene with hidden parts of one of its faces."""
    planes = [
        replace(plane, faces=tuple(replace(f, hidden=hidden) if f.id == identity else f for f in plane.faces))
        for plane in scene.planes
    ]
    return replace(scene, planes=tuple(planes))


def patch_of(scene, photo, identity):
    """The pixels of a face's patch without its margin."""
    model, view = build_model(scene), view_of(scene)
    layout = build_layout(model, view, 4096)
    pages, _ = paint_pages(model, layout, view, photo)
    (patch,) = (each for face, each in zip(model.faces, layout.patches, strict=True) if face.id == identity)
    return pages[patch.page][patch.top : patch.top + patch.rows, patch.left : patch.left + patch.columns]
