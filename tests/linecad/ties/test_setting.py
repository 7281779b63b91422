"""Bodies as every kind of evidence sees them: their lines, how far apart they are seen, how the fits moved them."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from linecad.decide.stability import SAME_DEPTH, Fits
from linecad.line_graph import Segments
from linecad.ties.bodies import RigidBodies
from linecad.ties.setting import LEAST_SEEN, STEPS, Setting, Sight, densest_groups, sample

BODY = np.array([0, 1, 1, -1, 0, 0, 1])
FITS = 10


@pytest.fixture
def looked_at(build_links):
    """Two bodies of three lines each in ten fits that connect all and move nothing."""
    fits = Fits(np.ones((FITS, 7), bool), np.zeros((FITS, 7)), np.zeros((FITS, 7), np.int64))
    return Setting(build_links(7, []), np.zeros(7), RigidBodies(BODY, 2), fits, Sight(np.eye(3), np.eye(3), 3840, None))


def test_each_body_knows_its_lines(looked_at):
    assert [lines.tolist() for lines in looked_at.lines] == [[0, 4, 5], [1, 2, 6]]
    assert [len(points) for points in looked_at.points] == [3 * STEPS] * 2


def test_points_lie_evenly_from_end_to_end():
    points = sample(np.array([[[0.0, 0.0], [6.0, 12.0]], [[1.0, 1.0], [1.0, 1.0]]]))
    assert points.tolist() == [[at, 2.0 * at] for at in range(7)] + [[1.0, 1.0]] * 7


@pytest.mark.parametrize("width", [3840, 1920])
def test_distances_are_px_at_the_reference_width(looked_at, width):
    ends = np.array([[[0.0, 100.0 * line], [90.0, 100.0 * line]] for line in range(7)])
    ends[5] = [[120.0, 230.0], [210.0, 230.0]]  # next to lines 2 and 3, of which 3 is of no body
    graph = replace(looked_at.graph, segments=Segments(ends, np.zeros(7, int)))
    seen = replace(looked_at, graph=graph, sight=replace(looked_at.sight, width=width))
    expected = np.hypot(30.0, 30.0) * 3840 / width
    assert seen.distance(0, 1) == seen.distance(1, 0) == pytest.approx(expected)


def test_support_is_the_share_of_fits_at_a_ratio(looked_at):
    looked_at.fits.depth[:6, looked_at.lines[0]] += 0.5
    looked_at.fits.group[:2, looked_at.lines[1]] = 1
    assert looked_at.support(0, 1, 0.5) == (0.4, 0.8)
    assert looked_at.support(1, 0, -0.5) == (0.4, 0.8)
    assert looked_at.support(0, 1, -0.5) == (0.0, 0.8)
    assert looked_at.support(0, 1, 0.0) == (0.4, 0.8)


@pytest.mark.parametrize(("by", "share"), [(0.9, 1.0), (1.1, 0.0)])
def test_support_is_within_a_tolerance(looked_at, by, share):
    assert looked_at.support(0, 1, by * SAME_DEPTH) == looked_at.support(0, 1, -by * SAME_DEPTH) == (share, 1.0)


def test_depths_are_meant_relative_to_the_fit_to_all_lines(looked_at):
    depth = np.arange(7.0)
    looked_at.fits.depth[:] = depth
    assert replace(looked_at, log_depth=depth).support(0, 1, 0.0) == (1.0, 1.0)


def test_fits_that_see_too_little_of_a_body_do_not_count(looked_at):
    looked_at.fits.present[:4, 6] = False
    looked_at.fits.group[:5, looked_at.lines[1]] = 1
    assert LEAST_SEEN == 3
    assert looked_at.support(0, 1, 0.0) == (pytest.approx(5 / 6), pytest.approx(5 / 6))


def test_a_body_moves_as_its_main_part(looked_at):
    looked_at.fits.group[:, 6] = 1
    looked_at.fits.depth[:, [1, 2, 6]] = [0.0, 0.02, 9.0]  # by 0.01; with the stray line it were 0.02
    assert looked_at.support(0, 1, 0.004) == (1.0, 1.0)


def test_bodies_that_no_fit_sees_have_no_support(looked_at):
    looked_at.fits.present[:, 6] = False
    assert looked_at.support(0, 1, 0.0) == (0.0, 0.0)


def test_groups_come_heaviest_first_with_their_weighted_mean():
    values, weight = np.array([1.0, 5.0, 1.01, 5.015, 9.0]), np.array([1.0, 1.0, 1.0, 3.0, 1.5])
    found = densest_groups(values, weight, 0.01, 2)
    assert [(pytest.approx(middle), sorted(which)) for middle, which in found] == [
        (5.01125, [1, 3]),
        (1.005, [0, 2]),
    ]
    assert [which.tolist() for _, which in densest_groups(values, weight, 0.01, 9)][2:] == [[4]]


def test_no_values_make_no_group():
    assert densest_groups(np.zeros(0), np.zeros(0), 0.1, 3) == []


@given(st.lists(st.tuples(st.floats(-1, 1), st.floats(0.5, 3)), min_size=1, max_size=12), st.floats(0.01, 0.2))
def test_groups_are_narrow_apart_and_the_first_is_the_heaviest(rows, width):
    values, weight = np.array(rows).T
    found = densest_groups(values, weight, width, 20)
    for _, which in found:
        assert np.ptp(values[which]) <= 2 * width + 1e-12
    middles = np.sort([middle for middle, _ in found])
    assert (np.diff(middles) > 2 * width - 1e-12).all()
    heaviest = max(weight[(values >= low) & (values <= low + 2 * width)].sum() for low in values)
    assert weight[found[0][1]].sum() == pytest.approx(heaviest)
    taken = np.concatenate([which for _, which in found])
    assert len(taken) == len(set(taken.tolist()))
