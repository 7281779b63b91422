"""PDF 1.7, one page at scale: https://www.iso.org/standard/51502.html

Every layer is an optional content group, which viewers list and switch off. Text is text, in the font of
exporters.drawings.fonts, which the file holds.
"""

import hashlib
import zlib
from dataclasses import dataclass, field
from pathlib import Path

from exporters.beside import Names
from exporters.drawings.fonts import font_file, width_of
from exporters.drawings.photo import INCH
from exporters.drawings.records import CAPITALS, PHOTO, PHOTO_OPACITY, Drawing, Label, Picture, Stroke
from exporters.drawings.writers import layers_on_paper
from exporters.textures.build import jpeg_of

_POINTS = 72 / INCH  # a mm
_ENCODING = "cp1252"  # Python's name of WinAnsiEncoding
_FIRST, _LAST = 32, 255  # its codes with glyphs
_DASHES = "[2 1] 0 d"  # mm, of what is a guess


@dataclass
class _File:
    """The numbered objects of a file that is being made; the first is number 1."""

    objects: list[bytes] = field(default_factory=list)

    def add(self, body: str) -> str:
        """Add an object; a reference to it."""
        self.objects.append(body.encode("latin-1"))
        return f"{len(self.objects)} 0 R"

    def add_stream(self, keys: str, data: bytes) -> str:
        """Add a stream with its dictionary; a reference to it."""
        self.objects.append(f"<< {keys} /Length {len(data)} >>\nstream\n".encode("latin-1") + data + b"\nendstream")
        return f"{len(self.objects)} 0 R"

    def finished(self, root: str, info: str) -> bytes:
        """The whole file."""
        parts, places, length = [b"%PDF-1.7\n%\xe2\xe3\xcf\xd3\n"], [], 0
        for number, body in enumerate(self.objects, start=1):
            length += len(parts[-1])
            places.append(length)
            parts.append(f"{number} 0 obj\n".encode() + body + b"\nendobj\n")
        start = length + len(parts[-1])
        digest = hashlib.sha256(b"".join(parts)).hexdigest()[:32]
        table = "".join(f"{place:010d} 00000 n \n" for place in places)
        count = len(self.objects) + 1
        trailer = f"<< /Size {count} /Root {root} /Info {info} /ID [<{digest}> <{digest}>] >>"
        end = f"xref\n0 {count}\n0000000000 65535 f \n{table}trailer\n{trailer}\nstartxref\n{start}\n%%EOF\n"
        return b"".join([*parts, end.encode()])


def write(drawing: Drawing, path: Path, _names: Names | None) -> None:
    """Write the drawing to `path`; OSError where that fails."""
    file = _File()
    names: list[str] = []  # of layers
    content = [f"{_n(_POINTS)} 0 0 {_n(_POINTS)} 0 0 cm"]  # from here on in mm
    images = ""
    if drawing.picture is not None:
        images = f"/XObject << /Photo {_image(file, drawing.picture)} >>"
        content += [_begin(names, PHOTO.name), *_placed(drawing, drawing.picture), "EMC"]
    for layer, strokes, labels in layers_on_paper(drawing):
        content.append(_begin(names, layer.name))
        for stroke in strokes:
            content += _stroke(stroke)
        content += [_text(label) for label in labels]
        content.append("EMC")
    groups = [file.add(f"<< /Type /OCG /Name ({name.lower()}) >>") for name in names]
    page = file.add_stream("/Filter /FlateDecode", zlib.compress("\n".join(content).encode("latin-1"), 9))
    root = _page(file, drawing, page, groups, f"{images} /Font << /F {_font(file)} >>")
    title, subject = _string(f"{drawing.title}, {drawing.photo}"), _string(drawing.unit_note)
    info = file.add(f"<< /Title {title} /Subject {subject} /Creator (linecad) >>")
    path.write_bytes(file.finished(root, info))


def _page(file: _File, drawing: Drawing, content: str, groups: list[str], resources: str) -> str:
    """Add the page with what leads to it; a reference to the root."""
    properties = " ".join(f"/L{number} {group}" for number, group in enumerate(groups))
    states = f"/ExtGState << /Pale << /Type /ExtGState /ca {PHOTO_OPACITY:g} >> >>"
    pages = len(file.objects) + 2  # the number that the list of pages gets, which the page names
    page = file.add(
        f"<< /Type /Page /Parent {pages} 0 R /Contents {content} /Resources << {resources} {states} "
        f"/Properties << {properties} >> >> "
        f"/MediaBox [0 0 {_n(drawing.paper.width * _POINTS)} {_n(drawing.paper.height * _POINTS)}] >>"
    )
    tree = file.add(f"<< /Type /Pages /Kids [{page}] /Count 1 >>")
    listed = " ".join(groups)
    layers = f"<< /OCGs [{listed}] /D << /BaseState /ON /Order [{listed}] >> >>"
    return file.add(f"<< /Type /Catalog /Pages {tree} /OCProperties {layers} >>")


