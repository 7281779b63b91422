"""Outlines with few corners: lines are taken away that only cut off steps.

All short ones go first, then longer ones, and of all answers on the way that one is taken whose labels and corners
together cost least. A surface that it gave up to clutter or sky is asked back with its outline, where that makes faces
cheaper: lines went with it that had nothing to do with it. Last, lines are asked one by one. What it costs to have one
more surface counts in none of this: the labels of each answer were asked for that.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely

from linecad.arrays import Bool, Float, Int
from linecad.geometry import unit_normals
from linecad.model.regions.labels import Labels

# Of the photo's width: lines are left out of which no longer piece is a border.
RUNS = (0.02, 0.04, 0.06, 0.08, 0.10, 0.14, 0.20)
LONGEST = 0.3  # of the photo's width: lines with more border than that are no steps
MOST_LOST = 0.2  # of what any label shows, that may go with steps: they are parts of something larger
LEAST_GIVEN_UP = 0.01  # of the photo, that a surface lost which is asked back
ON_BORDER = 1e-3  # px


@dataclass(frozen=True, eq=False)
class Outlined:
    """Labels of cells, with the lines that cut them out of the photo."""

    labels: Labels
    lines: Float  # (M, 2, 2) px, drawn out to each other, the photo's borders among them
    rows: Int  # (M,) of each line among those that there were to begin with; -1 for the photo's borders

    @property
    def used(self) -> Int:
        """The rows of the lines, ascending."""
        return np.unique(self.rows[self.rows >= 0])

    @property
    def width(self) -> float:
        """Of the photo, px."""
        return float(np.ptp(self.lines[self.rows < 0, :, 0]))

    @cached_property
    def shown(self) -> Int:
        """The label of each sample (S,)."""
        found: Int = self.labels.label[self.labels.cell]
        return found

    @cached_property
    def shares(self) -> Float:
        """Share of the photo that shows each label (K + 2,)."""
        return np.bincount(self.shown, minlength=self.labels.clutter + 1) / len(self.shown)

    def bordering(self, edges: Float) -> Int:
        """The rows of the lines on which edges (E, 2, 2) of regions lie, or beyond them."""
        return self.rows[self._in_line(edges).any(axis=0) & (self.rows >= 0)]

    def border(self) -> Float:
        """Length (M,) of the part of each line that separates two labels, whole px."""
        edges = np.concatenate([_edges(region, 0.0) for _, region in self.labels.regions])
        start, direction = self.lines[:, 0], self.lines[:, 1] - self.lines[:, 0]
        length = np.linalg.norm(direction, axis=1)
        along = ((edges[:, None] - start[None, :, None]) * (direction / length[:, None])[None, :, None]).sum(axis=3)
        shared = np.minimum(along.max(axis=2), length) - np.maximum(along.min(axis=2), 0.0)
        of_both = np.where(self._in_line(edges), np.maximum(shared, 0.0), 0.0)  # regions on both sides have each edge
        border: Float = np.rint(of_both.sum(axis=0) / 2)
        return border

    def _in_line(self, edges: Float) -> Bool:
        """Which edges (E, 2, 2) lie on which lines (E, M), however far these are drawn out."""
        across = unit_normals(self.lines[:, 1] - self.lines[:, 0])
        off = np.abs(((edges[:, None] - self.lines[None, :, :1]) * across[None, :, None]).sum(axis=3)).max(axis=2)
        return np.asarray(off < ON_BORDER)


def simplest(first: Outlined, draw: Callable[[Int], Outlined], meets: int) -> Labels:
    """Labels with few corners, from `first` to fewer lines; `draw` labels what lines of some rows cut out.

    In the first `meets` rows surfaces meet: these are no steps.
    """
    found = [first]
    for run in RUNS:
        found.append(draw(np.unique(_with_long_border(found[-1], run))))
    best = min(found, key=lambda each: each.labels.price)
    return _without_steps(_with_surfaces_given_up(best, found, draw), draw, meets).labels


def _with_long_border(found: Outlined, run: float) -> Int:
    """Rows of lines with a border of `run` of the photo's width or more in one piece, of a side of the shortest run."""
    labels, width = found.labels, found.width
    least = [(RUNS[0] if labels.is_side(number) else run) * width for number, _ in labels.regions]
    edges = [_edges(region, shortest) for (_, region), shortest in zip(labels.regions, least, strict=True)]
    return found.bordering(np.concatenate(edges))


def _with_surfaces_given_up(best: Outlined, found: list[Outlined], draw: Callable[[Int], Outlined]) -> Outlined:
    """The best answer with the surfaces that it gave up, each with its outline in the last answer that shows it.

    A surface comes back where it makes faces cheaper and none of the others loses more than a step.
    """
    for number in range(best.labels.sky):
        last = next((each for each in reversed(found) if _is_given_up(number, each, best)), None)
        if last is None:
            continue
        edges = [_edges(region, RUNS[0] * best.width) for n, region in last.labels.regions if n == number]
        more = draw(np.union1d(best.used, last.bordering(np.concatenate(edges))))
        loses_none = (more.shares >= (1 - MOST_LOST) * best.shares)[: best.labels.sky].all()
        is_cheaper = more.labels.price_of_faces < best.labels.price_of_faces
        if loses_none and is_cheaper and not _is_given_up(number, last, more):
            best = more
    return best


def _is_given_up(number: int, found: Outlined, best: Outlined) -> bool:
    """Whether the best answer shows less than half of a surface, by LEAST_GIVEN_UP, and mostly no surface there."""
    before, now = found.shares[number], best.shares[number]
    if before - now <= max(LEAST_GIVEN_UP, before / 2):
        return False
    return bool((best.shown[found.shown == number] >= best.labels.sky).mean() > 1 / 2)


def _without_steps(best: Outlined, draw: Callable[[Int], Outlined], meets: int) -> Outlined:
    """The answer without the lines that cut off steps, each asked once, those with the least border first.

    The first `meets` rows are none, nor are lines with LONGEST border or without which a label loses MOST_LOST.
    """
    least, length = (1 - MOST_LOST) * best.shares, best.border()
    may_be = (best.rows >= meets) & (length > 0) & (length < LONGEST * best.width)
    for row in best.rows[may_be][np.argsort(length[may_be], kind="stable")].tolist():
        fewer = draw(best.used[best.used != row])
        if fewer.labels.price < best.labels.price and (fewer.shares >= least).all():
            best = fewer
    return best


def _edges(region: shapely.Polygon, least: float) -> Float:
    """(E, 2, 2) the edges of a region, of `least` px or more."""
    rings = [shapely.get_coordinates(ring) for ring in (region.exterior, *region.interiors)]
    edges = np.concatenate([np.stack([corners[:-1], corners[1:]], axis=1) for corners in rings])
    return np.asarray(edges[np.linalg.norm(edges[:, 1] - edges[:, 0], axis=1) >= least])
