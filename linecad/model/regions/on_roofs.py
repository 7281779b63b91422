"""Clutter that is part of a building: a dome, a lantern, a gable of another shape, against the sky."""

import cv2
import numpy as np
import shapely

from linecad.arrays import Bool
from linecad.model.regions.labels import Labels
from linecad.model.regions.raster import Raster

MOST_PLANTS = 0.3  # of its samples


def is_on_roof(part: shapely.Polygon, labels: Labels, raster: Raster) -> bool:
    """Whether clutter, px, stands out against the sky and on no ground, and is no plant: a lantern, not a tree.

    Without a photo nothing is.
    """
    if not np.ptp(raster.colour.reshape(-1, 3), axis=0).any():
        return False
    inside = raster.inside(part).reshape(raster.shape)
    beside = labels.label[labels.cell].reshape(raster.shape)[_grown(inside) & ~inside]
    on_ground = any(labels.surfaces[number].kind == "ground" for number in np.unique(beside[beside < labels.sky]))
    is_plant = inside.any() and raster.plants[inside.ravel()].mean() > MOST_PLANTS
    return bool((beside == labels.sky).any() and not on_ground and not is_plant and not _at_border(inside))


def _grown(mask: Bool) -> Bool:
    return np.asarray(cv2.dilate(mask.astype(np.uint8), np.ones((3, 3), np.uint8)) > 0)


def _at_border(mask: Bool) -> bool:
    return bool(mask[0].any() or mask[-1].any() or mask[:, 0].any() or mask[:, -1].any())
