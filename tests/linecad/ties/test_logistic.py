"""What tests/benchmarks/logistic.py fits, where the answer is known otherwise."""

import numpy as np
import pytest
from logistic import Logistic, fit
from scipy.optimize import minimize


@pytest.fixture(scope="module")
def rows():
    """Features of unlike spread, and which rows are right, by a regression of known slopes."""
    random = np.random.default_rng(7)
    features = random.normal((0.0, 2.0, -1.0), (1.0, 0.1, 5.0), (400, 3))
    chance = Logistic(-11.2, np.array([1.0, 5.0, -0.2])).probability(features)
    return features, (random.random(400) < chance).astype(float)


def loss(at, features, right, ridge, near):
    """The negative log likelihood with its ridge, as it is defined."""
    log_odds = at[-1] + features @ at[:-1]
    spread = features.std(axis=0)
    return np.sum(np.log1p(np.exp(log_odds)) - right * log_odds) + ridge / 2 * np.sum(((at[:-1] - near) * spread) ** 2)


@pytest.mark.parametrize("near", [None, (2.0, -3.0, 0.1)])
@pytest.mark.parametrize("ridge", [0.01, 3.0, 100.0])
def test_a_fit_is_the_least_of_its_loss(rows, ridge, near):
    found = fit(*rows, ridge, near=None if near is None else Logistic(0.7, np.array(near)))
    about = np.zeros(3) if near is None else np.array(near)
    least = minimize(loss, np.zeros(4), (*rows, ridge, about), method="L-BFGS-B", options={"ftol": 1e-14, "gtol": 1e-8})
    assert found.slope == pytest.approx(least.x[:-1], rel=1e-3, abs=1e-3)
    assert found.at_once == pytest.approx(least.x[-1], rel=1e-3, abs=3e-3)


def test_a_strong_ridge_keeps_the_slopes_that_it_is_near(rows):
    near = Logistic(0.7, np.array([2.0, -3.0, 0.1]))
    assert fit(*rows, 1e9, near=near).slope == pytest.approx(near.slope, rel=1e-4)
    assert fit(*rows, 1e9).slope == pytest.approx(np.zeros(3), abs=1e-4)
