"""PDF, read back by pypdf: the page is the paper, text is text, every layer can be switched."""

import numpy as np
import pytest
from pypdf import PdfReader
from pypdf.generic import ContentStream

from exporters.formats import export

POINTS = 72 / 25.4


@pytest.fixture(scope="module")
def reader(facade, marked, tmp_path_factory):
    path = tmp_path_factory.mktemp("pdf") / "a.elevation.pdf"
    export(facade, path, marked, {"drawing-scale": "1:50"})
    return PdfReader(path, strict=True)


def strokes(reader):
    """Ends of strokes of two points, in mm, by layer."""
    page = reader.pages[0]
    names = {key: reference.get_object()["/Name"] for key, reference in page["/Resources"]["/Properties"].items()}
    found, layer, start, scale = {}, "", None, None
    for operands, operator in ContentStream(page.get_contents(), reader).operations:
        match operator:
            case b"cm" if scale is None:
                scale = float(operands[0]) / POINTS  # mm of a user unit
            case b"BDC":
                layer = names[operands[1]]
            case b"m":
                start = [float(each) for each in operands]
            case b"l":
                found.setdefault(layer, []).append([start, [float(each) for each in operands]])
    return {name: np.array(ends) * scale for name, ends in found.items()}


def test_the_page_is_as_large_as_the_paper(reader):
    box = reader.pages[0].mediabox
    assert np.allclose([float(box.width) / POINTS, float(box.height) / POINTS], [420, 297], atol=1e-4)
    assert len(reader.pages) == 1


def test_windows_are_to_scale(reader):
    ends = strokes(reader)["openings"]
    lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    assert np.allclose(sorted(lengths), [1200 / 50] * 6 + [1600 / 50] * 6, atol=1e-3)


def test_text_is_text(reader):
    text = reader.pages[0].extract_text()
    for part in (
        "Elevation of facade 0 (plane 11)",
        "Scale: 1:50 on A3",
        "12.00",
        "4.80",
        "±0.00",
        "lengths are in metres",
    ):
        assert part in text


def test_what_the_font_lacks_is_a_question_mark_on_the_page_and_whole_in_the_title(reader):
    assert "Photo: Hauschen ?.jpg" in reader.pages[0].extract_text()
    assert reader.metadata.title == "Elevation of facade 0 (plane 11), Häuschen 家.jpg"


def test_every_layer_is_an_optional_content_group(reader):
    groups = reader.trailer["/Root"]["/OCProperties"]["/OCGs"]
    names = [group.get_object()["/Name"] for group in groups]
    assert names[0] == "photo"
    assert {"openings", "outlines", "dimensions", "ground", "sheet"} <= set(names)


def test_the_photo_is_there_with_its_pixels(reader):
    (image,) = reader.pages[0].images
    width, height = image.image.size
    assert width == int(np.ceil(((12 + 2 * 0.08 * 12) * 1000 / 50) / 25.4 * 200))
    assert height > 0


def test_texts_are_centred_by_the_widths_that_the_font_has(reader):
    font = reader.pages[0]["/Resources"]["/Font"]["/F"]
    assert font["/FontDescriptor"]["/FontFile2"].get_data()[:4] == b"\x00\x01\x00\x00"  # a TrueType font
    widths = font["/Widths"]
    assert len(widths) == 256 - 32
    assert 200 < float(widths[ord("i") - 32]) < float(widths[ord("W") - 32]) < 1200


def test_windows_lie_where_the_view_puts_them(reader, drawing):
    """From the lower left corner of the page, y up."""
    found = {tuple(point) for ends in strokes(reader)["openings"].tolist() for point in np.round(ends, 3).tolist()}
    corners = np.array([(x + a, 4.8 + b) for x in (1.5, 4.8, 8.4) for a in (0, 1.2) for b in (0, 1.6)])
    placed = drawing.view.to_paper(corners)
    for point in placed:
        assert min(np.abs(np.subtract(other, point)).max() for other in found) < 2e-3
    assert len(found) == len(placed)
