"""How sure the place of each line is: the probability that its depth relative to component 0 is right within 5 %."""

import numpy as np

from linecad.arrays import Float
from linecad.decide.stability import LEAST_TOLERANCE
from linecad.ties.bodies import togetherness
from linecad.ties.setting import Setting
from solver.bodies.ties import Placement

LARGEST_MARGIN = 12.0
# Logistic regression on lines of known depth, by tests/benchmarks/ties.py (docs/results/ties.md).
AT_ONCE = -7.3537
LOG_ODDS: dict[str, float] = {
    "of the reference": 1.8709,
    "margin": -0.1237,
    "root of margin": 1.0562,
    "lines of the body": -0.0418,
    "share of the reference": 2.9845,
    "together": 2.4843,
    "agreement of all": -0.8356,
    "agreement of the line": 1.6449,
    "bodies": 0.5871,
}


def features(setting: Setting, placement: Placement, reference: int, log_depth: Float) -> dict[str, Float]:
    """What speaks for the place of each line at the depths (N,) that were found, each (N,); 0 for lines of no body."""
    graph = setting.graph
    agrees = graph.misfit(log_depth) <= np.maximum(graph.tolerance, LEAST_TOLERANCE)
    told, first, second = graph.informative, *graph.edges.T
    many = np.bincount(np.r_[first[told], second[told]], minlength=len(log_depth))
    agreeing = np.bincount(np.r_[first[told & agrees], second[told & agrees]], minlength=len(log_depth))
    body = setting.bodies.body
    own = body >= 0
    at = np.maximum(body, 0)
    shift = setting.fits.depth - setting.log_depth
    together = np.zeros(len(body))
    for number, lines in enumerate(setting.lines):
        core = body == number
        together[lines] = togetherness(setting.fits, shift, core)[lines]
    margin = np.minimum(placement.margin, LARGEST_MARGIN)
    size = np.bincount(body[own], minlength=len(margin))  # a photo without bodies has one place all the same
    found = {
        "of the reference": (body == reference).astype(np.float64),
        "margin": margin[at],
        "root of margin": np.sqrt(margin)[at],
        "lines of the body": np.log(np.maximum(size, 1))[at],
        "share of the reference": np.full(len(body), size[reference] / max(1, own.sum())),
        "together": together,
        "agreement of all": np.full(len(body), agreeing.sum() / max(1, many.sum())),
        "agreement of the line": (agreeing + 1) / (many + 2),
        "bodies": np.full(len(body), np.log(setting.bodies.count + 1)),
    }
    return {name: np.where(own, value, 0.0) for name, value in found.items()}


def probabilities(setting: Setting, placement: Placement, reference: int, log_depth: Float) -> Float:
    """(N,) from 0 to 1; 0 for lines of no body."""
    known = features(setting, placement, reference, log_depth)
    log_odds = AT_ONCE + sum(
        (LOG_ODDS[name] * value for name, value in known.items()), np.zeros(len(setting.log_depth))
    )
    return np.where(setting.bodies.body >= 0, 1 / (1 + np.exp(-log_odds)), 0.0)
