"""Evidence for what is real, one file a cue. To add one: write the function in a file here and add it to a set below.

A cue gives log-odds per edge; those of one set are summed. A unary cue gives a log depth for some lines, each with a
standard error; the robust fit and the lifting take it (`linecad.line_graph.LineDepths`).
"""

from dataclasses import dataclass, replace

import numpy as np

from linecad.arrays import Float
from linecad.graph.cues.collinear import collinear_log_odds
from linecad.graph.cues.cue import Cue, Known, UnaryCue
from linecad.graph.cues.gaps import gap_log_odds
from linecad.graph.cues.junctions import equal_weights, junction_weights
from linecad.line_graph import LineDepths, LineGraph
from linecad.options import Weights

__all__ = ["CUES", "UNARY_CUES", "Cue", "CueSet", "Known", "UnaryCue", "weigh"]


@dataclass(frozen=True)
class CueSet:
    """Cues that weigh the edges together: one value of the option `weights`."""

    cues: tuple[Cue, ...]
    are_log_odds: bool = True  # rounded and kept positive; else positive weights, taken as they are


CUES: dict[Weights, CueSet] = {
    "odds": CueSet((gap_log_odds, collinear_log_odds)),
    "junctions": CueSet((junction_weights,), are_log_odds=False),
    "ones": CueSet((equal_weights,), are_log_odds=False),
}
UNARY_CUES: tuple[UnaryCue, ...] = ()

# To which log-odds are rounded, and the least of any edge: objectives then have a common measure, by which bounds are
# rounded, and the search ends sooner. The paper's weights cannot be zero or less.
STEP = 0.5


def weigh(known: Known, weights: Weights) -> LineGraph:
    """The graph with the weights that its cues give, and with the depths that unary cues give."""
    chosen = CUES[weights]
    weight = sum((cue(known) for cue in chosen.cues), start=np.zeros(len(known.graph.edges)))
    depths = [cue(known) for cue in UNARY_CUES]
    return replace(
        known.graph,
        weight=_in_steps(weight) if chosen.are_log_odds else weight,
        depths=LineDepths.joined(depths) if depths else known.graph.depths,
    )


def _in_steps(log_odds: Float) -> Float:
    """Log-odds (E,) in whole STEPs, at least one."""
    return np.asarray(np.maximum(np.round(log_odds / STEP), 1) * STEP)
