"""How deep the ends of each line are for one depth of its middle, and the bounds that follow.

A line of known axis through a known segment has one unknown, the depth s of the segment's middle (camera z). The
depths of its two ends are fixed multiples of s. The *near end* is the one of smaller depth; the solver bounds its depth
to 1 .. depth_range, so every line fits, however far it runs away from the camera.
"""

import numpy as np

from linecad.scene import Float, LineGraph

VANISHING_TOLERANCE = 1e-6  # of the middle ray's length: how far a segment may miss the vanishing point of its axis


def end_ratios(graph: LineGraph) -> Float:
    """(N, 2) depth of each end over the depth of the segment's middle, positive.

    From the paper's (5): along the line only the coordinate of its axis changes, so s d_beta = lambda_a d_a,beta for
    the two other coordinates beta, solved by least squares. Raises ValueError where a segment does not pass through the
    vanishing point of its axis (the two coordinates disagree) or ends in it.
    """
    ratios = np.empty((len(graph.segments), 2))
    for i, axis in enumerate(graph.axis.tolist()):
        middle = np.delete(graph.rays[i], axis)
        ends = np.delete(graph.end_rays[i], axis, axis=1)
        scale = float(np.linalg.norm(middle))
        lengths = (ends**2).sum(axis=1)
        if scale == 0 or not (lengths > 0).all():
            raise ValueError(f"segment {i} of the line graph ends in the vanishing point of its axis")
        ratio = ends @ middle / lengths
        missed = np.abs(middle - ratio[:, None] * ends).max() / scale
        if missed > VANISHING_TOLERANCE or not (ratio > 0).all():
            raise ValueError(
                f"segment {i} of the line graph misses the vanishing point of its axis by {missed:.3g} of its ray"
            )
        ratios[i] = ratio
    return ratios


def near_log_ratio(graph: LineGraph, ratios: Float) -> Float:
    """(E,) log n_i - log n_j of two lines that meet, n the depth of a line's near end; `ratios` of `end_ratios`."""
    near = np.log(ratios.min(axis=1))
    i, j = graph.edges.T
    shifted: Float = graph.log_ratio + near[i] - near[j]
    return shifted
