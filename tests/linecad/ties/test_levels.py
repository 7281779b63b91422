"""Levels: bodies with the same heights have their best peak at the true ratio; chance; eaves."""

import numpy as np
import pytest

from linecad.ties.levels import (
    APART,
    AROUND,
    BESIDE,
    FLATTEST,
    LEAST_MATCHES,
    MOST,
    ONE_EAVE,
    ONE_LEVEL,
    WIDEST,
    WIDTH,
    LevelPair,
    Levels,
    Match,
    find_levels,
)

HEIGHTS = np.array([0.71, 0.94, 1.33, 1.9, 2.3, 3.1])  # above the eye; no two pairs of one ratio
NONE = np.zeros(0)


def levels(below=(), above=()):
    return Levels(np.sort(np.log(below)) if len(below) else NONE, np.sort(np.log(above)) if len(above) else NONE)


def pair_at(ratios):
    """Two bodies whose levels meet at these log ratios (M,) and nowhere else."""
    return LevelPair(Levels(NONE, np.zeros(1)), Levels(NONE, np.sort(np.asarray(ratios, float))))


@pytest.mark.parametrize("by", [0.0, 0.4, -0.7])
def test_the_best_peak_of_equal_heights_is_the_true_ratio(by):
    first = levels(below=HEIGHTS[:2], above=HEIGHTS)
    pair = LevelPair(first, Levels(first.below + by, first.above + by))
    best = pair.peaks[0]
    assert best.log_ratio == pytest.approx(by, abs=WIDTH + 1e-12)
    assert best.matches == 8
    assert pair.lead(pair.at(by)) > 2
    assert pair.fewest == 8


def test_heights_below_the_eye_do_not_match_those_above():
    assert len(LevelPair(levels(below=HEIGHTS), levels(above=HEIGHTS)).log_ratio) == 0
    assert LevelPair(levels(below=HEIGHTS), levels(above=HEIGHTS)).peaks == []


def test_fewest_counts_both_sides_of_the_eye():
    assert LevelPair(levels(below=HEIGHTS[:3], above=HEIGHTS[:1]), levels(above=HEIGHTS)).fewest == 4


def test_all_that_meet_in_a_window_match():
    pair = pair_at([0.1, 0.1 + 1.9 * WIDTH, 0.1 + 2.1 * WIDTH])
    assert pair.at(0.1 + WIDTH).matches == 2
    assert pair.at(0.1 + 1.05 * WIDTH).matches == 2


@pytest.mark.parametrize(("off", "matches"), [(1.9, 3), (2.1, 0)])
def test_a_ratio_may_be_off_by_a_window(off, matches):
    pair = pair_at([0.1] * 3)
    assert pair.at(0.1 + off * WIDTH).matches == pair.at(0.1 - off * WIDTH).matches == matches


def test_chance_is_known_from_around():
    """The window is expected to hold its share of what lies around it, without what lies right beside it."""
    around = [0.9 * AROUND, -0.9 * AROUND, 1.1 * BESIDE, -1.1 * BESIDE]
    match = pair_at([*around, 0.0, 0.9 * BESIDE, -0.9 * BESIDE, 1.1 * AROUND, -1.1 * AROUND]).at(0.0)
    assert match.matches == 1
    assert match.by_chance == pytest.approx(4 * 2 * WIDTH / (2 * (AROUND - BESIDE)))


def test_excess_is_in_standard_deviations():
    assert Match(0.0, 7, 3.0).excess == pytest.approx(2.0)
    assert Match(0.0, 3, 3.0).excess == 0.0


@pytest.mark.parametrize(("off", "leads_by"), [(0.9 * APART, 5.0), (1.1 * APART, 2.0), (-1.1 * APART, 2.0)])
def test_a_match_leads_over_the_best_peak_elsewhere(off, leads_by):
    pair = pair_at([0.0] * 4)
    pair.peaks = [Match(off, 3, 0.0), Match(0.7, 1, 0.0)]
    by = pair.lead(Match(0.0, 5, 0.0))
    assert by == pytest.approx(leads_by if abs(off) > APART else 4.0)


def test_a_lone_match_leads_over_nothing():
    pair = pair_at([0.0] * 4)
    pair.peaks = []
    assert pair.lead(Match(0.0, 3, 0.0)) == 3.0
    assert pair.lead(Match(0.0, 2, 0.0)) == 0.0


