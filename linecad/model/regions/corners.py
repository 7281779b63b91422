"""Corners of buildings: what follows for the labels from walls that end.

A building is no screen. Where the photo shows an end of a wall that is the nearer one to the camera, the side of the
building begins there, at right angles, though it may have no line of its own: what is seen beside the end is that side,
and no wall that is farther away.
"""

from dataclasses import dataclass, replace

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.depth.normals import UNTOLD
from linecad.directions import UP, components, partner
from linecad.model.regions.opened import costs_by_openings, shows_another
from linecad.model.regions.raster import Raster
from linecad.model.regions.steps import Pair, find_step
from linecad.model.regions.surfaces import Surface
from linecad.scene import Lines

LEAST_HEIGHT = 0.05  # of the photo's height, of an upright border between two walls
MOST_GAP = 0.05  # of the photo's width, of clutter between two walls that may be the side of the nearer one
LEAST_SEEN = 0.002  # of the photo; a side that is hardly seen from beside is none
STEP = 1.05  # times the depth of a wall's end, from which on what is beside it is behind it
NARROW = 1.15  # times the offset of a wall; a parallel one not farther behind its end makes a step
BEFORE = 0.02  # of the depth of a wall's end, by which borders of cells may miss it
MORE = 0.25  # of how far a side goes back, that it may go farther
SAME = 1.5  # samples, within which borders are one upright
IN_PLANE = 0.03  # of the offset; cornices are that far before their wall
NO_NEARER = 0.9  # times the offset of a wall; what is parallel and nearer, a wing or a porch, may hide its side
APART = 1.2  # times the offset of a side, of a wall behind that faces as it does; one nearer is that side itself
GOES_ON = 0.05  # share of the lines of a wall that may lie beyond its end
GOES_ON_STEP = 0.1  # the same before a wall a little behind: its lines decide with those of the other where it ends
SIDE_PRICE = 1 / 3  # of a side, where one end and one wall behind it say where it is
SIDE_COST = 0.75  # of a side, which has no lines to be near to; that of a ground
ABOVE_COST, MOST_ABOVE = 4.0, 1.5  # for each height of a wall by which its side is higher
BEHIND_COST = 0.5  # of a wall that would be seen through a side
UNBELIEVED = 1.6  # the least cost of that wall there, if it is placed by other ties than the one that ends
MOST_OPENED = 0.1  # share of a side that openings of another wall may take
NEVER = 50.0


