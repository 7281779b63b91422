"""Tests of the areas that quadrilaterals share."""

import numpy as np
import pytest
import shapely

from linecad.model.openings.quads import shared_areas

SQUARE = np.array([[[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]]])


@pytest.mark.parametrize(
    ("shift", "shared"), [((0, 0), 16), ((1, 0), 12), ((4, 0), 0), ((9, 9), 0), ((-3, 2), 2), ((0, 4.5), 0)]
)
@pytest.mark.parametrize("turned", [1, -1])
def test_squares_share_what_both_cover(shift: tuple[float, float], shared: float, turned: int) -> None:
    found = shared_areas(SQUARE[:, ::turned], SQUARE + np.array(shift, float))
    assert found == pytest.approx([shared], abs=1e-7)


def test_what_lies_inside_is_shared_whole_either_way() -> None:
    inner = SQUARE / 4 + 1
    assert shared_areas(inner, SQUARE) == pytest.approx([1.0])
    assert shared_areas(SQUARE, inner) == pytest.approx([1.0])


def test_turned_quadrilaterals_share_as_exact_geometry_says() -> None:
    generator = np.random.default_rng(5)
    angle = np.sort(generator.uniform(0, 2 * np.pi, (2, 400, 4)), axis=2)
    ring = 1500 + 40 * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    ring += generator.uniform(-30, 30, (2, 400, 1, 2))
    one, other = (shapely.polygons(each) for each in ring)
    exact = shapely.area(shapely.intersection(one, other))
    assert (exact > 0).sum() > 100
    assert (exact == 0).sum() > 20
    assert shared_areas(*ring) == pytest.approx(exact, abs=1e-6)


def test_sides_that_lie_on_each_other_but_for_rounding_add_nothing() -> None:
    generator = np.random.default_rng(6)
    other = SQUARE + generator.uniform(-1e-12, 1e-12, (200, 4, 2)) + [4.0, 1.0]
    assert shared_areas(np.repeat(SQUARE, 200, axis=0), other).max() < 1e-7
    same = SQUARE + generator.uniform(-1e-12, 1e-12, (200, 4, 2))
    assert shared_areas(np.repeat(SQUARE, 200, axis=0), same) == pytest.approx(16.0)
