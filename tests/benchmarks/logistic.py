"""Logistic regression with a ridge, and how good its probabilities are: what the fits of other scripts share."""

from dataclasses import dataclass

import numpy as np

from linecad.arrays import Bool, Float

STEPS = 25  # of Newton's method
STEPS_IF_HELD = 60  # of expectation and maximisation
LEAST = 1e-9  # probability, for logarithms; spread of a feature that is the same everywhere


@dataclass(frozen=True, eq=False)
class Logistic:
    """Log-odds = at_once + features @ slope."""

    at_once: float
    slope: Float  # (F,) for each unit of a feature

    def probability(self, features: Float) -> Float:
        """(M,) for features (M, F)."""
        return 1 / (1 + np.exp(-(self.at_once + features @ self.slope)))


def fit(
    features: Float,
    right: Float,
    ridge: float,
    weight: Float | None = None,
    used: Bool | None = None,
    held: Float | None = None,
    near: Logistic | None = None,
) -> Logistic:
    """The regression of `right` (M,) on features (M, F); the ridge is on features in units of their spread.

    The ridge draws slopes to 0, or to those of another regression that they shall stay `near`. Features that are
    not `used` (F,) get no slope. Where what is right needs something else too, which is so with the probability
    `held` (M,), the probability that a row is right is that of the regression times `held`.
    """
    weight = np.ones(len(right)) if weight is None else weight
    spread = features.std(axis=0) + LEAST
    middle = features.mean(axis=0)
    rows = np.column_stack([(features - middle) / spread, np.ones(len(right))])
    known = np.r_[np.ones(features.shape[1], bool) if used is None else used, True]
    rows = rows[:, known]
    held_back = np.diag(np.r_[np.full(rows.shape[1] - 1, ridge), 0.0])
    before = np.zeros(rows.shape[1])
    if near is not None:
        before[:-1] = (near.slope * spread)[known[:-1]]
    found = np.zeros(rows.shape[1])
    for _ in range(STEPS if held is None else STEPS_IF_HELD):
        p = 1 / (1 + np.exp(-rows @ found))
        # What is not right may be so for the other reason alone: expectation, then a step of maximisation.
        expected = right if held is None else np.where(right > 0, 1.0, p * (1 - held) / np.maximum(1 - p * held, LEAST))
        curvature = (rows.T * (weight * p * (1 - p))) @ rows + held_back
        found = found + np.linalg.solve(curvature, rows.T @ (weight * (expected - p)) - held_back @ (found - before))
    slope = np.zeros(features.shape[1])
    slope[known[:-1]] = found[:-1] / spread[known[:-1]]
    return Logistic(float(found[-1] - slope @ middle), slope)


def area_under_curve(right: Float, probability: Float) -> float:
    """Of the receiver operating characteristic; NaN where all are right or none is."""
    rank = np.empty(len(right))
    rank[np.argsort(probability, kind="stable")] = np.arange(1, len(right) + 1)
    many, few = float(right.sum()), float((1 - right).sum())
    return (rank[right > 0].sum() - many * (many + 1) / 2) / (many * few) if many and few else float("nan")


def log_loss(right: Float, probability: Float, weight: Float | None = None) -> float:
    """Mean, in nats."""
    p = np.clip(probability, LEAST, 1 - LEAST)
    return float(-np.average(np.where(right > 0, np.log(p), np.log(1 - p)), weights=weight))


def tenths(right: Float, probability: Float, weight: Float | None = None) -> list[tuple[float, float, int] | None]:
    """For each tenth of probability what was predicted, the share that is right, and how many; None: no row."""
    weight = np.ones(len(right)) if weight is None else weight
    tenth = np.minimum((probability * 10).astype(np.int64), 9)
    found: list[tuple[float, float, int] | None] = []
    for number in range(10):
        own = tenth == number
        found.append(
            (float(np.average(probability[own], weights=weight[own])),
             float(np.average(right[own], weights=weight[own])), int(own.sum()))
            if own.any() else None
        )  # fmt: skip
    return found
