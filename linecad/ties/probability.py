"""How sure the place of each line is: the probability that its depth relative to component 0 is right within 5 %."""

import numpy as np

from linecad.arrays import Float
from linecad.decide.stability import LEAST_TOLERANCE
from linecad.ties.bodies import togetherness
from linecad.ties.depth_ties import MapPlaces
from linecad.ties.setting import Setting
from solver.bodies.ties import Placement

LARGEST_MARGIN = 12.0
FARTHEST_OFF = 6.0  # widths
# Logistic regression on lines of known depth, by tests/benchmarks/probability.py (docs/results/ties.md).
AT_ONCE = -4.8570
LOG_ODDS: dict[str, float] = {
    "of the reference": 2.4394,
    "margin": -0.3206,
    "root of margin": 2.1794,
    "lines of the body": -0.0979,
    "share of the reference": 3.9925,
    "together": 0.8203,
    "agreement of all": -3.3440,
    "agreement of the line": 2.3376,
    "bodies": 0.5692,
}
# The same where a depth map was heard.
WITH_MAP_AT_ONCE = -5.9709
WITH_MAP_LOG_ODDS: dict[str, float] = {
    "of the reference": 1.8917,
    "margin": -0.0916,
    "root of margin": 0.9285,
    "lines of the body": 0.0221,
    "share of the reference": 2.9980,
    "together": 0.8031,
    "agreement of all": -0.1727,
    "agreement of the line": 2.6143,
    "bodies": 0.5292,
    "map's word": 0.0754,
    "off the map": -0.2288,
}


def features(
    setting: Setting, placement: Placement, reference: int, log_depth: Float, mapped: MapPlaces | None = None
) -> dict[str, Float]:
    """What speaks for the place of each line at the depths (N,) that were found, each (N,); 0 for lines of no body.

    `mapped` is what a depth map made of the places, where one was heard.
    """
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
    if mapped is not None:
        word, off_map = _by_the_map(mapped, len(margin))
        found |= {"map's word": word[at], "off the map": off_map[at]}
    return {name: np.where(own, value, 0.0) for name, value in found.items()}


def _by_the_map(mapped: MapPlaces, count: int) -> tuple[Float, Float]:
    """What the map's word is worth about each of `count` bodies, and how many widths they are off it; 0 without one."""
    off = np.minimum(np.abs(mapped.misfit) / mapped.width, FARTHEST_OFF)
    off = np.concatenate([off, np.full(count - len(off), np.nan)])
    told = np.isfinite(off)
    return np.where(told, mapped.worth, 0.0), np.where(told, off, 0.0)


def probabilities(
    setting: Setting,
    placement: Placement,
    reference: int,
    log_depth: Float,
    held: Float,
    mapped: MapPlaces | None = None,
) -> Float:
    """(N,) from 0 to 1; 0 for lines of no body. `mapped` as for `features`.

    A line is right where its body stands where it should, and where it is `held` (N,) in its body: the probability that
    it is (`linecad.ties.seams`).
    """
    known = features(setting, placement, reference, log_depth, mapped)
    at_once, slopes = (AT_ONCE, LOG_ODDS) if mapped is None else (WITH_MAP_AT_ONCE, WITH_MAP_LOG_ODDS)
    log_odds = at_once + sum((slopes[name] * value for name, value in known.items()), np.zeros(len(setting.log_depth)))
    return np.where(setting.bodies.body >= 0, held / (1 + np.exp(-log_odds)), 0.0)
