"""The depth buffer against rays that are cast one by one, pictures on faces, backs, near clipping and hidden lines."""

from dataclasses import replace

import numpy as np
import pytest

from exporters.colours import line_colour, linear
from linecad.evaluation.draughting.shapes import nearest_faces
from linecad.evaluation.turned.glb import Material
from linecad.evaluation.turned.raster import (
    BACKGROUND,
    NOTHING,
    View,
    colour_of,
    draw_triangles,
    paint,
    visible_lines,
)
from linecad.evaluation.turned.views import photo_view

BARE = (np.array(BACKGROUND) * 255).round()


def square(z, half, model, name=0):
    """Two triangles across the view of `straight` at a depth, with texels from 0 to 1."""
    corners = np.array([(-half, -half, z), (half, -half, z), (half, half, z), (-half, half, z)], float)
    texels = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], float)
    rows = np.array([(0, 1, 2), (0, 2, 3)])
    return replace(
        model, triangles=corners[rows], texels=texels[rows], material=np.full(2, name), materials=looks((1, 1, 1))
    )  # fmt: skip


def straight(width=101, focal=50.0):
    middle = (width - 1) / 2
    matrix = np.array([[focal, 0, middle], [0, focal, middle], [0, 0, 1]])
    return View("a", matrix, np.eye(3), np.zeros(3), 5.0, width, width)


def looks(*colours, double=True):
    return tuple(Material(np.array(colour, float), None, False, double) for colour in colours)


def test_every_pixel_shows_what_its_ray_meets_first(scene, model):
    view = photo_view(model.camera, 320)
    drawn = draw_triangles(model, view)
    y, x = np.mgrid[:240, :320]
    pixels = np.column_stack([x.ravel(), y.ravel()]).astype(float)
    face, depth = nearest_faces(scene, pixels, scene.faces)
    found = drawn.inverse_depth.ravel()
    same = np.isfinite(depth) == (found > 0)
    assert same.mean() > 0.9995  # a centre may lie on an outline
    both = np.isfinite(depth) & (found > 0)
    assert 1 / found[both] == pytest.approx(depth[both], rel=1e-5)
    assert (face[both] >= 0).all()


def test_from_the_photos_camera_the_model_looks_like_the_photo(model, photo):
    view = photo_view(model.camera, 320)
    drawn = draw_triangles(model, view)
    picture = paint(model, view, drawn)
    shown = drawn.triangle != NOTHING
    difference = np.abs(picture.astype(int) - photo)[shown]
    assert np.median(difference) <= 2
    assert np.percentile(difference, 95) <= 8
    assert (picture[~shown] == BARE).all()


def test_neighbours_share_their_border_without_a_gap_or_a_double(model):
    view = straight()
    flat = square(4.0, 3.3, model)
    halves = [
        replace(flat, triangles=flat.triangles[[k]], texels=flat.texels[[k]], material=flat.material[[k]])
        for k in (0, 1)
    ]
    covered = [draw_triangles(half, view).triangle != NOTHING for half in halves]
    assert not (covered[0] & covered[1]).any()
    whole = np.zeros((101, 101), bool)
    whole[9:92, 9:92] = True  # 3.3 / 4 * 50 = 41.25 px about pixel 50
    assert ((covered[0] | covered[1]) == whole).all()


def test_the_picture_on_a_face_is_true_to_perspective(model):
    ramp = np.repeat(np.repeat(np.arange(256, dtype=np.uint8)[None, :, None], 256, axis=0), 3, axis=2)
    flat = replace(square(4.0, 1.0, model), materials=(Material(np.ones(3), ramp, False, True),))
    slanted = flat.triangles.copy()
    slanted[..., 2] += 2.5 * slanted[..., 0]  # nearer on the left
    view = straight(401, 200.0)
    flat = replace(flat, triangles=slanted)
    picture = paint(flat, view, draw_triangles(flat, view))
    for x in (-0.8, -0.3, 0.4, 0.9):
        depth = 4 + 2.5 * x
        column = round(200 + 200 * x / depth)
        at = (column - 200) / 200
        true = 4 * at / (1 - 2.5 * at)  # where the ray meets the face
        assert picture[200, column, 0] == pytest.approx((true + 1) / 2 * 256 - 0.5, abs=1.5)


