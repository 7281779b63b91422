"""TIFF, read back by Pillow: what the photo shows lies on the lines of the drawing."""

import numpy as np
import pytest
from PIL import Image

from exporters.formats import export
from linecad.errors import OutputError

MARKS = [(0.5, 0.5), (11.5, 0.5), (11.5, 7.5), (0.5, 7.5)]  # as the photo has them
MARK = 0.4


@pytest.fixture(scope="module")
def path(facade, marked, tmp_path_factory):
    path = tmp_path_factory.mktemp("tif") / "a.elevation.tif"
    export(facade, path, marked, {"drawing-scale": "1:50"})
    return path


def to_pixels(path, x, y):
    """Column and row, counted from the centre of the first, by the world file alone."""
    step_x, turn_a, turn_b, step_y, left, top = map(float, path.with_name("a.elevation.tifw").read_text().split())
    assert turn_a == turn_b == 0
    return (x - left) / step_x, (y - top) / step_y


@pytest.mark.parametrize("mark", MARKS)
def test_a_square_on_the_wall_is_where_the_drawing_has_it_within_a_pixel(path, mark):
    with Image.open(path) as image:
        grey = np.asarray(image.convert("L"), float)
    column, row = to_pixels(path, *mark)
    half = MARK / 2 / (25.4 / 200 / 20)  # px
    reach = int(2 * half)
    x, y = round(column), round(row)
    dark = grey[y - reach : y + reach + 1, x - reach : x + reach + 1] < 115
    rows, columns = np.nonzero(dark)
    for found, centre in ((columns + x - reach, column), (rows + y - reach, row)):
        assert abs(found.min() - (centre - half)) <= 1
        assert abs(found.max() - (centre + half)) <= 1
        assert abs(found.mean() - centre) <= 0.5
    assert abs(dark.sum() - (2 * half) ** 2) < 4 * 2 * half


def test_its_resolution_prints_it_at_scale(path):
    with Image.open(path) as image:
        assert image.info["dpi"] == (200, 200)
        width = image.width / 200 * 25.4  # mm on the paper
    assert abs(width - (12 + 2 * 0.08 * 12) * 1000 / 50) < 25.4 / 200


def test_dpi_is_a_choice(facade, marked, tmp_path):
    export(facade, tmp_path / "a.elevation.tif", marked, {"drawing-scale": "1:50", "dpi": 72})
    with Image.open(tmp_path / "a.elevation.tif") as image:
        assert image.info["dpi"] == (72, 72)


def test_what_no_photo_shows_is_white(path):
    with Image.open(path) as image:
        assert image.getpixel((0, 0)) == (255, 255, 255)
        assert image.getpixel((image.width - 1, 0)) == (255, 255, 255)


def test_the_world_file_has_the_name_of_the_picture_whatever_it_is(facade, marked, tmp_path):
    export(facade, tmp_path / "my 'front'.elevation.tif", marked)
    assert (tmp_path / "my 'front'.elevation.tifw").is_file()


def test_it_needs_the_photo(facade, tmp_path):
    with pytest.raises(OutputError, match="no photo is at hand; name it with --photo"):
        export(facade, tmp_path / "a.elevation.tif")
    assert list(tmp_path.iterdir()) == []


def test_too_many_pixels_are_refused_with_a_resolution_that_fits(facade, marked, tmp_path):
    chosen = {"drawing-scale": "1:20", "paper": "A0"}
    with pytest.raises(OutputError, match=r"at 1200 dpi .* too many; --option dpi=(\d+) does") as caught:
        export(facade, tmp_path / "a.elevation.tif", marked, chosen | {"dpi": 1200})
    assert 100 < int(str(caught.value).split("dpi=")[1].split(" ")[0]) < 1200
