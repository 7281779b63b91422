"""Which axis of a frame is which, against frames that were renamed by hand."""

import numpy as np

from linecad.evaluation.frames import nearest_axes, true_axes
from linecad.geometry import rotation_about


def test_true_axes_are_those_that_the_found_ones_stand_for():
    true = rotation_about(np.array([0.2, -0.3, 0.4]))
    found = true[:, [2, 0, 1]]
    assert true_axes(found, true).tolist() == [2, 0, 1]


def test_nearest_axes_are_the_true_ones(made):
    axes = nearest_axes(made.noisy(0.3).ends, made.camera.matrix, made.frame.rotation)
    assert axes.tolist() == made.axis.tolist()
