"""Manhattan frames against the truth: which axis is which, and the axis that a segment points to."""

import numpy as np

from linecad.arrays import Float, Int
from linecad.directions import MAIN
from linecad.geometry import angle_between_frames, angles_to, vanishing_points


def true_axes(found: Float, true: Float) -> Int:
    """(3,) the true axis that each axis of the found frame stands for."""
    _, which = angle_between_frames(found, true)
    names = np.empty(3, np.int64)
    names[list(which)] = np.arange(3)
    return names


def true_directions(axes: Float, true: Float) -> Float:
    """(K, 3) unit vectors, in the world of the true frame, of found directions (3, K): true axes, then further ones."""
    main = np.eye(3)[true_axes(axes[:, :MAIN], true)]
    return np.concatenate([main, axes[:, MAIN:].T @ true])


def nearest_axes(ends: Float, K: Float, rotation: Float) -> Int:
    """Axis (N,) whose vanishing point each segment (N, 2, 2) points to best."""
    axes: Int = angles_to(ends, vanishing_points(K, rotation)).argmin(axis=0)
    return axes
