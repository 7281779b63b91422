import pytest

from exporters.colours import line_colour, linear


def test_x_is_red_y_green_and_z_blue():
    for axis in range(3):
        assert max(range(3), key=line_colour(axis, True).__getitem__) == axis


def test_lines_that_are_no_boundary_are_paler():
    for axis in range(3):
        assert min(line_colour(axis, False)) > min(line_colour(axis, True)) + 0.3


def test_all_six_colours_differ():
    assert len({line_colour(axis, boundary) for axis in range(3) for boundary in (True, False)}) == 6


@pytest.mark.parametrize(("srgb", "light"), [(0.0, 0.0), (0.04, 0.0030960), (0.5, 0.2140411), (1.0, 1.0)])
def test_linear_light_follows_the_standard(srgb, light):
    assert linear((srgb, srgb, srgb)) == pytest.approx((light,) * 3, abs=1e-7)
