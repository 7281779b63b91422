"""Colours about a crossing, on drawn photos of four patches; and the fit of weights on made data."""

import importlib.util
import sys
from pathlib import Path

import numpy as np
import pytest

from linecad.evaluation.features import colour_features
from linecad.graph.build import build_line_graph
from linecad.line_graph import ManhattanFrame, Segments
from linecad.scene import Camera

CAMERA = Camera(400, 300, np.array([[300.0, 0, 200], [0, 300, 150], [0, 0, 1]]), "file")
FRAME = ManhattanFrame(np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]), 0.0, 1.0)


def contrasts(top_left, top_right, low_left, low_right):
    """Of a level and a vertical line that cross in the middle of a photo of four grey patches, 0 to 1."""
    pixels = np.zeros((300, 400, 3), np.uint8)
    pixels[:150, :200], pixels[:150, 200:] = 255 * top_left, 255 * top_right
    pixels[150:, :200], pixels[150:, 200:] = 255 * low_left, 255 * low_right
    segments = Segments([[[100.0, 150], [300, 150]], [[200.0, 50], [200, 250]]], [0, 2])
    graph = build_line_graph(segments, CAMERA, FRAME)
    assert len(graph.edges) == 1
    return colour_features(pixels, graph)[0]


@pytest.mark.parametrize(
    ("patches", "expected"),
    [
        ((0, 0, 0, 0), [0, 0, 0]),
        ((0, 1, 0, 1), [0, 1, 1]),  # an edge between left and right alone
        ((0, 0, 1, 1), [0, 1, 1]),
        ((1, 0, 0, 0), [0.5, 0.5, 0]),  # one corner of a window
        ((1, 0, 0, 1), [1, 1, 0]),  # a chessboard
        ((0, 0, 0.4, 0.8), [0.2, 0.6, 0.4]),  # a T: one surface above, two below
    ],
)
def test_contrasts_of_four_patches(patches, expected):
    assert contrasts(*patches) == pytest.approx(expected, abs=0.01)


def test_a_crossing_at_the_border_of_the_photo_has_features():
    pixels = np.zeros((300, 400, 3), np.uint8)
    segments = Segments([[[0.0, 0], [300, 0]], [[0.0, 0], [0, 250]]], [0, 2])
    found = colour_features(pixels, build_line_graph(segments, CAMERA, FRAME))
    assert found.tolist() == [[0, 0, 0]]


@pytest.fixture(scope="module")
def fit_weights():
    path = Path(__file__).resolve().parents[2] / "benchmarks" / "fit_weights.py"
    spec = importlib.util.spec_from_file_location("fit_weights", path)
    module = importlib.util.module_from_spec(spec)
    sys.modules["fit_weights"] = module
    spec.loader.exec_module(module)
    return module


def test_the_fit_finds_the_log_odds_that_made_the_data(fit_weights):
    rng = np.random.default_rng(4)
    features = np.column_stack([rng.normal(3, 2, 40000), rng.random(40000) < 0.2, np.full(40000, 7.0)])
    odds = 1.5 - 0.8 * features[:, 0] + 2.0 * features[:, 1]
    real = rng.random(40000) < 1 / (1 + np.exp(-odds))
    fit = fit_weights.fit_logistic(features, real)
    assert fit.odds(np.array([[0.0, 0, 7]]))[0] == pytest.approx(1.5, abs=0.1)
    assert fit.factors[:2] == pytest.approx([-0.8, 2.0], abs=0.1)
    assert fit.factors[2] == pytest.approx(0, abs=1e-9)


def test_the_fit_stays_finite_where_the_labels_can_be_parted(fit_weights):
    features = np.array([[0.0], [1], [2], [3]])
    fit = fit_weights.fit_logistic(features, np.array([False, False, True, True]))
    assert 0 < fit.factors[0] < 10


def test_area_under_curve_by_hand(fit_weights):
    real = np.array([True, False, True, False])
    assert fit_weights.area_under_curve(np.array([4.0, 1, 3, 2]), real) == 1
    assert fit_weights.area_under_curve(np.array([3.0, 4, 2, 1]), real) == 0.5
    assert fit_weights.area_under_curve(np.array([1.0, 1, 1, 1]), real) == 0.5
    assert fit_weights.area_under_curve(np.array([1.0, 1, 2, 0]), real) == 0.875
