"""Ratios that no scales satisfy together: a negative cycle (Bellman and Ford).

Written out, as SciPy only says that there is a cycle and networkx knows no rounding (CLOSEST).
"""

import numpy as np

from linecad.arrays import Float, Int

CLOSEST = 1e-9  # log scale; what is less is rounding, not a contradiction


def find_contradiction(bodies: Int, log_ratio: Float, tolerance: Float, count: int) -> frozenset[int]:
    """Which of T ratios contradict each other around one cycle of `count` bodies; none where scales satisfy all.

    `bodies` (T, 2), `log_ratio` (T,) the log scale of the first less that of the second, within `tolerance` (T,).
    Without any one of a cycle the others of it hold.
    """
    if len(bodies) == 0:
        return frozenset()
    first, second = bodies.T
    # The first's log scale is at most log_ratio + tolerance above the second's, the second's at most so much below.
    start, end = np.r_[second, first], np.r_[first, second]
    length = np.r_[log_ratio + tolerance, tolerance - log_ratio]
    distance = np.zeros(count)
    came = np.full(count, -1)
    moved = -1
    for _ in range(count + 1):
        moved = -1
        for arc in np.flatnonzero(distance[start] + length < distance[end] - CLOSEST).tolist():
            if distance[start[arc]] + length[arc] < distance[end[arc]] - CLOSEST:
                distance[end[arc]] = distance[start[arc]] + length[arc]
                came[end[arc]] = arc
                moved = int(end[arc])
        if moved < 0:
            return frozenset()
    for _ in range(count):  # back into the cycle itself
        moved = int(start[came[moved]])
    found, body = set(), moved
    while True:
        arc = int(came[body])
        found.add(arc % len(bodies))
        body = int(start[arc])
        if body == moved:
            return frozenset(found)
