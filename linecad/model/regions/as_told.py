"""Regions as a person told them: labels that hold to the last cell, and nothing before what is in sight."""

from dataclasses import replace

import numpy as np
import shapely

from linecad.arrays import Bool, Int
from linecad.model.regions.cuts import Borders
from linecad.model.regions.filling import Filled, neighbours
from linecad.model.regions.surfaces import Surface
from linecad.model.regions.told import Told, column_of, polygons


def with_told(filled: Filled, told: Told) -> Filled:
    """The regions with labels as told, also of cells that are too small for a sample, or that feet have moved."""
    if not told.areas:
        return filled
    labels = filled.labels
    middle = shapely.point_on_surface(np.array(labels.cells, object))
    label = labels.label.copy()
    beyond = np.zeros(len(label), bool)
    for area in told.areas:
        number = None if area.shows == "clutter" else column_of(area, labels.surfaces)
        if number is not None:
            inside = shapely.contains(area.shape, middle)
            label[inside] = number
            beyond |= (label == number) & ~inside & isinstance(area.shows, Surface)
    if beyond.any():
        label = _as_beside(label, beyond, neighbours(labels.cells), labels.clutter)
    return replace(filled, labels=replace(labels, label=label))


def _as_beside(label: Int, taken: Bool, borders: Borders, clutter: int) -> Int:
    """Labels (C,) of which those that are `taken` away (C,) become that of most of the cells around, else clutter."""
    found = label.copy()
    one, other = np.concatenate([borders.cells, borders.cells[:, ::-1]]).T
    cost = np.concatenate([borders.cost, borders.cost])
    for cell in np.flatnonzero(taken).tolist():
        around = (one == cell) & ~taken[other]
        shared = np.bincount(label[other[around]], cost[around], clutter + 1)
        found[cell] = int(shared.argmax()) if around.any() else clutter
    return found


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