@dataclass(frozen=True, eq=False)
class Known:
    """What the photo shows as far as it is known."""

    shown: Int  # (S,) a surface, the sky or clutter, in this order
    surfaces: list[Surface]
    lines: Lines
    raster: Raster
    gap: Bool | None = None  # (S,) what is clutter, though `shown` has it as a wall; None: nothing is

    @property
    def ground(self) -> float:
        """The height of the ground, which is negative; -inf where none is known."""
        return next((surface.offset for surface in self.surfaces if surface.kind == "ground"), -np.inf)

    def box(self, number: int) -> Float:
        """Low and high components (2, K) of the lines of a surface, or of what else tells of it."""
        known = self.surfaces[number].box
        if known is not None:
            return known.copy()
        ends = components(self.lines.ends[self.surfaces[number].lines], self.raster.turns)
        return np.asarray(np.percentile(ends.reshape(-1, ends.shape[2]), [1, 99], axis=0))

    def without_gaps(self) -> "Known":
        """The same where narrow clutter between two walls is the farther one: it is beside the end of the nearer."""
        shown = self.shown.reshape(self.raster.shape).copy()
        clutter, most = len(self.surfaces) + 1, MOST_GAP * self.raster.shape[1]
        walls = np.array([*(each.kind == "wall" for each in self.surfaces), False, False])
        padded = np.pad(shown == clutter, ((0, 0), (1, 1)))
        row, start = np.nonzero(padded[:, 1:] & ~padded[:, :-1])
        _, end = np.nonzero(~padded[:, 1:] & padded[:, :-1])
        inside = (start > 0) & (end < shown.shape[1]) & (end - start <= most)
        row, start, end = row[inside], start[inside], end[inside]
        left, right = shown[row, start - 1], shown[row, end]
        between = walls[left] & walls[right] & (left != right)
        for at, low, high, one, other in np.column_stack([row, start, end, left, right])[between].tolist():
            first, second = (self._depth_at(number, at, (low + high) // 2) for number in (one, other))
            shown[at, low:high] = one if first > second else other
        return replace(self, shown=shown.ravel(), gap=shown.ravel() != self.shown)

    def _depth_at(self, number: int, row: int, column: int) -> float:
        surface, ray = self.surfaces[number], self.raster.rays[row * self.raster.shape[1] + column]
        return float(surface.offset / ray[surface.axis]) if ray[surface.axis] else np.inf

    def on_lines(self, number: int) -> Bool:
        """Which points (T,) lie on the lines of a surface."""
        return np.isin(self.raster.line, self.surfaces[number].lines)


@dataclass(frozen=True)
class End:
    """An upright in the photo where a wall ends that is before another one."""

    wall: int
    other: int
    place: float  # component along the wall
    inwards: float  # 1 where the wall is at larger components, else -1
    top: float  # height up to which both border on each other
    sample: float  # width of a sample there, along the wall


@dataclass(frozen=True, eq=False)
class WallsBeside:
    """B pairs of samples side by side in a row that show two walls."""

    walls: Int  # (B, 2) surfaces, the left one first
    left: Float  # (B, K) rays
    right: Float  # (B, K)
    at: Int  # (B, 2) row and column of the left sample


@dataclass(frozen=True, eq=False)
class Side:
    """A wall that begins where another one ends, and what it hides."""

    surface: Surface
    cost: Float  # (S,)
    wall: int  # the surface that ends there
    behind: int  # the one that is seen beside the end
    before: Bool  # (S, K) where it is before each surface
    hides: Bool  # (S,) where what is behind it is shown as yet
    reach: float = 0.0  # of a step: how far it goes back, per distance of its wall
    is_bare: bool = False  # of a step: hardly a line of either wall is there, between lines of both

    @property
    def is_step(self) -> bool:
        """Whether it goes back to a parallel wall a little behind."""
        return self.reach > 0


def find_sides(ends: list[End], known: Known) -> list[Side]:
    """The sides that begin at ends of walls and that the camera sees, one for all walls that are behind one end."""
    sides: list[Side] = []
    for end in ends:
        if end.inwards * end.place <= 0:
            continue
        side, behind = _side(end, known), known.surfaces[end.other]
        is_itself = behind.axis == side.surface.axis and behind.offset / side.surface.offset <= APART
        if is_itself or side.hides.mean() <= LEAST_SEEN or _shows_another_wall(side, known.raster):
            continue
        same = [at for at, other in enumerate(sides) if other.wall == end.wall and _is_one(other, side)]
        if not same:
            sides.append(side)
            continue
        first = sides[same[0]]
        surest = max(first, side, key=lambda each: (each.is_step, each.hides.sum()))  # lines say where a step is
        sides[same[0]] = replace(surest, hides=first.hides | side.hides)
    return sides


def _shows_another_wall(side: Side, raster: Raster) -> bool:
    """Whether openings that face another way are seen where a side would be, more than such as face its way."""
    told = raster.opened[side.hides] != UNTOLD
    other = shows_another(raster, side.surface.axis)[side.hides].mean()
    return bool(other > max(told.mean() - other, MOST_OPENED))


def _is_one(one: Side, other: Side) -> bool:
    """Whether two sides of a wall are at one end of it: a border may be as far off as a step is wide."""
    apart = abs(one.surface.offset / other.surface.offset - 1)
    reach = min((side.reach for side in (one, other) if side.is_step), default=0.0)
    return one.surface.axis == other.surface.axis and apart < max(IN_PLANE, reach)


def with_sides(costs: Float, sides: list[Side], known: Known) -> Float:
    """Costs (S, K + N + 2) of K surfaces, N sides, sky and clutter, from those (S, K + 2) without the sides."""
    costs = costs.copy(order="F")
    for side in sides:
        for number, through in enumerate((side.before & side.hides[:, None]).T):
            if through.any():
                is_likely = not side.is_bare and _is_tied(number, side.wall, through, known)
                least = 0.0 if is_likely else UNBELIEVED
                costs[through, number] = np.maximum(costs[through, number] + BEHIND_COST, least)
        is_gap = np.ones(known.raster.size, bool) if side.is_step else known.gap
        if is_gap is not None:
            costs[side.hides & is_gap & ~known.raster.plants, -1] += BEHIND_COST
    opened = costs_by_openings(known.raster, [side.surface for side in sides])
    own = [side.cost + more for side, more in zip(sides, opened.T, strict=True)]
    return np.column_stack([costs[:, :-2], *own, costs[:, -2:]])


def find_ends(known: Known) -> list[End]:
    """The ends of walls before others, beyond which hardly a line of theirs lies."""
    is_wall = [each.kind == "wall" and len(each.lines) > 0 for each in known.surfaces]
    beside = walls_beside(known.shown, is_wall, known.raster)
    least = LEAST_HEIGHT * known.raster.shape[0]
    found = []
    for one, other in np.unique(beside.walls, axis=0).tolist():
        own = (beside.walls == (one, other)).all(axis=1)
        if own.sum() >= least:
            left, right = beside.left[own], beside.right[own]
            found += _ends_at(known.surfaces, (one, other), left, right, least)
            found += _ends_at(known.surfaces, (other, one), right, left, least)
    return [end for end in found if _ends_there(end, known)]


def walls_beside(shown: Int, is_wall: list[bool], raster: Raster) -> WallsBeside:
    """Where walls border on each other, by what samples show (S,): a surface, the sky or clutter, in this order."""
    image, rays = shown.reshape(raster.shape), raster.rays.reshape(*raster.shape, -1)
    counts = np.array([*is_wall, False, False])
    border = counts[image[:, :-1]] & counts[image[:, 1:]] & (image[:, :-1] != image[:, 1:])
    walls = np.column_stack([image[:, :-1][border], image[:, 1:][border]])
    return WallsBeside(walls, rays[:, :-1][border], rays[:, 1:][border], np.argwhere(border))


def _ends_at(surfaces: list[Surface], pair: tuple[int, int], inner: Float, outer: Float, least: float) -> list[End]:
    """The end of the first wall of a pair, by rays (P, K) beside their border, inside and outside of that wall.

    None where the other one is not behind it.
    """
    wall, other = (surfaces[number] for number in pair)
    along = int(partner(wall.axis))
    places = wall.offset * np.stack([rays[:, along] / rays[:, wall.axis] for rays in (inner, outer)])
    middle = places.mean(axis=0)
    width = float(np.median(np.abs(places[0] - places[1])))
    same = np.abs(middle[:, None] - middle) < SAME * width
    best = int(same.sum(axis=1).argmax())
    if same[best].sum() < least:
        return []
    rays = (inner + outer)[same[best]] / 2
    depth = wall.offset / rays[:, wall.axis]
    ratio = float(np.median(other.offset / rays[:, other.axis] / depth))
    top = float((rays[:, UP] * depth).max())
    if top < 0 or ratio < STEP:
        return []  # what ends below the eye is a van or a fence
    place = float(np.median(middle[same[best]]))
    inwards = float(np.sign(np.median(places[0] - places[1])))
    return [End(*pair, place, inwards, top, width)]


def _ends_there(end: End, known: Known) -> bool:
    """Whether hardly a line of a wall goes on beyond its end."""
    wall, raster = known.surfaces[end.wall], known.raster
    own = known.on_lines(end.wall)
    reach = raster.line_rays[own, int(partner(wall.axis))] * raster.line_depth[own] - end.place
    most = GOES_ON_STEP if _is_step(end, known) else GOES_ON
    return bool((reach * end.inwards < -IN_PLANE * abs(wall.offset)).mean() < most)


def _is_step(end: End, known: Known) -> bool:
    """Whether a wall ends a little before a parallel one."""
    wall, behind = known.surfaces[end.wall], known.surfaces[end.other]
    return behind.axis == wall.axis and behind.offset / wall.offset < NARROW


def _is_tied(number: int, wall: int, there: Bool, known: Known) -> bool:
    """Whether most lines that a surface has in a part of the photo (S,) are placed with a wall, by crossings."""
    line = known.raster.line[known.on_lines(number) & there[known.raster.at]]
    own = np.bincount(known.lines.component[known.surfaces[wall].lines]).argmax()
    return len(line) > 0 and bool((known.lines.component[line] == own).mean() > 1 / 2)


def _side(end: End, known: Known) -> Side:
    """The side that begins at the end of a wall and goes back, to the wall behind it where that is parallel."""
    wall, behind, raster = known.surfaces[end.wall], known.surfaces[end.other], known.raster
    axis, is_parallel = int(partner(wall.axis)), behind.axis == wall.axis
    is_step = _is_step(end, known)
    box, far = known.box(end.wall), known.box(end.other)[:, wall.axis]
    step = find_step(_pair(end, known), end.inwards * end.place, raster) if is_step else None
    box[:, axis] = _furthest(end, known) if step is None else end.inwards * step.place
    box[:, wall.axis] = np.sort([wall.offset, behind.offset if is_parallel else far[np.abs(far).argmax()]])
    box[:, UP] = known.ground if np.isfinite(known.ground) else box[0, UP], max(box[1, UP], end.top)
    tall = max(float(np.ptp(box[:, UP])), IN_PLANE * abs(wall.offset))
    surface = Surface("wall", axis, float(box[0, axis]), np.zeros(0, np.int64), None, box, SIDE_PRICE)
    depth = _depth(surface, raster)
    back, height = raster.rays[:, wall.axis] * np.sign(wall.offset) * depth, raster.rays[:, UP] * depth
    most = abs(behind.offset) * STEP if is_parallel else np.inf
    reached = (depth > 0) & (back > (1 - BEFORE) * abs(wall.offset)) & (back < most) & (height > known.ground)
    if is_parallel:
        most = min(most, abs(behind.offset) + MORE * (abs(behind.offset) - abs(wall.offset)))
    before = _before(depth, wall if is_step else None, known)
    shown = known.shown == end.other
    if is_step:
        behind_it = np.column_stack([before, np.zeros(raster.size, bool), ~raster.plants])  # clutter as well
        shown = behind_it[np.arange(raster.size), known.shown] & (height < box[1, UP])
    hides = reached & (back > abs(wall.offset)) & (back < most) & shown
    above = np.where(hides, 0.0, np.clip(ABOVE_COST * (height - box[1, UP]) / tall, 0.0, MOST_ABOVE))
    cost = np.where(reached, SIDE_COST + above, NEVER)
    how = (0.0, False) if step is None else (behind.offset / wall.offset - 1, step.is_bare)
    return Side(surface, cost, end.wall, end.other, before, hides, *how)


def _before(depth: Float, wall: Surface | None, known: Known) -> Bool:
    """Where (S, K) a side of some depth (S,) is before each surface.

    What is parallel to the `wall` of a step, but for what is nearer, is one of its walls or their cornices, which end
    at the side too.
    """
    before = np.zeros((known.raster.size, len(known.surfaces)), bool, order="F")
    for number, surface in enumerate(known.surfaces):
        if wall is not None and surface.axis == wall.axis:
            before[:, number] = surface.offset / wall.offset > NO_NEARER
        elif surface.kind == "wall" or (wall is not None and surface.kind != "ground"):
            before[:, number] = _depth(surface, known.raster) > STEP * depth
    return before


def _pair(end: End, known: Known) -> Pair:
    """The walls at the end of one of two that are parallel, along it from there inwards."""
    wall, behind, raster = known.surfaces[end.wall], known.surfaces[end.other], known.raster
    along = int(partner(wall.axis))
    towards = raster.rays[:, wall.axis] * np.sign(wall.offset)
    is_before = towards > 0
    across = np.where(is_before, towards, 1.0)
    at = np.where(is_before, end.inwards * raster.rays[:, along] / across, 0.0)
    height = abs(wall.offset) * raster.rays[:, UP] / across
    seen = is_before & (height > known.ground) & (height < end.top) & ~raster.plants
    points = [raster.at[known.on_lines(number)] for number in (end.wall, end.other)]
    near, far = (own[seen[own]] for own in points)
    return Pair(abs(wall.offset), abs(behind.offset), at, seen, near, far, end.sample / abs(wall.offset))


def _furthest(end: End, known: Known) -> float:
    """Where a wall ends, by lines along it that go on beyond the border: the edge of a plain corner may be missed."""
    wall, lines = known.surfaces[end.wall], known.lines
    along = int(partner(wall.axis))
    ends = components(lines.ends[lines.axis == along], known.raster.turns)
    ends = ends[np.abs(ends[:, 0, wall.axis] / wall.offset - 1) < IN_PLANE]
    reach = np.sort((ends[:, :, along] - end.place) * end.inwards, axis=1)
    goes_on = (reach[:, 0] < 0) & (reach[:, 1] > -reach[:, 0])
    beyond = end.place + end.inwards * float(reach[goes_on, 0].min(initial=0.0))
    return beyond if beyond * end.place > 0 else end.place


def _depth(surface: Surface, raster: Raster) -> Float:
    """Depth (S,) of a surface, 0 where it is not seen."""
    with np.errstate(divide="ignore", invalid="ignore"):
        depth = surface.offset / raster.rays[:, surface.axis]
    return np.where(np.isfinite(depth) & (depth > 0), depth, 0.0)
