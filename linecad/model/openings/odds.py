"""Log-odds that a rectangle of a wall is an opening: sums of weighted evidence.

Fitted by logistic regression to the rectangles of made scenes, an overlap of 0.72 (by itself) or 0.66 (beside the
others) with a true opening counting as one, below 0.6 or 0.53 as none: tests/benchmarks/openings.py.
"""

import numpy as np

from linecad.arrays import Float

# By itself, in the order of `evidence.NAMES`.
FIRST_AT_ONCE = -4.4913
FIRST_LOG_ODDS: dict[str, float] = {
    "uprights": 0.7231,
    "weaker upright": 1.1906,
    "weaker level": 1.1904,
    "levels": 1.9985,
    "beyond uprights": -6.6573,
    "beyond levels": -4.5786,
    "contrast": 0.8858,
    "darker": -0.1466,
    "rough inside": 0.3931,
    "rough around": -1.4830,
    "weakest step": -0.1845,
    "steps": 0.0295,
    "edges inside": 7.3296,
    "edges around": -3.9038,
    "slender": -1.7639,
    "flat": -8.3048,
    "plain": 6.1765,
    "open": 0.0000,
}
# Beside the others: in the order of `evidence.NAMES`, then of `neighbours.NAMES`.
AT_ONCE = 0.9034
LOG_ODDS: dict[str, float] = {
    "uprights": 0.2621,
    "weaker upright": 0.6101,
    "weaker level": 1.8040,
    "levels": 0.1613,
    "beyond uprights": -4.8551,
    "beyond levels": -3.2309,
    "contrast": 0.7121,
    "darker": 0.0793,
    "rough inside": 0.4629,
    "rough around": -1.1685,
    "weakest step": 0.3728,
    "steps": -0.9806,
    "edges inside": 2.1577,
    "edges around": -4.3360,
    "slender": -1.5323,
    "flat": -7.0703,
    "plain": -5.2460,
    "open": -1.7389,
    "row, apart": 1.4753,
    "row, close": 0.8116,
    "row, tight": -5.4700,
    "column, apart": 2.0280,
    "column, close": 0.1624,
    "column, tight": -11.2381,
    "likeliest around": 0.1621,
    "likeliest inside": 0.0650,
    "panes inside": -2.3292,
    "others inside": -1.7996,
    "around": -3.3427,
    "across": -1.9991,
    "covered by panes": 1.9094,
    "covered by others": 0.6566,
}
LEAST_ODDS = -0.3  # of an opening; F1 hardly changes from -0.9 to 0.2
LEAST_FILLED = -1.5  # of one that fills a gap between openings that were taken


def first_odds(evidence: Float) -> Float:
    """Log-odds (N,) by the evidence (N, F) of each rectangle alone."""
    odds: Float = FIRST_AT_ONCE + evidence @ np.array(list(FIRST_LOG_ODDS.values()))
    return odds


def odds(evidence: Float, beside: Float) -> Float:
    """Log-odds (N,) by the evidence (N, F) of each rectangle and how it lies to the others (N, G)."""
    found: Float = AT_ONCE + np.column_stack([evidence, beside]) @ np.array(list(LOG_ODDS.values()))
    return found
