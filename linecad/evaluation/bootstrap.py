"""Shares over several photos, with intervals that say how much they hang on which photos were taken."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

DRAWS = 1000
SEED = 20181  # of the draws: the same photos give the same interval
COVERED = 0.95  # of the draws lie in the interval


@dataclass(frozen=True)
class Estimate:
    """A figure and its interval."""

    value: float
    low: float
    high: float
    photos: int  # that had something to say


def ratio_of_sums(numerators: Sequence[float], denominators: Sequence[float]) -> Estimate | None:
    """sum of numerators / sum of denominators over photos, with a bootstrap interval over photos.

    Photos whose denominator is 0 have nothing to say; None when no photo has. A draw in which all denominators are 0
    cannot occur then.
    """
    above, below = np.array(numerators, np.float64), np.array(denominators, np.float64)
    defined = below > 0
    above, below = above[defined], below[defined]
    if len(below) == 0:
        return None
    drawn = np.random.default_rng(SEED).integers(0, len(below), (DRAWS, len(below)))
    ratios = above[drawn].sum(axis=1) / below[drawn].sum(axis=1)
    low, high = np.quantile(ratios, [(1 - COVERED) / 2, (1 + COVERED) / 2])
    return Estimate(float(above.sum() / below.sum()), float(low), float(high), len(below))


def mean(values: Sequence[float | None]) -> Estimate | None:
    """The mean of the values that there are, with its interval."""
    known = [value for value in values if value is not None]
    return ratio_of_sums(known, [1.0] * len(known))


def exact(value: float) -> Estimate:
    """A figure that does not hang on which photos were taken, such as that of one photo: its interval has no width."""
    return Estimate(value, value, value, 1)
