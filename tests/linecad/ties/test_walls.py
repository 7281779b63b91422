"""Strips of walls: what the photo shows of a wall below the horizon, drawn from made photos whose walls are known."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from linecad.geometry import central_camera, project, rotation_about
from linecad.line_graph import Segments
from linecad.ties.bodies import RigidBodies
from linecad.ties.planes import BodyPlane
from linecad.ties.setting import Setting, Sight
from linecad.ties.walls import (
    BORDER,
    COLUMNS,
    LEAST_LINES,
    LEAST_SEEN,
    LEAST_WIDTH,
    MOST_OBLIQUE,
    ROW,
    ROWS,
    TOP,
    WIDEST,
    StripDrawer,
    Wall,
    find_walls,
    reach_below,
)

BELOW = 1.6  # m from the camera down to the ground
ACROSS = (-4.0, 0.0)
AWAY = 9.0
ABOVE = 3.0
YELLOW, BROWN, BLUE = (200.0, 180.0, 150.0), (90.0, 60.0, 50.0), (40.0, 60.0, 140.0)
L, B, SEEN, LINES, FINE = 0, 2, 3, 4, 5  # layers
FRONTAL = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])


def stripes(axis):
    """Uprights of half a metre, in two colours."""
    return lambda points: np.where((np.floor(points[..., axis] / 0.5) % 2 > 0)[..., None], YELLOW, BROWN)


def plain(colour):
    return lambda points: np.broadcast_to(np.array(colour), points.shape)


def at_own_scale(setting, normal, place, along):
    """A wall that no line was found on."""
    lines = np.arange(len(setting.graph.axis))
    plane = BodyPlane(normal, int(np.sign(place)), float(np.log(abs(place))), lines, 1.0, 0)
    return Wall(0, plane, place, along)


@pytest.fixture(scope="module")
def front(build_town, build_wall, build_facade, build_ground, paint_photo, build_setting):
    """A striped wall across on blue ground, as a setting with its body moved by so much."""

    def look(yaw=0.0, pitch=0.0, moved=0.0, block=4):
        across = np.arange(ACROSS[0] + 0.52, ACROSS[1], 0.5)  # not where one column of the strip ends and one begins
        lines = build_wall(1, AWAY, across, np.array([-1.0, -0.3, 0.5, 1.2, 2.0]))
        seen = build_town(lines, yaw=yaw, pitch=pitch)
        wall = build_facade(1, AWAY, ACROSS, (-BELOW, ABOVE), stripes(0))
        pixels = paint_photo(seen.sight, [wall, build_ground(BELOW, plain(BLUE))], block)
        return build_setting(seen, moved=(moved,), pixels=pixels)

    return look


@pytest.fixture(scope="module")
def usual(front):
    return front()


def only_strip(setting):
    (wall,) = find_walls(setting)
    strip = StripDrawer(setting).draw(wall)
    assert strip is not None
    return strip


def foot_of(strip):
    """The row where the ground begins, that is, the blue; between two rows where it begins in the middle of one."""
    blue = strip.layers[B]
    wall, ground = np.median(blue[: ROWS // 2], axis=0), np.median(blue[-1])
    return float(np.median(ROWS - ((wall - blue) / (wall - ground)).sum(axis=0)))


@pytest.mark.parametrize("moved", [0.0, 0.7, -1.2])
@pytest.mark.parametrize(("yaw", "pitch"), [(0.0, 0.0), (0.05, 0.06), (-0.1, -0.05)])
def test_the_foot_is_at_its_height_however_the_body_is_scaled(front, yaw, pitch, moved):
    strip = only_strip(front(yaw, pitch, moved))
    assert foot_of(strip) == pytest.approx((np.log(BELOW) + moved - strip.top) / ROW, abs=0.5)
    assert strip.log_height(foot_of(strip) - 0.5) == pytest.approx(np.log(BELOW) + moved, abs=0.5 * ROW)


@pytest.mark.parametrize("moved", [0.7, -1.2])
def test_the_scale_of_a_body_moves_its_strip_and_does_not_change_it(front, usual, moved):
    one, other = only_strip(usual), only_strip(front(moved=moved))
    assert other.top == pytest.approx(one.top + moved)
    assert other.wall.offset == pytest.approx(one.wall.offset * np.exp(moved))
    assert other.along == pytest.approx(one.along * np.exp(moved))
    np.testing.assert_allclose(other.layers, one.layers, atol=1e-4)


def test_a_strip_is_finite_and_as_large_as_the_network_wants_it(usual):
    strip = only_strip(usual)
    assert strip.layers.shape == (6, ROWS, COLUMNS)
    assert strip.layers.dtype == np.float32
    assert np.isfinite(strip.layers).all()
    assert strip.along.shape == (COLUMNS,)


def test_a_strip_begins_a_little_below_the_horizon(usual):
    strip = only_strip(usual)
    focal = usual.sight.matrix[0, 0]
    assert np.exp(strip.top) * focal / AWAY == pytest.approx(TOP * usual.sight.width)
    assert strip.log_height(0) - strip.top == pytest.approx(ROW / 2)
    assert strip.log_height(10) - strip.log_height(0) == pytest.approx(10 * ROW)


@pytest.mark.parametrize(("yaw", "pitch"), [(0.0, 0.0), (0.05, 0.06)])
def test_uprights_are_columns_and_courses_are_rows(front, yaw, pitch):
    strip = only_strip(front(yaw, pitch))
    above = strip.layers[L, : int(foot_of(strip)) - 2]
    # A column that the border of two stripes runs in may change; the others have one colour, and there are two colours.
    assert np.median(above.std(axis=0)) < 0.01
    assert np.ptp(np.median(above, axis=0)) > 1
    drawn = strip.layers[LINES]
    assert set(np.unique(drawn)) == {0.0, 1.0}
    course = int((np.log(1.0) - strip.top) / ROW)
    assert drawn[course - 1 : course + 2].max(axis=0).mean() > 0.95, "the course 1 m below the camera"
    upright = int(np.abs(strip.along + 2.0).argmin())
    assert drawn[: course - 1, upright - 1 : upright + 2].max(axis=1).all(), "an upright, from the horizon on"
    assert not drawn[course + 3 :].any(), "no line reaches lower"


def test_stripes_and_lines_are_where_the_columns_say(usual):
    strip = only_strip(usual)
    colour = np.median(strip.layers[L, : int(foot_of(strip)) - 2], axis=0)
    to_border = np.abs(strip.along / 0.5 - np.rint(strip.along / 0.5)) * 0.5
    is_yellow = np.floor(strip.along / 0.5) % 2 > 0
    clear = to_border > 0.1
    assert clear.sum() > COLUMNS / 3
    assert colour[clear & is_yellow].min() > colour[clear & ~is_yellow].max() + 0.5


def test_colours_are_relative_to_those_of_the_strip(usual):
    strip = only_strip(usual)
    colours = strip.layers[:3]
    assert np.abs(np.median(colours, axis=(1, 2))).max() < 0.5
    assert 0.5 < colours.std() < 1.5


def test_a_plain_photo_gives_a_strip_without_colour(usual):
    pixels = np.full_like(usual.sight.pixels, 140)
    strip = only_strip(replace(usual, sight=replace(usual.sight, pixels=pixels)))
    assert np.abs(strip.layers[:3]).max() < 1e-4


def lowered(setting, horizon):
    """A camera whose horizon is in another row of the photo."""
    matrix = setting.sight.matrix.copy()
    matrix[1, 2] = horizon
    return replace(setting, sight=replace(setting.sight, matrix=matrix))


def test_what_is_outside_the_photo_is_not_seen_and_has_no_colour(usual):
    horizon, height = 2400.0, usual.sight.pixels.shape[0]
    noise = np.random.default_rng(2).integers(0, 256, usual.sight.pixels.shape, np.uint8)
    setting = lowered(replace(usual, sight=replace(usual.sight, pixels=noise)), horizon)
    strip = StripDrawer(setting).draw(at_own_scale(setting, 1, AWAY, ACROSS))
    seen = strip.layers[SEEN]
    shrunk = WIDEST / setting.sight.width
    last = np.log((height - 1 / shrunk - BORDER / shrunk - horizon) / (TOP * setting.sight.width)) / ROW
    assert seen[: int(last) - 1].min() == 1
    assert seen[int(last) + 2 :].max() == 0
    assert np.abs(strip.layers[:3] * (seen == 0)).max() == 0
    assert strip.layers[L, : int(last) - 1].std() > 0.05


def test_the_layer_of_resolution_says_how_large_a_row_is_seen(usual):
    fine = only_strip(usual).layers[FINE]
    assert (np.diff(fine, axis=0) > 0).all(), "lower rows are larger"
    # Half a row of log height at the horizon's distance, in px of a photo 1000 px wide.
    row = 150
    size = TOP * 1000 * np.exp(ROW * (row + 0.5)) * ROW / 2
    assert fine[row] * 3.0 == pytest.approx(np.log(size), abs=0.01)


@pytest.mark.parametrize(("wider", "is_drawn"), [(0.9, False), (1.1, True)])
def test_narrow_walls_are_not_drawn(usual, wider, is_drawn):
    width = wider * LEAST_WIDTH * AWAY * usual.sight.width / usual.sight.matrix[0, 0]
    strip = StripDrawer(usual).draw(at_own_scale(usual, 1, AWAY, (-1.0, -1.0 + width)))
    assert (strip is not None) is is_drawn


def test_walls_that_the_photo_does_not_show_below_the_horizon_are_not_drawn(usual):
    height = usual.sight.pixels.shape[0]
    assert StripDrawer(low := lowered(usual, height)).draw(at_own_scale(low, 1, AWAY, ACROSS)) is None
    beside = at_own_scale(usual, 1, AWAY, (20.0, 30.0))
    assert StripDrawer(usual).draw(beside) is None


@pytest.mark.parametrize(("more", "is_drawn"), [(-8, False), (8, True)])
def test_a_tenth_of_a_strip_must_be_seen(usual, more, is_drawn):
    height, top = usual.sight.pixels.shape[0], TOP * usual.sight.width
    border = 1 + (1 + BORDER) * usual.sight.width / WIDEST
    low = lowered(usual, height - border - top * np.exp(ROW * (LEAST_SEEN * ROWS + more)))
    assert (StripDrawer(low).draw(at_own_scale(low, 1, AWAY, ACROSS)) is not None) is is_drawn


def test_walls_behind_the_camera_are_not_drawn(usual):
    assert StripDrawer(usual).draw(at_own_scale(usual, 1, -AWAY, ACROSS)) is None


@pytest.mark.parametrize("side", [-1, 1])
def test_a_wall_that_runs_beside_the_camera_is_drawn_as_far_as_the_photo_shows_it(usual, side):
    place = side * 2.0
    strip = StripDrawer(usual).draw(at_own_scale(usual, 0, place, (0.5, 30.0)))
    assert 0.5 <= strip.along.min() < 0.6
    assert strip.along.max() == pytest.approx(30.0, rel=0.3)
    assert np.isfinite(strip.layers).all()
    half = usual.sight.width / 2 / usual.sight.matrix[0, 0]
    assert (strip.layers[SEEN].max(axis=0) > 0).tolist() == (2.0 / strip.along < half).tolist()
    # Columns are evenly spaced along the horizon: the wall's near end takes most of them.
    horizon = project(np.column_stack([np.full(COLUMNS, place), strip.along, np.zeros(COLUMNS)]),
                      usual.sight.matrix, usual.sight.rotation)[:, 0]  # fmt: skip
    steps = np.abs(np.diff(horizon))
    assert steps[2:-2].max() < 1.2 * steps[2:-2].min()


def test_a_wall_that_runs_past_the_camera_has_no_column_behind_it(usual):
    wide = replace(usual, sight=replace(usual.sight, matrix=central_camera(300.0, *usual.sight.pixels.shape[1::-1])))
    strip = StripDrawer(wide).draw(at_own_scale(wide, 0, 2.0, (-10.0, 30.0)))
    assert strip.along.min() > 0, "y is the depth"
    assert strip.along.min() == pytest.approx(MOST_OBLIQUE * 2.0, abs=0.12)
    assert strip.layers[SEEN].mean() > LEAST_SEEN


@pytest.fixture(scope="module")
def alley(build_town, build_wall, build_facade, build_ground, paint_photo, build_setting):
    """Two walls to both sides of the camera, on ground that is in the second body's scale elsewhere."""
    deep, heights = np.linspace(7.0, 13.0, 7), np.array([-1.1, -0.6, 0.4, 1.0, 1.9])
    seen = build_town(build_wall(0, -2.5, deep, heights), build_wall(0, 3.0, deep, heights))
    walls = [build_facade(0, place, (6.0, 14.0), (-BELOW, ABOVE), stripes(1)) for place in (-2.5, 3.0)]
    pixels = paint_photo(seen.sight, [*walls, build_ground(BELOW, plain(BLUE))])
    return build_setting(seen, moved=(0.2, -0.4), pixels=pixels)


