"""Cue: a crossing of two segments, from the gap that is extended over and the segment that spans it.

A crossing convinces less the wider the gap, and the shorter the segment that spans it; two horizontal lines meet by
chance more often than a horizontal and a vertical one. The numbers fit 10,750 crossings of surveyed buildings
(docs/decisions/0018). Lengths are px at the reference width.
"""

import numpy as np

from linecad.arrays import Float
from linecad.geometry import REFERENCE_WIDTH
from linecad.graph.cues.cue import Known

AT_ONCE = 5.2  # log-odds of two segments that touch
PER_ROOT_GAP = 2.1  # for each root of gap over GAP_UNIT
PER_GAP_OVER_STEM = 0.6
BOTH_HORIZONTAL = 0.5  # and as much again for each GAP_UNIT of the gap
GAP_UNIT = 37.5  # px


def gap_log_odds(known: Known) -> Float:
    """(E,) log-odds that a crossing is real; 0 for collinear edges."""
    graph = known.graph
    gap = graph.gap * (REFERENCE_WIDTH / known.camera.width)
    widest = gap.max(axis=1, initial=0.0)
    over_stem = (graph.gap / graph.segments.length[graph.edges]).max(axis=1, initial=0.0)
    horizontal = (graph.axis[graph.edges] != 2).all(axis=1)
    log_odds: Float = AT_ONCE - PER_ROOT_GAP * np.sqrt(widest / GAP_UNIT) - PER_GAP_OVER_STEM * over_stem
    log_odds -= BOTH_HORIZONTAL * horizontal * (1 + widest / GAP_UNIT)
    return np.where(graph.kind == "collinear", 0.0, log_odds)
