"""Pieces of one line with the edge between them that detection lost: the photo shows it, so they are one line."""

import numpy as np

from linecad.arrays import Int
from linecad.model.clean.ends import NEAR
from linecad.model.clean.sight import Sight
from linecad.model.clean.strokes import SAME, Strokes, parallel_pairs

WIDEST = 1.0  # times the shorter piece, of a gap


def continued(strokes: Strokes, sight: Sight) -> Int:
    """Pairs (P, 2) of rows of strokes that both go on in the photo over the gap between them, of NEAR or more."""
    first, second, apart, overlap = parallel_pairs(strokes, SAME)
    length, depth = np.ptp(strokes.reach, axis=1), np.abs(strokes.depth)
    wide = -overlap >= NEAR * np.minimum(depth[first], depth[second])
    wide &= -overlap <= WIDEST * np.minimum(length[first], length[second])
    first, second, apart = first[wide], second[wide], apart[wide]
    swap = strokes.reach[first, 0] > strokes.reach[second, 0]
    low, high = np.where(swap, second, first), np.where(swap, first, second)
    seen = sight.pixels(strokes.points(strokes.reach))
    ways = np.stack([seen[low, 1], seen[high, 0]], axis=1)
    shown = sight.shows(seen[low], ways) & sight.shows(seen[high], ways)
    pairs: Int = np.column_stack([first, second])[shown][np.argsort(apart[shown], kind="stable")]
    return pairs
