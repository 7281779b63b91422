"""What each part of the photo was taken for, laid over it: a colour for each kind, a dark border between surfaces."""

from functools import lru_cache

import cv2
import numpy as np

from linecad.editing.state import Now
from linecad.scene import CellKind, Cells

COLOURS: dict[CellKind, str] = {  # sRGB
    "wall": "#d98a4e",
    "level": "#c9b458",
    "kerb": "#6f6f7a",
    "ground": "#8f9a52",
    "ceiling": "#b7a6d6",
    "roof": "#b5485d",
    "sky": "#69b3e7",
    "clutter": "#2f7d5b",
}
BORDER = "#22222a"  # sRGB


def document_of_cells(now: Now) -> dict[str, object] | None:
    """What the state tells of the layer: a number that changes when it does, and what each colour means."""
    cells = None if now.model is None else now.model.scene.cells
    if now.model is None or cells is None:
        return None
    seen = {cells.kinds[number] for number in np.unique(cells.number).tolist()}
    kinds = [{"name": kind, "colour": colour} for kind, colour in COLOURS.items() if kind in seen]
    return {"number": now.model.version, "kinds": kinds}


def picture_of_cells(now: Now) -> bytes | None:
    """The layer as PNG of the photo's shape; None where there is no model."""
    cells = None if now.model is None else now.model.scene.cells
    return None if cells is None else _png(cells)


@lru_cache(maxsize=2)
def _png(cells: Cells) -> bytes:
    number = cells.number
    table = np.array([_bytes(COLOURS[kind]) for kind in cells.kinds], np.uint8)
    pixels = table[number]
    differs = np.zeros(number.shape, bool)
    differs[:, 1:] |= number[:, 1:] != number[:, :-1]
    differs[1:] |= number[1:] != number[:-1]
    pixels[differs] = _bytes(BORDER)
    _, data = cv2.imencode(".png", pixels)
    return data.tobytes()


def _bytes(colour: str) -> tuple[int, int, int]:
    """Blue, green and red of #rrggbb."""
    blue, green, red = (int(colour[at : at + 2], 16) for at in (5, 3, 1))
    return blue, green, red
