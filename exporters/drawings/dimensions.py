"""Dimension chains and level marks: overall, bays, storeys, openings.

Every length is a difference of two coordinates of the scene. Openings of one row have the same sill and head, those of
one column the same sides, so rows and columns are read off the coordinates: the most frequent ones first, and of two
that overlap the more frequent one.
"""

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from exporters.drawings.fonts import width_of
from exporters.drawings.records import CAPITALS, DIMENSIONS, LEVELS, Dimension, Label, Stroke, Unit, View
from linecad.arrays import Float

Span = tuple[float, float]

TEXT = 3.2  # mm, the size of the font of dimensions
APART = 8.5  # mm from one chain to the next
_FIRST = 9.0  # mm from the view to the first chain
BEFORE, AFTER = 3.5, 1.2  # mm of extension lines before and behind the dimension line: none crosses a text
TICK = 1.4  # mm, half of the slanted stroke at an end, along x and y
OFF = 1.0  # mm from the dimension line to its text
FAR_OFF = AFTER + 0.5  # mm, where that stands on its far side
_SHORTEST = 0.8  # mm on the paper; ends that are nearer cannot be told apart, and make no dimension
_LEVEL_GAP = 1.5  # mm from a level mark to the view
_LEVEL_WIDTH = 4.0  # mm of the triangle of a level mark
CHAINS = 3  # on either side at most
ROOM = _FIRST + (CHAINS - 1) * APART + AFTER + OFF + TEXT  # mm that they take


@dataclass(frozen=True)
class Measured:
    """What is measured of a facade, in drawing metres."""

    width: Span
    height: Span  # of its walls
    columns: tuple[Span, ...]  # of openings, from left to right; none overlap
    rows: tuple[Span, ...]  # from below
    top: float  # of the roof above it; that of its walls where none is


def distinct_spans(spans: Iterable[Span]) -> tuple[Span, ...]:
    """In ascending order, the spans that do not overlap: the most frequent first, of equal ones the lowest."""
    chosen: list[Span] = []
    for (low, high), _ in sorted(Counter(spans).items(), key=lambda item: (-item[1], item[0])):
        if all(high <= other[0] or low >= other[1] for other in chosen):
            chosen.append((low, high))
    return tuple(sorted(chosen))


def chains_across(measured: Measured) -> list[list[float]]:
    """Places along x of the chains below the drawing, from the nearest: openings, bays, overall."""
    sides = [side for span in measured.columns for side in span]
    middles = [(low + high) / 2 for low, high in measured.columns]
    return _chains(measured.width, sides, middles)


def chains_up(measured: Measured) -> list[list[float]]:
    """Places along y of the chains beside the drawing, the nearest first: openings and eave, storeys, overall."""
    low, eave = measured.height
    sides = [side for span in measured.rows for side in span]
    if measured.top > eave:
        sides.append(eave)
    return _chains((low, measured.top), sides, [low for low, _ in measured.rows])


def _chains(whole: Span, sides: Sequence[float], repeated: Sequence[float]) -> list[list[float]]:
    within = [sorted({*whole, *(at for at in places if whole[0] <= at <= whole[1])}) for places in (sides, repeated)]
    chains = [within[0]] if sides else []
    chains += [within[1]] if len(repeated) > 1 else []
    return [*chains, list(whole)]


def build_dimensions(
    across: Sequence[Sequence[float]], up: Sequence[Sequence[float]], corner: tuple[float, float], view: View
) -> list[Dimension]:
    """All dimensions about a view: chains across below it and chains up to its right, the nearest first.

    Places are drawing metres, in ascending order; `corner` is the right lower one of what is measured.
    """
    left, bottom = view.corner
    right = left + view.size[0]
    made: list[Dimension] = []
    for number, places in enumerate(across):
        at, y = bottom - _FIRST - number * APART, corner[1]
        made += [Dimension((a, y), (b, y), False, at) for a, b in _pairs(places, view.scale)]
    for number, places in enumerate(up):
        at, x = right + _FIRST + number * APART, corner[0]
        made += [Dimension((x, a), (x, b), True, at) for a, b in _pairs(places, view.scale)]
    return made


