"""Log-odds that a rectangle of a wall is an opening: sums of weighted evidence.

The weights are fitted by logistic regression to the rectangles of 20 made scenes: an overlap of 0.72 (at first) or 0.66
(in the end) with a true opening counts as one, below 0.6 or 0.53 as none. Fitted to every other scene they are alike.
"""

import numpy as np

from linecad.arrays import Float
from linecad.model.openings.evidence import NAMES

# Evidence: its weight at first, and in the end, when rows and columns are known.
WEIGHTS = {
    "one": (-7.79, -1.59),
    "uprights": (1.45, 0.39),
    "weaker upright": (1.22, 0.08),
    "weaker level": (1.61, 0.33),
    "levels": (1.96, 0.88),
    "beyond uprights": (-4.96, -4.25),
    "beyond levels": (-3.80, -3.04),
    "contrast": (0.65, 0.49),
    "darker": (0.10, 0.11),
    "rough inside": (0.03, 0.26),
    "rough around": (-1.16, -1.07),
    "weakest step": (-0.38, 0.08),
    "steps": (0.57, -0.15),
    "edges inside": (8.48, 5.65),
    "edges around": (-2.77, -5.85),
    "slender": (-0.91, -1.29),
    "flat": (-2.80, -5.77),
    "plain": (0.00, -5.30),
    "open": (0.00, -0.69),
}
ROW, COLUMN = 1.40, 2.31  # the weights of the support by row and column
LEAST_ODDS = -0.5  # of an opening; the best F1 in either half of these scenes, fitted to the other
LEAST_FILLED = -1.5  # of one that fills a gap between openings that were taken


def first_odds(evidence: Float) -> Float:
    """Log-odds (N,) by the evidence (N, F) of each rectangle alone."""
    odds: Float = evidence @ _weights(0)
    return odds


def odds(evidence: Float, support: Float) -> Float:
    """Log-odds (N,) by the evidence (N, F) and the support (N, 2) by row and column."""
    found: Float = evidence @ _weights(1) + support @ np.array([ROW, COLUMN])
    return found


def _weights(stage: int) -> Float:
    return np.array([WEIGHTS[name][stage] for name in NAMES])