def test_walls_on_both_sides_of_the_camera_show_their_feet(alley):
    walls = [wall for wall in find_walls(alley) if wall.plane.normal == 0]
    assert [wall.body for wall in walls] == [0, 1]
    assert [wall.offset for wall in walls] == pytest.approx([-2.5 * np.exp(0.2), 3.0 * np.exp(-0.4)])
    for wall, moved in zip(walls, (0.2, -0.4), strict=True):
        assert wall.along == pytest.approx((7.0 * np.exp(moved), 13.0 * np.exp(moved)))
        strip = StripDrawer(alley).draw(wall)
        assert strip.log_height(foot_of(strip) - 0.5) == pytest.approx(np.log(BELOW) + moved, abs=ROW)


def test_walls_are_upright_planes_of_enough_lines(build_town, build_wall, build_setting):
    heights = np.array([-1.0, -0.5, 0.5])
    many = build_wall(1, AWAY, np.array([-4.0, -2.0, -1.0]), heights)
    upright, _, course, _ = build_wall(1, AWAY, np.array([0.5, 1.5]), np.array([-1.0, 1.0]))
    flat = [(axis, (1.0, 6.0, -1.2), end) for axis, end in ((0, (3.0, 6.0, -1.2)), (1, (1.0, 9.0, -1.2)))]
    across = [(0, (1.0, 9.0, -1.2), (3.0, 9.0, -1.2))]
    setting = build_setting(build_town(many, [upright, course], flat + across))
    assert LEAST_LINES == 3
    (wall,) = find_walls(setting)
    assert (wall.body, wall.plane.normal, len(wall.plane.lines)) == (0, 1, 6)
    assert (wall.offset, wall.along) == (pytest.approx(AWAY), pytest.approx((-4.0, -1.0)))


