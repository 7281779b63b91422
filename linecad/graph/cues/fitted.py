"""Weights of crossings fitted to labelled photos: named features, and a table of their log-odds of being real.

The table is `linecad/fitted_weights.json`, written by `tests/benchmarks/fit_weights.py`. Lengths are px at the
reference width, so that a table holds for photos of any size.
"""

from dataclasses import dataclass
from functools import cache
from importlib.resources import files

import numpy as np

from linecad.arrays import Bool, Float
from linecad.geometry import REFERENCE_WIDTH
from linecad.io import strict_json as strictjson
from linecad.line_graph import LineGraph

TABLE = "fitted_weights.json"
GAP_UNIT = 30.0  # px at the reference width, the paper's extension
LENGTH_UNIT = 100.0  # px at the reference width
LARGEST_STEM_SHARE = 3.0  # of the stem; a gap that is longer still says no more

CROSSING_FEATURES = (
    "T", "X", "corner", "root of gap", "gap over stem", "log of shorter", "log of longer", "both horizontal",
)  # fmt: skip
COLLINEAR_FEATURES = ("log of gap", "gap over shorter", "log of shorter", "log of longer", "vertical")


@dataclass(frozen=True)
class LogOdds:
    """Log-odds that a crossing is real: constant + sum of factor times feature."""

    constant: float
    factors: dict[str, float]  # by name of the feature, in the order of the features


@dataclass(frozen=True)
class WeightTable:
    """How features become weights: log-odds over `unit`, at least `least`."""

    unit: float  # log-odds of a crossing that weighs 1
    least: float  # weight; the paper's weights cannot be zero or less
    crossing: LogOdds  # features CROSSING_FEATURES
    collinear: LogOdds  # features COLLINEAR_FEATURES


def crossing_features(graph: LineGraph, width: int) -> Float:
    """Features (E, 8) of all edges of a graph, CROSSING_FEATURES; those of collinear ones mean nothing."""
    scale = REFERENCE_WIDTH / width
    gap = graph.gap * scale
    length = graph.segments.length[graph.edges] * scale
    both_horizontal = (graph.axis[graph.edges] != 2).all(axis=1)
    stem = np.minimum((gap / length).max(axis=1), LARGEST_STEM_SHARE)
    return np.column_stack(
        [
            graph.kind == "T",
            graph.kind == "X",
            graph.corner,
            np.sqrt(gap.max(axis=1) / GAP_UNIT),
            stem,
            np.log(length.min(axis=1) / LENGTH_UNIT),
            np.log(length.max(axis=1) / LENGTH_UNIT),
            both_horizontal,
        ]
    ).astype(np.float64)


def collinear_features(graph: LineGraph, width: int) -> Float:
    """Features (E, 5) of all edges of a graph, COLLINEAR_FEATURES; they mean something for collinear edges alone."""
    scale = REFERENCE_WIDTH / width
    gap = graph.gap.sum(axis=1) * scale  # the point is in the middle between the two segments
    length = graph.segments.length[graph.edges] * scale
    return np.column_stack(
        [
            np.log1p(gap / GAP_UNIT),
            gap / length.min(axis=1),
            np.log(length.min(axis=1) / LENGTH_UNIT),
            np.log(length.max(axis=1) / LENGTH_UNIT),
            graph.axis[graph.edges[:, 0]] == 2,
        ]
    ).astype(np.float64)


def fitted_weights(graph: LineGraph, width: int, table: WeightTable | None = None) -> Float:
    """Weights (E,) of the edges of a graph of a photo `width` px wide, by the table that comes with linecad."""
    table = fitted_table() if table is None else table
    collinear: Bool = graph.kind == "collinear"
    odds = np.where(
        collinear,
        _log_odds(table.collinear, collinear_features(graph, width)),
        _log_odds(table.crossing, crossing_features(graph, width)),
    )
    return np.asarray(np.maximum(odds / table.unit, table.least))


def _log_odds(fit: LogOdds, features: Float) -> Float:
    odds: Float = fit.constant + features @ np.array(list(fit.factors.values()))
    return odds


@cache
def fitted_table() -> WeightTable:
    """The table that comes with linecad."""
    return read_table((files("linecad") / TABLE).read_text(encoding="utf-8"))


def read_table(text: str) -> WeightTable:
    """A table from its JSON; JsonError where it is not what it should be."""
    top = strictjson.parse(text)
    return WeightTable(
        unit=top["unit"].number(),
        least=top["least"].number(),
        crossing=_read_odds(top["crossing"], CROSSING_FEATURES),
        collinear=_read_odds(top["collinear"], COLLINEAR_FEATURES),
    )


def _read_odds(node: strictjson.Node, features: tuple[str, ...]) -> LogOdds:
    return LogOdds(node["constant"].number(), {name: node["factors"][name].number() for name in features})
