"""What counts as an edge on a wall."""

import numpy as np
import pytest

from linecad.model.openings.raster import EDGE, TEXTURE, least_edge


@pytest.mark.parametrize(
    ("usual", "least"), [(0.0, EDGE[0]), (0.5, EDGE[0]), (3.0 / TEXTURE, 3.0), (6.0, EDGE[1])], ids=str
)
def test_fainter_edges_count_on_plainer_walls(usual, least):
    strong = np.full(40, 60.0)  # the edges themselves do not say how rough the wall is
    strength = np.concatenate([np.full(100, usual), strong]).astype(np.float32)
    assert least_edge(strength) == pytest.approx(least)


def test_a_wall_that_the_photo_does_not_show_is_plain():
    assert least_edge(np.zeros(0, np.float32)) == EDGE[0]
