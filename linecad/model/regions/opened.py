"""Where windows and doors tell along which axis a wall faces."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import shapely

from linecad.arrays import Bool, Float
from linecad.corrections.edits import FaceEdit, NoWindow
from linecad.depth.normals import UNTOLD
from linecad.directions import directions_of
from linecad.model.openings.shown import WallShown
from linecad.model.regions.raster import Raster
from linecad.model.regions.surfaces import Surface

TURNED = 0.8  # cost of another axis, of a sample that openings tell of
EACH, MOST = 300.0, 10.0  # the same of one opening, spread over its samples, and of one of them at most
ALIKE = 0.7  # cosine between walls, from which on one's openings do not tell it from the other


def with_walls_shown(raster: Raster, shown: Sequence[WallShown], faces: Sequence[FaceEdit] = ()) -> Raster:
    """The raster with what openings say about each sample, but for those that a person says are none.

    One small window is as sure as a large one, so each adds a cost of its own, spread over its samples.
    """
    axis, cost = np.full(raster.size, UNTOLD), np.zeros(raster.size)
    none = shapely.MultiPoint([each.at for each in faces if isinstance(each, NoWindow)])
    for wall in shown:
        if wall.shape.intersects(none):
            continue
        inside = raster.inside(wall.shape)
        own = min(TURNED + EACH * wall.is_opening / max(1, int(inside.sum())), MOST)
        stronger = inside & (own > cost)
        axis[stronger], cost[stronger] = wall.axis, own
    return replace(raster, opened=axis, opened_cost=cost)


def costs_by_openings(raster: Raster, surfaces: Sequence[Surface]) -> Float:
    """What each surface (S, K) costs where openings say otherwise."""
    costs = np.zeros((raster.size, len(surfaces)), order="F")
    for number, surface in enumerate(surfaces):
        costs[:, number] = raster.opened_cost * shows_another(raster, surface.axis)
    return costs


def shows_another(raster: Raster, axis: int) -> Bool:
    """Where (S,) openings tell of a wall that faces another way than along an axis."""
    normals = directions_of(raster.turns)
    unlike = np.abs(normals @ normals[axis]) < ALIKE
    return np.asarray((raster.opened != UNTOLD) & unlike[np.where(raster.opened == UNTOLD, 0, raster.opened)])
