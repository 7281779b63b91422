"""A drawing in the format of a suffix; the libraries of a format are loaded when it is written."""

from collections.abc import Iterator
from importlib import import_module
from pathlib import Path

from exporters.beside import Names, SideFiles
from exporters.drawings.dimensions import label_of, strokes_of
from exporters.drawings.records import LAYERS, Drawing, Label, Layer, Stroke

_MODULES = {suffix: f"exporters.drawings.{suffix[1:]}" for suffix in (".svg", ".pdf", ".dxf", ".tif")}


def write_drawing(drawing: Drawing, path: Path, names: Names | None) -> SideFiles | None:
    """Write a drawing; what lies beside it, for formats that have a name for that. Raises OSError or OutputError."""
    written: SideFiles | None = import_module(_MODULES[path.suffix]).write(drawing, path, names)
    return written


def layers_on_paper(drawing: Drawing) -> Iterator[tuple[Layer, list[Stroke], list[Label]]]:
    """What each layer has on the paper, in mm, the lowest layer first; layers without anything are left out."""
    view = drawing.view
    strokes = [
        Stroke(each.layer, view.to_paper(each.points), each.is_closed, each.is_filled) for each in drawing.strokes
    ]
    strokes += [*drawing.sheet, *(stroke for each in drawing.dimensions for stroke in strokes_of(each, view))]
    labels = [*drawing.labels, *(label_of(each, view, drawing.unit) for each in drawing.dimensions)]
    for layer in LAYERS:
        own = [each for each in strokes if each.layer.name == layer.name]
        texts = [each for each in labels if each.layer.name == layer.name]
        if own or texts:
            yield layer, own, texts
