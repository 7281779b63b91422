"""Cue: two pieces of one image line, from how nearly they lie on it and how many others lie near it.

A pair of collinear pieces convinces by how nearly they lie on one image line, against the chance that some other
parallel segment lies there: among courses of brick every line finds a continuation. Lengths are px at the reference
width.
"""

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.geometry import REFERENCE_WIDTH, directions_to, vanishing_points
from linecad.graph.cues.cue import Known
from linecad.line_graph import LineGraph, ManhattanFrame, Segments
from linecad.scene import Camera

AT_ONCE = 4.0  # log-odds of two pieces of exactly one image line where nothing else is near
PER_GAP_OVER_SHORTER = 0.5
ACROSS = 0.8  # px, standard deviation of pieces of one line across it
LONELY = 1 / 60  # parallel segments per px across, where each stands alone
CROWD_ACROSS = 25.0  # px to both sides, in which the others are counted
CROWD_ALONG = 40.0  # px to both sides of the end of the gap


def collinear_log_odds(known: Known) -> Float:
    """(E,) log-odds that a collinear edge is real; 0 for crossings."""
    graph = known.graph
    which = np.flatnonzero(graph.kind == "collinear")
    log_odds = np.zeros(len(graph.edges))
    log_odds[which] = _log_odds(graph, which, known.camera, known.frame)
    return log_odds


def _log_odds(graph: LineGraph, which: Int, camera: Camera, frame: ManhattanFrame) -> Float:
    """(M,) of the collinear edges `which` (M,) of a graph."""
    scale, segments = REFERENCE_WIDTH / camera.width, graph.segments
    middle = segments.ends.mean(axis=1)
    along = directions_to(middle, vanishing_points(camera.matrix, frame.axes)[segments.axis])
    first, second = graph.edges[which].T
    place = graph.crossing[which]
    # The second line's offset where the gap is, not at its middle: both run to one vanishing point.
    reach = ((place - middle[second]) * along[first]).sum(axis=1)
    turn = _across(along[second], along[first]) / (along[second] * along[first]).sum(axis=1)
    apart = np.abs(
        _across(middle[second] - place, along[first]) + reach * turn - _across(middle[first] - place, along[first])
    )
    shorter = segments.length[graph.edges[which]].min(axis=1)
    crowd = np.maximum(
        _crowd(segments, middle, along, first, place, scale), _crowd(segments, middle, along, second, place, scale)
    )
    odds: Float = AT_ONCE - PER_GAP_OVER_SHORTER * graph.gap[which].sum(axis=1) / shorter
    odds -= 0.5 * (apart * scale / ACROSS) ** 2 + np.log1p(crowd / LONELY)
    return odds


def _across(vector: Float, along: Float) -> Float:
    """Component (M,) of vectors (M, 2) across unit directions (M, 2)."""
    component: Float = vector[:, 1] * along[:, 0] - vector[:, 0] * along[:, 1]
    return component


def _crowd(segments: Segments, middle: Float, along: Float, which: Int, place: Float, scale: float) -> Float:
    """How many parallel segments per px lie beside the end (M,) of segments `which` at the gap in `place` (M, 2)."""
    found = np.zeros(len(which))
    for axis in np.unique(segments.axis[which]).tolist():
        parallel = segments.axis == axis
        own_ends, own_middle = segments.ends[parallel], middle[parallel]
        for number in np.flatnonzero(segments.axis[which] == axis).tolist():
            line = which[number]
            ends = segments.ends[line]
            near = ends[np.linalg.norm(ends - place[number], axis=1).argmin()]
            reach = (own_ends - near) @ along[line] * scale
            offset = (own_middle - near) @ np.array([-along[line, 1], along[line, 0]]) * scale
            beside: Bool = (np.abs(offset) < CROWD_ACROSS) & (reach.min(axis=1) < CROWD_ALONG)
            beside &= reach.max(axis=1) > -CROWD_ALONG
            found[number] = beside.sum() - 1
    return found / (2 * CROWD_ACROSS)
