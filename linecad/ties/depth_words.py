"""What a depth map says of each body, and what that is worth: its walls are witnesses of one scale.

A wall's error is a Cauchy draw. Where several walls of a body ask for one scale, that is worth more than the word of
one; where each asks for another, the map knows little of it.
"""

from dataclasses import dataclass

import numpy as np

from linecad.arrays import Float
from linecad.ties.depth_samples import WallVotes

WITHIN = 1.5  # widths, half of the interval in which a tie to the map holds
DENSITY = 1.25  # of scales, a unit of log ratio, where nothing is known: BY_CHANCE over twice TOLERANCE
MOST_VOTES = 2.0  # of a body: networks err on neighbouring walls alike
FARTHEST = 0.7  # log scale about the likeliest one, in which others are looked at
STEPS = 10  # to a width, between the scales that are tried


@dataclass(frozen=True, eq=False)
class BodyWords:
    """What a map says of B bodies."""

    log_scale: Float  # (B,) by which log each must most likely grow; NaN where the map does not tell
    # (B,) log-odds over chance that this is right within WITHIN widths, below 0 where walls disagree; 0 without a word
    worth: Float


def words_of(votes: WallVotes, width: float, bodies: int) -> BodyWords:
    """The words of a map whose walls are off by Cauchy draws of that `width`."""
    words = BodyWords(np.full(bodies, np.nan), np.zeros(bodies))
    for body in np.unique(votes.body).tolist():
        own = votes.body == body
        words.log_scale[body], words.worth[body] = _word(votes.log_scale[own], votes.weight[own], width)
    return words


def worth_within(share: float, width: float) -> float:
    """The log-odds over chance of a place within WITHIN widths of the right one, for the `share` of places that are."""
    chance = 2 * WITHIN * width * DENSITY
    return float(np.log(share / (1 - share)) - np.log(chance / (1 - chance)))


def _word(asked: Float, weight: Float, width: float) -> tuple[float, float]:
    """The likeliest log scale of one body, by those that its walls ask for (V,), and what it is worth."""
    counts = weight / weight.max()
    counts *= min(1.0, MOST_VOTES / counts.sum())
    # A sum of Cauchy's logs has its peaks within a width of what is asked for.
    near = (asked[:, None] + np.arange(-STEPS, STEPS + 1) * width / STEPS).ravel()
    best = float(near[_log_likelihood(near, asked, counts, width).argmax()])
    farthest = int(FARTHEST / width * STEPS)
    step = np.arange(-farthest, farthest + 1)
    likelihood = np.exp(_log_likelihood(best + step * width / STEPS, asked, counts, width))
    inside = np.abs(step) < WITHIN * STEPS
    return best, worth_within(float(likelihood[inside].sum() / likelihood.sum()), width)


def _log_likelihood(log_scale: Float, asked: Float, counts: Float, width: float) -> Float:
    """(S,) of log scales (S,)."""
    return np.asarray(-(counts[:, None] * np.log1p(((log_scale - asked[:, None]) / width) ** 2)).sum(axis=0))
