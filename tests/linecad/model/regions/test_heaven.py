"""What is above the lines of painted photos."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from linecad.model.regions.heaven import BELOW, BRIGHTER, DARKEST, EVENING, LAMPS, WIRE, look_up
from linecad.model.regions.raster import COLUMNS, take_raster

BLUE_SKY, WHITE = (120, 170, 235), (215, 212, 200)


def under(top, house, rough=()):
    """The raster of a photo whose upper third has one colour and whose rest is rough, as are patches (x, y, w, h)."""
    rng = np.random.default_rng(0)
    photo = rng.integers(40, 160, (720, 960, 3)).astype(np.uint8)
    photo = cv2.resize(photo[::4, ::4], (960, 720), interpolation=cv2.INTER_NEAREST)
    noisy = photo.copy()
    photo[:240] = top
    for x, y, width, height in rough:
        photo[y : y + height, x : x + width] = noisy[y : y + height, x : x + width]
    return take_raster(house.lines, house.camera, house.rotation, photo)


def test_what_is_blue_and_smooth_on_top_is_sky(house):
    heaven = look_up(under(BLUE_SKY, house))
    assert (heaven.is_sky, heaven.is_ceiling) == (True, False)
    seed = heaven.seed.reshape(360, COLUMNS)
    assert seed[10:110, 10:-10].mean() > 0.5
    assert not seed[125:].any()


def test_light_plaster_beside_the_sky_is_no_sky(house):
    """The plain wall above the shops of a street was its sky, and had no face."""
    raster = under(BLUE_SKY, house)
    colour = raster.colour.copy()
    colour[:120, 240:] = (220, 129, 138)
    colour[:120, 238:242] = (128, 128, 128)  # an edge between the two
    gradient = raster.gradient.reshape(raster.shape).copy()
    gradient[:120, 238:242] = 1.0
    both = replace(raster, colour=colour, gradient=gradient.ravel())
    seed = look_up(both).seed.reshape(raster.shape)
    assert seed[10:110, 10:230].mean() > 0.9
    assert not seed[:, 242:].any()
    colour[:120, 240:] = (250, 129, 138)
    bright = look_up(replace(both, colour=colour)).seed.reshape(raster.shape)
    assert bright[10:110, 250:].mean() > 0.9  # a cloud


@pytest.mark.parametrize(("light", "is_sky"), [(230, True), (145, False)])
def test_a_warm_sky_is_much_lighter_than_what_is_before_it(light, is_sky, house):
    """Ceilings of rooms were the sky of an evening."""
    raster = under(BLUE_SKY, house)
    colour = raster.colour.copy()
    usual = np.median(colour[150:, :, 0])
    assert usual * BRIGHTER < 145 < usual * EVENING < 230
    colour[:120] = (light, 129, 138)
    heaven = look_up(replace(raster, colour=colour))
    assert (heaven.is_sky, heaven.is_ceiling) == (is_sky, not is_sky)


@pytest.mark.parametrize(("farther", "is_sky"), [(0.5, True), (2.0, False), (np.inf, True)])
def test_what_goes_on_below_the_horizon_is_no_sky(farther, is_sky, house):
    """Bright walls that reached to the photo's top were its sky; what reaches to its foot is a background."""
    raster = under(BLUE_SKY, house)
    colour, gradient = raster.colour.copy(), raster.gradient.reshape(raster.shape).copy()
    down = (raster.rays[:, 2] > 0).reshape(raster.shape).sum(axis=0).max()
    ends = round(min(down * (1 + farther * BELOW), len(colour)))
    colour[:ends], gradient[:ends], gradient[ends : ends + 3] = (240, 128, 120), 0.0, 1.0
    heaven = look_up(replace(raster, colour=colour, gradient=gradient.ravel()))
    assert (heaven.is_sky, heaven.is_ceiling) == (is_sky, False)
    assert (heaven.seed.mean() > 0.3) == is_sky


def test_the_sky_beside_a_white_wall_is_darker(house):
    """As much as it is no sky beside a white cloud."""
    raster = under(BLUE_SKY, house)
    colour, gradient = raster.colour.copy(), raster.gradient.reshape(raster.shape).copy()
    ends = round((raster.rays[:, 2] > 0).reshape(raster.shape).sum(axis=0).max() * (1 + 3 * BELOW))
    colour[:120, :240], gradient[:120, :240] = (170, 125, 110), 0.0
    colour[:ends, 240:], gradient[:ends, 240:] = (170 / DARKEST + 5, 128, 125), 0.0
    gradient[:ends, 238:242] = gradient[ends : ends + 3, 240:] = 1.0
    heaven = look_up(replace(raster, colour=colour, gradient=gradient.ravel()))
    seed = heaven.seed.reshape(raster.shape)
    assert seed[10:110, 10:230].mean() > 0.9
    assert not seed[:, 242:].any()


