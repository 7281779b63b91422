"""Least squares of rows that leave some unknowns free."""

import numpy as np
import scipy.linalg
from hypothesis import given
from hypothesis import strategies as st

from solver.least_squares import shortest_solution


@given(st.integers(0, 2**32 - 1), st.integers(1, 12), st.integers(1, 30), st.integers(0, 12))
def test_the_shortest_of_all_best_solutions_is_found(seed, unknowns, count, rank):
    generator = np.random.default_rng(seed)
    few = generator.normal(size=(count, min(rank, unknowns)))
    rows = few @ generator.normal(size=(min(rank, unknowns), unknowns))
    right = generator.normal(size=count)

    found = shortest_solution(rows, right)

    missed = rows @ found - right
    assert np.allclose(rows.T @ missed, 0, atol=1e-8 * (1 + np.abs(rows).max()))  # nothing is nearer
    beside = np.eye(unknowns) - np.linalg.pinv(rows, rcond=1e-10) @ rows
    assert np.allclose(beside @ found, 0, atol=1e-6 * (1 + np.abs(found).max()))  # nothing in it that rows leave free


def test_the_solution_is_factorised_and_not_iterated(monkeypatch):
    """LAPACK's gelsd gave up on rows of a photo, 1312 of rank 254, with numbers of usual size."""
    drivers = []

    def spied(*args, lapack_driver, **rest):
        drivers.append(lapack_driver)
        return lstsq(*args, lapack_driver=lapack_driver, **rest)

    lstsq = scipy.linalg.lstsq
    monkeypatch.setattr(scipy.linalg, "lstsq", spied)
    rows = np.array([[0.6, 0.8, -1.0], [0.6, 0.8, -1.0]])
    assert np.allclose(shortest_solution(rows, np.array([1.0, 3.0])), [0.6, 0.8, -1.0])
    assert drivers == ["gelsy"]
