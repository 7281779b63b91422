"""How sure the place of each line is: the probability that its depth relative to component 0 is right within 5 %."""

import numpy as np

from linecad.arrays import Float
from linecad.ties.bodies import togetherness
from linecad.ties.setting import Setting
from solver.bodies.ties import Placement

LARGEST_MARGIN = 12.0
# Logistic regression on lines of known depth, by tests/benchmarks/ties.py (docs/results/ties.md).
AT_ONCE = 0.0
LOG_ODDS: dict[str, float] = {}


def features(setting: Setting, placement: Placement, reference: int) -> dict[str, Float]:
    """What speaks for the place of each line, each (N,); lines of no body have 0 everywhere."""
    body = setting.bodies.body
    own = body >= 0
    at = np.maximum(body, 0)
    shift = setting.fits.depth - setting.log_depth
    together = np.zeros(len(body))
    for number, lines in enumerate(setting.lines):
        core = body == number
        together[lines] = togetherness(setting.fits, shift, core)[lines]
    margin = np.minimum(placement.margin, LARGEST_MARGIN)
    size = setting.bodies.size
    found = {
        "of the reference": (body == reference).astype(np.float64),
        "margin": margin[at],
        "root of margin": np.sqrt(margin)[at],
        "lines of the body": np.log(size)[at],
        "share of the reference": np.full(len(body), size[reference] / max(1, own.sum())),
        "together": together,
        "weight of the line": np.log1p(np.bincount(setting.graph.edges.ravel(), minlength=len(body)).astype(float)),
    }
    return {name: np.where(own, value, 0.0) for name, value in found.items()}


def probabilities(setting: Setting, placement: Placement, reference: int) -> Float:
    """(N,) from 0 to 1; 0 for lines of no body."""
    known = features(setting, placement, reference)
    log_odds = AT_ONCE + sum((LOG_ODDS.get(name, 0.0) * value for name, value in known.items()), np.zeros(len(setting.log_depth)))
    return np.where(setting.bodies.body >= 0, 1 / (1 + np.exp(-log_odds)), 0.0)
