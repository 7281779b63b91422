"""What tests/benchmarks/feet_truth.py says of the feet of walls, on scenes of few quads."""

from types import SimpleNamespace

import numpy as np
import pytest
from feet_truth import OF_CORNICE, STEPPED, UNSEEN, GroundTruth, examples_of

from linecad.dataset.truth import NOTHING, Truth
from linecad.directions import directions_of
from linecad.ties.walls import ROW

BELOW = 1.6  # m from the camera down to the ground
MOVED = 0.3  # log, by how much the body is too large
HEAD = 1.2  # m from the camera up to the ceiling
WALL = ((-4.0, 9.0, -BELOW), (0.0, 9.0, 3.0))


def quad(low, high):
    """Corners of a rectangle along two axes."""
    low, high = np.array(low), np.array(high)
    flat = int(np.argmin(high - low))
    first, second = (axis for axis in range(3) if axis != flat)
    corners = np.tile(low, (4, 1))
    corners[1:3, first], corners[2:4, second] = high[first], high[second]
    return corners


def floor(below, nearest=3.0, farthest=60.0):
    return (-30.0, nearest, -below), (30.0, farthest, -below)


@pytest.fixture(scope="module")
def known(build_town, build_wall, build_setting, paint_photo, build_facade, build_ground):
    """The examples of a wall of lines before the camera, where the scene has these quads."""
    heights = np.array([-0.9, -0.2, 0.8, 1.5, 2.4])
    seen = build_town(build_wall(1, 9.0, np.arange(-3.5, 0.0, 0.8), heights))
    sight = seen.sight
    grey = np.full((2880, 3840, 3), 128, np.uint8)
    setting = build_setting(seen, moved=(MOVED,), pixels=grey)

    def look(*quads, scale=-MOVED, is_above=False):
        numbered = []
        for number, (low, high) in enumerate(quads):
            colour = number_colour(number)
            if low[2] == high[2]:
                surface = build_ground(-low[2], colour)
                numbered.append(type(surface)(2, low[2], low, high, colour))
            else:
                numbered.append(build_facade(1, low[1], (low[0], high[0]), (low[2], high[2]), colour))
        ids = paint_photo(sight, numbered)[..., 0].astype(np.int64)
        ids[ids > len(quads)] = NOTHING  # the sky
        corners = np.stack([quad(low, high) for low, high in quads])
        empty, none = np.zeros((0, 2, 3)), np.zeros(0, np.int64)
        truth = Truth("lane", 3840, 2880, sight.matrix, sight.rotation, corners, np.zeros(len(quads), np.int64),
                      empty, none, np.zeros((0, 2, 2)), none, ids)  # fmt: skip
        return examples_of("lane", setting, np.array([scale]), truth, is_above)

    return look


def ceiling(above):
    return (-30.0, 3.0, above), (30.0, 60.0, above)


def number_colour(number):
    return lambda points: np.full(points.shape, float(number))


def test_a_cellar_that_no_one_sees_is_no_ground(known):
    (example,) = known(WALL, floor(BELOW), floor(BELOW + 1, 70.0, 80.0))
    assert example.log_height == pytest.approx(np.log(BELOW), abs=0.6 * ROW)


def test_the_foot_is_where_the_wall_meets_the_ground(known):
    (example,) = known(WALL, floor(BELOW))
    assert example.row == pytest.approx((np.log(BELOW) + MOVED - example.strip.top) / ROW - 0.5, abs=0.6)
    assert example.log_height == pytest.approx(np.log(BELOW), abs=0.6 * ROW)
    assert example.is_clear
    assert example.scene == "lane"


def test_what_stands_before_the_foot_hides_it(known):
    (example,) = known(WALL, floor(BELOW), ((-6.0, 7.0, -BELOW), (2.0, 7.0, -0.6)))
    assert (example.row, example.is_clear) == (UNSEEN, True)
    assert np.isnan(example.log_height)


@pytest.mark.parametrize(("until", "row_is_known", "is_clear"), [(-1.5, True, True), (-0.5, False, False)])
def test_a_foot_that_is_hidden_in_part_may_be_in_doubt(known, until, row_is_known, is_clear):
    (example,) = known(WALL, floor(BELOW), ((-6.0, 8.5, -BELOW), (until, 8.5, -0.6)))
    assert (example.row != UNSEEN, example.is_clear) == (row_is_known, is_clear)


def test_a_foot_elsewhere_than_the_scale_says_is_none(known):
    (example,) = known(WALL, floor(BELOW), scale=-MOVED + 0.1)
    assert (example.row, example.is_clear) == (UNSEEN, True)


def test_a_body_of_unknown_scale_is_no_example(known):
    assert known(WALL, floor(BELOW), scale=np.nan) == []


@pytest.mark.parametrize(("above", "is_ground"), [(0.8 * STEPPED, True), (1.5 * STEPPED, False)])
def test_a_pavement_is_ground_and_a_terrace_is_not(known, above, is_ground):
    (example,) = known(WALL, floor(BELOW - above, nearest=6.0), floor(BELOW))
    assert (example.row != UNSEEN) is is_ground
    if is_ground:
        assert example.log_height == pytest.approx(np.log(BELOW - above), abs=0.6 * ROW)


def test_the_head_is_where_the_wall_meets_the_ceiling(known):
    (example,) = known(WALL, floor(BELOW), ceiling(HEAD), is_above=True)
    assert example.row == pytest.approx((np.log(HEAD) + MOVED - example.strip.top) / ROW - 0.5, abs=0.6)
    assert example.log_height == pytest.approx(np.log(HEAD), abs=0.6 * ROW)


@pytest.mark.parametrize(("rows", "is_seen"), [(OF_CORNICE - 2, True), (OF_CORNICE + 3, False)])
def test_a_low_cornice_hides_no_head_and_a_high_one_does(known, rows, is_seen):
    cornice = (-6.0, 8.6, HEAD * np.exp(-ROW * rows) * 8.6 / 9.0), (2.0, 8.6, HEAD)
    (example,) = known(WALL, floor(BELOW), ceiling(HEAD), cornice, is_above=True)
    assert (example.row != UNSEEN) is is_seen


def test_without_a_ceiling_there_is_no_head(known):
    (example,) = known(WALL, floor(BELOW), is_above=True)
    assert (example.row, example.is_clear) == (UNSEEN, True)


@pytest.mark.parametrize("turned", [0.0, 0.3, -np.pi / 2])
def test_walls_are_known_by_the_directions_that_were_found(turned):
    """Whatever the world of the truth, and walls of a turned house, which are numbered from 3 on."""
    turns = (0.4,)
    found = directions_of(turns)
    normals = found[[1, 2, 4]]
    camera = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
    cosine, sine = np.cos(turned), np.sin(turned)
    world = np.array([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]])  # from the found one to that of the truth
    quads = np.zeros((3, 4, 3)) - [0.0, 0.0, BELOW]
    truth = SimpleNamespace(
        planes=lambda: (normals @ world.T, np.ones(3)), quads=quads, rotation=camera @ world.T, ids=np.arange(3)[None]
    )  # fmt: skip
    setting = SimpleNamespace(sight=SimpleNamespace(rotation=camera @ found.T))
    along = np.abs(GroundTruth(truth, setting).normal) > 0.99
    assert along.tolist() == [[False, True, False, False, False], [False, False, True, False, False],
                              [False, False, False, False, True]]  # fmt: skip
