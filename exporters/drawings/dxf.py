"""DXF R2010 of a drawing: https://help.autodesk.com/view/OARX/2018/ENU/?guid=GUID-235B22E0-A567-4CF6-92D3-38A2306D73F3

What is drawn of the scene lies in model space, in drawing metres. The sheet is the layout in paper space, in mm: frame,
title block, dimensions that measure, and a viewport that shows model space at scale. Layers have the pens of the
drawing. The photo is a picture beside the file.
"""

from pathlib import Path

from ezdxf import new, units  # type: ignore[attr-defined]  # public, but re-exported without saying so
from ezdxf.document import Drawing as Document
from ezdxf.enums import TextEntityAlignment
from ezdxf.layouts.base import BaseLayout
from ezdxf.layouts.layout import Paperspace

from exporters.beside import Names, SideFiles
from exporters.drawings.dimensions import AFTER, BEFORE, FAR_OFF, OFF, TEXT, TICK, points_of
from exporters.drawings.records import (
    CAPITALS,
    DIMENSIONS,
    LAYERS,
    PHOTO,
    PHOTO_OPACITY,
    Drawing,
    Label,
    Picture,
    Stroke,
)
from exporters.dxf import bytes_of, fixed_metadata
from exporters.textures.build import jpeg_of
from exporters.textures.pages import page_name

_STYLE, _DASHED, _LAYOUT = "DRAWING", "GUESS", "Sheet"
_VIEWPORT_LAYER = "VIEWPORT"
_DASH, _GAP = 2.0, 1.0  # mm on the paper
_FADE = round(100 * (1 - PHOTO_OPACITY))
_ABOVE, _BEYOND = 1, 4  # where a dimension has its text: DIMTAD
_ACTIVE = 2  # status of a viewport that is shown
_ALIGNED = {
    "start": TextEntityAlignment.LEFT,
    "middle": TextEntityAlignment.CENTER,
    "end": TextEntityAlignment.RIGHT,
}


def write(drawing: Drawing, path: Path, names: Names | None) -> SideFiles:
    """Write the drawing to `path`, and return its picture; OSError where that fails."""
    parts, folder = {}, ""
    if drawing.picture is not None:
        assert names is not None, "the row of a format with a picture has a folder"
        folder = names.folder
        data = jpeg_of(drawing.picture.pixels)
        parts = {page_name(data): data}
    with fixed_metadata():
        document = _build_document(drawing, [f"{folder}/{name}" for name in parts])
        path.write_bytes(bytes_of(document))
    return SideFiles(parts)


def _build_document(drawing: Drawing, pictures: list[str]) -> Document:
    document = new("R2010", units=units.M)
    document.header["$MEASUREMENT"] = 1  # metric
    document.header["$PSLTSCALE"] = 1  # dashes are as long as the line type says on the sheet, whatever its scale
    document.styles.add(_STYLE, font="arial.ttf")
    document.linetypes.add(_DASHED, [_DASH + _GAP, _DASH, -_GAP], description="a guess")
    for layer in LAYERS:
        kind = _DASHED if layer.is_dashed else "Continuous"
        colour = document.layers.add(layer.name, linetype=kind, lineweight=round(100 * layer.pen))
        red, green, blue = (round(255 * value) for value in layer.colour)
        if red or green or blue:
            colour.rgb = (red, green, blue)  # else colour 7: black on paper, white on a dark screen
    document.layers.add(_VIEWPORT_LAYER).off()  # without its frame
    space = document.modelspace()
    if drawing.picture is not None:
        _add_picture(document, drawing.picture, pictures[0])
    for stroke in drawing.strokes:
        _add_stroke(space, stroke)
    _add_sheet(document, drawing)
    for name, value in (("photo", drawing.photo), ("unit", drawing.unit_note), ("drawing", drawing.title)):
        document.header.custom_vars.append(f"linecad {name}", value)
    _set_view(document, drawing)
    return document


def _add_picture(document: Document, picture: Picture, file: str) -> None:
    rows, columns = picture.pixels.shape[:2]
    definition = document.add_image_def(file, (columns, rows), name="PHOTO")
    width, height = picture.size
    place = (picture.left, picture.top - height)
    attributes = {"layer": PHOTO.name, "fade": _FADE}
    document.modelspace().add_image(definition, place, (width, height), dxfattribs=attributes)


