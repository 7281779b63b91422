"""What painted photos say about their parts."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from linecad.model.regions.evidence import (
    BESIDE_COST,
    BEYOND_SKY,
    CLUTTER,
    CLUTTER_COST,
    GREEN_COST,
    NEAR_COST,
    NEVER,
    RIM,
    ROOM_COST,
    SKY,
    SMOOTH_COST,
    THROUGH_COST,
    TURNED_COST,
    WALLED_COST,
    colour_costs,
    depths,
    direction_costs,
    sample_costs,
    sums,
)  # fmt: skip
from linecad.model.regions.heaven import Heaven, look_up
from linecad.model.regions.raster import COLUMNS, take_raster
from linecad.model.regions.segments import limit_of_depth
from linecad.model.regions.surfaces import Surface

NO_LINES = np.zeros(0, np.int64)
NO_HEAVEN = Heaven(np.zeros(360 * COLUMNS, bool), is_sky=False, is_ceiling=False)
WHITE, BROWN = (215, 212, 200), (120, 90, 70)


@pytest.fixture(scope="module")
def raster(house):
    return take_raster(house.lines, house.camera, house.rotation, house.photo)


@pytest.fixture(scope="module")
def surfaces(house):
    return house.surfaces()


def sample(x, y):
    """The sample at a pixel."""
    return (y // 2) * COLUMNS + x // 2


def test_depths_are_those_of_rays_on_surfaces(raster, surfaces):
    found = depths(raster, surfaces)
    for number, surface in enumerate(surfaces):
        seen = np.isfinite(found[:, number])
        assert seen.any()
        assert raster.rays[seen, surface.axis] * found[seen, number] == pytest.approx(surface.offset)
        assert (found[seen, number] > 0).all()
        assert (np.sign(raster.rays[~seen, surface.axis]) != np.sign(surface.offset)).all()


def test_the_sky_costs_more_away_from_what_is_sky_for_sure(house, raster):
    """Brick walls were the sky, which had the least cost of all that is strange."""
    plain = replace(raster, colour=np.full_like(raster.colour, 200), gradient=np.zeros(raster.size))
    seed = np.zeros(raster.shape, bool)
    seed[:40] = True
    heaven = Heaven(seed.ravel(), is_sky=True, is_ceiling=False)
    cost = sample_costs(plain, house.lines, [], heaven, limit_of_depth(raster))[:, SKY].reshape(raster.shape)
    rim = 40 + int(RIM)
    assert cost[rim + 1 : 100] - cost[40] == pytest.approx(BEYOND_SKY)
    assert cost[40 : rim - 1] == pytest.approx(cost[40, 0])


def test_costs_of_a_photo_are_least_where_the_truth_is(house, raster, surfaces):
    costs = sample_costs(raster, house.lines, surfaces, look_up(raster), limit_of_depth(raster))
    assert costs.shape == (raster.size, len(surfaces) + 2)
    truth = house.truth[::2, ::2].ravel()
    names = {(0, 2.0): 0, (1, 8.0): 1, (2, -2.0): 2}
    column = {names[surface.axis, surface.offset]: number for number, surface in enumerate(surfaces)
              if (surface.axis, surface.offset) in names}  # fmt: skip
    for number in (0, 1):
        own, other = costs[truth == number, column[number]], costs[truth == number, column[1 - number]]
        assert (own < other).mean() > 0.95
    assert (costs[truth == 3].argmin(axis=1) == len(surfaces) + 2 + SKY).mean() > 0.95
    below = raster.rays[:, 2] < 0
    assert (costs[below, SKY] == NEVER).all()
    assert (costs[~below, column[2]] == NEVER).all()


def wall(offset, rows):
    return Surface("wall", 1, offset, np.array(rows), 0)


def test_a_wall_costs_more_away_from_its_lines(house, raster):
    rows = [row for row in range(len(house.lines)) if (house.lines.ends[row, :, 1] == 8).all()]
    costs = sample_costs(raster, house.lines, [wall(8.0, rows)], NO_HEAVEN, np.inf)[:, 0]
    on_line = raster.marked(np.isin(raster.line, rows))
    assert costs[on_line].max() < 0.5 * NEAR_COST
    # Beside and above its lines; far from all of them.
    assert costs[sample(700, 120)] > costs[sample(700, 190)] > costs[on_line].max()


def test_a_wall_costs_no_more_in_its_box_than_one_without_lines(house, raster):
    rows = [row for row in range(len(house.lines)) if (house.lines.ends[row, :, 1] == 8).all()][:3]
    ends = house.lines.ends[house.lines.axis != 1]
    box = np.array([ends.min(axis=(0, 1)), ends.max(axis=(0, 1))])
    box[:, 1] = 8.0
    wide = replace(wall(8.0, rows), box=box)
    costs = [sample_costs(raster, house.lines, [each], NO_HEAVEN, np.inf)[:, 0]
             for each in (wide, wall(8.0, rows), replace(wide, lines=NO_LINES))]  # fmt: skip
    is_within = costs[2] <= costs[2].min() + GREEN_COST
    assert costs[0][is_within] == pytest.approx(np.minimum(costs[1], costs[2])[is_within])
    assert (costs[0] < costs[1])[is_within].any()
    assert (costs[0] < costs[2])[is_within].any()
    assert costs[0][~is_within] == pytest.approx(costs[1][~is_within])


@pytest.mark.parametrize(("beside", "grazes"), [(0.02, True), (0.6, False)])
def test_a_wall_that_the_camera_looks_along_is_none(house, to_lines, beside, grazes):
    edges = [(1, np.array([[beside, 3.0, height], [beside, 9.0, height]])) for height in (-0.5, 0.3, 0.9)]
    lines, _ = to_lines(edges, house.camera, house.rotation)
    raster = take_raster(lines, house.camera, house.rotation, house.photo)
    known = Surface("wall", 0, beside, np.arange(3), 0)
    costs = sample_costs(raster, lines, [known], NO_HEAVEN, np.inf)[:, 0]
    assert (costs[raster.rays[:, 0] > 0].min() >= NEVER) == grazes
    # But where its skirting tells its place.
    told = replace(known, box=np.array([[beside, 1.0, -2.0], [beside, 9.0, 2.0]]))
    assert sample_costs(raster, lines, [told], NO_HEAVEN, np.inf)[:, 0].min() < NEVER


def test_a_level_surface_may_be_seen_flatly(house, to_lines):
    edges = [(1, np.array([[along, 3.0, 0.05], [along, 9.0, 0.05]])) for along in (-1.0, 0.5, 1.0)]
    lines, _ = to_lines(edges, house.camera, house.rotation)
    raster = take_raster(lines, house.camera, house.rotation, house.photo)
    costs = sample_costs(raster, lines, [Surface("other", 2, 0.05, np.arange(3), 0)], NO_HEAVEN, np.inf)[:, 0]
    assert costs[raster.rays[:, 2] > 0].min() < NEVER


def test_a_line_behind_a_wall_shows_that_it_is_not_there(house, to_lines):
    edges = [(axis, ends.copy()) for axis, ends in zip(house.lines.axis.tolist(), house.lines.ends, strict=True)
             if (ends[:, 1] == 8).all()]  # fmt: skip
    place = np.array([3.9, 8, -0.4]) * 1.5
    through = (2, np.array([place, place + np.array([0, 0, 1.2])]))
    lines, _ = to_lines([*edges, through], house.camera, house.rotation)
    own = np.arange(len(edges))
    there = take_raster(lines, house.camera, house.rotation, house.photo)
    with_it = sample_costs(there, lines, [wall(8.0, own)], NO_HEAVEN, np.inf)[:, 0]
    elsewhere = replace(lines, component=np.r_[np.zeros(len(own), int), 1])
    without = sample_costs(there, elsewhere, [wall(8.0, own)], NO_HEAVEN, np.inf)[:, 0]
    on_line = there.marked(there.line == len(own))
    more = with_it - without
    assert more[on_line].min() >= THROUGH_COST - 1e-9
    assert more[on_line].max() <= THROUGH_COST + BESIDE_COST + 1e-9
    assert more[there.distance(on_line) > 60] == pytest.approx(0, abs=1e-3)


def test_walls_end_at_the_ground_and_no_level_goes_on_for_ever(house, raster):
    ground = Surface("ground", 2, -2.0, NO_LINES, None)
    rows = [row for row in range(len(house.lines)) if (house.lines.ends[row, :, 1] == 8).all()]
    alone = sample_costs(raster, house.lines, [wall(8.0, rows)], NO_HEAVEN, np.inf)[:, 0]
    with_ground = sample_costs(raster, house.lines, [wall(8.0, rows), ground], NO_HEAVEN, 20.0)
    buried = with_ground[:, 0] - alone
    assert buried[sample(700, 460)] == 0
    assert buried[sample(700, 600)] > 2
    depth = depths(raster, [ground])[:, 0]
    assert (with_ground[depth > 20, 1] >= NEVER).all()
    assert (with_ground[depth < 20, 1] < 2).all()


def test_the_ground_is_not_seen_through_walls(house, raster):
    ground = Surface("ground", 2, -2.0, NO_LINES, None)
    rows = [row for row in range(len(house.lines)) if (house.lines.ends[row, :, 1] == 8).all()]
    alone = sample_costs(raster, house.lines, [ground], NO_HEAVEN, np.inf)[:, 0]
    more = sample_costs(raster, house.lines, [ground, wall(8.0, rows)], NO_HEAVEN, np.inf)[:, 0] - alone
    assert more[sample(700, 450)] == pytest.approx(WALLED_COST)
    assert more[sample(700, 600)] == 0  # before the wall
    assert more[sample(300, 450)] == more[sample(950, 450)] == 0  # beside it


def test_a_depth_map_that_says_another_axis_speaks_against_a_surface(house, raster):
    rows = [row for row in range(len(house.lines)) if (house.lines.ends[row, :, 1] == 8).all()]

    def cost(axis):
        told = replace(raster, facing=np.full(raster.size, axis))
        return sample_costs(told, house.lines, [wall(8.0, rows)], NO_HEAVEN, np.inf)[sample(700, 300), 0]

    assert cost(1) == cost(-1)
    assert cost(0) == cost(2) == pytest.approx(cost(1) + TURNED_COST)


def test_green_speaks_against_walls_and_smoothness_against_clutter(house):
    rng = np.random.default_rng(0)
    photo = np.full((720, 960, 3), BROWN, np.uint8)
    photo[:, 720:] = (70, 130, 50)
    rough = np.clip(photo.astype(int) + rng.integers(-45, 45, (720, 960, 1)), 0, 255).astype(np.uint8)
    photo[360:] = cv2.resize(rough[360::4, ::4], (960, 360), interpolation=cv2.INTER_NEAREST)
    raster = take_raster(house.lines, house.camera, house.rotation, photo)
    rows = [row for row in range(len(house.lines)) if (house.lines.ends[row, :, 1] == 8).all()]
    surfaces = [wall(8.0, rows), Surface("ground", 2, -2.0, NO_LINES, None)]
    costs = sample_costs(raster, house.lines, surfaces, NO_HEAVEN, np.inf)
    plain = replace(raster, colour=np.full_like(raster.colour, 128))
    more = costs - sample_costs(plain, house.lines, surfaces, NO_HEAVEN, np.inf)
    assert more[sample(600, 300), 0] == 0
    assert more[sample(850, 300), 0] == pytest.approx(GREEN_COST)
    assert more[:, 1] == pytest.approx(0)  # a lawn is ground
    for x in (600, 850):
        assert costs[sample(x, 200), CLUTTER] == pytest.approx(CLUTTER_COST + SMOOTH_COST)
        assert costs[sample(x, 600), CLUTTER] == pytest.approx(CLUTTER_COST, abs=1e-3)


def test_sums_are_by_cell():
    values = np.array([[1.0, 10], [2, 20], [4, 40], [8, 80]])
    assert sums(np.array([2, 0, 2, 0]), 4, values).tolist() == [[10, 100], [0, 0], [5, 50], [0, 0]]


def test_edges_say_which_axis_a_cell_does_not_face(raster):
    cell = np.zeros(raster.size, np.int64)
    walls = [Surface("wall", axis, 3.0, NO_LINES, axis) for axis in (0, 1)]
    ground = Surface("ground", 2, -2.0, NO_LINES, None)
    for axis, likely, unlikely in ((0, 1, 0), (1, 0, 1)):
        votes = np.zeros((raster.size, 4))
        votes[:100, axis] = 1
        costs = direction_costs(replace(raster, votes=votes), [*walls, ground], cell, 1)[0]
        assert costs[likely] < costs[2] < 0 < costs[unlikely]
        assert costs[CLUTTER] == 0
        assert costs[SKY] > 0
    votes = np.zeros((raster.size, 4))
    votes[:100, 2] = 1
    costs = direction_costs(replace(raster, votes=votes), [*walls, ground], cell, 1)[0]
    assert costs[0] == costs[1] < 0 < costs[2]
    votes = np.zeros((raster.size, 4))
    votes[:100, -1] = 1
    costs = direction_costs(replace(raster, votes=votes), [*walls, ground], cell, 1)[0]
    assert (costs[:3] > 0).all()


def test_cells_in_the_colour_of_a_label_are_likely_to_have_it(house):
    photo = np.full((720, 960, 3), BROWN, np.uint8)
    photo[:, :480] = WHITE
    raster = take_raster(house.lines, house.camera, house.rotation, photo)
    cell = np.repeat([0, 1], COLUMNS // 4)
    cell = np.tile(np.r_[cell, cell + 2], raster.shape[0])  # two white ones beside two brown ones
    costs = colour_costs(raster, cell, np.array([0, 0, 1, 1]), 4)
    assert (costs[:2, 0] < 0).all()
    assert (costs[:2, 1] > 0).all()
    assert (costs[2:, 1] < 0).all()
    assert (costs[2:, 0] > 0).all()
    assert (costs[:, 2:] == 0).all()  # labels that none has


def test_in_a_room_no_level_is_seen_through_all_of_its_walls(house, raster):
    ground = Surface("ground", 2, -2.0, NO_LINES, None)
    rows = [row for row in range(len(house.lines)) if (house.lines.ends[row, :, 1] == 8).all()]
    below = replace(NO_HEAVEN, is_ceiling=True)
    at = sample(700, 520)

    def cost_behind(*offsets, heaven=below, seen=raster, also=None):
        walls = [wall(offset, rows) for offset in offsets] + [also] * (also is not None)
        alone, more = (sample_costs(seen, house.lines, [ground, *some], heaven, np.inf)[:, 0] for some in ([], walls))
        return more[at] - alone[at]

    assert cost_behind(8.0) == pytest.approx(ROOM_COST)
    assert cost_behind(7.0, 8.0) == pytest.approx(ROOM_COST)
    assert cost_behind(8.0, 11.5) == pytest.approx(WALLED_COST)  # the other one stands beyond what is seen of it
    assert cost_behind(8.0, heaven=NO_HEAVEN) == pytest.approx(WALLED_COST)
    mapped = replace(raster, map_depth=np.full(raster.size, np.nan))
    assert cost_behind(8.0, seen=mapped) == pytest.approx(ROOM_COST)
    # One that the ray never meets is not there, also where it reaches to both sides of the camera.
    behind = Surface("wall", 1, -8.0, NO_LINES, None, box=np.array([[-3.0, -8, -2], [3, -8, 2]]))
    assert cost_behind(8.0, also=behind) == pytest.approx(ROOM_COST)


def test_a_room_ends_at_the_last_wall_of_each_side_wherever_that_ends(house, raster):
    """Of a wall behind furniture a picture may be all that is seen; floor and ceiling once went on beside it."""
    ground = Surface("ground", 2, -2.0, NO_LINES, None)
    below = replace(NO_HEAVEN, is_ceiling=True)
    depth = depths(raster, [ground])[:, 0]
    seen = np.isfinite(depth)
    x, y = (raster.rays[:, axis] * np.where(seen, depth, 0.0) for axis in range(2))
    box = np.array([[-3.0, 8, 0], [-2.9, 8, 0.1]])  # it ends where no ray in the middle of the photo meets it
    for axis, offset, outside in ((1, 8.0, y > 8.0), (0, -2.0, x < -2.0), (0, 2.0, x > 2.0), (1, -8.0, y < -8.0)):
        short = Surface("wall", axis, offset, NO_LINES, None, box=box)
        alone, more = (sample_costs(raster, house.lines, [ground, *s], below, np.inf)[:, 0] for s in ([], [short]))
        at = x if axis == 0 else y
        clear = seen & (np.abs(at / offset - 1) > 0.05)
        assert (more - alone)[clear & outside] == pytest.approx(ROOM_COST)
        assert ((more - alone)[clear & ~outside] < ROOM_COST).all()
        assert (clear & outside).any() == (offset != -8.0)
