"""Which rectangles are taken: the most likely first, none that overlaps another in the photo."""

import numpy as np
import shapely

from linecad.arrays import Float, Int

SHARED = 0.1  # of the smaller of two openings, from which they overlap in the photo


def choose(shapes: list[shapely.Polygon], value: Float) -> Int:
    """The places (M,) of the taken ones among shapes in the photo, in the order of their places.

    Openings of different walls compete too, since each pixel shows one of them.
    """
    every = np.array(shapes, object)
    area = shapely.area(every)
    tree = shapely.STRtree(every)
    is_open = np.ones(len(every), bool)
    taken = []
    for number in np.argsort(-value, kind="stable").tolist():
        if not is_open[number]:
            continue
        taken.append(number)
        near = tree.query(every[number])
        shared = shapely.area(shapely.intersection(every[near], every[number]))
        is_open[near[shared > SHARED * np.minimum(area[near], area[number])]] = False
    return np.array(sorted(taken), np.int64)