def _add_stroke(space: BaseLayout, stroke: Stroke) -> None:
    attributes = {"layer": stroke.layer.name}
    usual = next(layer.pen for layer in LAYERS if layer.name == stroke.layer.name)
    weight = {} if stroke.layer.pen == usual else {"lineweight": round(100 * stroke.layer.pen)}
    points = stroke.points.tolist()
    if len(points) == 2 and not stroke.is_closed:
        space.add_line(points[0], points[1], dxfattribs=attributes | weight)
    else:
        space.add_lwpolyline(points, close=stroke.is_closed, dxfattribs=attributes | weight)
    if stroke.is_filled:
        space.add_hatch(color=256, dxfattribs=attributes).paths.add_polyline_path(points, is_closed=True)  # by layer


def _add_sheet(document: Document, drawing: Drawing) -> None:
    document.layouts.rename("Layout1", _LAYOUT)
    sheet = document.layouts.get(_LAYOUT)
    assert isinstance(sheet, Paperspace)
    paper, view = drawing.paper, drawing.view
    sheet.page_setup(size=(paper.width, paper.height), margins=(0, 0, 0, 0), units="mm", name=f"ISO {paper.name}")
    (width, height), (x, y), box = view.size, view.corner, view.box
    sheet.add_viewport(
        center=(x + width / 2, y + height / 2),
        size=(width, height),
        view_center_point=((box[0] + box[2]) / 2, (box[1] + box[3]) / 2),
        view_height=height / view.scale,
        status=_ACTIVE,
        dxfattribs={"layer": _VIEWPORT_LAYER},
    )
    for stroke in drawing.sheet:
        _add_stroke(sheet, stroke)
    for label in drawing.labels:
        _add_label(sheet, label)
    _add_dimensions(document, sheet, drawing)


def _add_label(space: BaseLayout, label: Label) -> None:
    text = space.add_text(
        label.text,
        height=label.size * CAPITALS,
        rotation=90 if label.is_upright else 0,
        dxfattribs={"layer": label.layer.name, "style": _STYLE},
    )
    text.set_placement((label.x, label.y), align=_ALIGNED[label.anchor])


def _add_dimensions(document: Document, sheet: Paperspace, drawing: Drawing) -> None:
    """Entities that measure: paper mm times a factor are what is written."""
    unit, scale = drawing.unit, drawing.view.scale
    settings = {
        "dimtxsty": _STYLE,
        "dimtxt": TEXT * CAPITALS,
        "dimtsz": TICK,
        "dimfxlon": 1,  # extension lines of one length
        "dimfxl": BEFORE,
        "dimexe": AFTER,
        "dimgap": OFF,
        "dimlfac": 1 / (scale * unit.metres),
        "dimdec": unit.decimals,
        "dimzin": 0,  # zeros stay
        "dimdsep": ord("."),
        "dimtad": _ABOVE,
        "dimtih": 0,  # text runs along the line
        "dimtoh": 0,
    }
    document.dimstyles.new(_STYLE, dxfattribs=settings)
    for each in drawing.dimensions:
        first, second = drawing.view.to_paper(points_of(each)).tolist()
        made = sheet.add_linear_dim(
            base=(each.at, first[1]) if each.is_upright else (first[0], each.at),
            p1=first,
            p2=second,
            angle=90 if each.is_upright else 0,
            dimstyle=_STYLE,
            override={"dimtad": _BEYOND, "dimgap": FAR_OFF} if each.is_beyond else {},
            dxfattribs={"layer": DIMENSIONS.name},
        )
        made.render()


def _set_view(document: Document, drawing: Drawing) -> None:
    x0, y0, x1, y1 = drawing.view.box
    space = document.modelspace()
    document.header["$EXTMIN"] = space.dxf.extmin = (x0, y0, 0.0)
    document.header["$EXTMAX"] = space.dxf.extmax = (x1, y1, 0.0)
    document.set_modelspace_vport(height=y1 - y0, center=((x0 + x1) / 2, (y0 + y1) / 2))
