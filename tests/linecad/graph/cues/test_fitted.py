"""Features of crossings by hand, and weights from a table."""

import json

import numpy as np
import pytest

from linecad.graph.build import build_line_graph
from linecad.graph.cues.fitted import (
    COLLINEAR_FEATURES,
    CROSSING_FEATURES,
    LogOdds,
    WeightTable,
    collinear_features,
    crossing_features,
    fitted_table,
    fitted_weights,
    read_table,
)
from linecad.io.strict_json import JsonError
from linecad.line_graph import ManhattanFrame, Segments
from linecad.scene import Camera

# A frontal camera: z lines are vertical in the photo, x lines level. The photo is half as wide as the reference.
CAMERA = Camera(1920, 1080, np.array([[1000.0, 0, 960], [0, 1000, 540], [0, 0, 1]]), "file")
FRAME = ManhattanFrame(np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]), 0.0, 1.0)


def graph_of(*lines, collinear=False):
    ends, axis = [ends for ends, _ in lines], [axis for _, axis in lines]
    return build_line_graph(Segments(ends, axis), CAMERA, FRAME, 60.0, "ones", collinear)


@pytest.fixture
def two():
    """A T: a level bar of 200 px, and 15 px below it a stem of 50 px."""
    return graph_of(([[400.0, 300], [600, 300]], 0), ([[500.0, 315], [500, 365]], 2))


def test_features_of_a_crossing(two):
    found = dict(zip(CROSSING_FEATURES, crossing_features(two, 1920)[0].tolist(), strict=True))
    assert found == pytest.approx(
        {
            "T": 1, "X": 0, "corner": 0, "root of gap": 1.0, "gap over stem": 0.3, "log of shorter": 0.0,
            "log of longer": np.log(4), "both horizontal": 0,
        }
    )  # fmt: skip


def test_features_do_not_change_with_the_size_of_the_photo(two):
    half = Camera(960, 540, CAMERA.matrix * [[0.5], [0.5], [1]], "file")
    small = build_line_graph(Segments(two.segments.ends / 2, two.segments.axis), half, FRAME, 60.0, "ones", False)
    assert crossing_features(small, 960) == pytest.approx(crossing_features(two, 1920))


def test_features_of_a_collinear_edge():
    graph = graph_of(([[400.0, 300], [500, 300]], 0), ([[530.0, 300], [730, 300]], 0), collinear=True)
    found = dict(zip(COLLINEAR_FEATURES, collinear_features(graph, 1920)[0].tolist(), strict=True))
    assert found == pytest.approx(
        {
            "log of gap": np.log(3), "gap over shorter": 0.3, "log of shorter": np.log(2), "log of longer": np.log(4),
            "vertical": 0,
        }
    )  # fmt: skip


def table_of(constant, least=0.1, **factors):
    crossing = LogOdds(constant, {name: factors.get(name.replace(" ", "_"), 0.0) for name in CROSSING_FEATURES})
    return WeightTable(2.0, least, crossing, LogOdds(5.0, dict.fromkeys(COLLINEAR_FEATURES, 0.0)))


def test_weights_are_log_odds_over_the_unit(two):
    assert fitted_weights(two, 1920, table_of(3.0, T=-1.0, gap_over_stem=-2.0)) == pytest.approx([(3 - 1 - 0.6) / 2])


def test_no_weight_is_below_the_least(two):
    assert fitted_weights(two, 1920, table_of(-9.0)).tolist() == [0.1]


def test_collinear_edges_have_a_table_of_their_own():
    graph = graph_of(([[400.0, 300], [500, 300]], 0), ([[530.0, 300], [730, 300]], 0), collinear=True)
    assert fitted_weights(graph, 1920, table_of(0.0)).tolist() == [2.5]


def test_the_table_that_comes_with_linecad_is_used(two):
    table = fitted_table()
    assert table.unit > 0
    assert table.least > 0
    fitted = build_line_graph(two.segments, CAMERA, FRAME, 60.0, "fitted", False)
    assert fitted.weight == pytest.approx(fitted_weights(two, 1920, table))
    assert fitted.weight[0] != 1


def test_a_gap_makes_a_crossing_less_likely(two):
    near = graph_of(([[400.0, 300], [600, 300]], 0), ([[500.0, 302], [500, 365]], 2))
    assert fitted_weights(near, 1920) > fitted_weights(two, 1920)


def test_a_table_without_a_factor_is_refused():
    odds = {"constant": 1.0, "factors": dict.fromkeys(CROSSING_FEATURES, 0.0)}
    text = json.dumps({"unit": 1.0, "least": 0.1, "crossing": odds, "collinear": odds})
    with pytest.raises(JsonError, match=r"collinear\.factors\.log of gap is missing"):
        read_table(text)
