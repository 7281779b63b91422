"""How deep the ends of each line are for one depth of its middle, and the bounds that follow.

A line of known axis through a known segment has one unknown, the depth s of the segment's middle (camera z). The
depths of its two ends are fixed multiples of s. The *near end* is the one of smaller depth; the solver bounds its depth
to 1 .. depth_range, so every line fits, however far it runs away from the camera.
"""

import numpy as np

from linecad.arrays import Float
from linecad.directions import across
from linecad.line_graph import LineGraph

VANISHING_TOLERANCE = 1e-6  # of the middle ray's length: how far a segment may miss the vanishing point of its axis


def end_ratios(graph: LineGraph) -> Float:
    """(N, 2) depth of each end over the depth of the segment's middle, positive.

    From the paper's (5): along the line only the coordinate of its axis changes, so s d_beta = lambda_a d_a,beta for
    the two components beta across it, solved by least squares. Raises ValueError where a segment does not pass through
    the vanishing point of its axis (the two disagree) or ends in it.
    """
    lines = np.arange(len(graph.segments))
    sides = across(graph.axis)
    middle = graph.components[lines[:, None], sides]
    ends = graph.end_components[lines[:, None, None], [[0], [1]], sides[:, None, :]]
    scale = np.linalg.norm(middle, axis=1)
    lengths = (ends**2).sum(axis=2)
    ends_there = (scale == 0) | (lengths == 0).any(axis=1)
    if ends_there.any():
        i = int(np.argmax(ends_there))
        raise ValueError(f"segment {i} of the line graph ends in the vanishing point of its axis")
    ratios: Float = (ends * middle[:, None, :]).sum(axis=2) / lengths
    missed = np.abs(middle[:, None, :] - ratios[:, :, None] * ends).max(axis=(1, 2), initial=0) / scale
    misses = (missed > VANISHING_TOLERANCE) | (ratios <= 0).any(axis=1)
    if misses.any():
        i = int(np.argmax(misses))
        raise ValueError(
            f"segment {i} of the line graph misses the vanishing point of its axis by {missed[i]:.3g} of its ray"
        )
    return ratios


def near_log_ratio(graph: LineGraph, ratios: Float) -> Float:
    """(E,) log n_i - log n_j of two lines that meet, n the depth of a line's near end; `ratios` of `end_ratios`."""
    near = np.log(ratios.min(axis=1))
    i, j = graph.edges.T
    shifted: Float = graph.log_ratio + near[i] - near[j]
    return shifted
