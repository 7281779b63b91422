"""What counts as an edge on a wall."""

import cv2
import numpy as np
import pytest

from linecad.model.openings.raster import EDGE, TEXTURE, _thin, least_edge, look


@pytest.mark.parametrize(
    ("usual", "least"), [(0.0, EDGE[0]), (0.5, EDGE[0]), (3.0 / TEXTURE, 3.0), (6.0, EDGE[1])], ids=str
)
def test_fainter_edges_count_on_plainer_walls(usual, least):
    strong = np.full(40, 60.0)  # the edges themselves do not say how rough the wall is
    strength = np.concatenate([np.full(100, usual), strong]).astype(np.float32)
    assert least_edge(strength) == pytest.approx(least)


def test_a_wall_that_the_photo_does_not_show_is_plain():
    assert least_edge(np.zeros(0, np.float32)) == EDGE[0]


def painted(*colours):
    """Stripes of 20 px of these L*, a*, b* as bytes, side by side."""
    stripes = np.repeat(np.array(colours, np.uint8)[None], 20, axis=1)
    return cv2.cvtColor(np.repeat(stripes, 40, axis=0), cv2.COLOR_LAB2RGB)


def steepest(pixels):
    """The gradient of the middle of its height that is steepest, x and y."""
    along = look(pixels).gradient[20]
    return along[np.linalg.norm(along, axis=1).argmax()]


def test_colours_as_light_as_the_wall_have_edges_too():
    beige, blue = (200, 130, 142), (200, 126, 118)
    grey = cv2.cvtColor(painted(beige, blue), cv2.COLOR_RGB2GRAY).astype(int)
    assert np.ptp(grey[20]) <= 8  # hardly an edge to who sees no colours
    across, along = steepest(painted(beige, blue))
    assert -across > 2 * EDGE[1]  # b* falls by 24
    assert along == 0


def test_where_lightness_changes_more_colour_adds_nothing():
    plain, tinted = painted((200, 128, 128), (150, 128, 128)), painted((200, 128, 134), (150, 128, 128))
    assert steepest(tinted)[0] == pytest.approx(steepest(plain)[0], rel=0.05)


@pytest.mark.parametrize("across", [0, 1])
def test_an_edge_at_one_end_of_a_wall_does_not_hide_one_at_the_other(across):
    strength = np.zeros((7, 7), np.float32)
    strength[3, :] = [5.0, 0.0, 2.0, 3.0, 2.5, 0.0, 9.0]
    thin = _thin(strength if across == 1 else strength.T, across, np.float32(1.0))
    shown = thin if across == 1 else thin.T
    assert shown[3].tolist() == [True, False, False, True, False, False, True]
    assert not np.delete(shown, 3, axis=0).any()


@pytest.mark.parametrize(("width", "scale"), [(320, 2.0), (640, 2.0), (1000, 1.28), (1280, 1.0), (2560, 0.5)])
def test_photos_are_looked_at_in_one_size_but_for_tiny_ones(width, scale):
    sight = look(np.zeros((width // 2, width, 3), np.uint8))
    assert sight.scale == pytest.approx(scale)
    assert sight.colours.shape == (*sight.gradient.shape[:2], 3)
    assert sight.gradient.shape[:2] == (round(scale * (width // 2)), round(scale * width))


def test_an_edge_is_as_steep_in_a_photo_that_is_made_larger():
    """A soft one: a sharp one is blurred by less where pixels are more."""
    small = cv2.GaussianBlur(painted((200, 128, 128), (150, 128, 128)), (0, 0), 2.5)
    wide = np.pad(small, ((0, 0), (0, 1280 - small.shape[1]), (0, 0)), mode="edge")
    across, along = look(wide).gradient[20, :40].T
    larger = look(small)
    assert larger.scale == 2.0
    twice = larger.gradient[40]
    assert np.abs(across).max() > 5
    assert np.abs(twice[:, 0]).max() == pytest.approx(np.abs(across).max(), rel=0.1)
    assert np.abs(along).max() == pytest.approx(np.abs(twice[:, 1]).max(), abs=0.1)
