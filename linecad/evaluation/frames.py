"""Manhattan frames against the truth: the angle between two, which axis is which, the axis a segment points to."""

from itertools import permutations

import numpy as np

from linecad.arrays import Float, Int
from linecad.geometry import angles_to


def rotation_error(found: Float, true: Float) -> tuple[float, tuple[int, int, int]]:
    """Angle, rad, between two frames (3, 3) whose columns are axes of free name and sign; and which axis is which.

    The second value names, for each true axis, the found one.
    """
    best: tuple[float, tuple[int, int, int]] = (np.inf, (0, 1, 2))
    for names in permutations(range(3)):
        signs = np.sign((found[:, list(names)] * true).sum(axis=0))
        turn = (found[:, list(names)] * signs).T @ true
        angle = float(np.arccos(np.clip((np.trace(turn) - 1) / 2, -1, 1)))
        if angle < best[0]:
            best = (angle, (names[0], names[1], names[2]))
    return best


def true_axes(found: Float, true: Float) -> Int:
    """(3,) the true axis that each axis of the found frame stands for."""
    _, which = rotation_error(found, true)
    names = np.empty(3, np.int64)
    names[list(which)] = np.arange(3)
    return names


def nearest_axes(ends: Float, K: Float, rotation: Float) -> Int:
    """Axis (N,) whose vanishing point each segment (N, 2, 2) points to best."""
    axes: Int = angles_to(ends, (K @ rotation).T).argmin(axis=0)
    return axes
