"""Regions as a person told them: labels that hold to the last cell, and nothing before what is in sight."""

from dataclasses import replace

import numpy as np
import shapely

from linecad.model.regions.filling import Filled
from linecad.model.regions.told import Told, column_of, polygons


def with_told(filled: Filled, told: Told) -> Filled:
    """The regions with labels as told, also of cells that are too small for a sample, or that feet have moved."""
    if not told.areas:
        return filled
    labels = filled.labels
    middle = shapely.point_on_surface(np.array(labels.cells, object))
    label = labels.label.copy()
    for area in told.areas:
        number = None if area.shows == "clutter" else column_of(area, labels.surfaces)
        if number is not None:
            label[shapely.contains(area.shape, middle)] = number
    return replace(filled, labels=replace(labels, label=label))


def uncovered(filled: Filled, told: Told) -> Filled:
    """The regions with what was told to be clutter before them, none before told ground, and no roof in any area."""
    filled = replace(filled, told=told.notes)
    if not told.areas:
        return filled
    every = shapely.union_all([area.shape for area in told.areas])
    clutter = shapely.difference(filled.clutter, told.shapes("ground", "sky"))
    roofs = [
        replace(
            roof,
            polygon=polygons(shapely.difference(roof.polygon, every)),
            hood=polygons(shapely.difference(roof.hood, every)),
        )
        for roof in filled.roofs
    ]
    return replace(
        filled,
        clutter=shapely.union_all([clutter, told.shapes("clutter")]),
        roofs=tuple(roof for roof in roofs if not roof.polygon.is_empty),
    )
