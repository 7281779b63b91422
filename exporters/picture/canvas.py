"""A picture to draw on, with edges smooth to a sixteenth of a pixel; positions count from the centre of a pixel."""

import unicodedata
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from exporters.colours import RGB
from linecad.arrays import Float

_SHIFT = 4  # bits after the point in OpenCV's coordinates
_FARTHEST = 1e6  # px; OpenCV's coordinates are 32 bits wide, and this is far outside of any picture
_COLOUR_KEPT = 0.50  # of the colours of a photo, so that those of the lines stand out
_BRIGHTENED = 0.30  # share of white laid over a photo


@dataclass(frozen=True)
class Text:
    """A text at a place, in px of the whole picture."""

    x: float
    y: float
    text: str
    size: int
    colour: tuple[int, int, int]
    anchor: str


class Canvas:
    """An RGB picture, or a window into one that drawing does not leave."""

    def __init__(self, width: int, height: int, background: RGB) -> None:
        self.pixels: NDArray[np.uint8] = np.full((height, width, 3), _bytes(background), np.uint8)
        self._left, self._top = 0, 0
        self.texts: list[Text] = []

    @property
    def width(self) -> int:
        """Width in px."""
        return int(self.pixels.shape[1])

    @property
    def height(self) -> int:
        """Height in px."""
        return int(self.pixels.shape[0])

    def window(self, left: int, top: int, width: int, height: int) -> "Canvas":
        """A part of this picture with its own origin; what is drawn on it shows here."""
        part = Canvas.__new__(Canvas)
        part.pixels = self.pixels[top : top + height, left : left + width]
        part._left, part._top, part.texts = self._left + left, self._top + top, self.texts
        return part

    def fill(self, colour: RGB) -> None:
        """Paint all of it."""
        self.pixels[:] = _bytes(colour)

    def show(self, photo: NDArray[np.uint8]) -> None:
        """Fill it with a photo (H, W, 3), paler than it is."""
        smaller = self.width < photo.shape[1]
        size, how = (self.width, self.height), cv2.INTER_AREA if smaller else cv2.INTER_CUBIC
        self.pixels[:] = _faded(np.asarray(cv2.resize(photo, size, interpolation=how), np.float32))

    def frame(self, colour: RGB) -> None:
        """Draw a border one pixel wide."""
        for edge in (np.s_[:1], np.s_[-1:], np.s_[:, :1], np.s_[:, -1:]):
            self.pixels[edge] = _bytes(colour)

    def line(self, start: Sequence[float], end: Sequence[float], colour: RGB, width: int) -> None:
        """A line `width` px wide."""
        cv2.line(self.pixels, _fixed(start), _fixed(end), _bytes(colour), width, cv2.LINE_AA, _SHIFT)

    def disc(self, centre: Sequence[float], radius: float, colour: RGB) -> None:
        """A filled circle."""
        cv2.circle(self.pixels, _fixed(centre), round(radius * 2**_SHIFT), _bytes(colour), -1, cv2.LINE_AA, _SHIFT)

    def ring(self, centre: Sequence[float], radius: float, colour: RGB, width: int) -> None:
        """A circle `width` px wide."""
        self.ellipse(centre, (radius, radius), colour, width)

    def ellipse(self, centre: Sequence[float], radii: Sequence[float], colour: RGB, width: int) -> None:
        """An upright ellipse, its line `width` px wide."""
        axes = _fixed(radii)
        cv2.ellipse(self.pixels, _fixed(centre), axes, 0, 0, 360, _bytes(colour), width, cv2.LINE_AA, _SHIFT)

    def cross(self, centre: Sequence[float], radius: float, colour: RGB, width: int) -> None:
        """Two strokes at 45 degrees, each reaching `radius` px to both sides."""
        (x, y), arm = centre, radius / np.sqrt(2)
        self.line((x - arm, y - arm), (x + arm, y + arm), colour, width)
        self.line((x - arm, y + arm), (x + arm, y - arm), colour, width)

    def tint(self, polygons: Iterable[Sequence[Float]], colour: RGB, opacity: float) -> None:
        """Lay a transparent colour over polygons with holes, each a list of rings (V, 2); overlaps count once."""
        mask = np.zeros(self.pixels.shape[:2], np.uint8)
        for rings in polygons:
            fixed = [np.round(np.clip(ring, -_FARTHEST, _FARTHEST) * 2**_SHIFT).astype(np.int32) for ring in rings]
            cv2.fillPoly(mask, fixed, (255,), cv2.LINE_AA, _SHIFT)
        share = np.asarray(mask[..., None], np.float32) * (opacity / 255)
        painted = self.pixels * (1 - share) + np.array(_bytes(colour), np.float32) * share
        self.pixels[:] = np.round(painted).astype(np.uint8)

    def text(self, x: float, y: float, text: str, size: int, colour: RGB, anchor: str = "ls") -> None:
        """Text over everything drawn; `anchor` is Pillow's: l, m, r for x, and a, m, s (baseline), d for y."""
        self.texts.append(Text(self._left + x, self._top + y, text, size, _bytes(colour), anchor))

    def image(self) -> Image.Image:
        """The finished picture."""
        picture = Image.fromarray(self.pixels)
        draw = ImageDraw.Draw(picture)
        for text in self.texts:
            draw.text((text.x, text.y), text.text, text.colour, default_font(text.size), text.anchor)
        return picture


def text_width(text: str, size: int) -> float:
    """How wide a text is, in px."""
    return float(default_font(size).getlength(text))


def drawable(text: str) -> str:
    """The text in the characters that the font has: without accents, and with question marks for all others."""
    font = default_font(20)
    unknown = bytes(font.getmask("\uffff"))
    plain = [character for character in unicodedata.normalize("NFKD", text) if not unicodedata.combining(character)]
    return "".join("?" if bytes(font.getmask(character)) == unknown else character for character in plain)


def default_font(size: int) -> ImageFont.FreeTypeFont:
    """Pillow's own font in a size, px."""
    font = ImageFont.load_default(size)  # the font that comes with Pillow: the same on every machine
    assert isinstance(font, ImageFont.FreeTypeFont)  # Pillow's wheels all have FreeType
    return font


def _faded(photo: NDArray[np.float32]) -> NDArray[np.uint8]:
    grey = photo @ np.array([0.299, 0.587, 0.114], np.float32)
    faded = grey[..., None] * (1 - _COLOUR_KEPT) + photo * _COLOUR_KEPT
    return np.asarray(np.round(faded * (1 - _BRIGHTENED) + 255 * _BRIGHTENED), np.uint8)


def _fixed(point: Sequence[float]) -> tuple[int, int]:
    x, y = np.round(np.clip(np.asarray(point, np.float64), -_FARTHEST, _FARTHEST) * 2**_SHIFT).astype(int).tolist()
    return x, y


def _bytes(colour: RGB) -> tuple[int, int, int]:
    red, green, blue = (round(255 * value) for value in colour)
    return red, green, blue
