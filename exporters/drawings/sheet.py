"""The sheet about a view: frame, title block, scale bar, and what is uncertain, on the paper in mm."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from exporters.drawings.dimensions import ROOM
from exporters.drawings.fonts import drawable, shortened, wrapped
from exporters.drawings.paper import Borders, Fit
from exporters.drawings.records import CAPITALS, SHEET, Label, Layer, Paper, Stroke, Unit, View

_EDGE = 8.0  # mm from the edge of the paper to the frame
_STRIP = 36.0  # mm, height of the strip at the foot: notes to the left, title block to the right
_BLOCK = 112.0  # mm, width of the title block
_PAD = 2.5  # mm between a line of the frame and a text
_TITLE, _TEXT, _NOTE = 5.0, 3.2, 2.5  # mm, sizes of fonts
_NARROWER = 0.82  # of its room that a text takes: fonts that readers take for ours are wider
_LEADING = 1.35  # from one line of a text to the next, in sizes of its font
_HEADROOM = 6.0  # mm above the view
_LEVELS = 22.0  # mm to the left of the view, for level marks
_BAR_ROOM, _BAR_HEIGHT = 13.0, 1.6  # mm below the dimensions, for the scale bar
_BAR_SHARE = 0.35  # of the width of the view that the bar takes at most
_LONGEST_BAR = 100.0  # mm
_BAR_PARTS = 5
_THIN = Layer(SHEET.name, 0.18, SHEET.colour)  # lines within the title block

BORDERS = Borders(
    left=_EDGE + _LEVELS, right=_EDGE + ROOM + 2, top=_EDGE + _HEADROOM, bottom=_EDGE + _STRIP + _BAR_ROOM + ROOM
)


@dataclass(frozen=True)
class Facts:
    """What the title block and the notes say."""

    title: str
    photo: str
    unit_note: str
    lines: tuple[str, ...]  # further ones of the title block, such as the camera
    notes: tuple[str, ...]  # what is guessed and uncertain, the first is the most important


def place_view(box: tuple[float, float, float, float], fit: Fit) -> View:
    """The view on its sheet: in the middle of what borders leave."""
    width, height = (box[2] - box[0]) * fit.scale, (box[3] - box[1]) * fit.scale
    x = (BORDERS.left + fit.paper.width - BORDERS.right - width) / 2
    y = (BORDERS.bottom + fit.paper.height - BORDERS.top - height) / 2
    return View(box, (x, y), fit.scale)


def build_sheet(facts: Facts, fit: Fit, view: View, unit: Unit) -> tuple[list[Stroke], list[Label]]:
    """All that stands on the sheet and is not of the view."""
    strokes, labels = _title_block(facts, fit)
    for more_strokes, more_labels in (_notes(facts.notes, fit.paper), _scale_bar(fit, view, unit)):
        strokes += more_strokes
        labels += more_labels
    return strokes, labels


def scale_word(fit: Fit) -> str:
    """The scale as the title block says it."""
    return "none, as no length is known" if fit.denominator is None else f"1:{fit.denominator} on {fit.paper.name}"


def _title_block(facts: Facts, fit: Fit) -> tuple[list[Stroke], list[Label]]:
    paper = fit.paper
    left, right, top = paper.width - _EDGE - _BLOCK, paper.width - _EDGE, _EDGE + _STRIP
    frame = np.array([(_EDGE, _EDGE), (right, _EDGE), (right, paper.height - _EDGE), (_EDGE, paper.height - _EDGE)])
    strokes = [
        Stroke(SHEET, frame, is_closed=True),
        Stroke(SHEET, np.array([(_EDGE, top), (right, top)])),
        Stroke(SHEET, np.array([(left, _EDGE), (left, top)])),
        Stroke(_THIN, np.array([(left, top - 9.5), (right, top - 9.5)])),
    ]
    width, x = _NARROWER * (_BLOCK - 2 * _PAD), left + _PAD
    labels = [Label(SHEET, x, top - 6.6, shortened(drawable(facts.title), _TITLE, width), _TITLE)]
    unit = [] if fit.denominator is None else [facts.unit_note]  # the first row says that none is known
    rows = [f"Scale: {scale_word(fit)}", f"Photo: {facts.photo}", *unit, *facts.lines]
    y = top - 9.5 - _PAD - _TEXT * CAPITALS
    for row in rows:
        for line in wrapped(drawable(row), _TEXT, width):
            if y > _EDGE + 1:
                labels.append(Label(SHEET, x, y, shortened(line, _TEXT, width), _TEXT))
            y -= _TEXT * _LEADING
    return strokes, labels


def _notes(notes: Sequence[str], paper: Paper) -> tuple[list[Stroke], list[Label]]:
    """What is uncertain, in the strip to the left of the title block: as many notes as it has room for."""
    x, width = _EDGE + _PAD, _NARROWER * (paper.width - 2 * _EDGE - _BLOCK - 2 * _PAD)
    y = _EDGE + _STRIP - _PAD - _NOTE * CAPITALS
    most = int((y - _EDGE - 1) / (_NOTE * _LEADING)) + 1
    lines: list[str] = []
    for number, note in enumerate(notes):
        more = wrapped(drawable(f"- {note}"), _NOTE, width)
        last = number == len(notes) - 1
        if len(lines) + len(more) > most - (not last):  # a line is kept for the count
            lines.append(f"- {len(notes) - number} more notes are in the scene file")
            break
        lines += more
    texts = [shortened(line, _NOTE, width) for line in lines[:most]]
    return [], [Label(SHEET, x, y - row * _NOTE * _LEADING, text, _NOTE) for row, text in enumerate(texts)]


def _scale_bar(fit: Fit, view: View, unit: Unit) -> tuple[list[Stroke], list[Label]]:
    """Five equal parts, black and white in turn, of a round length each."""
    most = min(view.size[0] * _BAR_SHARE, _LONGEST_BAR) / (unit.metres * fit.scale)  # units that fit
    part = _round_below(most / _BAR_PARTS)
    step = part * unit.metres * fit.scale
    x, y = view.corner[0], _EDGE + _STRIP + _BAR_ROOM / 2 - 1
    strokes = []
    for number in range(_BAR_PARTS):
        a, b = x + number * step, x + (number + 1) * step
        ring = np.array([(a, y), (b, y), (b, y + _BAR_HEIGHT), (a, y + _BAR_HEIGHT)])
        strokes.append(Stroke(_THIN, ring, is_closed=True, is_filled=number % 2 == 0))
    texts = [(x, "0"), (x + step, f"{part:g}"), (x + _BAR_PARTS * step, f"{_BAR_PARTS * part:g}{unit.suffix}")]
    if step < 9:  # mm; else the texts of the first two would run into each other
        del texts[1]
    return strokes, [Label(SHEET, at, y + _BAR_HEIGHT + 1, text, _NOTE, "middle") for at, text in texts]


def _round_below(value: float) -> float:
    """The largest of 1, 2 and 5 times a power of ten that is not larger."""
    power = 10.0 ** np.floor(np.log10(value))
    return float(next(factor * power for factor in (5, 2, 1) if factor * power <= value * (1 + 1e-9)))
