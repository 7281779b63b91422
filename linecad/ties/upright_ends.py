"""Ends of uprights: the heights of heads and sills, of floors and eaves, are the same in two parts of one building.

Courses of bricks, boards and blinds have levels at all heights, so that levels (`linecad.ties.levels`) match at any
ratio. Uprights end where something ends: jambs at heads and sills, corners at eaves and at the ground.
"""

import numpy as np

from linecad.arrays import Float
from linecad.directions import UP
from linecad.ties.frequencies import Frequencies, Spectrum, spectrum
from linecad.ties.setting import Setting

FLATTEST = 0.03  # of the body's median depth: nearer to eye level a height says nothing
LEAST_ENDS = 3  # above the camera, or below, for frequencies to tell anything
ALIKE = 0.004  # log height: standard deviation of how well one is known
AROUND = 0.2  # log height to both sides, over which frequencies are counted against their mean


def find_upright_ends(setting: Setting) -> list[Frequencies]:
    """How often uprights of each body end at each height, below the camera and above it.

    By the roots of the counts, which are as uncertain in tall heaps as in low ones: a wall has dozens of ends at one
    height.
    """
    found = []
    for lines in setting.lines:
        middle = float(np.median(setting.log_depth[lines]))
        ends = setting.reach[lines[setting.graph.axis[lines] == UP]].ravel()
        found.append(Frequencies(middle, tuple(_spectrum(sign * ends, middle) for sign in (-1, 1))))
    return found


def _spectrum(heights: Float, middle: float) -> Spectrum | None:
    telling = heights[heights > FLATTEST * np.exp(middle)]
    if len(telling) < LEAST_ENDS:
        return None
    return spectrum(np.log(telling) - middle, ALIKE, AROUND, scaled=np.sqrt)
