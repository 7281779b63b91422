"""Ends of uprights: heads and sills of like windows match at the true ratio, however many courses the walls have."""

import numpy as np
import pytest

from linecad.ties.frequencies import APART, BESIDE, SAME, Correlation, Frequencies, spectrum
from linecad.ties.levels import LevelPair, find_levels
from linecad.ties.upright_ends import LEAST_ENDS, find_upright_ends

HEADS_AND_SILLS = [(-1.31, -0.42), (0.33, 1.12), (1.63, 2.47)]  # of three storeys
PLACES = np.arange(-0.5, 0.5, 0.004)


def facade(at, storeys, courses=0, higher=0.0):
    """Windows in the wall y = 6 from `at` on, four in each row, and courses all over it."""
    uprights = [
        (2, np.array([at + 0.5 * number, 6.0, sill]), np.array([at + 0.5 * number, 6.0, head]))
        for sill, head in storeys
        for number in range(4)
    ]
    levels = [
        (0, np.array([at, 6.0, height]), np.array([at + 2.0, 6.0, height]))
        for height in np.linspace(-1.6 + higher, 2.65 + higher, courses + 2).tolist()
    ]
    return uprights + levels


def correlation(build_setting, build_town, first, second, moved=0.0):
    setting = build_setting(build_town(first, second), moved=(moved,))
    return Correlation(*find_upright_ends(setting))


def best(pair):
    return float(PLACES[np.argmax([pair.at(place) for place in PLACES])])


@pytest.mark.parametrize("moved", [0.0, 0.07, -0.2])
def test_like_storeys_match_best_where_the_bodies_truly_are(build_setting, build_town, moved):
    pair = correlation(build_setting, build_town, facade(-2.4, HEADS_AND_SILLS), facade(0.3, HEADS_AND_SILLS), moved)
    assert best(pair) == pytest.approx(-moved, abs=SAME + 0.004)
    assert pair.lead(-moved) > 1.5
    assert pair.lead(-moved + 0.05) < -1.5


def test_courses_hide_levels_and_not_ends(build_setting, build_town):
    """The second wall's courses lie half a course higher: more levels match elsewhere."""
    walls = [facade(at, HEADS_AND_SILLS, courses=60, higher=by) for at, by in ((-2.4, 0.0), (0.3, 0.035))]
    setting = build_setting(build_town(*walls), moved=(0.1,))
    levels, ends = LevelPair(*find_levels(setting)), Correlation(*find_upright_ends(setting))
    rivals = [place for place in PLACES if APART < abs(place + 0.1) < BESIDE]
    assert max(levels.at(place).excess for place in rivals) > levels.at(-0.1).excess
    assert ends.lead(-0.1) > 1.5


def test_other_storeys_match_nowhere_well(build_setting, build_town):
    other = [(-1.5, -0.71), (0.21, 0.84), (1.05, 1.41), (1.77, 2.6)]
    pair = correlation(build_setting, build_town, facade(-2.4, HEADS_AND_SILLS), facade(0.3, other))
    assert pair.lead(0.0) < 0.5


def test_what_ends_below_the_camera_is_not_held_against_what_ends_above(build_setting, build_town):
    above = [(0.42, 1.31), (1.6, 2.2)]
    below = [(-head, -sill) for sill, head in above]
    pair = correlation(build_setting, build_town, facade(-2.4, above), facade(0.3, below))
    assert all(pair.at(place) == 0.0 for place in PLACES)
    assert pair.lead(0.0) == 0.0


def test_a_few_ends_tell_nothing(build_setting, build_town):
    few = facade(-2.4, [(0.42, 1.31)])[: LEAST_ENDS // 2] + facade(-2.4, [], courses=2)
    found = find_upright_ends(build_setting(build_town(few, facade(0.3, HEADS_AND_SILLS))))
    assert found[0].spectra == (None, None)
    assert all(each is not None for each in found[1].spectra)


def test_ends_at_eye_level_tell_nothing(build_setting, build_town):
    at_eyes = [(-0.1, 0.1)]
    found = find_upright_ends(build_setting(build_town(facade(-2.4, at_eyes), facade(0.3, HEADS_AND_SILLS))))
    assert found[0].spectra == (None, None)


def test_a_lead_is_over_rivals_near_the_ratio_alone():
    """Not over the ratio's own neighbours, nor over ratios that no two bodies beside each other have."""
    random = np.random.default_rng(4)
    values = random.uniform(-1.0, 1.0, 40)

    def frequencies(by):
        return Frequencies(0.0, (spectrum(np.concatenate([values + shift for shift in by]), 0.004, 0.2),))

    pair = Correlation(frequencies([0.0]), frequencies([0.0, 0.1, 0.9]))
    assert pair.lead(0.9) > 3
    assert abs(pair.lead(0.0)) < 2
    assert pair.lead(0.05) == pytest.approx(pair.at(0.05) - max(pair.at(0.0), pair.at(0.1)), abs=0.3)


def test_roots_of_counts_make_a_heap_of_ends_count_less():
    heap = np.concatenate([np.zeros(90), np.full(1, 1.0)])
    plain, rooted = (np.fft.irfft(spectrum(heap, 0.004, 0.2, scaled=scaled)) for scaled in (None, np.sqrt))
    assert rooted[1200:1300].max() / rooted.max() > 5 * plain[1200:1300].max() / plain.max()
