"""Whether plants hide the feet of walls.

A hedge before a wall has a foot as straight as the wall's, in front of it: in the wall's plane that is far below.
"""

import numpy as np

from linecad.geometry import project
from linecad.model.regions.raster import Raster
from linecad.model.regions.segments import View
from linecad.model.regions.surfaces import GroundOfFeet, level_of_ends, weights_of
from linecad.scene import Lines

STEPS = 8  # between the height from which on plants are looked for and the foot
BEGINS = 0.5  # times the lowest level of the lines
MOST_PLANTS = 0.15  # of what the photo shows there; 0.37 where a hedge was taken for the foot, else 0 to 0.02


def is_in_the_open(feet: GroundOfFeet, lines: Lines, raster: Raster, view: View) -> bool:
    """Whether the photo shows hardly any plants below the lines, in their planes, down to the ground of `feet`."""
    lowest = level_of_ends(lines, above=False)
    if lowest is None:
        return False
    heights = -np.linspace(BEGINS * lowest, feet.height, STEPS)
    points = np.repeat(lines.ends.mean(axis=1)[:, None], STEPS, axis=1)  # (N, STEPS, 3)
    points[:, :, 2] = heights
    below = (lines.ends[:, :, 2].min(axis=1)[:, None] > heights) & (points @ view.rotation[2] > 0)
    line, step = np.nonzero(below)
    column, row = np.floor(project(points[line, step], view.camera.matrix, view.rotation) / raster.step).astype(int).T
    inside = (column >= 0) & (row >= 0) & (column < raster.shape[1]) & (row < raster.shape[0])
    weight = weights_of(lines)[line[inside]]
    plants = raster.plants.reshape(raster.shape)[row[inside], column[inside]]
    return bool(weight.sum() > 0 and (weight * plants).sum() <= MOST_PLANTS * weight.sum())
