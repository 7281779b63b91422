"""The rectangles of a wall that are judged: those that edges close, windows of panes, what rows and columns ask for."""

from dataclasses import dataclass

import numpy as np

from linecad.arrays import Float, Int
from linecad.model.openings.evidence import Sums, measure
from linecad.model.openings.lattice import distinct, new_ones, propose
from linecad.model.openings.neighbours import compare, windows_of_panes
from linecad.model.openings.odds import log_odds_alone, log_odds_beside
from linecad.model.openings.raster import Raster
from linecad.model.openings.rectangles import Edges, count_edges, find_rectangles

ALMOST_SAME = 0.8  # overlap of rectangles of which one is judged
MOST = 1500  # rectangles of a wall that are judged, beside those that are proposed


@dataclass(frozen=True, eq=False)
class Pool:
    """All rectangles of a wall that are judged, likely or not."""

    raster: Raster
    edges: Edges
    sums: Sums
    box: Int  # (N, 4)
    evidence: Float  # (N, F)
    others: Int  # (M, 4) that they are compared with: distinct ones that edges close, and windows of panes
    other_log_odds: Float  # (M,) by themselves

    def log_odds(self) -> Float:
        """Log-odds (N,) that each is an opening, by itself and beside the others."""
        # Beside these alone: beside what rows and columns ask for, they would support themselves.
        return log_odds_beside(self.evidence, compare(self.box, self.raster, self.others, self.other_log_odds))


def build_pool(raster: Raster) -> Pool:
    """The rectangles of one wall."""
    edges = count_edges(raster)
    box = find_rectangles(raster, edges)
    sums = Sums(raster)
    evidence = measure(box, edges, sums, raster)
    log_odds = log_odds_alone(evidence)
    kept = distinct(box, log_odds, ALMOST_SAME, MOST)
    box, evidence, log_odds = box[kept], evidence[kept], log_odds[kept]
    core = distinct(box, log_odds)
    whole = windows_of_panes(box[core], log_odds[core], raster)
    whole_log_odds = log_odds_alone(measure(whole, edges, sums, raster))
    others = np.concatenate([box[core], whole])
    other_log_odds = np.concatenate([log_odds[core], whole_log_odds])
    asked = [
        propose(some[np.argsort(-value, kind="stable")], raster)
        for some, value in ((others, other_log_odds), (whole, whole_log_odds))
    ]
    proposed = new_ones(np.concatenate([whole, *asked]), box)
    return Pool(
        raster,
        edges,
        sums,
        np.concatenate([box, proposed]),
        np.concatenate([evidence, measure(proposed, edges, sums, raster)]),
        others,
        other_log_odds,
    )
