"""What is measured in and around a rectangle: by a dark window in a grey wall, whose numbers are known by hand."""

import numpy as np
import pytest

from linecad.model.openings.evidence import LEVELS, NAMES, PLAIN, Sums, measure
from linecad.model.openings.raster import Raster
from linecad.model.openings.rectangles import count_edges

WALL, GLASS = 128, 78  # lightness
WINDOW = np.array([[60, 100, 30, 70]])


def raster_of(lightness, inside=None, window=None):
    """A raster of a wall, its edges those of one window."""
    shape = lightness.shape
    colours = np.dstack([lightness, np.full((*shape, 2), 128)]).astype(np.uint8)
    upright, level = np.zeros(shape, bool), np.zeros(shape, bool)
    if window is not None:
        left, right, low, high = window
        upright[low : high + 1, [left, right]] = True
        level[[low, high], left : right + 1] = True
    seen = np.ones(shape, bool) if inside is None else inside
    return Raster(np.arange(shape[1]) / 50, np.arange(shape[0]) / 50, colours, seen, upright, level)


def told(raster, box):
    """The numbers of one rectangle by their names."""
    return dict(zip(NAMES, measure(np.array(box), count_edges(raster), Sums(raster), raster)[0], strict=True))


@pytest.fixture
def wall():
    lightness = np.full((100, 200), WALL)
    lightness[30:71, 60:101] = GLASS
    return lightness


def test_a_dark_window_in_a_grey_wall(wall):
    evidence = told(raster_of(wall, window=WINDOW[0]), WINDOW)
    step = (WALL - GLASS) / LEVELS
    expected = {
        "uprights": 2.0, "weaker upright": 1.0, "weaker level": 1.0, "levels": 2.0,
        "beyond uprights": 0.0, "beyond levels": 0.0, "contrast": step, "darker": step,
        "rough inside": 0.0, "rough around": 0.0, "weakest step": step, "steps": step,
        "edges inside": 0.0, "edges around": 0.0, "slender": 0.0, "flat": 0.0, "plain": 0.0, "open": 0.0,
        "columns": np.log(40), "rows": np.log(40),
    }  # fmt: skip
    assert evidence == pytest.approx(expected)


def test_a_bright_one_is_less_dark(wall):
    evidence = told(raster_of(2 * WALL - wall), WINDOW)
    assert evidence["darker"] == pytest.approx((GLASS - WALL) / LEVELS)
    assert evidence["contrast"] == pytest.approx((WALL - GLASS) / LEVELS)


def test_one_that_changes_at_three_sides_is_weakest_at_the_fourth(wall):
    wall[71:, 60:101] = GLASS
    evidence = told(raster_of(wall), WINDOW)
    assert evidence["weakest step"] == 0.0
    assert evidence["steps"] == pytest.approx(0.75 * (WALL - GLASS) / LEVELS)


def test_a_wide_one_is_flat_and_a_tall_one_slender(wall):
    assert told(raster_of(wall), [[60, 140, 30, 70]])["flat"] == pytest.approx(np.log(2))
    assert told(raster_of(wall), [[60, 100, 10, 90]])["slender"] == pytest.approx(np.log(2))


@pytest.mark.parametrize(
    "box", [[60, 99, 30, 70], [60, 199, 30, 70], [60, 98, 0, 70], [60, 98, 30, 99], [0, 99, 0, 99]]
)
def test_beside_the_photo_and_the_raster_nothing_changes(box):
    """What lies outside has no colour: it is no black wall."""
    inside = np.ones((100, 200), bool)
    inside[:, 100 if box[1] < 100 else 200 :] = False
    evidence = told(raster_of(np.full((100, 200), WALL), inside), [box])
    assert evidence["steps"] == evidence["weakest step"] == evidence["contrast"] == evidence["darker"] == 0.0
    assert evidence["plain"] == PLAIN


def test_sums_are_those_of_the_points():
    rng = np.random.default_rng(3)
    lightness = rng.integers(0, 255, (30, 40))
    inside = rng.random((30, 40)) < 0.8
    raster = raster_of(lightness, inside)
    found = Sums(raster).of(np.array([-4, 5]), np.array([12, 60]), np.array([2, 7]), np.array([9, 31]))
    for row, (left, right, low, high) in zip(found, [(0, 12, 2, 9), (5, 40, 7, 30)], strict=True):
        own = (lightness * inside)[low:high, left:right]
        assert row[0] == own.sum()
        assert row[3] == (own**2).sum()
        assert row[5] == inside[low:high, left:right].sum()
