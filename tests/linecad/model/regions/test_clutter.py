"""Plants and things on the ground, in painted pictures."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
import shapely

from linecad.model.regions.clutter import find_things, hiding, outlines, with_hidden
from linecad.model.regions.find import Look, find_regions
from linecad.model.regions.raster import take_raster

FOOT, SHAPE = 200, (300, 480)
GREY, WHITE, RED = (110, 110, 115), (220, 215, 205), (170, 30, 30)


def street(*things):
    """CIE L*a*b* of a white wall on grey ground, with boxes (left, top, right, bottom) before them."""
    rng = np.random.default_rng(0)
    photo = np.full((*SHAPE, 3), WHITE, np.uint8)
    photo[FOOT:] = GREY
    for left, top, right, bottom in things:
        photo[top:bottom, left:right] = RED
    noisy = np.clip(photo.astype(int) + rng.integers(-6, 7, photo.shape), 0, 255).astype(np.uint8)
    return cv2.cvtColor(noisy, cv2.COLOR_RGB2LAB)


def found(*things):
    ground = np.zeros(SHAPE, bool)
    ground[FOOT:] = True
    return find_things(street(*things), ground, ~ground)


def test_a_thing_on_the_ground_is_found_up_the_wall():
    truth = np.zeros(SHAPE, bool)
    truth[160:225, 200:260] = True
    mask = found((200, 160, 260, 225))
    assert (mask & truth).sum() > 0.95 * (mask | truth).sum()


def test_the_same_photo_gives_the_same_things():
    assert (found((200, 160, 260, 225)) == found((200, 160, 260, 225))).all()


@pytest.mark.parametrize(
    "box",
    [
        pytest.param((200, 100, 240, FOOT - 10), id="a window is the wall's"),
        pytest.param((200, 230, 260, 260), id="a sign on the ground reaches no wall"),
        pytest.param((20, FOOT, 460, 215), id="a pavement is wide"),
        pytest.param((200, FOOT, 206, 206), id="a speck"),
    ],
)
def test_what_is_no_thing_is_left(box):
    assert not found(box).any()


def test_without_ground_nothing_stands_on_it():
    nothing = np.zeros(SHAPE, bool)
    assert not find_things(street((200, 160, 260, 225)), nothing, ~nothing).any()


def test_outlines_are_pixels_around_the_mask_and_keep_its_larger_holes():
    mask = np.zeros((100, 100), bool)
    mask[20:60, 10:50] = True
    mask[30:45, 20:35] = False
    mask[50, 40] = False
    (shape,) = outlines(mask, 2.0)
    assert shape.bounds == (20.5, 40.5, 98.5, 118.5)
    assert len(shape.interiors) == 1
    assert not shape.contains(shapely.Point(55, 75))


def leaves(photo, left, top, right, bottom):
    """The photo with a bush in a box: green in many shades."""
    rng = np.random.default_rng(0)
    shade = rng.uniform(0.4, 1.4, ((bottom - top) // 8, (right - left) // 8))
    rough = cv2.resize(shade, (right - left, bottom - top), interpolation=cv2.INTER_CUBIC)
    bush = cv2.warpAffine(rough, cv2.getRotationMatrix2D((60, 60), 30, 1), (right - left, bottom - top))[..., None]
    bush = np.maximum(bush, 0.4)
    changed = photo.copy()
    changed[top:bottom, left:right] = np.clip(bush * (60, 110, 40), 0, 255)
    return changed


def test_a_bush_before_a_wall_hides_it_and_changes_no_outline(house, house_regions):
    box = (560, 380, 680, 500)
    look = Look(leaves(house.photo, *box), None, None)
    seen = find_regions(house.planes, house.lines, house.camera, house.rotation, look)
    bush = shapely.box(*box)
    more = shapely.difference(seen.clutter, house_regions.clutter)
    assert shapely.intersection(more, bush).area > 0.85 * bush.area
    assert shapely.difference(more, bush.buffer(12)).area < 0.05 * bush.area
    areas = [sorted(region.area for _, region in one.labels.regions) for one in (seen, house_regions)]
    assert areas[0] == pytest.approx(areas[1], rel=0.02)


@pytest.mark.parametrize(
    ("plants", "is_lawn"),
    [
        pytest.param([(0, 90, 100, 60)], True, id="grass"),
        pytest.param([(10, 40, 20, 65)], False, id="a bush at the foot of a wall"),
        pytest.param([(0, 90, 40, 60), (0, 60, 100, 10)], False, id="ivy down to the ground"),
        pytest.param([(0, 90, 60, 60), (0, 60, 100, 10)], True, id="grass, and ivy above it"),
        pytest.param([(0, 65, 60, 60), (0, 60, 60, 0)], False, id="trees"),
    ],
)
def test_plants_hide_what_they_grow_before_and_a_lawn_is_the_ground(plants, is_lawn):
    ground, mask = np.zeros((90, 100), bool), np.zeros((90, 100), bool)
    ground[60:] = True
    for left, one, right, other in plants:
        mask[min(one, other) : max(one, other), left:right] = True
    hidden = hiding(mask, ground)
    assert (hidden[:60] == mask[:60]).all()
    assert (hidden[60:] == (mask[60:] & (not is_lawn))).all()


@pytest.mark.parametrize("is_wall", [True, False])
def test_what_was_called_clutter_is_the_wall_where_it_has_its_colours(house, house_regions, is_wall):
    box = (560, 380, 680, 500)
    photo = house.photo.copy()
    if not is_wall:
        photo[box[1] : box[3], box[0] : box[2]] = (150, 30, 140)
    raster = take_raster(house.lines, house.camera, house.rotation, photo)
    called = replace(house_regions, clutter=shapely.union_all([house_regions.clutter, shapely.box(*box)]))
    kept = with_hidden(called, raster).clutter
    share = shapely.intersection(kept, shapely.box(*box)).area / shapely.box(*box).area
    assert share < 0.3 if is_wall else share > 0.95


@pytest.mark.parametrize(("what", "is_hidden"), [("lantern", False), ("tree", True), ("van", True)])
def test_what_stands_out_against_the_sky_and_is_no_plant_hides_nothing(house, house_regions, what, is_hidden):
    labels, step = house_regions.labels, house.camera.width / 480
    shown = labels.label[labels.cell].reshape(-1, 480)
    ground = next(number for number, surface in enumerate(labels.surfaces) if surface.kind == "ground")
    column = next(at for at in range(200, 400) if shown[0, at] == labels.sky and shown[-1, at] == ground)
    border = (
        np.flatnonzero(shown[:, column] != labels.sky)[0] if what != "van" else np.argmax(shown[:, column] == ground)
    )
    middle = np.array([column, border]) * step
    left, top, right, bottom = np.rint([*(middle - 40), *(middle + 40)]).astype(int).tolist()
    photo = house.photo.copy()
    photo[top:bottom, left:right] = (150, 30, 140)
    if what == "tree":
        photo = leaves(house.photo, left, top, right, bottom)
    raster = take_raster(house.lines, house.camera, house.rotation, photo)
    thing = shapely.box(left, top, right, bottom)
    kept = with_hidden(replace(house_regions, clutter=thing), raster).clutter
    share = shapely.intersection(kept, thing).area / thing.area
    assert share > 0.6 if is_hidden else share < 0.05
