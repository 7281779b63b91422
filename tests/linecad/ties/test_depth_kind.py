"""What a map measures: told by its file or by the walls; maps that are not of this photo are left out."""

from dataclasses import replace

import numpy as np
import pytest

from linecad.depth.depth_map import DepthMap
from linecad.errors import DepthMapError
from linecad.ties.depth_kind import read_depth
from linecad.ties.depth_samples import sample_walls

MOVED = (0.3, -0.2, 0.1)
NEAR = 0.02  # log scale: a shift is found within some percent only
KINDS = [("z", 0.0), ("distance", 0.0), ("inverse", 0.0), ("affine-inverse", 0.4), ("affine-inverse", -0.1)]
UNTOLD = [one for one in KINDS if one[0] != "inverse"]
FLAT = 0.02  # share of the depth that walls span


@pytest.fixture(scope="module")
def moved(avenue_walls, build_setting):
    seen, _ = avenue_walls
    return build_setting(seen, MOVED)


@pytest.fixture(scope="module")
def read(avenue_walls, build_depth_map, moved):
    """A function that makes a map of the avenue, changes its values, and reads it."""
    seen, surfaces = avenue_walls

    def of(kind="z", scale=1.0, shift=0.0, told=True, change=None):
        depth = build_depth_map(seen.sight, surfaces, kind, scale, shift, told)
        if change is not None:
            depth = replace(depth, values=np.where(depth.valid, change(depth.values), 0.0))
        return read_depth(depth, sample_walls(moved, depth))

    return of


def relative(reading):
    """The log scales that are asked for, less the first."""
    return reading.log_scale - reading.log_scale[0]


TRUE = -np.array(MOVED) + MOVED[0]


@pytest.mark.parametrize("scale", [0.1, 50.0])
@pytest.mark.parametrize(("kind", "shift"), KINDS)
def test_a_told_kind_is_taken(read, kind, shift, scale):
    reading = read(kind, scale, shift)
    assert reading.kind == kind
    assert (reading.shift == 0) == (kind != "affine-inverse")
    assert reading.unevenness < FLAT
    np.testing.assert_allclose(relative(reading), TRUE, atol=NEAR)
    if kind != "affine-inverse":
        np.testing.assert_allclose(reading.log_scale, np.log(scale) - np.array(MOVED), atol=1e-3)


@pytest.mark.parametrize("scale", [0.1, 50.0])
@pytest.mark.parametrize(("kind", "shift"), UNTOLD)
def test_an_untold_kind_is_found(read, kind, shift, scale):
    reading = read(kind, scale, shift, told=False)
    assert reading.kind == kind
    np.testing.assert_allclose(relative(reading), TRUE, atol=NEAR)


def test_disparity_without_a_shift_is_disparity_with_none(read):
    """Nobody can tell the two apart, and no body stands elsewhere."""
    reading = read("inverse", told=False)
    assert reading.kind == "affine-inverse"
    np.testing.assert_allclose(reading.log_scale, -np.array(MOVED), atol=NEAR)


def test_a_wrong_kind_that_is_told_bends_walls(read, avenue_walls, build_depth_map, moved):
    seen, surfaces = avenue_walls
    depth = replace(build_depth_map(seen.sight, surfaces, "distance"), kind="z")
    bent = read_depth(depth, sample_walls(moved, depth))
    assert bent.kind == "z"
    assert bent.unevenness > 5 * read("distance").unevenness


