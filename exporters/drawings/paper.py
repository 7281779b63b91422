"""Sizes of paper and scales: which scale fits on which sheet."""

import math
import re
from dataclasses import dataclass

from exporters.drawings.records import Paper
from exporters.drawings.sizes import FIT, SCALES, SIZES
from linecad.errors import OutputError

USUAL_SIZE = "A3"  # where neither is given
_FINEST, _COARSEST = 1, 100_000
_LEAST_PART = 0.999  # of what fits that a drawing without scale takes; rounding must not push it off the sheet


@dataclass(frozen=True)
class Borders:
    """Mm about the view that frame, dimensions and title block take."""

    left: float
    right: float
    top: float
    bottom: float


@dataclass(frozen=True)
class Fit:
    """A sheet with the scale of the view on it."""

    paper: Paper
    denominator: int | None  # N of 1:N; None where no length is known
    scale: float  # mm on the paper for a drawing metre


def read_scale(text: str) -> int:
    """N of `1:N`; OutputError for another text."""
    digits = re.fullmatch(r"1:([0-9]{1,6})", text)
    if digits is None or not _FINEST <= int(digits[1]) <= _COARSEST:
        raise OutputError(f"scale {text[:40]!a} is none, expected one like 1:50, from 1:{_FINEST} to 1:{_COARSEST}")
    return int(digits[1])


def sheets(name: str) -> list[Paper]:
    """A size of paper lying and standing."""
    width, height = SIZES[name]
    return [Paper(name, width, height), Paper(name, height, width)]


def fit(size: tuple[float, float], borders: Borders, paper: str, scale: str, is_metric: bool) -> Fit:
    """The sheet and scale for a view of `size` drawing metres; `paper` and `scale` may be FIT.

    Raises OutputError where the scale is none, does not fit, or means nothing because no length is known.
    """
    if scale == FIT:
        return _largest(size, borders, USUAL_SIZE if paper == FIT else paper, is_metric)
    wanted = read_scale(scale)
    if not is_metric:
        raise OutputError(
            f"{scale} needs a known length, and the scene has none; give that of a line, or --camera-height METRES, "
            "or leave the scale out"
        )
    for name in SIZES if paper == FIT else (paper,):
        for sheet in sheets(name):
            if 1000 / wanted <= _most(size, borders, sheet):
                return Fit(sheet, wanted, 1000 / wanted)
    raise OutputError(_too_large(size, borders, "A0" if paper == FIT else paper, wanted))


def _most(size: tuple[float, float], borders: Borders, sheet: Paper) -> float:
    """Mm for a drawing metre, at most."""
    return min(
        (sheet.width - borders.left - borders.right) / size[0], (sheet.height - borders.top - borders.bottom) / size[1]
    )


def _largest(size: tuple[float, float], borders: Borders, name: str, is_metric: bool) -> Fit:
    """The largest scale on a size of paper, lying or standing; lying where that is the same."""
    found: list[Fit] = []
    for sheet in sheets(name):
        most = _most(size, borders, sheet)
        denominator = _denominator(most) if is_metric else None
        found.append(Fit(sheet, denominator, most * _LEAST_PART if denominator is None else 1000 / denominator))
    return max(found, key=lambda each: each.scale)  # the first of equal ones


def _denominator(most: float) -> int:
    """The smallest usual N of 1:N for which a metre takes at most `most` mm; above them whole thousands."""
    least = 1000 / most
    return next((each for each in SCALES if each >= least), math.ceil(least / 1000) * 1000)


def _too_large(size: tuple[float, float], borders: Borders, name: str, wanted: int) -> str:
    fits = _largest(size, borders, name, is_metric=True).denominator
    larger = next(
        (each for each in SIZES for sheet in sheets(each) if 1000 / wanted <= _most(size, borders, sheet)), ""
    )
    choice = f"1:{fits} does" + (f", or --paper {larger}" if larger else "")
    return f"{size[0]:.2f} x {size[1]:.2f} m at 1:{wanted} does not fit on {name}; {choice}"
