"""What a part of the photo may show: the walls of the scene, its ground, its ceiling.

Planes that a wall's relief puts a little before and behind it are one wall here: the one with the most lines stands for
them. The ground may be where the feet of walls put it, at the lowest of the lines, or at a level of many lines.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from linecad.arrays import Float, Int
from linecad.scene import Camera, Lines, Plane

Kind = Literal["wall", "level", "kerb", "ground", "ceiling"]

RELIEF = 0.012  # log offset within which parallel planes are one wall
GROUND_STEP = 0.12  # the same between the ground and a kerb or step, which are no ground of their own
SAME_LEVEL = 0.03  # the same between the ground that feet found and lines that lie on it; between them may be a kerb
LEAST_LENGTH = 0.02  # of a surface's lines together, as a share of the photo's width
MOST_SURFACES = 20
NEARLY_ALL = 0.95  # of the length of the lines that reach below the horizon ends above the lowest level
LEAST_ENDS = 3  # of lines on one side of the horizon, for a level there
FURTHEST_FOOT = 1.5  # times the lowest level; the ground is no lower, unless feet are firm and in the open:
FURTHEST_FIRM = 3.5  # below shop windows and plain walls there is no line
FIRM_FEET = 10.0  # log-odds of the feet of walls, from which on they know the ground better than a map or few lines
BELOW = 1.04  # times the ground's height; a line that ends lower contradicts it
CONTRADICTION = 20.0  # log-odds against a ground, times the share of lines that contradict it
LEVEL_LINES, LEVEL_SHARE = 8, 0.05  # of a level that may be the ground, with its share of what lines say about levels
MOST_LEVELS = 2  # that may be the ground, those with the most of that


@dataclass(frozen=True, eq=False)
class Surface:
    """All points whose coordinate `axis` is `offset`, with the rows of the lines that show it."""

    kind: Kind
    axis: int
    offset: float
    lines: Int  # (M,) rows of the scene's lines
    plane: int | None  # id of the plane that stands for it; None for one without lines of its own
    box: Float | None = None  # (2, K) low and high components of a wall, where more than its lines tells them
    price: float = 1.0  # of having it, in that of one whose place no other surface tells


@dataclass(frozen=True)
class GroundOfFeet:
    """The ground as the feet of walls put it."""

    height: float  # of the camera above it, in the scene's unit
    log_odds: float  # of all that says so
    is_open: bool = False  # no plants hide the feet (`linecad.model.regions.overgrown`)


@dataclass(frozen=True)
class Ground:
    """A height at which the ground may be."""

    height: float  # of the camera above it, in the scene's unit
    reach: float  # log offset within which it is the level of lines that is there
    of_feet: float = 0.0  # log-odds of the feet of walls that put it there
    is_by_feet: bool = False


def find_walls(planes: tuple[Plane, ...], lines: Lines, camera: Camera) -> list[Surface]:
    """The walls and levels of a scene, those with the longest lines first."""
    length = np.linalg.norm(lines.segment[:, 1] - lines.segment[:, 0], axis=1)
    row = {number: index for index, number in enumerate(lines.id.tolist())}
    members = [np.array([row[number] for number in plane.lines], np.int64) for plane in planes]
    order = sorted(range(len(planes)), key=lambda index: (-length[members[index]].sum(), index))
    found: list[Surface] = []
    for index in order:
        plane, own = planes[index], members[index]
        for number, wall in enumerate(found):
            if wall.axis == plane.axis and apart(wall.offset, plane.offset) < RELIEF:
                both = np.union1d(wall.lines, own)
                found[number] = Surface(wall.kind, wall.axis, wall.offset, both, wall.plane)
                break
        else:
            kind: Kind = "level" if plane.axis == 2 else "wall"
            found.append(Surface(kind, plane.axis, plane.offset, own, plane.id))
    return [wall for wall in found if length[wall.lines].sum() >= LEAST_LENGTH * camera.width][:MOST_SURFACES]


def find_surfaces(walls: list[Surface], ground: Ground | None, ceiling: float | None) -> list[Surface]:
    """The walls and levels, then the ground and the ceiling, of which `ceiling` is the height above the camera."""
    if ground is not None:
        walls = _with_level(walls, "ground", -ground.height, ground.reach)
    return walls if ceiling is None else _with_level(walls, "ceiling", ceiling, GROUND_STEP)


def likely_grounds(walls: list[Surface], lines: Lines, feet: GroundOfFeet | None) -> list[Ground]:
    """Where the ground may be: first where it is by lines and feet alone, then its rivals; none above the horizon.

    Feet put it there unless lines that end lower say as much against it; then it is at the lowest of the lines, and
    that of the feet, where no plants hide them, is a rival. So are the levels of many lines among the `walls`.
    """
    lowest = level_of_ends(lines, above=False)
    if lowest is None:
        return []
    found = [Ground(lowest, GROUND_STEP)]
    if feet is not None:
        furthest = FURTHEST_FIRM if feet.is_open and feet.log_odds >= FIRM_FEET else FURTHEST_FOOT
        if feet.height < furthest * lowest:
            trodden = Ground(feet.height, SAME_LEVEL, feet.log_odds, is_by_feet=True)
            if feet.log_odds > against(lines, feet.height):
                found.insert(0, trodden)
            elif feet.is_open:  # else it may be the foot of a hedge, where the photo shows an edge too
                found.append(trodden)
    weight, below = weights_of(lines), lines.ends[:, :, 2].min(axis=1) < 0
    levels = [wall for wall in walls if wall.axis == 2 and wall.offset < 0 and len(wall.lines) >= LEVEL_LINES]
    levels = [level for level in levels if weight[level.lines].sum() >= LEVEL_SHARE * weight[below].sum()]
    levels.sort(key=lambda level: -weight[level.lines].sum())
    return found + [Ground(-level.offset, SAME_LEVEL) for level in levels[:MOST_LEVELS]]


def against(lines: Lines, height: float) -> float:
    """Log-odds of the lines that end lower against a ground, by the height of the camera above it."""
    weight, low = weights_of(lines), -lines.ends[:, :, 2].min(axis=1)
    below = weight[low > 0].sum()
    return CONTRADICTION * float(weight[low > height * BELOW].sum() / below) if below > 0 else 0.0


def is_contested(grounds: list[Ground]) -> bool:
    """Whether the ground of the feet is a rival of another one."""
    return any(ground.is_by_feet for ground in grounds[1:])


def ground_of_feet(surfaces: list[Surface], ground: Ground | None) -> Surface | None:
    """The ground of those that were found, if feet of walls made it what it is."""
    if ground is None or not ground.is_by_feet:
        return None
    return next((surface for surface in surfaces if surface.kind == "ground"), None)


def level_of_ends(lines: Lines, above: bool) -> float | None:
    """How far above or below the camera nearly all lines that reach there end; None where hardly any does."""
    reach = lines.ends[:, :, 2].max(axis=1) if above else -lines.ends[:, :, 2].min(axis=1)
    weight = np.where(reach > 0, weights_of(lines), 0.0)
    if (weight > 0).sum() < LEAST_ENDS:
        return None
    order = np.argsort(reach, kind="stable")
    share = np.cumsum(weight[order]) / weight.sum()
    return float(reach[order][min(int(np.searchsorted(share, NEARLY_ALL)), len(order) - 1)])


def weights_of(lines: Lines) -> Float:
    """How much the end of each line (N,) says about levels: its length in the photo, less where its place is unsure."""
    length: Float = np.linalg.norm(lines.segment[:, 1] - lines.segment[:, 0], axis=1)
    if len(lines.probability) == 0:
        return np.where(lines.component == 0, length, 0.0)
    sure = np.asarray(lines.probability)
    return length * sure**2


def _with_level(walls: list[Surface], kind: Kind, height: float, reach: float) -> list[Surface]:
    """The surfaces with the ground or ceiling: the levels there that it is made one of, or one of its own.

    It has the height of the first level within `reach`, a difference of logs, else the one that was given.
    """
    own = [wall for wall in walls if wall.axis == 2 and apart(wall.offset, height) < GROUND_STEP]
    others = [wall for wall in walls if all(wall is not one for one in own)]
    if not own:
        return [*others, Surface(kind, 2, height, np.zeros(0, np.int64), None)]
    lines = np.unique(np.concatenate([wall.lines for wall in own]))
    there = [level for level in own if apart(level.offset, height) < reach]
    if not there:
        return [*others, Surface(kind, 2, height, lines, None)]
    return [*others, Surface(kind, 2, there[0].offset, lines, there[0].plane)]


def with_ground(surfaces: list[Surface], height: float) -> list[Surface]:
    """The surfaces with a ground of that height of the camera above it, or the level that is nearly there as such."""
    return _with_level(surfaces, "ground", -height, GROUND_STEP)


def box_of(wall: Surface, ends: Float) -> Float:
    """Low and high components (2, K) of a wall with lines or a box, by those (N, 2, K) of the ends of all lines."""
    if wall.box is not None:
        return wall.box
    return np.asarray(np.percentile(ends[wall.lines].reshape(-1, ends.shape[2]), [2, 98], axis=0))


def apart(one: float, other: float) -> float:
    """How far two offsets differ in their logarithms; infinite on two sides of the camera."""
    return float(abs(np.log(one / other))) if one * other > 0 else float("inf")
