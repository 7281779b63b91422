"""Where a map is asked, and what it asks of each body: on exact maps of exact walls, and on samples made by hand."""

from dataclasses import replace

import numpy as np
import pytest

from linecad.depth.depth_map import DepthMap
from linecad.geometry import world_rays
from linecad.ties.depth_samples import DepthSamples, sample_walls, wall_votes, weighted_median

MOVED = (0.3, -0.2, 0.1)  # log depth by which the bodies stand wrong
EXACT = 2e-4  # log depth: samples are at whole pixels
KINDS = [("z", 0.0), ("distance", 0.0), ("inverse", 0.0), ("affine-inverse", 0.4), ("affine-inverse", -0.1)]
SIZE = 20  # samples of a wall made by hand


@pytest.fixture(scope="module")
def moved(avenue_walls, build_setting):
    seen, _ = avenue_walls
    return build_setting(seen, MOVED)


@pytest.fixture(scope="module")
def plain(avenue_walls, build_depth_map):
    seen, surfaces = avenue_walls
    return build_depth_map(seen.sight, surfaces)


def changed(depth, **fields):
    """The map with other values, or with fewer that are valid."""
    values, valid = fields.get("values", depth.values), fields.get("valid", depth.valid)
    return replace(depth, values=np.where(valid, values, 0.0), valid=valid)


def numbered(like):
    """A map of the shape of that array in which each pixel holds its number from 1 on, all valid."""
    values = np.arange(1, like.size + 1, dtype=np.float32).reshape(like.shape)
    return DepthMap("numbers.npz", values, np.ones(values.shape, bool), "z")


def places(samples, depth):
    """The pixels (S, 2), column and row, that samples of a numbered map are from."""
    row, column = np.divmod(np.rint(samples.value).astype(int) - 1, depth.width)
    return np.column_stack([column, row])


def by_hand(*walls, bodies):
    """Samples that ask for given log scales (S,) of walls, each (its body, its lines, what its samples ask for)."""
    asked = np.concatenate([np.asarray(own, float) for _, _, own in walls])
    count = [len(own) for _, _, own in walls]
    return DepthSamples(
        value=np.exp(asked),
        slant=np.ones(len(asked)),
        log_depth=np.zeros(len(asked)),
        wall=np.repeat(np.arange(len(walls)), count),
        body=np.repeat([body for body, _, _ in walls], count),
        lines=np.repeat([lines for _, lines, _ in walls], count),
        bodies=bodies,
    )


def log_scales(samples, kind="z", shift=0.0):
    """By which log a map asks each body to grow."""
    return wall_votes(samples, samples.excess(kind, shift)).of_bodies(samples.bodies)


def asked_of(*walls, bodies):
    samples = by_hand(*walls, bodies=bodies)
    return log_scales(samples)


@pytest.mark.parametrize("scale", [0.2, 1.0, 30.0])
@pytest.mark.parametrize(("kind", "shift"), KINDS)
def test_an_exact_map_asks_each_body_for_its_true_scale(
    avenue_walls, build_depth_map, moved, plain, kind, shift, scale
):
    seen, surfaces = avenue_walls
    depth = build_depth_map(seen.sight, surfaces, kind, scale, shift)
    added = shift / (plain.values[plain.valid].min() * scale)  # a share of the largest inverse depth
    samples = sample_walls(moved, depth)
    assert len(samples) > 100
    asked = log_scales(samples, kind, -added)
    np.testing.assert_allclose(asked, np.log(scale) - np.array(MOVED), atol=EXACT)


def test_samples_lie_beside_lines_of_their_wall(avenue_walls, moved, plain):
    seen, _ = avenue_walls
    samples = sample_walls(moved, numbered(plain.values))
    at = places(samples, plain)
    assert set(samples.body.tolist()) == {0, 1, 2}
    assert (np.diff(samples.wall) >= 0).all()
    for place, body in zip(at, samples.body, strict=True):
        start, end = np.moveaxis(seen.graph.segments.ends[seen.part == body], 1, 0)
        along = (end - start) / np.linalg.norm(end - start, axis=1, keepdims=True)
        off = place - start
        position = (off * along).sum(axis=1)
        across = np.abs(off[:, 0] * along[:, 1] - off[:, 1] * along[:, 0])
        beside = (position > 0) & (position < np.linalg.norm(end - start, axis=1))
        nearest = across[beside & (across > 3)].min()  # px: never on the edge itself
        assert nearest < 0.02 * plain.width


