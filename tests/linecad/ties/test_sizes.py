"""Sizes: the same windows at another scale correlate best at the true ratio, others nowhere; what counts as a size."""

from dataclasses import replace

import numpy as np
import pytest

from linecad.ties.frequencies import SAME, STEP, WIDEST, Correlation
from linecad.ties.sizes import LEAST_SIZES, NEAREST, find_sizes, sizes_of

random = np.random.default_rng(5)
WINDOWS = np.log(np.concatenate([random.uniform(0.4, 3.0, 40).repeat(3), random.uniform(0.4, 3.0, 20)]))
OTHERS = np.log(random.uniform(0.4, 3.0, 120))
NONE = np.zeros(0)
PLACES = np.arange(-1.1, 1.1, 0.01)


def sizes(level, upright=NONE, middle=0.0):
    return sizes_of(level, upright, middle)


def best(pair):
    return float(PLACES[np.argmax([pair.at(place) for place in PLACES])])


@pytest.mark.parametrize("by", [0.0, 0.07, -0.4, 0.9])
@pytest.mark.parametrize("middle", [0.0, 0.5])
def test_equal_windows_match_best_at_the_true_ratio(by, middle):
    """Whatever the depths of the bodies are: frequencies are counted from there, ratios are not."""
    pair = Correlation(sizes(WINDOWS, WINDOWS), sizes(WINDOWS + by, WINDOWS + by, middle))
    assert best(pair) == pytest.approx(by, abs=SAME + STEP)
    assert pair.at(by) > 8


def test_the_ratio_is_that_of_the_first_to_the_second():
    """Scales that make sizes equal: the body whose sizes are smaller must grow."""
    pair = Correlation(sizes(WINDOWS), sizes(WINDOWS + 0.3))
    assert pair.at(0.3) > 5 > abs(pair.at(-0.3))
    turned = Correlation(sizes(WINDOWS + 0.3), sizes(WINDOWS))
    assert turned.at(-0.3) == pytest.approx(pair.at(0.3), rel=0.05)


def test_level_lines_are_not_held_against_uprights():
    assert Correlation(sizes(WINDOWS), sizes(NONE, WINDOWS)).at(0.0) == 0.0


def test_windows_of_other_sizes_match_nowhere():
    pair = Correlation(sizes(WINDOWS), sizes(OTHERS))
    assert max(pair.at(place) for place in PLACES) < Correlation(sizes(WINDOWS), sizes(WINDOWS)).at(0.0) / 2


def test_too_few_sizes_tell_nothing():
    few = sizes(WINDOWS[: LEAST_SIZES - 1])
    assert few.spectra == (None, None)
    assert Correlation(few, sizes(WINDOWS)).at(0.0) == 0.0
    assert sizes(WINDOWS[:LEAST_SIZES]).spectra[0] is not None


def test_beyond_the_widest_ratio_nothing_is_told():
    pair = Correlation(sizes(WINDOWS), sizes(WINDOWS + WIDEST + 0.2))
    assert pair.at(WIDEST + 0.2) == 0.0


def test_bodies_of_which_one_has_moved_match_where_they_were(build_setting, build_town):
    """Two like grids in one wall: the sizes of the second are moved by as much as its depths."""
    across = np.cumsum([0.0, 0.31, 0.52, 0.23, 0.44, 0.65])
    pieces = [row(place, across) for place in (-2.6, 0.3)]
    setting = build_setting(build_town(*pieces), moved=(0.2,))
    first, second = find_sizes(setting)
    assert first.spectra[0] is not None
    pair = Correlation(first, second)
    assert pair.at(-0.2) == pytest.approx(max(pair.at(place) for place in PLACES))
    assert pair.at(-0.2) > 3


def row(at, across):
    """Uprights and courses of a grid in the wall y = 6, unevenly apart."""
    lines = [(2, np.array([at + x, 6.0, -1.5]), np.array([at + x, 6.0, 1.6])) for x in across]
    heights = np.cumsum([-1.5, 0.37, 0.58, 0.29, 0.71, 0.43])
    return lines + [(0, np.array([at, 6.0, z]), np.array([at + across[-1], 6.0, z])) for z in heights]


def test_sizes_are_of_lines_beside_each_other_in_one_plane(build_setting, build_town):
    """Nine uprights far before a wall of nine: each has its own sizes and those to the other wall do not count."""
    near = [(2, np.array([x, 4.0, -1.0]), np.array([x, 4.0, 1.0])) for x in np.linspace(-2.0, 2.0, 9)]
    far = [(2, np.array([x, 8.0, -1.0]), np.array([x, 8.0, 1.0])) for x in np.linspace(-1.93, 2.07, 9)]
    setting = build_setting(build_town(near + far))
    setting = replace(setting, bodies=replace(setting.bodies, body=np.zeros(18, np.int64), count=1))
    (found,) = find_sizes(setting)
    spectrum = found.spectra[1]
    assert spectrum is not None
    assert found.spectra[0] is None
    frequency = np.fft.irfft(spectrum)
    # Half a metre apart, and multiples: of both walls alike, to the NEAREST neighbours.
    strong = np.flatnonzero(frequency > 0.4 * frequency.max()) * STEP - 4.0 + found.middle
    steps = np.log(0.5 * np.arange(1, NEAREST + 1))
    assert all(np.abs(steps - size).min() < 2 * STEP for size in strong)