@pytest.mark.parametrize(("warmer", "is_sky"), [(0.8 * LAMPS, True), (1.2 * LAMPS, False)])
def test_the_light_of_lamps_is_warmer_where_it_falls(warmer, is_sky, house):
    """The lit wall of a corridor was the sky of an evening."""
    raster = under(BLUE_SKY, house)
    colour, gradient = raster.colour.copy(), raster.gradient.reshape(raster.shape).copy()
    colour[:120] = (230, 129, 138)
    colour[:120, 240:] = (230, 129, 138 + warmer)
    gradient[:120, 238:242] = 1.0  # an edge between the two
    heaven = look_up(replace(raster, colour=colour, gradient=gradient.ravel()))
    assert (heaven.is_sky, heaven.is_ceiling) == (is_sky, not is_sky)


def test_what_is_as_light_as_walls_and_not_blue_is_a_ceiling(house):
    # Light walls, lines apart.
    photo = np.full((720, 960, 3), WHITE, np.uint8)
    photo[240:720:12] = (150, 148, 140)
    photo[:240] = (180, 176, 165)
    lines = replace(house.lines, segment=house.lines.segment + np.array([0, 250]))
    heaven = look_up(take_raster(lines, house.camera, house.rotation, photo))
    assert (heaven.is_sky, heaven.is_ceiling) == (False, True)
    assert not heaven.seed.any()


def test_what_is_rough_on_top_is_neither(house):
    heaven = look_up(under(BLUE_SKY, house, rough=[(0, 0, 960, 240)]))
    assert (heaven.is_sky, heaven.is_ceiling) == (False, False)
    assert not heaven.seed.any()


def test_the_ground_is_no_sky_whatever_its_colour(house):
    photo = np.full((720, 960, 3), BLUE_SKY, np.uint8)
    rng = np.random.default_rng(0)
    photo[:360] = cv2.resize(rng.integers(40, 160, (90, 240, 3)).astype(np.uint8), (960, 360), interpolation=0)
    heaven = look_up(take_raster(house.lines, house.camera, house.rotation, photo))
    assert (heaven.is_sky, heaven.is_ceiling) == (False, False)


def test_a_smooth_part_with_lines_in_it_is_no_sky(house):
    # The walls of the house are above the horizon in part, and as smooth as they can be.
    photo = np.full((720, 960, 3), BLUE_SKY, np.uint8)
    across = np.array([[[u, v], [u + 60, v]] for v in range(10, 355, 10) for u in range(0, 900, 60)], float)
    count = len(across)
    lines = replace(
        house.lines, id=np.arange(count), axis=np.zeros(count, int), segment=across,
        ends=np.resize(house.lines.ends, (count, 2, 3)), is_boundary=np.zeros(count, bool),
        component=np.zeros(count, int), confidence=np.full(count, "proven"), by_depth_map=(), role=(),
        by_face=(), pieces=(),
    )  # fmt: skip
    assert not look_up(take_raster(lines, house.camera, house.rotation, photo)).is_sky


def sky_over(photo, house, *segments):
    """The sky (H, W) of a photo whose only lines are segments, px."""
    count = len(segments)
    lines = replace(
        house.lines, id=np.arange(count), axis=np.zeros(count, int), segment=np.array(segments, float),
        ends=np.resize(house.lines.ends, (count, 2, 3)), is_boundary=np.zeros(count, bool),
        component=np.zeros(count, int), confidence=np.full(count, "proven"), by_depth_map=(), role=(),
        by_face=(), pieces=(),
    )  # fmt: skip
    raster = take_raster(lines, house.camera, house.rotation, photo)
    return look_up(raster).seed.reshape(raster.shape)


def painted(top, below=(110, 80, 60)):
    """A photo with a plain wall, and above it what `top` (240, 960, 3) shows."""
    photo = np.full((720, 960, 3), below, np.uint8)
    photo[:240] = top
    return photo


def test_the_sky_goes_on_over_clouds_to_where_it_ends(house):
    rng = np.random.default_rng(1)
    cloud = cv2.resize(rng.integers(0, 2, (24, 96, 1)).astype(np.float32), (960, 240))[..., None]
    top = (1 - cloud) * np.array(BLUE_SKY) + cloud * 250
    haze = np.linspace(0, 1, 960)[:, None]  # smooth, so that it shows all colours of the clouds
    top[:60] = (1 - haze) * np.array(BLUE_SKY) + haze * 250
    seed = sky_over(painted(top.astype(np.uint8)), house, [[300, 500], [600, 500]])
    assert seed[:118].mean() > 0.98  # nearly all of it is rough
    assert not seed[121:].any()


def test_no_line_is_crossed_to_what_is_as_light_but_of_another_colour(house):
    """The fascia of a white building was sky."""
    top = np.full((240, 960, 3), (170, 205, 245), np.uint8)
    top[:, 480:] = 243 + np.rint(9 * np.sin(np.arange(480) / 30))[:, None]  # a cloud
    top[200:, :480] = np.where(np.arange(480) % 12 < 6, 234, 252)[:, None]
    seed = sky_over(painted(top), house, [[0, 200], [480, 200]], [[480, 200], [480, 240]])
    assert seed[:98].mean() > 0.9
    assert not seed[102:, :238].any()
    assert sky_over(painted(top), house, [[300, 500], [600, 500]])[102:118, :238].any()  # nothing else parts them


