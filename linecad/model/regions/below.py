"""Walls below their lines: a wall goes down to the ground.

What the photo shows below the lowest line of a wall is as plain as the ground, and often of its colour. But a wall that
is seen hides the ground behind it: what would be ground farther away than the wall that is seen above it is that wall.
"""

import cv2
import numpy as np

from linecad.arrays import Float, Int
from linecad.model.regions.corners import Known
from linecad.model.regions.evidence import BEHIND, depths, is_green
from linecad.model.regions.surfaces import Surface

HIDDEN_COST = 1.0  # of ground that would be seen through the wall above it
WALL_COST = 0.6  # of that wall there, at most
LEAST = 0.003  # of the photo; less is how exactly borders follow feet
PLANTS = 15  # samples above the ground that are looked at for green
MOST_GREEN = 0.3  # of them


def with_feet(costs: Float, known: Known, firm: Surface | None) -> Float:
    """Costs (S, K + 2), dearer for ground and cheaper for walls where walls that are shown go down to it.

    `firm` is the ground, if its height is sure: of one too low walls would cover what is before them.
    """
    ground = next((number for number, surface in enumerate(known.surfaces) if surface is firm), None)
    if ground is None:
        return costs
    above = walls_above(known, ground)
    costs = costs.copy(order="F")
    walls = np.unique(above[above >= 0]).tolist()
    to_ground, *to_walls = depths(known.raster, [known.surfaces[number] for number in (ground, *walls)]).T
    for number, to_wall in zip(walls, to_walls, strict=True):
        under = (above == number) & (to_wall < to_ground / BEHIND)
        if under.mean() >= LEAST:
            costs[under, ground] += HIDDEN_COST
            costs[under, number] = np.minimum(costs[under, number], WALL_COST)
    return costs


def walls_above(known: Known, ground: int) -> Int:
    """The wall (S,) that is shown above each sample of surface `ground` in its column; -1 where none is, and elsewhere.

    Clutter between the two does not count: a car stands before its wall. Nor does a wall whose lowest part is green:
    plants before it hide where it ends, and feet are found at theirs.
    """
    clutter = len(known.surfaces) + 1
    is_wall = np.array([surface.kind == "wall" for surface in known.surfaces] + [False] * 2)
    shown = known.shown.reshape(known.raster.shape)
    grown = cv2.blur(is_green(known.raster).reshape(shown.shape).astype(np.float32), (1, PLANTS)) > MOST_GREEN
    above = np.full(shown.shape, -1)
    for row in range(1, len(shown)):
        last, plants = shown[row - 1], grown[max(row - 1 - PLANTS // 2, 0)]
        seen = np.where(plants, -1, last)
        above[row] = np.where(is_wall[last], seen, np.where((last == ground) | (last == clutter), above[row - 1], -1))
    found: Int = np.where(shown == ground, above, -1).ravel()
    return found
