"""Simulated maps err as they say, per wall, smoothly, at edges, in scale and shift, and read back as what they are."""

import numpy as np
import pytest

from linecad.arrays import Float, Int
from linecad.dataset.depth_maps import (
    LARGEST_SCALE,
    LONGEST_SIDE,
    SKY,
    MapKind,
    corrupted_depth,
    draw_depth_map,
    map_arrays,
    map_pixels,
)
from linecad.dataset.light import draw_light
from linecad.dataset.make import Draft, measure
from linecad.dataset.scenes import draw_scene
from linecad.dataset.store import DEPTH_MAP, write_depth_map
from linecad.dataset.truth import NOTHING, Truth
from linecad.depth.depth_map import DepthMap, Single
from linecad.depth.read import read_depth_map

TILE = 24  # px; far wider than edges bleed
REACH = 10  # px, the widest ramp
KINDS_OF_MAPS: tuple[MapKind, MapKind] = ("z", "affine-inverse")


def quilt(count: int) -> tuple[Float, Int]:
    """Depth and labels of count x count square walls that face the camera at depths of 5 to 50."""
    walls = np.kron(np.arange(count**2).reshape(count, count), np.ones((TILE, TILE), np.int64))
    depth = np.random.default_rng(9).uniform(5, 50, count**2)
    return depth[walls], walls


def street(sky: int = 40) -> tuple[Float, Int]:
    """Sky over a near wall beside a far one."""
    walls = np.zeros((120, 160), np.int64)
    walls[:, 80:] = 1
    depth = np.where(walls == 0, 5.0, 20.0)
    walls[:sky], depth[:sky] = NOTHING, np.nan
    return depth, walls


