"""How far segments lie off their directions, where there are several frames."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from linecad.camera.frame_mixture import Noise, Observed
from linecad.camera.joint_fit import student

UPRIGHT = np.array([0.0, 1.0, 0.0])
LEVEL = np.array([[1.0, 0.0, 0.0], [0.6, 0.0, 0.8]])
ENDS = np.array([[[100.0, 80.0], [160.0, 90.0]], [[700.0, 500.0], [640.0, 470.0]]])


def seen(noise):
    return Observed(ENDS, 1000.0, np.array([400.0, 300.0]), 800, 600, noise)


@given(st.floats(1.0, 20.0))
def test_a_density_sums_to_one(freedom):
    ratio = np.tan(np.linspace(-np.pi / 2, np.pi / 2, 20001)[1:-1])
    total = np.trapezoid(Noise(freedom, 1.0, 0.0, UPRIGHT).density(ratio), ratio)
    assert total == pytest.approx(1.0, abs=1e-3)


def test_one_degree_of_freedom_is_the_noise_of_the_camera():
    ratio = np.linspace(-10, 10, 101)
    assert_allclose(Noise(1.0, 1.0, 0.0, UPRIGHT).density(ratio), student(ratio))
    assert_allclose(seen(Noise(1.0, 1.0, 0.0, UPRIGHT)).density(LEVEL), seen(None).density(LEVEL))


def test_more_degrees_of_freedom_have_shorter_tails():
    few, many = (Noise(freedom, 1.0, 0.0, UPRIGHT).density(np.array([5.0])) for freedom in (1.0, 4.0))
    assert many < few / 2


def test_walls_off_their_frame_widen_level_directions_and_not_the_upright():
    plain, off = seen(Noise(4.0, 1.0, 0.0, UPRIGHT)), seen(Noise(4.0, 1.0, np.radians(0.5), UPRIGHT))
    directions = np.vstack([UPRIGHT, LEVEL])
    narrow, wide = (each.scale(each.against(directions), directions) for each in (plain, off))
    assert_allclose(wide[0], narrow[0])
    assert (wide[1:] > narrow[1:]).all()
    turn = np.radians(1e-3)  # a turn about the upright moves the angle by as much as the scale says
    x, z = LEVEL[:, 0], LEVEL[:, 2]
    turned = np.column_stack([x * np.cos(turn) + z * np.sin(turn), 0 * x, z * np.cos(turn) - x * np.sin(turn)])
    slope = (plain.against(turned).sine - plain.against(LEVEL).sine) / turn
    assert_allclose(wide[1:] ** 2 - narrow[1:] ** 2, (np.radians(0.5) * slope) ** 2, rtol=0.01, atol=1e-12)