def smaller(setting, by):
    """The same photo with fewer pixels."""
    ends = (setting.graph.segments.ends + 0.5) * by - 0.5
    matrix = np.diag([by, by, 1.0]) @ setting.sight.matrix
    matrix[:2, 2] += 0.5 * by - 0.5
    width, height = (round(side * by) for side in setting.sight.pixels.shape[1::-1])
    pixels = cv2.resize(setting.sight.pixels, (width, height), interpolation=cv2.INTER_AREA)
    graph = replace(setting.graph, segments=Segments(ends, setting.graph.axis))
    return replace(setting, graph=graph, sight=Sight(matrix, setting.sight.rotation, width, pixels))


@pytest.mark.thorough
def test_a_large_photo_gives_the_strip_of_a_small_one(front):
    setting = front(0.05, 0.03, block=1)
    assert setting.sight.width > WIDEST
    large, small = only_strip(setting), only_strip(smaller(setting, 0.4))
    assert small.top == pytest.approx(large.top, abs=0.1 * ROW)
    assert small.along == pytest.approx(large.along, abs=0.01)
    assert np.abs(large.layers[:3] - small.layers[:3]).mean() < 0.05
    assert np.abs(large.layers[FINE] - small.layers[FINE]).max() < 0.01
    assert foot_of(small) == pytest.approx(foot_of(large), abs=0.2)