def test_what_bleeds_on_the_lines_themselves_changes_nothing(avenue_walls, moved, plain):
    seen, _ = avenue_walls
    before = sample_walls(moved, plain)
    values = plain.values.copy()
    for start, end in seen.graph.segments.ends:
        on = start + np.linspace(0, 1, 2000)[:, None] * (end - start)
        column, row = np.rint(on).astype(int).T
        for x in range(-1, 2):
            for y in range(-1, 2):
                values[row + y, column + x] = 99.0
    after = sample_walls(moved, changed(plain, values=values))
    assert 0 < (after.value != before.value).mean() < 0.3, "only where another line crosses"
    asked = log_scales(after)
    np.testing.assert_allclose(asked, log_scales(before), atol=EXACT)


def test_invalid_pixels_are_not_asked(moved, plain):
    valid = np.zeros(plain.valid.shape, bool)
    valid[::2, 1::3] = True
    numbers = numbered(plain.values)
    samples = sample_walls(moved, changed(numbers, valid=valid))
    at = places(samples, plain)
    assert len(samples) > 50
    assert (at[:, 1] % 2 == 0).all()
    assert (at[:, 0] % 3 == 1).all()


def test_walls_that_the_map_does_not_show_are_not_told(avenue_walls, moved, plain):
    seen, _ = avenue_walls
    valid = plain.valid.copy()
    first = seen.graph.segments.ends[seen.part == 0]
    valid[:, : int(first[..., 0].max()) + 30] = False
    samples = sample_walls(moved, changed(plain, valid=valid))
    asked = log_scales(samples)
    assert np.isnan(asked).tolist() == [True, False, False]
    np.testing.assert_allclose(asked[1:], [0.2, -0.1], atol=EXACT)


def test_a_map_without_any_depth_tells_nothing(moved, plain):
    samples = sample_walls(moved, changed(plain, valid=np.zeros(plain.valid.shape, bool)))
    assert len(samples) == 0
    assert samples.bodies == 3
    assert np.isnan(log_scales(samples)).all()


@pytest.mark.parametrize("turned", ["yaw", "pitch"])
def test_nothing_outside_the_photo_is_asked(
    build_wall, build_town, build_setting, build_facade, build_depth_map, small_camera, turned
):
    """Lines hug two edges of the photo. Beyond them there is nothing: neither the other edge nor more of this one."""
    half = np.arctan((small_camera.width if turned == "yaw" else small_camera.height) / 2 / small_camera.focal)
    hugging = 10 * np.tan(0.3 + np.array([-half + 0.001, -half + 0.004, 0.0, half - 0.004, half - 0.001]))
    between = np.linspace(-0.5, 0.5, 5)
    grid = (hugging, between) if turned == "yaw" else (between, hugging)
    seen = build_town(build_wall(1, 10.0, *grid), **{turned: 0.3}, camera=small_camera)
    depth = build_depth_map(seen.sight, [build_facade(1, 10.0, (-99.0, 99.0), (-99.0, 99.0))])
    samples = sample_walls(build_setting(seen), depth)
    at = places(sample_walls(build_setting(seen), numbered(depth.values)), depth)
    along = at[:, 0 if turned == "yaw" else 1]
    assert along.min() < 20
    assert along.max() > (depth.width if turned == "yaw" else depth.height) - 20
    np.testing.assert_allclose(samples.excess("z"), 0.0, atol=1e-3)