def test_a_map_between_two_kinds_is_refused_with_both_numbers(
    build_wall, build_town, build_setting, build_facade, build_depth_map, small_camera
):
    """Half way between z and distance, a little nearer to the latter, so that walls are as bent by either."""
    beside = build_wall(0, -4.6, np.arange(8.0, 13.1, 0.7), np.array([-2.0, -0.4, 0.9, 2.1]))
    across = build_wall(1, 26.0, np.arange(-1.5, 1.6, 0.5), np.array([-2.5, 0.2, 1.2, 3.1]))
    seen = build_town(beside, across, camera=small_camera)
    surfaces = [build_facade(0, -4.6, (7.0, 14.0), (-3.0, 3.0)), build_facade(1, 26.0, (-3.0, 3.0), (-4.0, 4.0))]
    z, distance = (build_depth_map(seen.sight, surfaces, kind) for kind in ("z", "distance"))
    depth = DepthMap("half.npz", np.where(z.valid, z.values**0.45 * distance.values**0.55, 0.0), z.valid, None)
    samples = sample_walls(build_setting(seen), depth)
    with pytest.raises(DepthMapError) as caught:
        read_depth(depth, samples)
    said = str(caught.value)
    assert said.startswith("half.npz may hold distance or z: ")
    assert said.endswith("say which, like --option depth-kind=z")
    assert len(said.splitlines()) == 1
    for kind in ("z", "distance"):
        reading = read_depth(replace(depth, kind=kind), samples)
        assert reading.kind == kind, "what the user says is taken"
        assert f"{reading.unevenness:.0%}" in said


def test_a_map_of_one_depth_is_left_out(read):
    assert "one depth" in read(change=lambda values: np.full_like(values, 7.0))
    assert "one depth" in read(told=False, change=lambda values: np.full_like(values, 7.0))


@pytest.mark.parametrize("told", [True, False])
@pytest.mark.parametrize("seed", range(3))
def test_permuted_depths_are_left_out(read, told, seed):
    def permuted(values):
        return np.random.default_rng(seed).permutation(values.ravel()).reshape(values.shape) + 1.0

    said = read(told=told, change=permuted)
    assert isinstance(said, str)
    assert "off the photo's walls by" in said


@pytest.mark.parametrize("told", [True, False])
def test_a_map_of_other_walls_is_left_out(avenue_walls, build_facade, build_ground, build_depth_map, moved, told):
    seen, _ = avenue_walls
    others = [build_ground(1.5, None), build_facade(1, 12.0, (-30.0, 30.0), (-1.5, 30.0))]
    depth = build_depth_map(seen.sight, others, told=told)
    said = read_depth(depth, sample_walls(moved, depth))
    assert isinstance(said, str)
    assert "off the photo's walls by" in said


def test_walls_that_face_the_camera_tell_nothing_of_a_map(
    build_wall, build_town, build_setting, build_facade, build_depth_map, small_camera
):
    heights = np.array([-2.0, -0.4, 0.9, 2.1])
    walls = [build_wall(1, place, np.arange(at, at + 3.1, 0.6), heights) for place, at in ((12.0, -4.0), (18.0, 2.0))]
    seen = build_town(*walls, camera=small_camera)
    surfaces = [build_facade(1, 12.0, (-5.0, 0.0), (-3.0, 3.0)), build_facade(1, 18.0, (1.0, 6.0), (-3.0, 3.0))]
    depth = build_depth_map(seen.sight, surfaces)
    said = read_depth(depth, sample_walls(build_setting(seen), depth))
    assert said == "the walls of this photo span too little depth to tell whether it follows them"


@pytest.mark.parametrize("shown", [0, 1])
def test_a_map_that_shows_too_few_walls_is_left_out(avenue_walls, build_depth_map, moved, shown):
    seen, surfaces = avenue_walls
    depth = build_depth_map(seen.sight, surfaces)
    valid = depth.valid.copy()
    valid[:, 1 + int(seen.graph.segments.ends[seen.part < shown][..., 0].max(initial=-1.0)) :] = False
    depth = replace(depth, values=np.where(valid, depth.values, 0.0), valid=valid)
    assert read_depth(depth, sample_walls(moved, depth)) == "it covers too few walls of this photo"


def test_reasons_are_one_clause(read):
    said = read(change=lambda values: np.full_like(values, 7.0))
    assert not said.endswith(".")
    assert "\n" not in said
    assert said[0].islower()