@pytest.fixture(scope="module")
def noisy(build_links):
    """A photo of noise, to look at imagined walls in."""
    pixels = np.random.default_rng(1).integers(0, 256, (240, 320, 3), np.uint8)

    def look(turn, focal):
        sight = Sight(central_camera(focal, 320, 240), rotation_about(np.array(turn)) @ FRONTAL, 320, pixels)
        return Setting(build_links(4, []), np.zeros(4), RigidBodies(np.zeros(4, int), 1), None, sight)

    return look


@pytest.mark.parametrize("moved", [0.0, 0.4])
def test_lines_reach_as_far_below_the_camera_as_their_lower_ends(front, moved):
    setting = front(moved=moved)
    (wall,) = find_walls(setting)
    found = reach_below(setting, wall) / np.exp(moved)
    heights = np.array([-1.0, -0.3, 0.5, 1.2, 2.0])
    assert np.abs(found[:, None] + heights).min(axis=1).max() < 0.02
    assert found.max() == pytest.approx(1.0, abs=0.02)
    uprights = setting.graph.axis[wall.plane.lines] == 2
    np.testing.assert_allclose(found[uprights], 1.0, atol=0.02)


def test_a_line_behind_the_camera_reaches_nowhere(usual):
    (wall,) = find_walls(usual)
    assert np.isneginf(reach_below(usual, replace(wall, offset=-wall.offset))).all()


