"""What every cell of a photo shows, and what that costs."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely

from linecad.arrays import Float, Int
from linecad.model.regions.cuts import Borders, energy
from linecad.model.regions.partition import polygons_of
from linecad.model.regions.surfaces import Surface

UNIT = 100  # of whole costs, in one sample
CORNER = 0.0025  # cost of one more corner of an outline, in samples of all
STRAIGHT = 1e-6  # px; a corner nearer to the straight outline is none


@dataclass(frozen=True, eq=False)
class Labels:
    """C cells of a photo with what they show, one of K surfaces, sky or clutter."""

    surfaces: list[Surface]  # those that are shown
    cells: list[shapely.Polygon]  # px
    cell: Int  # (S,) of each sample
    label: Int  # (C,) from 0: a surface, then the sky, then clutter
    of_samples: Float  # (S, K + 2) costs of each sample by itself
    costs: Int  # (C, K + 2), of the cells as they were labelled: feet of walls cut them further
    borders: Borders  # of the same cells
    gap: float = 1.0  # by which other labels may be cheaper, as a share of what is not cheapest; 1: nothing is known

    @property
    def sky(self) -> int:
        """The label of the sky."""
        return len(self.surfaces)

    @property
    def clutter(self) -> int:
        """The label of what has no plane."""
        return len(self.surfaces) + 1

    def is_side(self, label: int) -> bool:
        """Whether a label is a wall that begins where another one ends: it may be as narrow as that is thick."""
        return label < self.sky and self.surfaces[label].price < 1

    @cached_property
    def regions(self) -> list[tuple[int, shapely.Polygon]]:
        """Every connected union of cells with one label, px, with corners only where its outline turns."""
        return [
            (number, region)
            for number in np.unique(self.label).tolist()
            for region in united([cell for cell, own in zip(self.cells, self.label, strict=True) if own == number])
        ]

    @cached_property
    def price(self) -> float:
        """What labels and corners cost, in samples; that of having a surface is not among it."""
        return energy(self.costs, self.borders, self.label) / UNIT + self._price_of_corners(0)

    @property
    def price_of_faces(self) -> float:
        """The same without the corners of sky and clutter, which no face has."""
        return self.price - self._price_of_corners(self.sky)

    def _price_of_corners(self, first: int) -> float:
        """What the corners of labels from the `first` on cost, in samples."""
        corners = sum(len(shapely.get_coordinates(region)) for number, region in self.regions if number >= first)
        return CORNER * corners * len(self.cell)


def united(cells: list[shapely.Polygon]) -> list[shapely.Polygon]:
    """The connected unions of cells, px, with corners only where their outlines turn."""
    union = shapely.simplify(shapely.union_all(np.array(cells, object)), STRAIGHT)
    return polygons_of(union)
