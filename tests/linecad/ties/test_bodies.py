"""Rigid bodies: what one bar joins are two, what many lines join is one; what hangs on them, and what is too small."""

import numpy as np
import pytest

from linecad.decide.stability import LEAST_TOLERANCE, SAME_DEPTH, Fits, resample
from linecad.ties.bodies import HANGING_STEPS, LEAST_BODY, LEAST_CORE, RigidBodies, find_rigid_bodies, togetherness
from solver.robust import RobustFit

TEN = 10  # fits that are made by hand


def found_in(seen):
    depth = RobustFit(seen.graph).depths()
    fits = resample(seen.graph, 0, 21)
    return find_rigid_bodies(seen.graph, depth, fits)


def fits_of(core, loose=0):
    """Fits in which `core` lines stay, and `loose` more go somewhere else each time; all are connected."""
    count = core + loose
    depth = np.zeros((TEN, count))
    depth[:, core:] = np.arange(1, TEN + 1)[:, None] * np.arange(1, loose + 1)
    depth += np.arange(TEN)[:, None]  # the scale of a fit means nothing
    return Fits(np.ones((TEN, count), bool), depth, np.zeros((TEN, count), np.int64))


def two_cores():
    """Fits in which five lines and five others stay together, and an eleventh with neither."""
    fits = fits_of(10, 1)
    fits.depth[:, 5:10] += 10.0 * np.arange(TEN)[:, None]
    return fits


def bodies_of(graph, fits):
    return find_rigid_bodies(graph, np.zeros(len(graph.segments)), fits).body.tolist()


def test_a_grid_is_one_body(build_town, build_wall):
    found = found_in(build_town(build_wall(1, 10.0, np.linspace(-4, 4, 12), np.linspace(-3, 3, 12))))
    assert found.count == 1
    assert found.size.tolist() == [24]


def test_grids_that_one_bar_joins_are_two_bodies(build_town, build_row):
    seen = build_town(*build_row(1))
    found = found_in(seen)
    assert found.count == 2
    for part in range(2):
        assert np.bincount(found.body[seen.part == part]).max() >= 23, "the bar alone may be on either side"
    assert found.size.sum() == len(seen.part)


def test_grids_that_many_lines_join_are_one_body(build_town, build_row):
    found = found_in(build_town(*build_row(6)))
    assert found.count == 1
    assert found.size.tolist() == [48]


def test_bodies_are_the_same_each_time(build_town, build_row):
    seen = build_town(*build_row(2, at=(10.0, 11.0)))
    assert found_in(seen).body.tolist() == found_in(seen).body.tolist()


def test_the_largest_core_comes_first(build_links):
    fits = fits_of(15)
    fits.depth[:, :6] += 10.0 * np.arange(TEN)[:, None]
    assert bodies_of(build_links(15, []), fits) == [1] * 6 + [0] * 9


@pytest.mark.parametrize(("away", "body"), [(1, 0), (2, -1)])
def test_a_line_of_a_core_is_there_in_nine_fits_of_ten(build_links, away, body):
    moved, apart = fits_of(7), fits_of(7)
    moved.depth[:away, 6] += 1.0
    apart.group[:away, 6] = 1
    for fits in (moved, apart):
        assert bodies_of(build_links(7, []), fits) == [0] * 6 + [body]


@pytest.mark.parametrize(("by", "body"), [(0.9, 0), (1.1, -1)])
@pytest.mark.parametrize("sign", [-1, 1])
def test_a_line_may_move_a_little_against_its_core(build_links, by, sign, body):
    fits = fits_of(7)
    fits.depth[:, 6] += sign * by * SAME_DEPTH
    assert bodies_of(build_links(7, []), fits) == [0] * 6 + [body]


def test_fits_without_a_line_say_nothing_about_it(build_links):
    fits = fits_of(7)
    fits.present[:5, 6] = False
    fits.depth[:5, 6] += 1.0
    assert bodies_of(build_links(7, []), fits) == [0] * 7