turns = st.tuples(st.floats(-0.3, 0.3), st.floats(-0.6, 0.6), st.floats(-0.1, 0.1))
places = st.floats(0.5, 20).flatmap(lambda far: st.sampled_from([-far, far]))
alongs = st.tuples(st.floats(-30, 30), st.floats(0.01, 40)).map(lambda at: (at[0], at[0] + at[1]))


@settings(max_examples=settings.default.max_examples * 3 // 5)
@given(turns, st.floats(150, 600), st.integers(0, 1), places, alongs)
def test_every_strip_is_finite_and_in_its_range(noisy, turn, focal, normal, place, along):
    setting = noisy(turn, focal)
    strip = StripDrawer(setting).draw(at_own_scale(setting, normal, place, along))
    if strip is None:
        return
    assert strip.layers.shape == (6, ROWS, COLUMNS)
    assert np.isfinite(strip.layers).all()
    assert strip.layers[SEEN].min() >= 0
    assert LEAST_SEEN <= strip.layers[SEEN].mean() <= 1 + 1e-6
    assert set(np.unique(strip.layers[LINES])) <= {0.0, 1.0}
    assert np.abs(strip.layers[:3] * (strip.layers[SEEN] == 0)).max() == 0
    assert along[0] - 1e-9 <= strip.along.min()
    assert strip.along.max() <= along[1] + 1e-9
    points = np.zeros((COLUMNS, 3))
    points[:, normal], points[:, 1 - normal] = place, strip.along
    assert (points @ setting.sight.rotation[2] > 0).all()


@settings(max_examples=settings.default.max_examples * 2 // 5)
@given(turns, st.floats(150, 600), st.integers(0, 1), places, alongs, st.floats(-2, 2))
def test_no_scale_changes_a_strip(noisy, turn, focal, normal, place, along, moved):
    setting, by = noisy(turn, focal), np.exp(moved)
    drawer = StripDrawer(setting)
    one = drawer.draw(at_own_scale(setting, normal, place, along))
    other = drawer.draw(at_own_scale(setting, normal, place * by, (along[0] * by, along[1] * by)))
    if one is None or other is None:
        assert one is other
        return
    assert other.top == pytest.approx(one.top + moved)
    assert other.along == pytest.approx(one.along * by)
    # A sample that lies just between two pixels, or on the border, may fall on the other side.
    assert np.abs(other.layers - one.layers).mean() < 2e-3