def test_peaks_come_in_order_and_apart():
    meetings = [0.0] * 9 + [0.9 * APART] * 8 + [0.5] * 7 + [-0.5] * 6 + [0.8] * 5 + [-0.8] * 4
    peaks = pair_at(meetings).peaks
    assert [peak.matches for peak in peaks] == [9, 7, 6, 5]
    assert len(peaks) == MOST + 1
    assert [peak.log_ratio for peak in peaks] == pytest.approx([0.0, 0.5, -0.5, 0.8], abs=2 * WIDTH)


def test_peaks_stand_out_from_what_is_around_them():
    crowded = np.repeat(np.arange(-0.14, 0.14, 0.002), 2)
    peaks = pair_at([*(1.0 + crowded), *[0.0] * 6]).peaks
    assert peaks[0].log_ratio == pytest.approx(0.0, abs=WIDTH + 1e-12)
    assert peaks[0].matches < peaks[1].matches


@pytest.mark.parametrize(("at", "peaks"), [(0.99, 1), (1.01, 0)])
def test_scales_are_looked_for_within_reach(at, peaks):
    for sign in (-1, 1):
        found = pair_at([sign * at * WIDEST] * 5).peaks
        assert len(found) == peaks


@pytest.mark.parametrize(("meetings", "peaks"), [(LEAST_MATCHES - 1, 0), (LEAST_MATCHES, 1)])
def test_few_levels_have_no_peak(meetings, peaks):
    assert len(pair_at([0.0] * meetings).peaks) == peaks


def test_eaves_are_the_highest_levels():
    first, second = levels(below=[9.0], above=[1.0, 2.0]), levels(below=[1.0], above=[0.5, 1.5, 3.0])
    pair = LevelPair(first, second)
    true = np.log(3.0 / 2.0)
    for off, same in ((0.9, True), (-0.9, True), (1.1, False), (-1.1, False)):
        assert pair.same_eaves(float(true + off * ONE_EAVE)) is same
    for other in (levels(below=[3.0]), levels()):
        assert not LevelPair(first, other).same_eaves(0.0)
        assert not LevelPair(other, first).same_eaves(0.0)


def test_levels_are_the_heights_of_courses(build_town, build_wall, build_setting):
    heights = np.array([-2.0, -1.0, 1.5, 2.0, 3.0])
    seen = build_town(build_wall(1, 10.0, np.linspace(-4, 4, 5), heights))
    (found,) = find_levels(build_setting(seen, moved=(0.5,)))
    np.testing.assert_allclose(found.below, np.log([1.0, 2.0]) + 0.5)
    np.testing.assert_allclose(found.above, np.log([1.5, 2.0, 3.0]) + 0.5)
    assert found.count == 5


def test_levels_of_two_walls_meet_where_both_are_in_place(build_town, build_row, build_setting):
    seen = build_town(*build_row(0, level=True))
    one, other = find_levels(build_setting(seen, moved=(0.1, 0.35)))
    best = LevelPair(one, other).peaks[0]
    assert best.log_ratio == pytest.approx(0.25, abs=WIDTH + 1e-12)
    assert best.matches == one.count == other.count == 10  # two courses are at eye level


@pytest.mark.parametrize(("apart", "count"), [(0.9, 1), (1.1, 2)])
def test_courses_of_one_height_are_one_level(build_setting, build_town, build_wall, apart, count):
    heights = 2.0 * np.exp([0.0, apart * ONE_LEVEL])
    seen = build_town(build_wall(1, 10.0, np.array([-4.0, 4.0]), heights)[2:])
    (found,) = find_levels(build_setting(seen))
    assert found.count == count


@pytest.mark.parametrize(("flat", "count"), [(0.9, 0), (1.1, 1)])
def test_heights_at_eye_level_say_nothing(build_town, build_wall, build_setting, flat, count):
    for sign in (-1, 1):
        height = sign * flat * FLATTEST * 10.0
        course = build_wall(1, 10.0, np.array([-4.0, 4.0]), np.array([height, 4.0]))[2:3]
        (found,) = find_levels(build_setting(build_town(course)))
        assert found.count == count


def test_uprights_have_no_level(build_town, build_wall, build_setting):
    uprights = build_wall(1, 10.0, np.linspace(-4, 4, 5), np.array([0.5, 3.0]))[:5]
    (found,) = find_levels(build_setting(build_town(uprights)))
    assert found.count == 0