def test_a_line_that_no_fit_has_is_together_with_nothing():
    fits = fits_of(6)
    fits.present[:, 5] = False
    assert togetherness(fits, fits.depth, np.arange(6) < 5).tolist() == [1.0] * 5 + [0.0]


def test_togetherness_is_a_share_of_the_fits_that_see_the_line():
    fits = fits_of(6)
    fits.depth[:3, 5] += 1.0
    fits.present[:2, 5] = False
    assert togetherness(fits, fits.depth, np.arange(6) < 5)[5] == pytest.approx(7 / 8)


def test_togetherness_is_measured_at_the_main_part_of_a_core():
    fits = fits_of(6)
    fits.depth[:, 1:3] += [0.6 * SAME_DEPTH, 1.2 * SAME_DEPTH]
    fits.group[:, 3:] = 1
    fits.depth[:, 3:] += 9.0
    share = togetherness(fits, fits.depth, np.array([True] * 5 + [False]))
    assert share.tolist() == [1.0] * 3 + [0.0] * 3


def test_a_small_core_is_none(build_links):
    assert bodies_of(build_links(LEAST_CORE, []), fits_of(LEAST_CORE)) == [0] * LEAST_CORE
    assert bodies_of(build_links(LEAST_CORE - 1, []), fits_of(LEAST_CORE - 1)) == [-1] * (LEAST_CORE - 1)


@pytest.mark.parametrize(("lines", "body"), [(LEAST_BODY, 1), (LEAST_BODY - 1, -1)])
def test_loose_lines_that_meet_are_a_body_if_they_are_enough(build_links, lines, body):
    chain = [(5 + at, 6 + at) for at in range(lines - 1)]
    assert bodies_of(build_links(5 + lines, chain), fits_of(5, lines)) == [0] * 5 + [body] * lines


def test_lines_hang_on_lines_that_hang_on_a_body(build_links):
    loose = HANGING_STEPS + 1
    chain = [(4 + at, 5 + at) for at in range(loose)]
    assert bodies_of(build_links(5 + loose, chain), fits_of(5, loose)) == [0] * (5 + HANGING_STEPS) + [-1]


def test_a_line_hangs_on_the_body_to_which_its_edges_are_heaviest(build_links):
    edges = [(0, 10), (1, 10), (5, 10)]
    for weight, body in ((3.0, 1), (1.5, 0)):
        graph = build_links(11, edges, weight=np.array([1.0, 1.0, weight]))
        assert bodies_of(graph, two_cores()) == [0] * 5 + [1] * 5 + [body]


@pytest.mark.parametrize(("off", "body"), [(0.9, 0), (-0.9, 0), (1.1, -1), (-1.1, -1)])
def test_lines_hang_by_edges_that_agree(build_links, off, body):
    graph = build_links(6, [(0, 5)], log_ratio=np.array([off * LEAST_TOLERANCE]))
    assert bodies_of(graph, fits_of(5, 1)) == [0] * 5 + [body]


def test_a_wide_tolerance_is_kept_to(build_links):
    graph = build_links(6, [(0, 5)], log_ratio=np.array([0.04]), tolerance=np.array([0.05]))
    assert bodies_of(graph, fits_of(5, 1)) == [0] * 6


def test_edges_that_say_nothing_about_depth_hold_nothing(build_links):
    graph = build_links(6, [(0, 5)], informative=np.array([False]))
    assert bodies_of(graph, fits_of(5, 1)) == [0] * 5 + [-1]


def test_a_graph_without_lines_has_no_bodies(build_links):
    graph = build_links(0, [], segments=build_links(1, []).segments.subset(np.zeros(0, int)))
    found = find_rigid_bodies(graph, np.zeros(0), Fits(*(np.zeros((TEN, 0), kind) for kind in (bool, float, int))))
    assert (found.count, found.body.tolist(), found.size.tolist()) == (0, [], [])


def test_sizes_leave_out_lines_of_no_body():
    assert RigidBodies(np.array([1, -1, 0, 1]), 3).size.tolist() == [1, 2, 0]
