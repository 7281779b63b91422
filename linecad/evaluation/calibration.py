"""How far the probabilities of lines hold: tenths of stated probability, and what is left at a confidence.

Each surveyed point has the probability of the line that gives it its depth.
"""

from dataclasses import dataclass

import numpy as np

from linecad.arrays import Bool, Float

TENTHS = np.arange(1, 10) / 10  # the bounds between the ten


@dataclass(frozen=True)
class Tenth:
    """The points whose stated probability lies in one tenth; sums, so that photos can be added."""

    points: int
    stated: float  # sum of their probabilities
    right: int


@dataclass(frozen=True)
class ConfidenceScore:
    """What probabilities are worth when lines are taken from the surest on; shares from 0 to 1."""

    recall_area: float  # under recall over confidence: the mean recall over all confidences from 0 to 1
    precision_area: float  # under precision over recall: probabilities count by their order alone
    sure_recall: float  # of the points stated at SURE or above
    sure_precision: float | None  # None where no point is stated so


SURE = 0.9


def find_tenths(stated: Float, right: Bool) -> tuple[Tenth, ...]:
    """The ten tenths of points with stated probabilities (P,), of which `right` (P,) tells the truth.

    A probability on the bound of two tenths is in the upper one; 1 is in the last.
    """
    tenth = np.digitize(stated, TENTHS)
    members = [tenth == number for number in range(10)]
    return tuple(Tenth(int(own.sum()), float(stated[own].sum()), int(right[own].sum())) for own in members)


def score_confidence(stated: Float, right: Bool, points: int) -> ConfidenceScore:
    """Score the probabilities (P,) of the points with a depth, `right` (P,) or not, of all surveyed `points`."""
    sure = stated >= SURE
    return ConfidenceScore(
        # A point that is right counts for the recall at every confidence up to its own.
        recall_area=float(stated[right].sum()) / points,
        precision_area=_precision_area(stated, right, points),
        sure_recall=int(right[sure].sum()) / points,
        sure_precision=float(right[sure].mean()) if sure.any() else None,
    )


def _precision_area(stated: Float, right: Bool, points: int) -> float:
    """Sum over the steps of recall of the precision after each, points of one probability being one step."""
    order = np.argsort(-stated, kind="stable")
    last = np.append(np.diff(stated[order]) != 0, True)[: len(order)]  # the last point of each step
    rights = np.cumsum(right[order])[last]
    taken = np.arange(1, len(order) + 1)[last]
    return float((np.diff(rights, prepend=0) * rights / taken).sum()) / points