def test_nothing_behind_the_camera_is_asked(build_wall, build_town, build_setting, small_camera):
    """A wall that runs far away ends at its horizon, beyond which its plane is behind the camera."""
    wall = build_wall(0, 2.5, np.array([9.0, 14.0, 30.0, 90.0, 250.0]), np.array([-3.0, 0.3, 4.0]))
    seen = build_town(wall, camera=small_camera)
    depth = numbered(np.empty((small_camera.height, small_camera.width)))
    samples = sample_walls(build_setting(seen), depth)
    rays = world_rays(places(samples, depth).astype(float), seen.sight.matrix, seen.sight.rotation)
    assert len(samples) > 50
    assert (rays[:, 0] > 0).all()
    np.testing.assert_allclose(samples.log_depth, np.log(2.5 / rays[:, 0]), atol=0.03)


def test_bodies_without_a_wall_are_not_told(
    build_wall, build_town, build_setting, build_facade, build_depth_map, small_camera
):
    first = build_wall(1, 10.0, np.linspace(-5.0, -2.0, 5), np.linspace(-2.0, 2.0, 5))
    uprights = build_wall(1, 10.0, np.linspace(1.0, 4.0, 6), np.array([-2.0, 2.0]))[:6]
    seen = build_town(first, uprights, camera=small_camera)
    depth = build_depth_map(seen.sight, [build_facade(1, 10.0, (-6.0, 6.0), (-4.0, 4.0))])
    samples = sample_walls(build_setting(seen), depth)
    assert np.isnan(log_scales(samples)).tolist() == [False, True]


def test_samples_that_agree_speak_for_their_wall():
    """Beside the edge of a house half of the samples are on what stands behind it."""
    random = np.random.default_rng(2)
    own, behind = random.normal(0.2, 0.002, 24), random.uniform(0.4, 0.9, 16)
    assert asked_of((0, 9, [*own, *behind]), bodies=1)[0] == pytest.approx(0.2, abs=0.003)


def test_a_wall_has_one_vote():
    """Lines do not count beyond their wall: two walls outvote one of as many samples."""
    asked = asked_of((0, 40, [0.5] * SIZE), (0, 5, [0.1] * SIZE), (0, 5, [0.102] * SIZE), bodies=1)
    assert asked[0] == pytest.approx(0.1, abs=0.003)


def test_walls_on_which_samples_disagree_count_only_where_there_is_no_other():
    spread = np.linspace(-2.0, 2.0, 60)
    assert asked_of((0, 9, spread), (0, 9, [0.3] * SIZE), bodies=1)[0] == pytest.approx(0.3)
    assert np.isfinite(asked_of((0, 9, spread), bodies=1)[0])


def test_walls_of_two_lines_count_only_where_there_is_no_other():
    small = (0, 2, [0.7] * 3 * SIZE)
    assert asked_of(small, (0, 9, [0.3] * SIZE), bodies=1)[0] == pytest.approx(0.3)
    assert asked_of(small, bodies=1)[0] == pytest.approx(0.7)


def test_too_few_samples_are_no_vote():
    asked = asked_of((0, 9, [0.1] * SIZE), (1, 9, [0.1] * 2), (2, 9, [np.nan] * SIZE + [0.1] * 2), bodies=4)
    assert np.isfinite(asked).tolist() == [True, False, False, False]


def test_what_a_shift_makes_negative_has_no_depth():
    samples = replace(by_hand((0, 9, [0.0] * SIZE), bodies=1), value=np.linspace(0.1, 2.0, SIZE))
    excess = samples.excess("affine-inverse", -1.0)
    assert np.isnan(excess).tolist() == (samples.value <= 1.0).tolist()
    assert excess[-1] == pytest.approx(0.0)


@pytest.mark.parametrize(
    ("values", "weight", "wanted"),
    [([3.0], [0.1], 3.0), ([3.0, 1.0, 2.0], [1, 1, 1], 2.0), ([3.0, 1.0, 2.0], [9, 1, 1], 3.0), ([1, 2], [1, 3], 2)],
)
def test_the_weighted_median(values, weight, wanted):
    assert weighted_median(np.array(values, float), np.array(weight, float)) == wanted