def tile_errors(found: Single, depth: Float) -> Float:
    """The error of each tile's middle in log depth, after the best scale."""
    error = np.log(found / depth)[TILE // 2 :: TILE, TILE // 2 :: TILE]
    return error - np.median(error)


@pytest.fixture(scope="module")
def truth() -> Truth:
    rng = np.random.default_rng(3)
    model, view = draw_scene("street", rng)
    return measure(Draft("street-0000", model, view, draw_light(rng, False), 0), 400, 225)


def written(truth: Truth, folder, kind: MapKind, seed: int = 5) -> DepthMap:
    write_depth_map(draw_depth_map(truth, 0.012, kind, np.random.default_rng(seed)), folder / DEPTH_MAP)
    return read_depth_map(folder / DEPTH_MAP)


@pytest.mark.parametrize("width", [0.002, 0.012, 0.08])
def test_errors_of_walls_have_the_width_that_was_asked_for(width: float) -> None:
    depth, walls = quilt(20)
    errors = tile_errors(corrupted_depth(depth, walls, width, np.random.default_rng(1)), depth)
    # Half of a Cauchy distribution lies within its width, a twelfth beyond 7.6 times that; a Gauss's tail is empty.
    assert 0.8 * width < np.median(np.abs(errors)) < 1.3 * width
    assert 0.04 < (np.abs(errors) > 7.6 * width).mean() < 0.14


def test_all_of_a_wall_errs_alike_but_for_a_smooth_warp() -> None:
    depth, walls = street(sky=0)
    found = corrupted_depth(depth, walls, 0.05, np.random.default_rng(2))
    error = np.log(found / depth)
    for wall in (np.s_[:, : 80 - REACH], np.s_[:, 80 + REACH :]):
        assert 0.003 < np.ptp(error[wall]) < 0.1
        assert max(np.abs(np.diff(error[wall], axis=axis)).max() for axis in (0, 1)) < 0.002


def test_no_error_is_absurd() -> None:
    depth, walls = quilt(20)
    errors = tile_errors(corrupted_depth(depth, walls, 0.2, np.random.default_rng(1)), depth)
    assert 0.6 < np.abs(errors).max() < np.log(2) + 0.25


def test_the_scale_is_off_by_up_to_two() -> None:
    depth, walls = street()
    scales = [
        np.nanmedian(corrupted_depth(depth, walls, 0.001, np.random.default_rng(seed)) / depth) for seed in range(60)
    ]
    assert 1 / LARGEST_SCALE / 1.1 < min(scales) < 0.6
    assert 1.7 < max(scales) < LARGEST_SCALE * 1.1


def test_the_sky_is_one_value_beyond_the_walls() -> None:
    depth, walls = street()
    z, disparity = (corrupted_depth(depth, walls, 0.01, np.random.default_rng(8), kind) for kind in KINDS_OF_MAPS)
    far_from_walls = np.s_[: 40 - REACH]
    assert np.unique(z[far_from_walls]).tolist() == [z.max()]
    assert z.max() == pytest.approx(SKY * z[40 + REACH :].max(), rel=0.02)
    assert not disparity[far_from_walls].any()
    assert (disparity[walls != NOTHING] > 0).all()


def test_edges_are_ramps_of_three_to_ten_pixels() -> None:
    depth, walls = street(sky=0)
    widths = []
    for seed in range(40):
        row = corrupted_depth(depth, walls, 0.001, np.random.default_rng(seed))[60]
        near, far = row[40], row[120]
        between = np.flatnonzero((row > 1.02 * near) & (row < far / 1.02))
        assert (np.diff(row[70:90]) > -1e-3 * far).all()
        assert abs((between[0] + between[-1]) / 2 - 79.5) <= 0.5  # where the edge is, but for the thresholds
        widths.append(len(between))
    assert 2 <= min(widths) <= 4
    assert 9 <= max(widths) <= 10


def test_nothing_bleeds_within_a_plane_not_even_at_the_border_of_the_map() -> None:
    row, column = np.mgrid[:200, :300]
    depth = 1 / (0.01 + 0.0002 * column + 0.0001 * row)  # a plane, which grows by up to 2 % a pixel
    found = corrupted_depth(depth, np.zeros(depth.shape, np.int64), 0.001, np.random.default_rng(0))
    assert np.ptp(np.log(found / depth)) < 0.003


def test_depth_that_nobody_knows_stays_unknown_and_does_not_spread() -> None:
    walls = np.zeros((120, 160), np.int64)
    depth = np.broadcast_to(1 / np.linspace(0.2, 0.02, 160), walls.shape).copy()
    depth[80:90, 20:30] = np.nan
    found = corrupted_depth(depth, walls, 0.001, np.random.default_rng(0))
    np.testing.assert_array_equal(np.isnan(found), np.isnan(depth))
    beside = found[70:100, 10:40] / depth[70:100, 10:40]
    assert np.nanmax(beside) / np.nanmin(beside) < 1.005


def test_a_map_without_walls_is_refused() -> None:
    with pytest.raises(ValueError, match="no pixel shows a wall"):
        corrupted_depth(np.full((20, 20), np.nan), np.full((20, 20), NOTHING), 0.01, np.random.default_rng(0))


def test_the_same_numbers_give_the_same_map() -> None:
    depth, walls = street()
    first, second, other = (corrupted_depth(depth, walls, 0.01, np.random.default_rng(seed)) for seed in (4, 4, 5))
    np.testing.assert_array_equal(first, second)
    assert (first != other).any()


def test_what_is_given_is_left_as_it_was() -> None:
    depth, walls = street()
    before = depth.copy(), walls.copy()
    corrupted_depth(depth, walls, 0.01, np.random.default_rng(4), "affine-inverse")
    np.testing.assert_array_equal(depth, before[0])
    np.testing.assert_array_equal(walls, before[1])


def test_disparity_is_inverse_depth_with_a_shift_either_way() -> None:
    depth, walls = quilt(6)
    middle = np.s_[TILE // 2 :: TILE, TILE // 2 :: TILE]
    shares = []
    for seed in range(30):
        same, found = (
            corrupted_depth(depth, walls, 0.01, np.random.default_rng(seed), kind).astype(float)
            for kind in KINDS_OF_MAPS
        )
        assert (found > 0).all()
        # The map of z with the same errors tells what the inverse is before the shift.
        inverse = 1 / same[middle].ravel()
        slope, shift = np.polyfit(inverse, found[middle].ravel(), 1)
        assert slope == pytest.approx(1, abs=1e-4)
        shares.append(shift / inverse.min())
    assert -0.91 < min(shares) < -0.6
    assert 0.6 < max(shares) < 0.91


@pytest.mark.parametrize(
    ("height", "width", "shape"),
    [(2160, 3840, (432, 768)), (3000, 4000, (576, 768)), (225, 400, (225, 400)), (8192, 64, (768, 16))],
)
def test_maps_are_as_large_as_those_of_networks(height: int, width: int, shape: tuple[int, int]) -> None:
    rows, columns = map_pixels(height, width)
    assert (len(rows), len(columns)) == shape
    assert max(shape) <= LONGEST_SIDE
    for places, side in ((rows, height), (columns, width)):
        middles = (np.arange(len(places)) + 0.5) * side / len(places) - 0.5
        assert np.abs(places - middles).max() <= 0.5


def test_a_map_of_z_reads_back_as_z_with_its_camera_and_without_the_sky(truth: Truth, tmp_path) -> None:
    found = written(truth, tmp_path, "z")
    assert found.kind == "z"
    np.testing.assert_array_equal(found.intrinsics, truth.matrix)
    is_sky = truth.ids == NOTHING
    assert is_sky.mean() > 0.03
    # Only where walls bleed into it is the sky taken for depth.
    assert found.valid[~is_sky].all()
    assert found.valid[is_sky].mean() < 0.35
    error = np.log(found.values[~is_sky] / truth.depth()[~is_sky])
    assert np.median(np.abs(error - np.median(error))) < 0.05


def test_a_map_of_disparity_reads_back_as_affine_inverse_without_the_sky(truth: Truth, tmp_path) -> None:
    found = written(truth, tmp_path, "affine-inverse")
    assert found.kind == "affine-inverse"
    assert found.intrinsics is None
    np.testing.assert_array_equal(found.valid, written(truth, tmp_path, "z").valid)


def test_the_same_seed_gives_the_same_bytes(truth: Truth, tmp_path) -> None:
    contents = []
    for seed in (5, 5, 6):
        written(truth, tmp_path, "z", seed)
        contents.append((tmp_path / DEPTH_MAP).read_bytes())
    assert contents[0] == contents[1] != contents[2]


def test_the_camera_of_a_smaller_map_sees_the_same_rays() -> None:
    matrix = np.array([[2000.0, 0.0, 1900.0], [0.0, 2000.0, 1100.0], [0.0, 0.0, 1.0]])
    found = map_arrays(np.ones((432, 768), np.float32), "z", matrix, 3840, 2160)["intrinsics"]
    rows, columns = map_pixels(2160, 3840)
    ray = np.linalg.inv(matrix) @ [columns[100], rows[30], 1.0]
    np.testing.assert_allclose((found @ ray)[:2], [100, 30], atol=1e-9)


def test_a_sample_photo_has_a_map_too(sample_depth_map) -> None:
    found = read_depth_map(sample_depth_map("street"))
    assert (found.kind, found.width, found.height) == ("z", 768, 512)
    assert read_depth_map(sample_depth_map("courtyard", kind="affine-inverse")).kind == "affine-inverse"
