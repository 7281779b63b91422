"""Panes behind a wall tell how deep they are by where the photo shows them; painted ones tell nothing."""

import numpy as np
import pytest

from linecad.model.openings import recess
from linecad.model.openings.raster import Raster
from linecad.model.openings.recess import depth_ratios

WALL, REVEAL, FRAME, GLASS = 190, 150, 235, 60
WIDE, TALL = 1.2, 1.8
STEP = 0.02  # units between columns and rows; the wall is at 10
STARTS = np.array([4.0, 6.5, 9.0, 11.5])


def lightness_of(u, start, ratio):
    """What the wall at 10 shows at places u (C,) in a window that starts at `start` and is deeper by ratio."""
    side = 1.0 if start > 0 else -1.0
    across = u * (1 + ratio) - start  # on the pane
    in_frame = np.minimum(np.abs(across), np.abs(WIDE - across)) < 0.1
    in_bar = np.abs(across - WIDE / 2) < 0.05
    shown = np.where(in_frame | in_bar, FRAME, GLASS)
    past = across > WIDE if side > 0 else across < 0
    return np.where(past, REVEAL, shown)


def raster_of(starts, ratio):
    """A wall with windows, edges where its lightness changes."""
    u = np.arange(min(starts) - 1.5, max(starts) + WIDE + 1.5, STEP)
    v = np.arange(-0.5, TALL + 0.5, STEP)
    row = np.full(len(u), WALL, float)
    for start in starts:
        inside = (u > start) & (u < start + WIDE)
        row[inside] = lightness_of(u[inside], start, ratio)
    edge = np.abs(np.diff(row, prepend=row[0])) > 10
    within = (v > 0) & (v < TALL)
    colours = np.full((len(v), len(u), 3), WALL, np.uint8)
    colours[within] = row[None, :, None]
    shape = colours.shape[:2]
    return Raster(u, v, colours, np.ones(shape, bool), edge & within[:, None], np.zeros(shape, bool))


def boxes(starts, change=(0.0, 0.0)):
    """Where windows that start there were found, each side changed."""
    return np.array([[start + change[0], start + WIDE + change[1], 0.0, TALL] for start in starts])


@pytest.mark.parametrize("ratio", [0.0075, 0.012, 0.018])
def test_panes_of_equal_windows_tell_one_depth(ratio):
    found = depth_ratios(raster_of(STARTS, ratio), boxes(STARTS))
    assert np.ptp(found) == 0
    assert found[0] == pytest.approx(ratio, rel=0.12)


def test_on_the_other_side_of_the_camera_too():
    starts = -STARTS[::-1] - WIDE
    found = depth_ratios(raster_of(starts, 0.012), boxes(starts))
    assert found == pytest.approx(0.012, rel=0.12)


def test_windows_painted_on_the_wall_tell_nothing():
    assert np.isnan(depth_ratios(raster_of(STARTS, 0.0), boxes(STARTS))).all()


def test_pane_before_the_wall_tells_nothing():
    assert np.isnan(depth_ratios(raster_of(STARTS, -0.012), boxes(STARTS))).all()


def test_bare_wall_tells_nothing():
    raster = raster_of(STARTS, 0.012)
    raster.colours[:] = WALL
    assert np.isnan(depth_ratios(raster, boxes(STARTS))).all()


def test_one_window_alone_tells_nothing():
    assert np.isnan(depth_ratios(raster_of(STARTS[:1], 0.012), boxes(STARTS[:1]))).all()


def test_windows_of_another_size_tell_for_themselves():
    box = np.concatenate([boxes(STARTS), [[4.0, 5.2, 0.0, 0.9]]])
    found = depth_ratios(raster_of(STARTS, 0.012), box)
    assert found[:4] == pytest.approx(0.012, rel=0.12)
    assert np.isnan(found[4])


def test_no_windows_tell_nothing():
    assert depth_ratios(raster_of(STARTS, 0.012), np.zeros((0, 4))).shape == (0,)


def test_hole_that_was_found_too_small_tells_the_same():
    found = depth_ratios(raster_of(STARTS, 0.012), boxes(STARTS, (0.05, -0.05)))
    assert found == pytest.approx(0.012, rel=0.2)


@pytest.mark.parametrize("starts", [STARTS, -STARTS[::-1] - WIDE])
def test_holes_are_tried_larger_on_both_sides(starts, monkeypatch):
    # With shifts both ways a wrong sign is no other set of holes; outwards alone it is.
    monkeypatch.setattr(recess, "SHIFTS", np.array([0.0, 0.04, 0.09]))
    raster = raster_of(starts, 0.012)
    assert depth_ratios(raster, boxes(starts, (0.05, -0.05))) == pytest.approx(0.012, rel=0.2)
    assert np.isnan(depth_ratios(raster, boxes(starts, (-0.05, 0.05)))).all()


def test_what_fits_before_the_wall_as_well_tells_nothing(monkeypatch):
    raster, box = raster_of(STARTS, 0.012), boxes(STARTS)
    monkeypatch.setattr(recess, "BETTER", 9.0)
    assert np.isnan(depth_ratios(raster, box)).all()