def _begin(names: list[str], name: str) -> str:
    names.append(name)
    return f"/OC /L{len(names) - 1} BDC"


def _image(file: _File, picture: Picture) -> str:
    height, width = picture.pixels.shape[:2]
    keys = f"/Type /XObject /Subtype /Image /Width {width} /Height {height} /ColorSpace /DeviceRGB /BitsPerComponent 8"
    return file.add_stream(f"{keys} /Filter /DCTDecode", jpeg_of(picture.pixels))


def _placed(drawing: Drawing, picture: Picture) -> list[str]:
    scale = drawing.view.scale
    width, height = (side * scale for side in picture.size)
    x, top = drawing.view.to_paper_of(picture.left, picture.top)
    return ["q /Pale gs", f"{_n(width)} 0 0 {_n(height)} {_n(x)} {_n(top - height)} cm /Photo Do Q"]


def _stroke(stroke: Stroke) -> list[str]:
    (x, y), *others = stroke.points.tolist()
    red, green, blue = (_n(value) for value in stroke.layer.colour)
    paint = "B" if stroke.is_filled else "S"
    return [
        f"q {_n(stroke.layer.pen)} w {red} {green} {blue} RG {red} {green} {blue} rg 1 j",
        _DASHES if stroke.layer.is_dashed else "1 J",
        f"{_n(x)} {_n(y)} m",
        *(f"{_n(a)} {_n(b)} l" for a, b in others),
        f"h {paint} Q" if stroke.is_closed else f"{paint} Q",
    ]


def _text(label: Label) -> str:
    back = {"start": 0.0, "middle": 0.5, "end": 1.0}[label.anchor] * width_of(label.text, label.size)
    x, y = (label.x, label.y - back) if label.is_upright else (label.x - back, label.y)
    turn = "0 1 -1 0" if label.is_upright else "1 0 0 1"
    red, green, blue = (_n(value) for value in label.layer.colour)
    shown = label.text.encode(_ENCODING, "replace").decode("latin-1")
    escaped = shown.replace("\\", "\\\\").replace("(", "\\(").replace(")", "\\)")
    return f"BT /F {_n(label.size)} Tf {red} {green} {blue} rg {turn} {_n(x)} {_n(y)} Tm ({escaped}) Tj ET"


def _font(file: _File) -> str:
    """Add the font; a reference to it."""
    data = font_file()
    packed = zlib.compress(data, 9)
    program = file.add_stream(f"/Filter /FlateDecode /Length1 {len(data)}", packed)
    descriptor = file.add(
        "<< /Type /FontDescriptor /FontName /Aileron-Regular /Flags 32 /FontBBox [-200 -300 1400 1000] /ItalicAngle 0 "
        f"/Ascent 976 /Descent -224 /CapHeight {CAPITALS * 1000:g} /StemV 80 /FontFile2 {program} >>"
    )
    letters = [bytes([code]).decode(_ENCODING, "ignore") for code in range(_FIRST, _LAST + 1)]
    widths = " ".join(_n(width_of(letter, 1000.0)) for letter in letters)
    return file.add(
        f"<< /Type /Font /Subtype /TrueType /BaseFont /Aileron-Regular /FirstChar {_FIRST} /LastChar {_LAST} "
        f"/Widths [{widths}] /Encoding /WinAnsiEncoding /FontDescriptor {descriptor} >>"
    )


def _string(text: str) -> str:
    """A text outside the page: as it is in ASCII, else in UTF-16."""
    if text.isascii():
        return "(" + text.replace("\\", "\\\\").replace("(", "\\(").replace(")", "\\)") + ")"
    return "<FEFF" + text.encode("utf-16-be").hex().upper() + ">"


def _n(value: float) -> str:
    """A number, as short as it goes; PDF knows no exponents."""
    text = f"{value:.5f}".rstrip("0").rstrip(".")
    return "0" if text in ("-0", "") else text
