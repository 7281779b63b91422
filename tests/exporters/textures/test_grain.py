"""The grain of a face goes on where something hides it, and nothing else than grain does."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from exporters.textures.grain import _largest_in, _mirrored, add_grain

WALL = np.array([150, 120, 100])
COURSE, JOINT = 6, 25  # texels between the joints of bricks, and how much darker these are
HEDGE = np.s_[150:, :]


def bricks(rows=240, columns=320):
    """A wall of courses with a dark frame of a window, and the foot of it hidden."""
    colours = np.tile(WALL, (rows, columns, 1)).astype(np.int16)
    colours[::COURSE] -= JOINT
    colours[40:110, 60:64] = colours[40:110, 116:120] = 250
    wanted = np.zeros((rows, columns), bool)
    wanted[HEDGE] = True
    colours[wanted] = (20, 200, 20)
    return colours.astype(np.uint8), wanted


def filled(colours, clear, wanted):
    filling = np.tile(WALL, (*wanted.shape, 1)).astype(np.uint8)
    add_grain(filling, colours, clear, wanted)
    return filling.astype(int)


def test_courses_go_on_behind_a_hedge_and_frames_of_windows_do_not():
    colours, wanted = bricks()
    filling = filled(colours, ~wanted, wanted)
    hidden = filling[HEDGE]
    assert (hidden == hidden[:, :1]).all()  # every row is even: no upright thing was taken
    rows = hidden[:, 0, 0]
    assert np.isclose((rows < rows.mean()).mean(), 1 / COURSE, atol=0.05)
    assert np.ptp(rows) == pytest.approx(JOINT, abs=2)
    assert np.abs(hidden.mean(axis=(0, 1)) - WALL).max() < 2  # about the colours that were asked for


def test_nothing_changes_where_nothing_is_hidden():
    colours, wanted = bricks()
    filling = filled(colours, ~wanted, wanted)
    assert (filling[~wanted] == WALL).all()


def test_a_face_without_an_even_square_gives_no_grain():
    colours, wanted = bricks()
    noise = np.random.default_rng(0).integers(0, 2, (30, 40, 3)) * 200
    colours[~wanted] = noise.repeat(8, 0).repeat(8, 1)[~wanted]
    assert (filled(colours, ~wanted, wanted) == WALL).all()


def test_a_strip_in_which_no_square_fits_gives_no_grain():
    colours, wanted = bricks(rows=180, columns=30)
    colours[:20:3] = 250  # a cornice at its top
    clear = ~wanted
    clear[:, 9:] = False  # as wide as what must be plain, but not as that with what is about it
    assert (filled(colours, clear, wanted) == WALL).all()


@pytest.mark.parametrize("shape", [(1, 1), (3, 200), (7, 7)])
def test_small_faces_stay_as_they_are(shape):
    colours = np.zeros((*shape, 3), np.uint8)
    wanted = np.zeros(shape, bool)
    wanted[-1] = True
    assert (filled(colours, ~wanted, wanted) == WALL).all()


def test_each_hidden_part_takes_the_grain_near_it():
    colours, wanted = bricks()
    wanted[:] = False
    colours[HEDGE] = colours[:90]
    colours[:, 160:] = np.where((np.arange(160) % 8 == 0)[None, :, None], WALL - JOINT, WALL)
    wanted[170:220, 40:80] = wanted[170:220, 250:290] = True
    filling = filled(colours, ~wanted, wanted)
    left, right = filling[170:220, 40:80, 0], filling[170:220, 250:290, 0]
    assert np.ptp(left, axis=1).max() == 0 < np.ptp(left, axis=0).max()  # courses on the left
    assert np.ptp(right, axis=0).max() == 0 < np.ptp(right, axis=1).max()  # boards on the right


@given(st.integers(-50, 50), st.integers(1, 60), st.integers(-50, 50), st.integers(1, 20))
def test_a_square_is_mirrored_at_its_edges(start, length, place, side):
    found = _mirrored(slice(start, start + length), place, side)
    assert ((found >= 0) & (found < side)).all()
    assert (np.abs(np.diff(found)) <= 1).all()  # so neighbours stay neighbours
    inside = np.arange(start, start + length)
    own = (inside >= place) & (inside < place + side)
    assert (found[own] == inside[own] - place).all()


@given(st.integers(1, 9), st.integers(1, 12), st.integers(1, 6), st.randoms(use_true_random=False))
def test_the_largest_in_squares_is_that_of_a_loop(rows, columns, side, random):
    values = np.array([[random.random() for _ in range(columns)] for _ in range(rows)])
    found = _largest_in(values, side)
    if side > min(rows, columns):
        assert found.size == 0
        return
    loop = [
        [values[row : row + side, column : column + side].max() for column in range(columns - side + 1)]
        for row in range(rows - side + 1)
    ]
    assert (found == np.array(loop)).all()
