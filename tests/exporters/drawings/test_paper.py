import pytest
from hypothesis import given
from hypothesis import strategies as st

from exporters.drawings.paper import Borders, fit, read_scale
from exporters.drawings.sheet import BORDERS
from exporters.drawings.sizes import FIT, SCALES, SIZES
from linecad.errors import OutputError

sizes = st.tuples(st.floats(0.5, 300), st.floats(0.5, 300))


def room(paper):
    return paper.width - BORDERS.left - BORDERS.right, paper.height - BORDERS.top - BORDERS.bottom


@given(sizes, st.sampled_from([*SIZES, FIT]))
def test_without_a_scale_the_largest_usual_one_is_taken_that_fits(size, name):
    found = fit(size, BORDERS, name, FIT, is_metric=True)
    assert found.paper.name == ("A3" if name == FIT else name)
    assert found.scale == 1000 / found.denominator
    width, height = room(found.paper)
    assert size[0] * found.scale <= width
    assert size[1] * found.scale <= height
    lying = SIZES[found.paper.name]
    for larger in (each for each in SCALES if each < found.denominator):
        for across, down in (lying, lying[::-1]):
            wide, high = across - BORDERS.left - BORDERS.right, down - BORDERS.top - BORDERS.bottom
            assert size[0] * 1000 / larger > wide or size[1] * 1000 / larger > high


@given(sizes, st.sampled_from(SCALES))
def test_a_scale_takes_the_smallest_paper_that_it_fits_on_or_says_which_scale_fits(size, wanted):
    fits = {
        name: any(
            size[0] * 1000 / wanted <= w - BORDERS.left - BORDERS.right
            and size[1] * 1000 / wanted <= h - BORDERS.top - BORDERS.bottom
            for w, h in (SIZES[name], SIZES[name][::-1])
        )
        for name in SIZES
    }
    if any(fits.values()):
        assert fit(size, BORDERS, FIT, f"1:{wanted}", is_metric=True).paper.name == next(n for n in fits if fits[n])
        return
    with pytest.raises(OutputError, match=f"at 1:{wanted} does not fit on A0; 1:(\\d+) does") as caught:
        fit(size, BORDERS, FIT, f"1:{wanted}", is_metric=True)
    other = str(caught.value).split("; 1:")[1].split(" ")[0]
    assert fit(size, BORDERS, "A0", f"1:{other}", is_metric=True).denominator == int(other) > wanted


def test_a_scale_that_does_not_fit_on_the_chosen_paper_names_a_larger_one():
    with pytest.raises(OutputError) as caught:
        fit((10.0, 5.0), BORDERS, "A4", "1:25", is_metric=True)
    assert str(caught.value) == "10.00 x 5.00 m at 1:25 does not fit on A4; 1:50 does, or --paper A2"


@given(sizes)
def test_without_a_known_length_the_drawing_fills_its_sheet(size):
    found = fit(size, BORDERS, FIT, FIT, is_metric=False)
    width, height = room(found.paper)
    filled = max(size[0] * found.scale / width, size[1] * found.scale / height)
    assert 0.99 < filled < 1
    assert found.denominator is None


def test_a_scale_needs_a_known_length():
    with pytest.raises(OutputError, match="1:50 needs a known length, and the scene has none"):
        fit((1.0, 1.0), BORDERS, FIT, "1:50", is_metric=False)


@pytest.mark.parametrize("text", ["", "50", "1:0", "1:-5", "2:1", "1:50.5", "1:1000000", "1:\u0665", "1:50 "])
def test_what_is_no_scale_is_refused(text):
    with pytest.raises(OutputError, match="expected one like 1:50"):
        read_scale(text)


def test_paper_stands_where_that_gives_a_larger_scale():
    found = fit((5.0, 30.0), Borders(10, 10, 10, 10), "A3", FIT, is_metric=True)
    assert (found.paper.width, found.paper.height) == (297, 420)