def _pairs(places: Sequence[float], scale: float) -> list[Span]:
    """Each place with the next that can be told apart from it on the paper; the last one is always an end."""
    kept = [places[0]]
    for at in places[1:]:
        if (at - kept[-1]) * scale >= _SHORTEST:
            kept.append(at)
        elif at == places[-1] and len(kept) > 1:
            kept[-1] = at
    return list(pairwise(kept))


def spread(dimensions: Sequence[Dimension], view: View, unit: Unit) -> list[Dimension]:
    """The dimensions, with texts that are wider than what they measure beyond the line; every second one in a row."""
    done: list[Dimension] = []
    for each in dimensions:
        narrow = width_of(unit.text(each.length), TEXT) + OFF > each.length * view.scale
        before = done[-1] if done else None
        taken = before is not None and before.is_beyond
        taken = taken and before is not None and (before.is_upright, before.at) == (each.is_upright, each.at)
        done.append(replace(each, is_beyond=narrow and not taken))
    return done


def strokes_of(dimension: Dimension, view: View) -> list[Stroke]:
    """Paper mm: the dimension line, its extension lines and slanted ends."""
    axis, at = int(dimension.is_upright), dimension.at
    a, b = _ends(dimension, view)
    near, past = (at - BEFORE, at + AFTER) if axis else (at + BEFORE, at - AFTER)
    lines = [((a, at), (b, at)), ((a, near), (a, past)), ((b, near), (b, past))]
    lines += [((end - TICK, at - TICK), (end + TICK, at + TICK)) for end in (a, b)]
    return [Stroke(DIMENSIONS, np.array(line)[:, ::-1] if axis else np.array(line)) for line in lines]


def label_of(dimension: Dimension, view: View, unit: Unit) -> Label:
    """The text of a dimension, above its line, to the left of an upright one; or on the other side."""
    middle = sum(_ends(dimension, view)) / 2
    text = unit.text(dimension.length)
    below = dimension.at + OFF
    if dimension.is_upright:
        x = dimension.at + FAR_OFF + TEXT * CAPITALS if dimension.is_beyond else dimension.at - OFF
        return Label(DIMENSIONS, x, middle, text, TEXT, "middle", True)
    y = dimension.at - FAR_OFF - TEXT * CAPITALS if dimension.is_beyond else below
    return Label(DIMENSIONS, middle, y, text, TEXT, "middle")


def _ends(dimension: Dimension, view: View) -> Span:
    """Mm on the paper, along what is measured."""
    axis = int(dimension.is_upright)
    a, b = view.to_paper(points_of(dimension))[:, axis].tolist()
    return a, b


def points_of(dimension: Dimension) -> Float:
    """(2, 2) drawing metres, the two places."""
    return np.array([dimension.start, dimension.end])


def build_levels(measured: Measured, view: View, unit: Unit) -> tuple[list[Stroke], list[Label]]:
    """Marks to the left of a view, on the paper, of top, zero, eave, foot, sills, heads: what stands apart."""
    left = view.corner[0] - _LEVEL_GAP
    heights = [measured.top, 0.0, *reversed(measured.height), *(at for span in measured.rows for at in span)]
    strokes: list[Stroke] = []
    labels: list[Label] = []
    taken: list[float] = []
    for height in heights:
        y = float(view.to_paper(np.array([0.0, height]))[1])
        inside = view.corner[1] - 1e-6 <= y <= view.corner[1] + view.size[1] + 1e-6
        if not inside or any(abs(y - other) < TEXT for other in taken):
            continue
        taken.append(y)
        x = left - _LEVEL_WIDTH
        half = _LEVEL_WIDTH / 4
        strokes.append(
            Stroke(LEVELS, np.array([(x, y), (x - half, y + 2 * half), (x + half, y + 2 * half)]), is_closed=True)
        )
        strokes.append(Stroke(LEVELS, np.array([(x - half, y), (left, y)])))
        text = unit.text(height)
        sign = "±" if not float(text) else "+" if height > 0 else ""
        labels.append(Label(LEVELS, x - 2.5 * half, y + 0.3, f"{sign}{text}", TEXT, "end"))
    return strokes, labels
