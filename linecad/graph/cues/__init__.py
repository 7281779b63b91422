"""Evidence for what is real, one file a cue. To add one: write the function in a file here and add its row below.

A cue gives log-odds per edge; those of one set are summed. A unary cue gives a log depth for some lines, each with a
standard error; the robust fit and the lifting take it (`linecad.line_graph.LineDepths`).
"""

from dataclasses import replace

import numpy as np

from linecad.arrays import Float
from linecad.graph.cues.collinear import collinear_log_odds
from linecad.graph.cues.cue import Cue, Known, UnaryCue
from linecad.graph.cues.gaps import gap_log_odds
from linecad.graph.cues.junctions import equal_weights, junction_weights
from linecad.line_graph import LineDepths, LineGraph
from linecad.options import Weights

__all__ = ["CUES", "UNARY_CUES", "Cue", "Known", "UnaryCue", "weigh"]

CUES: dict[Weights, tuple[Cue, ...]] = {
    "odds": (gap_log_odds, collinear_log_odds),
    "junctions": (junction_weights,),
    "ones": (equal_weights,),
}
UNARY_CUES: tuple[UnaryCue, ...] = ()

# To which log-odds are rounded, and the least of any edge: objectives then have a common measure, by which bounds are
# rounded, and the search ends sooner. The paper's weights cannot be zero or less.
STEP = 0.5


def weigh(known: Known, weights: Weights) -> LineGraph:
    """The graph with the weights that its cues give, and with the depths that unary cues give."""
    weight = sum((cue(known) for cue in CUES[weights]), start=np.zeros(len(known.graph.edges)))
    depths = [cue(known) for cue in UNARY_CUES]
    return replace(
        known.graph,
        weight=_in_steps(weight) if weights == "odds" else weight,
        depths=LineDepths.joined(depths) if depths else known.graph.depths,
    )


def _in_steps(log_odds: Float) -> Float:
    """Log-odds (E,) in whole STEPs, at least one."""
    return np.asarray(np.maximum(np.round(log_odds / STEP), 1) * STEP)
