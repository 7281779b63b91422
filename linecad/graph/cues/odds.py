"""Log-odds that an edge of a line graph is real, from its gap and its two segments: the weights `odds`.

A crossing convinces less the wider the gap that is extended over, and the shorter the segment that spans it; two
horizontal lines meet by chance more often than a horizontal and a vertical one. The numbers fit 10,750 crossings of
surveyed buildings (CONTRIBUTING, 2026-11-21). A pair of collinear pieces convinces by how nearly they lie on one image
line, against the chance that some other parallel segment lies there: among courses of brick every line finds a
continuation. Lengths are px at the reference width.
"""

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.geometry import REFERENCE_WIDTH, directions_to, vanishing_points
from linecad.line_graph import LineGraph, ManhattanFrame, Segments
from linecad.scene import Camera

AT_ONCE = 5.2  # log-odds of two segments that touch
PER_ROOT_GAP = 2.1  # for each root of gap over GAP_UNIT
PER_GAP_OVER_STEM = 0.6
BOTH_HORIZONTAL = 0.5  # and as much again for each GAP_UNIT of the gap
GAP_UNIT = 37.5  # px
# To which all are rounded, and the least of any edge: objectives then have a common measure, by which bounds are
# rounded, and the search ends sooner. The paper's weights cannot be zero or less.
STEP = 0.5

COLLINEAR = 4.0  # log-odds of two pieces of exactly one image line where nothing else is near
PER_GAP_OVER_SHORTER = 0.5
ACROSS = 0.8  # px, standard deviation of pieces of one line across it
LONELY = 1 / 60  # parallel segments per px across, where each stands alone
CROWD_ACROSS = 25.0  # px to both sides, in which the others are counted
CROWD_ALONG = 40.0  # px to both sides of the end of the gap


def log_odds(graph: LineGraph, camera: Camera, frame: ManhattanFrame) -> Float:
    """Log-odds (E,) of all edges of a graph that they are real, in whole STEPs and at least one."""
    odds = crossing_odds(graph, camera.width)
    collinear = np.flatnonzero(graph.kind == "collinear")
    odds[collinear] = collinear_odds(graph, collinear, camera, frame)
    return np.asarray(np.maximum(np.round(odds / STEP), 1) * STEP)


def crossing_odds(graph: LineGraph, width: int) -> Float:
    """Log-odds (E,) of all edges of a graph of a photo `width` px wide; those of collinear edges mean nothing."""
    gap = graph.gap * (REFERENCE_WIDTH / width)
    widest = gap.max(axis=1)
    over_stem = (graph.gap / graph.segments.length[graph.edges]).max(axis=1)
    horizontal = (graph.axis[graph.edges] != 2).all(axis=1)
    odds: Float = AT_ONCE - PER_ROOT_GAP * np.sqrt(widest / GAP_UNIT) - PER_GAP_OVER_STEM * over_stem
    odds -= BOTH_HORIZONTAL * horizontal * (1 + widest / GAP_UNIT)
    return odds


def collinear_odds(graph: LineGraph, which: Int, camera: Camera, frame: ManhattanFrame) -> Float:
    """Log-odds (M,) of the collinear edges `which` (M,) of a graph."""
    scale, segments = REFERENCE_WIDTH / camera.width, graph.segments
    middle = segments.ends.mean(axis=1)
    along = directions_to(middle, vanishing_points(camera.matrix, frame.rotation)[segments.axis])
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
    odds: Float = COLLINEAR - PER_GAP_OVER_SHORTER * graph.gap[which].sum(axis=1) / shorter
    odds -= 0.5 * (apart * scale / ACROSS) ** 2 + np.log1p(crowd / LONELY)
    return odds


def _across(vector: Float, along: Float) -> Float:
    """Component (M,) of vectors (M, 2) across unit directions (M, 2)."""
    component: Float = vector[:, 1] * along[:, 0] - vector[:, 0] * along[:, 1]
    return component


def _crowd(segments: Segments, middle: Float, along: Float, which: Int, place: Float, scale: float) -> Float:
    """How many parallel segments per px lie beside the end (M,) of segments `which` at the gap in `place` (M, 2)."""
    found = np.zeros(len(which))
    for axis in range(3):
        parallel = np.flatnonzero(segments.axis == axis)
        for number in np.flatnonzero(segments.axis[which] == axis).tolist():
            line = which[number]
            ends = segments.ends[line]
            near = ends[np.linalg.norm(ends - place[number], axis=1).argmin()]
            reach = (segments.ends[parallel] - near) @ along[line] * scale
            offset = (middle[parallel] - near) @ np.array([-along[line, 1], along[line, 0]]) * scale
            beside: Bool = (np.abs(offset) < CROWD_ACROSS) & (reach.min(axis=1) < CROWD_ALONG)
            beside &= reach.max(axis=1) > -CROWD_ALONG
            found[number] = beside.sum() - 1
    return found / (2 * CROWD_ACROSS)
