"""How sure the depth of a line is, as a word by its probability: sure, likely or guess."""

import numpy as np

from linecad.arrays import Text
from linecad.scene import Lines

SURE, LIKELY, GUESS = BANDS = ("sure", "likely", "guess")
LEAST = {SURE: 0.9, LIKELY: 0.5, GUESS: 0.0}  # the smallest probability of each


def bands_of(lines: Lines) -> Text | None:
    """(N,) the word of each line; None where the scene does not tell probabilities."""
    if not len(lines.probability):
        return None
    probability = np.asarray(lines.probability)
    return np.select([probability >= least for least in LEAST.values()], BANDS, default="")
