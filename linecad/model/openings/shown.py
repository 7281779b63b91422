"""Where the photo shows which wall, by its openings: in each of them, and between two of one row or column."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import shapely

from linecad.arrays import Bool, Float, Int, true_places
from linecad.model.openings.lattice import mates
from linecad.model.openings.raster import Raster

WIDEST = 1.5  # times the wider of two, of the wall between them, if it is one
LEVEL = 0.5  # of the taller of two, which both have


@dataclass(frozen=True, eq=False)
class WallShown:
    """A part of the photo that shows a wall."""

    axis: int  # direction along which the wall faces
    shape: shapely.Polygon  # px
    is_opening: bool  # else between two


def walls_shown(
    axis: int, raster: Raster, box: Int, shapes_of: Callable[[Raster, Int], list[shapely.Polygon]]
) -> list[WallShown]:
    """What openings (N, 4) of a wall that faces along `axis` show; `shapes_of` puts rectangles into the photo.

    One without another of its size in its row or column says nothing: alone it is less sure, and may be a car's.
    """
    box = box[np.logical_or(*mates(box, box, raster)).any(axis=1)]
    upright = [2, 3, 0, 1]
    beside = _between(box, raster.u, raster.v)
    above = _between(box[:, upright], raster.v, raster.u)[:, upright]
    shapes = shapes_of(raster, np.concatenate([box, beside, above]))
    return [WallShown(axis, shape, row < len(box)) for row, shape in enumerate(shapes)]


def _between(box: Int, along: Float, across: Float) -> Int:
    """The rectangles (M, 4) between two of a row (N, 4), of columns at `along` and rows at `across`."""
    start, end = along[box[:, 0]], along[box[:, 1]]
    low, high = np.maximum.outer(box[:, 2], box[:, 2]), np.minimum.outer(box[:, 3], box[:, 3])
    wide, tall = end - start, np.abs(across[box[:, 3]] - across[box[:, 2]])
    gap = start[None] - end[:, None]
    is_row = np.abs(across[np.maximum(low, high)] - across[low]) > LEVEL * np.maximum.outer(tall, tall)
    is_next: Bool = is_row & (gap > 0) & (gap < WIDEST * np.maximum.outer(wide, wide))
    one, other = true_places(is_next)
    found: Int = np.column_stack([box[one, 1], box[other, 0], low[one, other], high[one, other]])
    return found
