"""How sure the place of each line is: the probability that its depth relative to component 0 is right within 5 %.

Bodies may stand wrong to each other (`linecad.ties.links`), and the sides of a seam too (`linecad.ties.seams`). The
scale of component 0 is that of most of its lines, so that a reference body which is wrong itself does not make all
others wrong. How often each piece stands where most of component 0 does is counted over draws of all these. A line is
right where its piece is and where it is right in its piece.
"""

import numpy as np

from linecad.arrays import Bool, Float
from linecad.decide.stability import LEAST_TOLERANCE
from linecad.geometry import lengths
from linecad.graph.connectivity import components
from linecad.ties.bodies import togetherness
from linecad.ties.links import Link
from linecad.ties.pieces import Pieces
from linecad.ties.seams import Seam
from linecad.ties.setting import Setting

DRAWS = 1000
SEED = 0
RIGHT = 0.05  # log scale
OFF = (0.06, 1.0)  # log scale, by which what does not hold is off, to either side
LEAST_WEIGHT = 0.1  # log-odds of one crossing that agrees and one that does not, for lines with hardly any
LEAST_PIECES = 12  # of a photo that are counted; nine of ten that were fitted to have more
# Logistic regression on lines of known depth, by tests/benchmarks/probability.py (docs/results/ties.md).
AT_ONCE = -5.8208
LOG_ODDS: dict[str, float] = {
    "together": 2.3900,
    "agreement": 3.7965,
    "pieces": 0.8486,
}


def line_features(setting: Setting, log_depth: Float, pieces: Pieces) -> dict[str, Float]:
    """What speaks for the place of each line in its piece, at the depths (N,) that were found, each (N,).

    Of a photo in which more was found, more of what is stated is true.
    """
    graph, count = setting.graph, len(log_depth)
    told = graph.informative
    agrees = told & (graph.misfit(log_depth) <= np.maximum(graph.tolerance, LEAST_TOLERANCE))

    def sums(chosen: Bool, weight: Float | None = None) -> Float:
        ends = graph.edges[chosen].T.ravel()
        return np.bincount(ends, None if weight is None else np.tile(weight[chosen], 2), count).astype(np.float64)

    shift = setting.fits.depth - setting.log_depth
    together = np.zeros(count)
    for number, lines in enumerate(setting.lines):
        together[lines] = togetherness(setting.fits, shift, setting.bodies.body == number)[lines]
    return {
        "together": together,
        "agreement": (sums(agrees, graph.weight) + LEAST_WEIGHT) / (sums(told, graph.weight) + 2 * LEAST_WEIGHT),
        "pieces": np.full(count, np.log1p(max(pieces.count, LEAST_PIECES))),
    }


def main_lines(setting: Setting, connected: Bool) -> Bool:
    """(N,) the lines of bodies in the component of `connected` crossings (E,) that most of the photo shows."""
    length = lengths(np.diff(setting.graph.segments.ends, axis=1)[:, 0]) * (setting.bodies.body >= 0)
    parts = components(setting.graph, connected & setting.graph.informative)
    main = np.zeros(len(length), bool)
    if parts:
        main[max(parts, key=lambda part: float(length[part].sum()))] = True
    return main & (setting.bodies.body >= 0)


def chances(pieces: Pieces, seams: list[Seam], links: list[Link], length: Float) -> Float:
    """(Q,) how likely each piece stands where most of component 0 does.

    `length` (N,) is that of its lines, 0 for all others. Links are those of `find_links`, outwards from the reference.
    """
    if pieces.count == 0:
        return np.zeros(0)
    random = np.random.default_rng(SEED)
    within: Float = np.zeros((DRAWS, pieces.count))  # of each piece in its body
    for seam in seams:
        within[:, pieces.of(seam.smaller)] += _off(random, seam.probability)[:, None]
    place: Float = np.zeros((DRAWS, int(pieces.body.max()) + 1))
    for link in links:
        tied_to = place[:, link.to] + within[:, link.other]
        place[:, link.body] = tied_to + _off(random, link.probability) - within[:, link.piece]
    at: Float = place[:, pieces.body] + within
    own = pieces.piece >= 0
    weight = np.bincount(pieces.piece[own], length[own], pieces.count).astype(np.float64)
    off: Float = np.abs(at - _medians(at, weight)[:, None])
    near: Float = (off < RIGHT).mean(axis=0)
    return near


def _off(random: np.random.Generator, probability: float) -> Float:
    """(DRAWS,) by how much two sides are off each other: 0 with a probability."""
    fails = random.random(DRAWS) >= probability
    return np.where(fails, random.choice([-1.0, 1.0], DRAWS) * random.uniform(*OFF, DRAWS), 0.0)


def _medians(values: Float, weight: Float) -> Float:
    """(D,) weighted medians of the rows of values (D, Q)."""
    order = np.argsort(values, axis=1, kind="stable")
    sums = np.cumsum(weight[order], axis=1)
    middle = (sums >= sums[:, -1:] / 2).argmax(axis=1)
    rows = np.arange(len(values))
    medians: Float = values[rows, order[rows, middle]]
    return medians


def probabilities(setting: Setting, log_depth: Float, pieces: Pieces, chance: Float) -> Float:
    """(N,) from 0 to 1 at the depths (N,) that were found, by the `chance` (Q,) of each piece; 0 in no body."""
    known = line_features(setting, log_depth, pieces)
    log_odds = AT_ONCE + sum((LOG_ODDS[name] * value for name, value in known.items()), np.zeros(len(log_depth)))
    own = pieces.piece >= 0
    found = np.zeros(len(log_depth))
    found[own] = chance[pieces.piece[own]] / (1 + np.exp(-log_odds[own]))
    return found
