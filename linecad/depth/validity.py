"""Which pixels of a depth map hold depth: not the infinite, the missing, and the sky that a network fills in."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from linecad.arrays import Bool
from linecad.depth.depth_map import Single

SKY_SHARE = 0.002  # of the valid pixels, at least, that one value must have to be a plateau
MOST_BEYOND = 0.05  # of the other pixels: Depth Anything 3 fills the sky with their 99th percentile in all its photos
SPIKE = 10.0  # times as many pixels as any value next to it; steps of half precision or 1/256 m are even
NEIGHBOURS = 3  # values on either side that a plateau is compared with
MOST_COUNTED = 500_000  # px, evenly taken, in which the commonest value is looked for


def valid_depths(values: NDArray[Any], mask: Bool | None) -> tuple[Single, Bool]:
    """Values (H, W) in single precision, 0 where they hold no depth, and where they do.

    No depth: NaN, infinite, 0 and below, outside the network's own `mask`, and a plateau at the largest value.
    """
    with np.errstate(all="ignore"):
        depth: Single = values.astype(np.float32)
        valid = (depth > 0) & (depth < np.inf)
    if mask is not None:
        valid &= mask
    plateau = _plateau(depth[valid])
    if plateau is not None:
        valid &= depth != plateau
    return np.where(valid, depth, np.float32(0)), valid


def _plateau(depths: Single) -> np.float32 | None:
    """The value of depths (N,) that stands for the sky; None where none does.

    It is a spike among the values around it with hardly any beyond. A map of one value alone has none.
    """
    counted = depths[:: max(1, len(depths) // MOST_COUNTED)]
    if len(counted) == 0:
        return None
    values, counts = np.unique(counted, return_counts=True)
    # Of the values with few others beyond them, the commonest.
    beyond = len(counted) - np.cumsum(counts)
    far = beyond <= MOST_BEYOND * (len(counted) - counts)
    at = int(np.argmax(np.where(far, counts, 0)))
    around = np.concatenate([counts[max(0, at - NEIGHBOURS) : at], counts[at + 1 : at + 1 + NEIGHBOURS]])
    if len(values) == 1 or counts[at] < max(SKY_SHARE * len(counted), SPIKE * around.max()):
        return None
    plateau: np.float32 = values[at]
    return plateau
