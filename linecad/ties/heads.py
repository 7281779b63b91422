"""Where walls meet the ceiling: the network that reads their feet reads their heads too, the photo being upside down.

Lines alone do not tell how high a ceiling is: shelves, doors and pictures end below it, and its own edge, that nothing
crosses, is in no body with them. Seen on a wall of known place its edge has a height, and all walls have one ceiling.
"""

import numpy as np

from linecad.arrays import Float
from linecad.ties.feet import SAME, FootReader
from linecad.ties.setting import Setting
from linecad.ties.walls import find_walls

# Of the log of a ceiling's height above the camera over the camera's above the ground: 1.6 m above it, 2.4 to 3.1 m.
USUAL, SPREAD = -0.4, 0.35
LEAST_USUAL = 0.1  # what an unusual height counts, halls being higher
BEFORE = 0.05  # log height by which what stands before its wall, as a shelf does, may show a head too low
UPPER = 0.75  # of the heads that agree, by their probabilities, the quantile that is the ceiling
LEAST = 0.25  # sum of the probabilities of walls, from which a ceiling is told by them


def log_height_of_ceiling(setting: Setting, log_scale: Float, log_ground: float | None) -> float | None:
    """Log of the height of the ceiling above the camera, of bodies at log scales (B,).

    None where too few walls show their head. `log_ground` is the log of the camera's height above the ground.
    """
    walls = find_walls(setting)
    found = [
        (log_height + log_scale[wall.body], share)
        for wall, reading in zip(walls, FootReader(setting, is_above=True).read(walls), strict=True)
        if reading is not None
        for log_height, share in reading.peaks
    ]
    if not found:
        return None
    height, share = np.array(found).T
    above = height - height[:, None]
    near = (above > -BEFORE) & (above < SAME)
    agreeing = near @ share
    usual = np.ones(len(height))
    if log_ground is not None:
        usual = np.maximum(np.exp(-(((height - log_ground - USUAL) / SPREAD) ** 2) / 2), LEAST_USUAL)
    worth = np.where(agreeing >= LEAST, agreeing * usual, 0.0)
    best = int(worth.argmax())
    if worth[best] == 0:
        return None
    own = near[best]
    return float(np.quantile(height[own], UPPER, weights=share[own], method="inverted_cdf"))