def test_a_picture_with_far_more_texels_than_pixels_is_averaged(model):
    rng = np.random.default_rng(1)
    noise = np.repeat(rng.integers(0, 2, (1024, 1024, 1), dtype=np.uint8) * 255, 3, axis=2)
    far = replace(square(50.0, 10.0, model), materials=(Material(np.ones(3), noise, False, True),))
    view = straight()
    drawn = draw_triangles(far, view)
    assert paint(far, view, drawn)[drawn.triangle != NOTHING].std() < 15  # a point of it alone would have 127


def test_the_nearer_face_hides_the_other_whichever_comes_first(model):
    near, far = square(3.0, 0.5, model, 0), square(6.0, 3.0, model, 1)
    for order in ((near, far), (far, near)):
        both = replace(
            model, triangles=np.concatenate([each.triangles for each in order]),
            texels=np.concatenate([each.texels for each in order]),
            material=np.concatenate([each.material for each in order]), materials=looks((1, 0, 0), (0, 0, 1)),
        )  # fmt: skip
        picture = paint(both, straight(), draw_triangles(both, straight()))
        assert picture[50, 50].tolist() == [255, 0, 0]
        assert picture[50, 65].tolist() == [0, 0, 255]


def test_a_back_shows_where_the_material_has_two_sides(model):
    flat = square(4.0, 1.0, model)
    back = replace(flat, triangles=flat.triangles[:, ::-1], texels=flat.texels[:, ::-1])
    shown = {
        (each is back, double): (
            draw_triangles(replace(each, materials=looks((1, 1, 1), double=double)), straight()).triangle != NOTHING
        ).any()
        for each in (flat, back)
        for double in (True, False)
    }
    assert sorted(shown.values()) == [False, True, True, True]
    assert shown[(False, True)]
    assert shown[(True, True)]


def test_what_reaches_behind_the_camera_is_cut_and_its_front_kept(model):
    floor = np.array([(-5, 1, -5), (5, 1, -5), (5, 1, 20), (-5, 1, 20)], float)
    flat = replace(square(1.0, 1.0, model), triangles=floor[[(0, 1, 2), (0, 2, 3)]])
    drawn = draw_triangles(flat, straight())
    assert (drawn.triangle[53:] != NOTHING).all(axis=1).any()
    assert (drawn.triangle[:50] == NOTHING).all()
    assert 1 / drawn.inverse_depth[90, 50] == pytest.approx(50 / 40)  # 1 below the camera, seen 40 px below the middle


def test_lines_are_hidden_by_faces_before_them_alone(model):
    flat = square(4.0, 1.0, model)  # from pixel 37.5 to 62.5
    view = straight()
    drawn = draw_triangles(flat, view)
    before, on, behind = (np.array([[(-2.0, 0, z), (2.0, 0, z)]]) for z in (3.0, 4.0, 5.0))
    for line in (before, on):
        (piece,), owner = visible_lines(line, view, drawn)
        assert owner.tolist() == [0]
        assert np.ptp(piece[:, 0]) == pytest.approx(4 * 50 / line[0, 0, 2])
    pieces, owner = visible_lines(behind, view, drawn)
    assert owner.tolist() == [0, 0]
    assert pieces[..., 0] == pytest.approx(np.array([[30, 37.5], [62.5, 70]]), abs=1.5)
    assert len(visible_lines(np.array([[(0.0, 0, -3), (0, 0, -1)]]), view, drawn)[1]) == 0


def test_colours_are_those_that_were_written():
    colour = line_colour(0, True)
    assert colour_of(Material(np.array(linear(colour)), None, False, False)) == tuple(round(255 * c) for c in colour)


def test_a_lit_face_is_darker_at_a_flat_angle(model):
    flat = replace(square(4.0, 1.0, model), materials=(Material(np.full(3, 0.5), None, True, True),))
    slanted = flat.triangles.copy()
    slanted[..., 2] += 3 * slanted[..., 0]
    straight_on, flat_angle = (
        int(paint(each, straight(), draw_triangles(each, straight()))[50, 50, 0])
        for each in (flat, replace(flat, triangles=slanted))
    )
    assert straight_on > flat_angle + 20


def test_a_face_has_one_light_all_over(model):
    wide = replace(square(4.0, 4.0, model), materials=(Material(np.full(3, 0.5), None, True, True),))
    lit = replace(wide, triangles=wide.triangles + np.array([3.0, 0.0, 0.0]))  # one triangle is nearer than the other
    colours = paint(lit, straight(), draw_triangles(lit, straight()))
    assert len({tuple(colours[row, column].tolist()) for row in (5, 50, 95) for column in (40, 60, 95)}) == 1
