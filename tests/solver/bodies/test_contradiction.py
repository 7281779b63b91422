"""Which ratios contradict each other, against linear programs on drawn cases."""

import numpy as np
import pytest
from scipy.optimize import linprog

from solver.bodies.contradiction import find_contradiction

DRAWN = 120


def fits(bodies, log_ratio, tolerance, count):
    """Whether scales exist that keep every ratio, by a linear program."""
    rows = np.zeros((len(bodies), count))
    rows[np.arange(len(bodies)), bodies[:, 0]] = 1.0
    rows[np.arange(len(bodies)), bodies[:, 1]] -= 1.0
    upper = np.r_[log_ratio + tolerance, tolerance - log_ratio]
    found = linprog(np.zeros(count), np.r_[rows, -rows], upper, bounds=[(None, None)] * count)
    return found.status == 0


def drawn(seed):
    random = np.random.default_rng(seed)
    count, ties = int(random.integers(2, 6)), int(random.integers(1, 9))
    bodies = np.array([random.choice(count, 2, replace=False) for _ in range(ties)])
    true = random.normal(0, 1, count)
    log_ratio = true[bodies[:, 0]] - true[bodies[:, 1]] + random.choice([0.0, 0.0, 0.05, 0.3], ties)
    return bodies, log_ratio, random.uniform(0.01, 0.1, ties), count


@pytest.mark.parametrize("seed", range(DRAWN))
def test_it_is_found_where_no_scales_fit_and_none_of_it_can_be_left_out(seed):
    bodies, log_ratio, tolerance, count = drawn(seed)
    found = sorted(find_contradiction(bodies, log_ratio, tolerance, count))
    assert bool(found) != fits(bodies, log_ratio, tolerance, count)
    if not found:
        return
    assert not fits(bodies[found], log_ratio[found], tolerance[found], count)
    for left_out in found:
        rest = [tie for tie in found if tie != left_out]
        assert fits(bodies[rest], log_ratio[rest], tolerance[rest], count)


def test_both_answers_are_drawn():
    answers = {fits(*drawn(seed)) for seed in range(DRAWN)}
    assert answers == {True, False}


def test_nothing_contradicts_nothing():
    assert find_contradiction(np.zeros((0, 2), int), np.zeros(0), np.zeros(0), 3) == frozenset()


def test_rounding_is_no_contradiction():
    bodies, third = np.array([[0, 1], [1, 2], [0, 2]]), 0.1
    total = third + third
    exact = np.array([third, third, np.nextafter(total, 1)])
    assert find_contradiction(bodies, exact, np.full(3, 1e-12), 3) == frozenset()