@pytest.mark.parametrize(("wide", "goes_on"), [(1, True), (WIRE, True), (WIRE + 1, False)])
def test_the_sky_goes_on_beyond_a_wire_and_no_beam(wide, goes_on, house):
    photo = painted(np.full((240, 960, 3), BLUE_SKY, np.uint8))
    photo[120 : 120 + 2 * wide] = 40
    seed = sky_over(photo, house, [[0, 120], [959, 120]])
    assert seed[:58].mean() > 0.9
    assert (seed[64 + wide : 116].mean() > 0.9) == goes_on
    assert seed[60 + wide :].any() == goes_on


@pytest.mark.parametrize("colour", [BLUE_SKY, (252, 252, 252)])
def test_the_sky_above_a_beam_is_sky_though_more_of_it_is_below(colour, house):
    photo = painted(np.full((240, 960, 3), colour, np.uint8))
    photo[60:90] = 40
    seed = sky_over(photo, house, [[300, 500], [600, 500]])
    assert seed[:28].mean() > 0.9


def test_what_looks_the_same_elsewhere_in_the_photo_is_plaster(house):
    """The white panels at the top of a facade were sky, and the others walls."""
    photo = np.full((720, 960, 3), (60, 60, 60), np.uint8)
    for y in range(0, 300, 100):
        for x in range(0, 960, 160):
            photo[y : y + 88, x : x + 148] = (250, 246, 240)
    photo[:88, 320:640] = (170, 205, 245)
    seed = sky_over(photo, house, [[300, 500], [600, 500]])
    assert seed[5:38, 165:315].all()
    assert not seed[:, :150].any()
    assert not seed[:, 330:].any()


def test_a_photo_that_is_all_panels_has_neither_sky_nor_ceiling(house):
    photo = np.full((720, 960, 3), (60, 60, 60), np.uint8)
    for y in range(0, 300, 100):
        for x in range(0, 960, 160):
            photo[y : y + 88, x : x + 148] = (250, 246, 240)
    lines = replace(house.lines, segment=house.lines.segment + np.array([0, 400]))
    heaven = look_up(take_raster(lines, house.camera, house.rotation, photo))
    assert (heaven.is_sky, heaven.is_ceiling) == (False, False)


CLEAR_SKY = (190, 215, 245)


def framed(colour, *bars):
    """A dark photo with a smooth opening of some colour above the horizon, dark bars (x, y, w, h) across it."""
    photo = np.full((720, 960, 3), (60, 60, 60), np.uint8)
    photo[80:260, 200:700] = colour
    for x, y, width, height in bars:
        photo[y : y + height, x : x + width] = (60, 60, 60)
    return photo


@pytest.mark.parametrize(
    ("colour", "is_sky"), [(CLEAR_SKY, True), (BLUE_SKY, False), (WHITE, False), ((252, 252, 252), False)]
)
def test_a_clear_sky_is_sky_under_a_bridge_and_beyond_leaves_too(colour, is_sky, house):
    """It was a wall, with the sky as its texture."""
    seed = sky_over(framed(colour), house, [[300, 500], [600, 500]])
    assert seed[45:125, 105:345].all() == is_sky
    assert seed.any() == is_sky
    assert not seed[:38].any()


def test_several_openings_show_one_sky(house):
    """Arches of a bridge: the largest is sky, and those that look like it tell nothing against each other."""
    seed = sky_over(framed(CLEAR_SKY, (400, 80, 10, 180), (560, 80, 10, 180)), house, [[300, 500], [600, 500]])
    assert seed[45:125, [150, 240, 320]].all()


@pytest.mark.parametrize("above", [(60, 60, 60), (66, 62, 60)])
def test_a_ceiling_stays_one_where_a_window_shows_the_sky(above, house):
    photo = framed(CLEAR_SKY)
    photo[:70] = above
    heaven = look_up(take_raster(house.lines, house.camera, house.rotation, photo))
    assert (heaven.is_sky, heaven.is_ceiling) == (True, True)
    assert not heaven.seed.reshape(360, COLUMNS)[:38].any()


def test_a_blue_wall_in_panels_is_no_clear_sky(house):
    bars = [(x, 80, 12, 180) for x in (300, 400, 500, 600)]
    assert not sky_over(framed(CLEAR_SKY, *bars), house, [[300, 500], [600, 500]]).any()
    assert sky_over(framed(CLEAR_SKY, bars[1]), house, [[300, 500], [600, 500]]).any()  # a post before the sky


def test_a_blue_wall_with_windows_is_no_clear_sky(house):
    windows = [(x, 130, 40, 60) for x in (260, 360, 460, 560)]
    frames = [[[x, y], [x + 40, y]] for x, *_ in windows for y in range(130, 191, 6)]
    photo = framed(CLEAR_SKY, *windows)
    assert sky_over(photo, house, [[300, 500], [600, 500]]).any()  # birds
    assert not sky_over(photo, house, *frames).any()


def test_the_same_photo_has_the_same_sky(house):
    raster = take_raster(house.lines, house.camera, house.rotation, house.photo)
    first = look_up(raster)
    cv2.setRNGSeed(7)
    assert np.array_equal(look_up(raster).seed, first.seed)
