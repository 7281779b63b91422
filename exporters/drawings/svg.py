"""SVG 1.1, a user unit a millimetre: https://www.w3.org/TR/SVG11/

Every layer is a group that Inkscape shows as a layer, with its photo as JPEG in the lowest. Text is text.
"""

import base64
from pathlib import Path
from xml.sax.saxutils import escape, quoteattr

from exporters.beside import Names
from exporters.colours import RGB
from exporters.drawings.fonts import FAMILY
from exporters.drawings.records import PHOTO, PHOTO_OPACITY, Drawing, Label, Picture, Stroke
from exporters.drawings.writers import layers_on_paper
from exporters.textures.build import jpeg_of

_DASHES = "2 1"  # mm, of what is a guess


def write(drawing: Drawing, path: Path, _names: Names | None) -> None:
    """Write the drawing to `path`; OSError where that fails."""
    path.write_text("\n".join(_lines(drawing)) + "\n", encoding="utf-8", newline="\n")


def _lines(drawing: Drawing) -> list[str]:
    width, height = drawing.paper.width, drawing.paper.height
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        '<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" '
        'xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape" version="1.1" '
        f'width="{width:g}mm" height="{height:g}mm" viewBox="0 0 {width:g} {height:g}">',
        f"<title>{escape(f'{drawing.title}, {drawing.photo}')}</title>",
        f"<desc>{escape(drawing.unit_note)}</desc>",
        f'<rect width="{width:g}" height="{height:g}" fill="#ffffff"/>',
    ]
    if drawing.picture is not None:
        lines += [_group(PHOTO.name), _image(drawing, drawing.picture), "</g>"]
    for layer, strokes, labels in layers_on_paper(drawing):
        lines.append(_group(layer.name))
        lines += [_path(stroke, height) for stroke in strokes]
        lines += [_text(label, height) for label in labels]
        lines.append("</g>")
    return [*lines, "</svg>"]


def _group(name: str) -> str:
    return f'<g id="{name}" inkscape:groupmode="layer" inkscape:label="{name.lower()}">'


def _image(drawing: Drawing, picture: Picture) -> str:
    view = drawing.view
    (x, y), (width, height) = view.to_paper_of(picture.left, picture.top), picture.size
    data = base64.b64encode(jpeg_of(picture.pixels)).decode("ascii")
    return (
        f'<image x="{_n(x)}" y="{_n(drawing.paper.height - y)}" width="{_n(width * view.scale)}" '
        f'height="{_n(height * view.scale)}" preserveAspectRatio="none" opacity="{PHOTO_OPACITY:g}" '
        f'xlink:href="data:image/jpeg;base64,{data}"/>'
    )


def _path(stroke: Stroke, height: float) -> str:
    places = "L".join(f"{_n(x)} {_n(height - y)}" for x, y in stroke.points.tolist())
    colour = _hex(stroke.layer.colour)
    style = f'fill="{colour if stroke.is_filled else "none"}" stroke="{colour}" stroke-width="{stroke.layer.pen:g}"'
    dashes = f' stroke-dasharray="{_DASHES}"' if stroke.layer.is_dashed else ' stroke-linecap="round"'
    return f'<path d="M{places}{"Z" if stroke.is_closed else ""}" {style}{dashes}/>'


def _text(label: Label, height: float) -> str:
    x, y = _n(label.x), _n(height - label.y)
    turn = f' transform="rotate(-90 {x} {y})"' if label.is_upright else ""
    anchor = "" if label.anchor == "start" else f' text-anchor="{label.anchor}"'
    return (
        f'<text x="{x}" y="{y}" font-family={quoteattr(FAMILY)} font-size="{label.size:g}"{anchor}{turn} '
        f'fill="{_hex(label.layer.colour)}" xml:space="preserve">{escape(label.text)}</text>'
    )


def _hex(colour: RGB) -> str:
    return "#" + "".join(f"{round(255 * value):02x}" for value in colour)


def _n(value: float) -> str:
    """A number of mm to a hundredth of a micrometre, as short as it goes."""
    text = f"{value:.5f}".rstrip("0").rstrip(".")
    return "0" if text in ("-0", "") else text
