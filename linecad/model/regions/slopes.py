"""How steep a roof is, by the line that ends it beside its ridge.

With P the point where the end of a roof begins on the eave, and Q the one where it ends on the ridge: a *verge* runs in
the upright plane across the eave, a *hip* between two roofs of one slope at 45 degrees to it in plan, inwards, and a
*valley* outwards. So P, whose place is known, and the ray of Q tell Q, and the slope.
"""

from dataclasses import dataclass, replace
from itertools import product
from typing import Literal

import numpy as np

from linecad.arrays import Float
from linecad.directions import UP
from linecad.model.regions.bearings import Bearing
from linecad.model.regions.profiles import Shown, Wall

End = Literal["verge", "hip", "valley"]

USUAL, SPREAD = np.radians(45.0), np.radians(9.0)  # of roofs: docs/decisions/0101
FLATTEST, STEEPEST = np.radians(20.0), np.radians(68.0)
SHIFT = 1.0  # px at a width of NORMAL_WIDTH, by which an end may err in the photo
ERROR = {"verge": np.radians(1.5), "hip": np.radians(5.0), "valley": np.radians(5.0)}  # of a slope by an end seen well
SQUARE = np.radians(0.75)  # by which a verge may be turned from the right angle to its eave
ABUTS = np.radians(4.0)  # the same where something is seen beside it: a wall of another house may cut the roof off
UNSURE = np.radians(12.0)  # error of a slope that tells no more than that there is an end


@dataclass(frozen=True)
class Slope:
    """A slope that the end of a roof tells."""

    angle: float  # rad above the level
    error: float  # rad
    end: End


@dataclass(frozen=True, eq=False)
class Edge:
    """The line in the photo that ends a roof, and what is known of it."""

    foot: Float  # (2,) px, at the eave
    top: Float  # (2,) px, at the ridge
    inwards: float  # 1 where the roof lies at larger components along its wall, else -1
    bearing: Bearing  # of its eave
    is_free: bool  # the sky is seen beside it: nothing there cuts the roof off


def slopes_by(edge: Edge, wall: Wall, shown: Shown, may_be: tuple[End, ...]) -> list[Slope]:
    """The slopes that the edge of a roof tells, one for each thing that it may be."""
    run = (edge.top - edge.foot) / np.linalg.norm(edge.top - edge.foot)
    across = SHIFT * shown.pixel * np.array([run[1], -run[0]])
    found, zero = [], np.zeros(2)
    for end in may_be:
        turn = edge.bearing.error
        if end == "verge":
            turn = float(np.hypot(turn, SQUARE if edge.is_free else ABUTS))
        seen = ((zero, 0.0), (across, 0.0), (-across, 0.0), (zero, turn), (zero, -turn))
        told, *others = (_angle(replace(edge, top=edge.top + off), end, more, wall, shown) for off, more in seen)
        off = np.abs(np.array(others) - told)
        if np.isfinite(off).all() and FLATTEST < told < STEEPEST:
            found.append(Slope(told, float(np.linalg.norm([off[:2].max(), off[2:].max(), ERROR[end]])), end))
    return found


def _angle(edge: Edge, end: End, more: float, wall: Wall, shown: Shown) -> float:
    """The slope, rad, with the eave turned by so much more; not finite where the photo cannot show it."""
    along = edge.bearing.turned(wall.direction, more)
    back = np.sign(wall.offset) * edge.bearing.turned(wall.normal, more)
    normal = along - {"verge": 0.0, "hip": edge.inwards, "valley": -edge.inwards}[end] * back
    start, seen = wall.point(shown.rays(edge.foot)), shown.rays(edge.top)
    with np.errstate(divide="ignore", invalid="ignore"):
        depth = (normal @ start) / (seen @ normal)
    rise = seen * depth - start
    return float(np.arctan2(rise[UP], rise @ back)) if depth > 0 else float("nan")


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
