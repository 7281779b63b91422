"""SVG, read back as XML: a user unit is a millimetre on the paper."""

import base64
import re
from io import BytesIO
from xml.etree import ElementTree

import numpy as np
import pytest
from PIL import Image

from exporters.formats import export

SVG = "{http://www.w3.org/2000/svg}"
LABEL = "{http://www.inkscape.org/namespaces/inkscape}label"
HREF = "{http://www.w3.org/1999/xlink}href"


@pytest.fixture(scope="module")
def root(facade, marked, tmp_path_factory):
    path = tmp_path_factory.mktemp("svg") / "a.elevation.svg"
    export(facade, path, marked, {"drawing-scale": "1:50"})
    return ElementTree.parse(path).getroot()


def layer(root, name):
    return next(group for group in root.iter(f"{SVG}g") if group.get(LABEL) == name)


def points(path):
    return np.array([[float(n) for n in pair.split()] for pair in re.split("[MLZ]", path.get("d")) if pair])


def test_the_page_is_as_large_as_the_paper(root):
    assert (root.get("width"), root.get("height"), root.get("viewBox")) == ("420mm", "297mm", "0 0 420 297")


def test_windows_are_to_scale(root):
    ends = np.array([points(path) for path in layer(root, "openings")])
    assert ends.shape == (12, 2, 2)
    lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    assert np.allclose(sorted(lengths), [1200 / 50] * 6 + [1600 / 50] * 6, atol=1e-4)


def test_text_is_text(root):
    texts = [text.text for text in root.iter(f"{SVG}text")]
    assert {"12.00", "8.00", "Scale: 1:50 on A3", "Elevation of facade 0 (plane 11)"} <= set(texts)
    assert any(text.startswith("Photo: H") for text in texts)


def test_the_photo_lies_beneath_on_a_layer_of_its_own_and_covers_the_view(root):
    assert root.findall(f"{SVG}g")[0].get(LABEL) == "photo"
    (image,) = layer(root, "photo")
    kind, _, data = image.get(HREF).partition(",")
    assert kind == "data:image/jpeg;base64"
    with Image.open(BytesIO(base64.b64decode(data))) as picture:
        for side, pixels in zip(("width", "height"), picture.size, strict=True):
            assert np.isclose(float(image.get(side)), pixels * 25.4 / 200, atol=1e-4)


def test_layers_have_pens(root):
    widths = {path.get("stroke-width") for path in layer(root, "outlines")}
    assert widths == {"0.35"}
    assert {path.get("stroke-width") for path in layer(root, "openings")} == {"0.25"}


def test_without_a_photo_the_layer_is_not_there(facade, tmp_path):
    export(facade, tmp_path / "a.elevation.svg")
    root = ElementTree.parse(tmp_path / "a.elevation.svg").getroot()
    assert "photo" not in [group.get(LABEL) for group in root.iter(f"{SVG}g")]
    assert any("no photo lies beneath" in text.text for text in root.iter(f"{SVG}text"))


def test_windows_lie_where_the_view_puts_them(root, drawing):
    """From the upper left corner of the page, y down."""
    found = {tuple(point) for path in layer(root, "openings") for point in points(path).round(3).tolist()}
    corners = np.array([(x + a, 4.8 + b) for x in (1.5, 4.8, 8.4) for a in (0, 1.2) for b in (0, 1.6)])
    placed = drawing.view.to_paper(corners) * [1, -1] + [0, 297]
    assert found == {tuple(point) for point in placed.round(3).tolist()}
    (image,) = layer(root, "photo")
    assert np.isclose(float(image.get("x")), drawing.view.corner[0], atol=1e-4)
    assert np.isclose(float(image.get("y")), 297 - drawing.view.corner[1] - drawing.view.size[1], atol=1e-4)
