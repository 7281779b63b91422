"""Streaks of a face that is seen at a flat angle go, and what is seen well stays."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from exporters.textures.smear import STREAKED, WHOLLY_STREAKED, streaks, without_streaks

SIZE = (160, 120)  # columns, rows


def floor(tilt, focal=300.0):
    """From texels of a floor, that are a hundredth of its camera's height, to the photo; far rows first."""
    texel = 0.01
    return np.array(
        [[focal * texel, 0.0, -focal * texel * SIZE[0] / 2], [0.0, 0.0, focal], [0.0, -texel, texel * SIZE[1] + tilt]]
    )


@given(st.floats(0.5, 20.0))
def test_a_streak_is_as_long_as_the_derivative_says(tilt):
    to_photo = floor(tilt)
    length = streaks(to_photo, SIZE)
    column, row = 83.5, 59.5  # the middle of a square, where nothing is interpolated
    at = np.array([column, row])

    def pixel(texel):
        u, v, w = to_photo @ np.array([*texel, 1.0])
        return np.array([u / w, v / w])

    step = 1e-4
    slopes = np.stack([(pixel(at + step * d) - pixel(at - step * d)) / (2 * step) for d in np.eye(2)], axis=1)
    assert length[int(row), int(column)] == pytest.approx(1 / np.linalg.svd(slopes)[1][1], rel=0.02)


def test_behind_the_camera_nothing_is_long():
    length = streaks(np.diag([1.0, 1.0, -1.0]), SIZE)
    assert length.shape == SIZE[::-1]
    assert (length == 0).all()


def test_what_is_seen_well_stays_and_streaks_go():
    rng = np.random.default_rng(0)
    colours = rng.integers(100, 140, (*SIZE[::-1], 1)).repeat(3, axis=2).astype(np.uint8)
    colours[:60] = (np.arange(SIZE[0]) % 2 * 40 + 100)[None, :, None]  # streaks along the rows' columns
    length = np.where(np.arange(SIZE[1])[:, None] < 60, WHOLLY_STREAKED, STREAKED).astype(np.float32)
    length = np.broadcast_to(length, SIZE[::-1]).copy()
    before = colours.copy()
    without_streaks(colours, np.ones(length.shape, bool), length)
    assert (colours[60:] == before[60:]).all()
    across = colours[:50].astype(float).mean(axis=0)[:, 0]
    assert np.ptp(across) < 20 < np.ptp(before[:50].astype(float).mean(axis=0)[:, 0])
    assert colours[:50].std() == pytest.approx(before[60:].std(), rel=0.5)  # with the grain of what is seen well


def test_unknown_texels_are_not_spread():
    colours = np.full((*SIZE[::-1], 3), 120, np.uint8)
    known = np.ones(SIZE[::-1], bool)
    known[:, :40] = False
    colours[~known] = 255
    without_streaks(colours, known, np.full(known.shape, WHOLLY_STREAKED, np.float32))
    assert (colours[known] == 120).all()
    assert (colours[~known] == 255).all()
