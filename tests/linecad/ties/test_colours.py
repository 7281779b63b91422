"""Colours: walls of one paint are alike, red and blue ones are not, and light alone makes no difference."""

from dataclasses import replace

import numpy as np
import pytest

from linecad.ties.colours import BESIDE, BINS, TYPICAL, find_colours, likeness, seen_beside

RED, BLUE, GREY = (170, 60, 50), (50, 70, 170), (128, 128, 128)


def colours_of(setting):
    return find_colours(setting, seen_beside(setting))


@pytest.fixture(scope="module")
def row(build_town, build_row):
    return build_town(*build_row(0))


def painted(left, right):
    """A photo of two halves, with grain."""
    grain = np.random.default_rng(3).normal(0, 3, (288, 192, 1))
    halves = [np.tile(np.clip(colour + grain, 0, 255).astype(np.uint8), (10, times, 1))
              for colour, times in ((left, 9), (right, 11))]  # fmt: skip
    return np.concatenate(halves, axis=1)


def looking_at(setting, pixels, **more):
    return replace(setting, sight=replace(setting.sight, pixels=pixels), **more)


def like(setting, left, right):
    colours = colours_of(looking_at(setting, painted(left, right)))
    return likeness(colours, 0, 1)


@pytest.fixture(scope="module")
def walls(row, build_setting):
    return build_setting(row)


def test_equal_walls_are_alike(walls):
    assert like(walls, RED, RED) > 0.95


def test_walls_of_two_colours_are_not(walls):
    assert like(walls, RED, BLUE) < 0.02
    assert like(walls, RED, GREY) < 0.1


def test_walls_of_one_grey_in_sun_and_shade_are_alike(walls):
    assert like(walls, (220, 220, 220), (90, 90, 90)) > 0.9


def test_shares_of_colours_sum_to_one(walls):
    for colours in colours_of(looking_at(walls, painted(RED, BLUE))):
        assert colours.shape == (BINS, BINS)
        assert colours.sum() == pytest.approx(1)
        assert colours.min() >= 0


def test_likeness_is_what_both_have():
    one, other = np.zeros((BINS, BINS)), np.zeros((BINS, BINS))
    one[0, :2], other[0, 1:3] = [0.7, 0.3], [0.4, 0.6]
    assert likeness([one, other], 0, 1) == likeness([one, other], 1, 0) == pytest.approx(0.3)


def test_without_pixels_walls_are_as_alike_as_walls_are(walls):
    assert colours_of(walls) is None
    assert likeness(None, 0, 1) == TYPICAL == 0.87


@pytest.mark.parametrize("width", [3840, 1920])
def test_walls_are_looked_at_beside_their_lines(walls, row, width):
    """The lines themselves are blue, and red is what lies from 14 to 26 px at the reference width beside them."""
    far = np.array(BESIDE) * width / 3840
    pixels = np.empty((2880, 3840, 3), np.uint8)
    pixels[:] = BLUE
    upright = row.graph.segments.ends[0]  # between others that are far away
    u, (v, w) = round(upright[0, 0]), np.sort(upright[:, 1]).astype(int)
    for side in (-1, 1):
        left, right = sorted(u + side * far)
        pixels[v : w + 1, int(left) - 4 : int(right) + 5] = RED
    alone = replace(walls.bodies, body=np.where(np.arange(len(row.part)) == 0, 0, 1))
    seen = looking_at(replace(walls, sight=replace(walls.sight, width=width)), pixels, bodies=alone)
    (found, _), (red, _) = colours_of(seen), colours_of(looking_at(seen, painted(RED, RED)))
    assert np.minimum(found, red).sum() > 0.9
