"""The least moves of planes for as many conditions as may be, against every choice of conditions."""

from itertools import combinations

import numpy as np
import pytest
from scipy.optimize import linprog

from linecad.model import least_moves as module
from linecad.model.least_moves import EXACT, FARTHEST, PlaneOffsets, least_moves
from solver.least_squares import shortest_solution

DEPTH = 10.0


def planes_at(values, weight=100.0):
    values = np.asarray(values, np.float64)
    return PlaneOffsets(values, np.full(len(values), DEPTH), np.full(len(values), weight))


def drawn(seed, planes=5, conditions=6):
    """Planes near each other, and pairs of them that are to be one."""
    generator = np.random.default_rng(seed)
    rows = np.zeros((conditions, planes))
    for row in rows:
        row[generator.choice(planes, 2, replace=False)] = 1.0, -1.0
    return rows, planes_at(generator.normal(0, FARTHEST * DEPTH, planes))


def held(rows, planes, moves):
    return np.abs(rows @ (planes.value + moves)) <= EXACT * 2 * DEPTH


def most_at_once(rows, planes):
    """By trying every set, the largest first."""
    for count in range(len(rows), 0, -1):
        for chosen in combinations(range(len(rows)), count):
            own = rows[list(chosen)]
            bounds = (-FARTHEST * DEPTH, FARTHEST * DEPTH)
            if linprog(np.zeros(len(planes.value)), A_eq=own, b_eq=-own @ planes.value, bounds=bounds).success:
                return count
    return 0


def test_nearly_as_many_conditions_hold_as_any_choice_of_them_allows():
    best = found = 0
    for seed in range(60):
        rows, planes = drawn(seed)
        moves = least_moves(rows, planes, np.ones(len(rows), bool))
        assert np.abs(moves).max() <= FARTHEST * DEPTH * (1 + 1e-9)
        most = most_at_once(rows, planes)
        count = held(rows, planes, moves).sum()
        assert count <= most
        best, found = best + most, found + count
    assert found >= 0.97 * best, (found, best)


def test_conditions_that_hold_together_all_hold_by_the_least_moves():
    rows = np.array([[1.0, -1.0, 0.0], [0.0, 1.0, -1.0]])
    moves = least_moves(rows, planes_at([0.0, 0.01, 0.02]), np.ones(2, bool))
    np.testing.assert_allclose(moves, [0.01, 0.0, -0.01], atol=1e-12)


@pytest.mark.parametrize("firm", [0, 1])
def test_the_firm_one_of_two_that_contradict_each_other_holds(firm):
    rows = np.array([[1.0, -1.0, 0.0], [1.0, 0.0, -1.0]])
    planes = planes_at([0.0, 0.06, -0.06])
    moves = least_moves(rows, planes, np.arange(2) == firm)
    assert held(rows, planes, moves).tolist() == [firm == 0, firm == 1]


@pytest.mark.parametrize("often", [0, 1])
def test_conditions_that_are_asked_many_times_outweigh_others(often):
    both = np.array([[1.0, -1.0, 0.0], [1.0, 0.0, -1.0]])
    rows, planes = both[[1 - often] + 3 * [often]], planes_at([0.0, 0.06, -0.06])
    assert held(rows, planes, least_moves(rows, planes, np.ones(4, bool))).tolist() == [False, True, True, True]


@pytest.mark.parametrize("angle", [1e-5, 1e-3, 0.01, 0.03, 0.5])
def test_no_plane_moves_far_however_parallel_two_frames_are(angle):
    """Uprights in planes of level lines of two directions: rounding of the program is multiplied by 1 / sine."""
    for seed in range(40):
        generator = np.random.default_rng(seed)
        uprights, levels = generator.integers(2, 9, 2)
        rows = np.zeros((uprights * levels, 2 * uprights + levels))
        for number, row in enumerate(rows):
            upright, level = divmod(number, levels)
            along = angle * (level % 2)
            row[[2 * upright, 2 * upright + 1, 2 * uprights + level]] = np.cos(along), np.sin(along), -1.0
        planes = planes_at(generator.normal(0, FARTHEST * DEPTH, rows.shape[1]))
        moves = least_moves(rows, planes, np.ones(len(rows), bool))
        assert np.abs(moves).max() <= FARTHEST * DEPTH * (1 + 1e-8)
        assert held(rows, planes, moves).sum() >= held(rows, planes, np.zeros(len(moves))).sum()


def test_many_conditions_that_contradict_each_other_are_told_apart_in_few_steps(monkeypatch):
    """One by one, 2219 of 2420 conditions of a castle photo went in a minute and more."""
    steps = []
    monkeypatch.setattr(module, "shortest_solution", lambda *args: steps.append(1) or shortest_solution(*args))
    rows, planes = drawn(7, planes=40, conditions=300)
    moves = least_moves(rows, planes, np.ones(len(rows), bool))
    assert held(rows, planes, moves).sum() > 10
    assert len(steps) < 40


def test_no_conditions_move_nothing():
    assert least_moves(np.zeros((0, 2)), planes_at([1.0, 2.0]), np.zeros(0, bool)).tolist() == [0.0, 0.0]
