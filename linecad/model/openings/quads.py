"""How much of each other convex quadrilaterals share, many pairs at once."""

import numpy as np

from linecad.arrays import Float

ON = 1e-9  # px from a side, within which a corner lies on it: neighbours share sides, but for rounding


def shared_areas(one: Float, other: Float) -> Float:
    """The areas (P,) that convex quadrilaterals (P, 4, 2) share with others (P, 4, 2), corners in order."""
    ring = one
    edges = np.roll(other, -1, axis=1) - other
    sides = np.sign(_areas(other))
    for corner in range(4):
        start, edge = other[:, None, corner], edges[:, None, corner]
        away = ring - start
        length = np.maximum(np.linalg.norm(edge, axis=2), np.finfo(float).tiny)
        inside = sides[:, None] * (edge[..., 0] * away[..., 1] - edge[..., 1] * away[..., 0]) / length
        ring = _clipped(ring, inside)
    found: Float = np.abs(_areas(ring))
    return found


def _clipped(ring: Float, inside: Float) -> Float:
    """The part (P, V + 2, 2) of convex rings (P, V, 2) whose signed distance `inside` (P, V) of a line is positive.

    A ring with fewer corners repeats one of them; one of which nothing is left is a point.
    """
    count = ring.shape[1]
    kept = inside >= -ON
    crosses = kept != np.roll(kept, -1, axis=1)
    following = np.roll(inside, -1, axis=1)
    share = inside / np.where(crosses, inside - following, 1.0)
    crossing = ring + share.clip(0, 1)[..., None] * (np.roll(ring, -1, axis=1) - ring)
    every = np.stack([ring, crossing], axis=2).reshape(len(ring), 2 * count, 2)
    there = np.stack([kept, crosses], axis=2).reshape(len(ring), 2 * count)
    # Corners that stay come first, in their order; the last of them fills what is left.
    order = np.argsort(~there, axis=1, kind="stable")[:, : count + 2]
    last = np.maximum(there.sum(axis=1), 1) - 1
    order = np.take_along_axis(order, np.minimum(np.arange(count + 2), last[:, None]), axis=1)
    found: Float = np.take_along_axis(every, order[..., None], axis=1)
    return found


def _areas(ring: Float) -> Float:
    """Signed areas (P,) of rings (P, V, 2)."""
    # From the first corner, since far from the origin the products would round.
    x, y = np.moveaxis(ring - ring[:, :1], 2, 0)
    found: Float = (x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1)).sum(axis=1) / 2
    return found
