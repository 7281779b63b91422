"""The records of a drawing at scale, which every writer draws alike.

Two frames of reference. *Drawing metres*: what is drawn of the scene, x to the right, y up, as in space; where a plan
or an elevation begins is told by its `Projection`. *Paper millimetres*: the sheet, from its lower left corner, x to
the right, y up. A `View` takes one to the other. Where no length is known, a unit of the scene stands for a metre, and
lengths are told as shares of one length of the drawing (`Unit`).
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from exporters.colours import RGB
from linecad.arrays import Float, freeze


@dataclass(frozen=True)
class Layer:
    """What can be shown and hidden together, drawn with one pen."""

    name: str  # ASCII, upper case
    pen: float  # mm, of ISO 128
    colour: RGB  # sRGB, 0 to 1
    is_dashed: bool = False

    @property
    def of_guesses(self) -> "Layer":
        """The layer of what would be on this one if it were sure."""
        return replace(self, name=f"{self.name}_GUESS", is_dashed=True)


_INK, _GREY, _BLUE = (0.0, 0.0, 0.0), (0.45, 0.45, 0.45), (0.10, 0.30, 0.60)
PHOTO = Layer("PHOTO", 0.13, _GREY)
FACES = Layer("FACES", 0.13, _GREY)  # borders of faces
DETAILS = Layer("DETAILS", 0.13, _INK)
OPENINGS = Layer("OPENINGS", 0.25, _INK)
OUTLINES = Layer("OUTLINES", 0.35, _INK)
WALLS = Layer("WALLS", 0.70, _INK)  # of a plan
GROUND = Layer("GROUND", 0.70, _INK)
CAMERA = Layer("CAMERA", 0.18, _BLUE)
LEVELS = Layer("LEVELS", 0.18, _INK)
DIMENSIONS = Layer("DIMENSIONS", 0.18, _INK)
SHEET = Layer("SHEET", 0.35, _INK)  # frame, title block, scale bar
_OF_THE_SCENE = (DETAILS, OPENINGS, OUTLINES, WALLS)
LAYERS = (  # from below
    PHOTO, FACES, *(each for layer in _OF_THE_SCENE for each in (layer.of_guesses, layer)),
    GROUND, CAMERA, LEVELS, DIMENSIONS, SHEET,
)  # fmt: skip

PHOTO_OPACITY = 0.6  # of the photo, so that the lines above it stand out
CAPITALS = 0.69  # of the size of the font (exporters.drawings.fonts)


@dataclass(frozen=True, eq=False)
class Stroke:
    """A polyline, in drawing metres or paper millimetres, as the list that it is in says."""

    layer: Layer
    points: Float  # (M, 2)
    is_closed: bool = False
    is_filled: bool = False  # in the colour of its layer

    def __post_init__(self) -> None:
        freeze(self, "points", np.float64, (None, 2))


@dataclass(frozen=True)
class Label:
    """A text on the paper: one line."""

    layer: Layer
    x: float  # mm
    y: float  # mm, of the line that it is written on
    text: str
    size: float  # mm, of the font: its capitals are CAPITALS of that high
    anchor: str = "start"  # what is at x: its start, middle or end
    is_upright: bool = False  # it runs up the paper


@dataclass(frozen=True, eq=False)
class Dimension:
    """A length of the drawing between two places, measured along x or y."""

    start: tuple[float, float]  # drawing metres
    end: tuple[float, float]  # drawing metres
    is_upright: bool  # it measures y
    at: float  # mm on the paper: y of the dimension line, x where it is upright
    is_beyond: bool = False  # its text stands on the far side of the line, because it is too wide for the near one

    @property
    def length(self) -> float:
        """Drawing metres."""
        axis = int(self.is_upright)
        return self.end[axis] - self.start[axis]


@dataclass(frozen=True)
class Unit:
    """What lengths are told in."""

    metres: float  # drawing metres of one unit
    decimals: int
    suffix: str  # of a length told alone, such as ` m`

    def text(self, length: float) -> str:
        """A length in drawing metres as the number that is written."""
        shown = f"{length / self.metres:.{self.decimals}f}"
        return shown[1:] if shown.startswith("-") and not float(shown) else shown  # no minus before a zero


@dataclass(frozen=True, eq=False)
class Picture:
    """The rectified photo: what of it shows the drawing's faces, each in its place."""

    pixels: NDArray[np.uint8]  # (H, W, 3) RGB, white where the photo shows nothing
    left: float  # drawing metres of its left border
    top: float  # of its upper border
    step: float  # drawing metres of a pixel, along x and y
    dpi: float  # pixels an inch on the paper

    @property
    def size(self) -> tuple[float, float]:
        """Drawing metres, width and height."""
        return self.pixels.shape[1] * self.step, self.pixels.shape[0] * self.step


@dataclass(frozen=True)
class Paper:
    """A sheet."""

    name: str  # such as A3
    width: float  # mm
    height: float  # mm


@dataclass(frozen=True)
class View:
    """Where what is drawn lies on the paper, and how large."""

    box: tuple[float, float, float, float]  # drawing metres: x from, y from, x to, y to; nothing is drawn outside
    corner: tuple[float, float]  # mm, of the box's lower left corner
    scale: float  # mm on the paper for a drawing metre

    def to_paper(self, points: Float) -> Float:
        """Paper mm (..., 2) of points (..., 2) in drawing metres."""
        placed: Float = (points - np.array(self.box[:2])) * self.scale + np.array(self.corner)
        return placed

    def to_paper_of(self, x: float, y: float) -> tuple[float, float]:
        """Paper mm of one point in drawing metres."""
        across, up = self.to_paper(np.array([x, y])).tolist()
        return across, up

    @property
    def size(self) -> tuple[float, float]:
        """Mm on the paper, width and height."""
        x0, y0, x1, y1 = self.box
        return (x1 - x0) * self.scale, (y1 - y0) * self.scale


@dataclass(frozen=True, eq=False)
class Drawing:
    """A finished sheet."""

    title: str  # such as `Elevation of facade 0`
    photo: str  # name of the photo
    unit_note: str  # one ASCII phrase that says what a unit is
    paper: Paper
    view: View
    unit: Unit
    strokes: tuple[Stroke, ...]  # of the scene, in drawing metres
    sheet: tuple[Stroke, ...]  # of frame, title block and scale bar, in paper mm
    labels: tuple[Label, ...]
    dimensions: tuple[Dimension, ...]
    picture: Picture | None
