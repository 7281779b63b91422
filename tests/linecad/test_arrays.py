"""What is true in a table."""

import numpy as np
import pytest

from linecad.arrays import true_places


@pytest.mark.parametrize("shape", [(0, 3), (3, 0), (1, 1), (4, 7)])
@pytest.mark.parametrize("share", [0.0, 0.3, 1.0])
def test_true_places_are_those_of_numpy(shape, share):
    table = np.random.default_rng(3).random(shape) < share
    np.testing.assert_array_equal(true_places(table), np.nonzero(table))
    np.testing.assert_array_equal(true_places(table.T), np.nonzero(table.T))
