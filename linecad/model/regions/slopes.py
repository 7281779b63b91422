"""How steep a roof is, by the line that ends it beside its ridge.

With P the point where the end of a roof begins on the eave, and Q the one where it ends on the ridge: a *verge* runs in
the upright plane across the eave, a *hip* between two roofs of one slope at 45 degrees to it in plan, inwards, and a
*valley* outwards. So P, whose place is known, and the ray of Q tell Q, and the slope.
"""

from dataclasses import dataclass
from itertools import product
from typing import Literal

import numpy as np

from linecad.arrays import Float
from linecad.directions import UP, directions_of
from linecad.model.regions.profiles import Shown, Wall

End = Literal["verge", "hip", "valley"]

USUAL, SPREAD = np.radians(45.0), np.radians(9.0)  # of roofs: docs/decisions/0101
FLATTEST, STEEPEST = np.radians(20.0), np.radians(68.0)
SHIFT, NORMAL_WIDTH = 1.0, 1280.0  # px at that width by which an end may err in the photo
ERROR = np.radians(5.0)  # of a slope whose end is seen well: frames err, and two slopes beside a hip differ
UNSURE = np.radians(8.0)  # error of a slope that tells no more than that there is an end


@dataclass(frozen=True)
class Slope:
    """A slope that the end of a roof tells."""

    angle: float  # rad above the level
    error: float  # rad
    end: End


def slopes_by(foot: Float, top: Float, inwards: float, wall: Wall, shown: Shown, ends: tuple[End, ...]) -> list[Slope]:
    """The slopes that an end from `foot` to `top` (2,) px tells, one for each thing of `ends` that it may be.

    `inwards` is 1 where the roof lies at larger components along the wall, else -1.
    """
    vectors = directions_of(shown.view.turns)
    along, back = vectors[wall.along], np.sign(wall.offset) * vectors[wall.axis]
    start = wall.point(shown.rays(foot), shown)
    reach = SHIFT * max(shown.view.camera.width / NORMAL_WIDTH, 1.0)
    run = (top - foot) / np.linalg.norm(top - foot)
    tops = top + reach * np.array([[0.0], [1.0], [-1.0]]) * np.array([run[1], -run[0]])
    rays = shown.rays(tops)
    seen = rays[:, [wall.axis, wall.along, UP]] @ vectors[[wall.axis, wall.along, UP]]
    found = []
    for end in ends:
        normal = along - {"verge": 0.0, "hip": inwards, "valley": -inwards}[end] * back
        with np.errstate(divide="ignore", invalid="ignore"):
            depth = (normal @ start) / (seen @ normal)
        rise = seen * depth[:, None] - start
        angles = np.arctan2(rise[:, UP], rise @ back)
        if not (np.isfinite(depth).all() and (depth > 0).all() and FLATTEST < angles[0] < STEEPEST):
            continue
        error = np.hypot(np.abs(angles - angles[0]).max(), ERROR)
        found.append(Slope(float(angles[0]), float(error), end))
    return found


def slope_of(left: list[Slope], right: list[Slope]) -> float | None:
    """The slope, rad, that the ends of a roof tell together, each being what agrees best; None where neither tells any.

    What is usual has its say: it is the mean of that and of the ends, by their errors.
    """
    choices = list(product(*(end for end in (left, right) if end)))
    if not choices or not choices[0]:
        return None
    told = max(choices, key=_likely)
    weight = np.array([SPREAD**-2, *(each.error**-2 for each in told)])
    return float(weight @ [USUAL, *(each.angle for each in told)] / weight.sum())


def _likely(told: tuple[Slope, ...]) -> float:
    """Log of how likely such ends are, given that they are of one roof."""
    usual = -sum((each.angle - USUAL) ** 2 / (SPREAD**2 + each.error**2) for each in told) / 2 / len(told)
    apart = told[0].angle - told[-1].angle
    return float(usual - apart**2 / (told[0].error ** 2 + told[-1].error ** 2) / 2)
