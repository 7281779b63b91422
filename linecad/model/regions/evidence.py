"""What the photo says about what each part of it shows: a cost of every label, for each sample and for each cell.

Costs are in units of one sample that is as unlikely as a wall's own without a line anywhere near. Labels are the K
surfaces, then SKY and CLUTTER, which is what has no plane: trees, cars, people.
"""

import cv2
import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.depth.normals import UNTOLD
from linecad.directions import MAIN, UP, across, components, frame_axes, frame_of, partner
from linecad.model.regions.heaven import SMOOTH, Heaven
from linecad.model.regions.mapped import cost_outside, costs_by_map
from linecad.model.regions.opened import costs_by_openings
from linecad.model.regions.raster import SHADES, Raster
from linecad.model.regions.surfaces import Surface, box_of
from linecad.scene import Lines

SKY, CLUTTER = -2, -1  # columns of costs

NEVER = 50.0
GRAZING = 0.03  # of a ray at camera depth 1, along a wall's normal: seen so flatly, its place is chance
NEAR, FAR = 18.0, 70.0  # samples from a surface's lines, in which its cost rises
NEAR_COST, FAR_COST = 1.0, 0.6
BEHIND = 1.03  # times a surface's depth; a line further away is behind it
SEEN_THROUGH, REACH = 2.0, 8.0  # samples from such a line, in which the surface is not, or hardly
THROUGH_COST, BESIDE_COST = 1.2, 0.5
OUTSIDE_COST, MOST_OUTSIDE = 4.0, 1.5  # for each length of a surface beyond its lines
UNDERGROUND, BURIED = 1.03, 2.5  # times the ground's depth below the camera, and the cost of what is lower
TURNED_COST = 0.8  # of a surface along another axis than a depth map says
NARROWEST = 0.02  # of its offset, of a surface: what is less is relief
FURTHEST, NEARLY_ALL = 1.25, 0.98  # times the depth of so many of a surface's lines; it does not go on for ever
RARE_COST = 0.3  # of levels that are no ground: soffits and tops of walls are small
WALLED_COST = 0.5  # of ground and ceiling behind a wall
ROOM_COST = 3.0  # the same below a ceiling, behind all walls there or the last of a side: walls close a room
LEVEL_COST, COVERED_COST = 0.75, 0.35  # of ground and ceiling; the second where lines stand beyond
COVERED = 8  # samples on lines
MAPPED_COST = 0.8  # of a wall within its box, which a depth map tells, its foot or its skirting
CLUTTER_COST, SMOOTH_COST = 1.2, 0.4
GREEN_COST = 0.5  # of a wall; what is green grows
FULL_OF_EDGES = 0.25  # share of edges around a sample, from which on it is not smooth
GREEN = (118, 134)  # of CIE a* and b*, in bytes: less of the first and more of the second is green
AROUND = 9  # samples

# Shares of edges that run along x, y, z and along none, of surfaces by their axis, of the ground, of clutter.
DIRECTIONS = np.array([[0.05, 0.33, 0.33, 0.29], [0.33, 0.05, 0.33, 0.29], [0.30, 0.30, 0.08, 0.32]])
OF_GROUND = np.array([0.24, 0.24, 0.08, 0.44])
OF_CLUTTER = np.array([0.11, 0.11, 0.11, 0.67])
OF_EDGE = 0.3  # weight of the votes: the pixels of one edge are no witnesses apart
SKY_EDGE = 0.15  # cost of an edge in the sky

SKY_COST, STRANGE_COST, ROUGH_COST, SEED_GAIN = 0.35, 0.35, 1.2, 0.7
RIM, BEYOND_SKY = 3.0, 1.0  # samples from where it is sky for sure, and what it costs beyond: there it is seldom

COLOUR_WEIGHT = 0.25
MOST_BY_COLOUR = 2.0  # log-odds
SHARE_OF_ALL = 0.05  # of the photo's colours in those of a label, for what it has not shown yet


def depths(raster: Raster, surfaces: list[Surface]) -> Float:
    """Camera depth (S, K) of each surface on the ray of each sample; infinite where it does not meet it."""
    found = np.empty((raster.size, len(surfaces)), order="F")
    with np.errstate(divide="ignore", invalid="ignore"):
        for number, surface in enumerate(surfaces):
            depth = surface.offset / raster.rays[:, surface.axis]
            found[:, number] = np.where(np.isfinite(depth) & (depth > 0), depth, np.inf)
    return found


def sample_costs(raster: Raster, lines: Lines, surfaces: list[Surface], heaven: Heaven, limit: float) -> Float:
    """Costs (S, K + 2) of each label for each sample, but for colour and the directions of edges.

    Ground and ceiling end at the depth `limit`.
    """
    costs = np.empty((raster.size, len(surfaces) + 2), order="F")  # each label by itself
    depth = depths(raster, surfaces)
    green = GREEN_COST * is_green(raster)
    ground = next((surface.offset for surface in surfaces if surface.kind == "ground"), None)
    is_room = heaven.is_ceiling
    for number, surface in enumerate(surfaces):
        cost = _surface_cost(raster, lines, surface, depth[:, number])
        if ground is not None and surface.kind != "ground":
            cost = cost + BURIED * (raster.rays[:, 2] * depth[:, number] < UNDERGROUND * ground)
        turned = (raster.facing != UNTOLD) & (raster.facing != surface.axis)
        is_level = surface.kind in ("ground", "ceiling")
        if is_level:
            some, every = _behind_walls(raster, lines, surfaces, depth, number)
            if is_room:
                out = _out_of_room(raster, surfaces, depth[:, number])
                some, every = some | out, every | out
            cost = cost + np.where(every & is_room, ROOM_COST, WALLED_COST) * some
        cost = cost + (NEVER * (depth[:, number] > limit) if is_level else green)
        is_met = np.isfinite(depth[:, number]) & ~_is_grazing(raster, surface)
        costs[:, number] = np.where(is_met, cost + TURNED_COST * turned, NEVER)
    edges = (raster.gradient > SMOOTH).reshape(raster.shape).astype(np.float32)
    smooth = 1 - np.minimum(cv2.blur(edges, (AROUND, AROUND)).ravel() / FULL_OF_EDGES, 1)
    costs[:, SKY] = _sky_cost(raster, heaven)
    costs[:, CLUTTER] = CLUTTER_COST + SMOOTH_COST * smooth
    costs[:, : len(surfaces)] += costs_by_openings(raster, surfaces)
    if raster.map_depth is not None:
        costs += costs_by_map(raster, surfaces, depth, limit)
    return costs


def is_green(raster: Raster) -> Bool:
    """Which samples (S,) have the colour of plants."""
    colour = raster.colour.reshape(-1, 3)
    return np.asarray((colour[:, 1] < GREEN[0]) & (colour[:, 2] > GREEN[1]))


def _surface_cost(raster: Raster, lines: Lines, surface: Surface, depth: Float) -> Float:
    """Cost (S,) of one surface by its lines, and by those that are behind it; in its box no more than without lines."""
    within = None if surface.box is None else MAPPED_COST + cost_outside(surface, raster, depth)
    if within is not None and len(surface.lines) == 0:
        return within
    is_own = np.zeros(len(lines), bool)
    is_own[surface.lines] = True
    own = is_own[raster.line]
    near = raster.distance(raster.marked(own))
    cost: Float = _rising(near, NEAR, NEAR_COST)
    cost += _rising(near, FAR, FAR_COST)
    if surface.kind in ("ground", "ceiling"):
        cost = np.minimum(cost, LEVEL_COST + COVERED_COST * (_beyond(raster, surface.kind) > COVERED))
    if len(surface.lines):
        component = int(np.bincount(lines.component[surface.lines]).argmax())
        with np.errstate(divide="ignore", invalid="ignore"):
            before = surface.offset / raster.line_rays[:, surface.axis]
        # Other components have scales of their own: what is behind what is less sure there.
        behind = ~own & (lines.component[raster.line] == component) & (before > 0)
        through = raster.distance(raster.marked(behind & (raster.line_depth > BEHIND * before)))
        beside = np.flatnonzero((through < near) | (through <= SEEN_THROUGH))
        off = through[beside]
        cost[beside] += THROUGH_COST * (off <= SEEN_THROUGH) + BESIDE_COST * np.exp(-off / REACH) * (off < near[beside])
    if surface.kind not in ("ground", "ceiling"):
        cost += _outside(raster, lines, surface, depth)
    return cost if within is None else np.where(within > MAPPED_COST, cost, np.minimum(cost, within))


def _is_grazing(raster: Raster, surface: Surface) -> bool:
    """Whether a wall is seen so flatly that its place is chance, by half of its lines."""
    if surface.box is not None:  # something else tells its place
        return False
    across = np.abs(raster.line_rays[np.isin(raster.line, surface.lines), surface.axis])
    return surface.axis != UP and len(across) > 0 and bool(np.median(across) < GRAZING)


def _rising(off: Float, reach: float, most: float) -> Float:
    """A cost (S,) that rises to `most` with the distance (S,) from a line."""
    cost = off / -reach  # in place from here: new arrays of this size take longer than the sums in them
    np.exp(cost, out=cost)
    np.subtract(1, cost, out=cost)
    cost *= most
    return cost


def _outside(raster: Raster, lines: Lines, surface: Surface, depth: Float) -> Float:
    """Cost (S,) of being outside the box of a surface's lines, and NEVER far behind all of them."""
    ends = components(lines.ends[surface.lines], raster.turns).reshape(-1, raster.rays.shape[1])
    is_seen = np.isfinite(depth)
    met = np.where(is_seen, depth, 0.0)  # whole columns are faster than the seen samples of them
    over = np.zeros(raster.size)
    for axis in sorted(across(np.array(surface.axis)).tolist()):
        low, high = np.percentile(ends[:, axis], [1, 99])
        at = raster.rays[:, axis] * met
        off = low - at
        at -= high
        np.maximum(off, at, out=off)
        np.maximum(off, 0, out=off)
        off /= max(high - low, NARROWEST * abs(surface.offset))
        over += off
    own = raster.line_depth[np.isin(raster.line, surface.lines)]
    furthest = float(np.quantile(own, NEARLY_ALL)) if len(own) else 0.0
    over *= OUTSIDE_COST
    np.minimum(over, NEVER if surface.kind == "level" else MOST_OUTSIDE, out=over)
    over += (surface.kind == "level") * RARE_COST
    over[met > FURTHEST * furthest] += NEVER
    over[~is_seen] = NEVER
    return over


def _behind_walls(raster: Raster, lines: Lines, surfaces: list[Surface], depth: Float, level: int) -> tuple[Bool, Bool]:
    """Where (S,) a level would be seen through a wall between the wall's ends, and where through all that are there.

    `depth` (S, K) is that of each surface.
    """
    some, every = np.zeros(raster.size, bool), np.ones(raster.size, bool)
    reach, ends = depth[:, level] / BEHIND, components(lines.ends, raster.turns)
    for number, surface in enumerate(surfaces):
        if surface.kind != "wall":
            continue
        along = int(partner(surface.axis))
        low, high = box_of(surface, ends)[:, along]
        before = depth[:, number]
        at = raster.rays[:, along] * np.where(np.isfinite(before), before, 0.0)
        is_there, is_before = np.isfinite(before) & (at > low) & (at < high), before < reach
        some |= is_before & is_there
        every &= is_before | ~is_there
    return some, some & every


def _out_of_room(raster: Raster, surfaces: list[Surface], depth: Float) -> Bool:
    """Where (S,) a level at depths (S,) is farther off to a side than the last wall there, wherever that wall ends."""
    found, reach = np.zeros(raster.size, bool), np.where(np.isfinite(depth), depth, 0.0)
    offsets: dict[int, list[float]] = {}
    for surface in surfaces:
        if surface.kind == "wall":
            offsets.setdefault(surface.axis, [0.0]).append(BEHIND * surface.offset)
    for axis, own in offsets.items():
        at = raster.rays[:, axis] * reach
        found |= (min(own) < 0) & (at < min(own))
        found |= (max(own) > 0) & (at > max(own))
    return found


def _beyond(raster: Raster, kind: str) -> Float:
    """How many samples (S,) on lines there are on the far side in each column: below for ground, above for ceilings."""
    on_line = raster.marked(np.ones(len(raster.at), bool)).reshape(raster.shape).astype(np.float64)
    count = on_line.cumsum(axis=0) if kind == "ceiling" else on_line[::-1].cumsum(axis=0)[::-1]
    beyond: Float = (count - on_line).ravel()
    return beyond


def _sky_cost(raster: Raster, heaven: Heaven) -> Float:
    """Cost (S,) of being sky, by colour and smoothness."""
    if not heaven.is_sky:
        return np.full(raster.size, NEVER)
    colour = raster.colour.reshape(-1, 3).astype(np.float64)
    middle = np.median(colour[heaven.seed], axis=0)
    spread = 1.4826 * np.median(np.abs(colour[heaven.seed] - middle), axis=0) + 6
    strange = np.sqrt((((colour - middle) / spread) ** 2).mean(axis=1))
    edges = (raster.gradient > 0.5).reshape(raster.shape).astype(np.float32)
    rough = cv2.blur(edges, (7, 7)).ravel()
    cost = SKY_COST + STRANGE_COST * np.minimum(strange / 2, 3) + ROUGH_COST * np.minimum(rough / 0.2, 1)
    beyond = raster.distance(heaven.seed) > RIM
    return np.where(raster.rays[:, 2] > 0, cost - SEED_GAIN * heaven.seed + BEYOND_SKY * beyond, NEVER)


def sums(cell: Int, count: int, values: Float) -> Float:
    """Sums (count, L) over the samples of each cell of values (S, L)."""
    return np.column_stack([np.bincount(cell, column, count) for column in values.T])


def direction_costs(raster: Raster, surfaces: list[Surface], cell: Int, count: int) -> Float:
    """Costs (count, K + 2) for each cell, by the axes along which its edges run."""
    votes = sums(cell, count, raster.votes)
    costs = np.zeros((count, len(surfaces) + 2))
    for number, surface in enumerate(surfaces):
        own = OF_GROUND if surface.kind == "ground" else DIRECTIONS[_axis_in_frame(surface)]
        costs[:, number] = -OF_EDGE * (_votes_in_frame(votes, surface) * np.log(own / OF_CLUTTER)).sum(axis=1)
    costs[:, SKY] = SKY_EDGE * votes.sum(axis=1)
    return costs


def _axis_in_frame(surface: Surface) -> int:
    """The normal of a surface in its own frame: 0, 1 or 2."""
    return surface.axis if surface.axis < MAIN else (surface.axis - MAIN) % 2


def _votes_in_frame(votes: Float, surface: Surface) -> Float:
    """Votes (C, K + 1) as those (C, 4) along x, y and z of a surface's frame, of all frames for a level one, and none.

    What runs along another frame is as strange to a wall as what runs along none.
    """
    if votes.shape[1] == MAIN + 1:
        return votes
    further = range(MAIN, votes.shape[1] - 1)
    if surface.axis == UP:
        level = [votes[:, [first, *further[first::2]]].sum(axis=1) for first in range(2)]
        return np.column_stack([*level, votes[:, UP], votes[:, -1]])
    own = frame_axes(int(frame_of(np.array(surface.axis))))
    return np.column_stack([votes[:, own], np.delete(votes, own, axis=1).sum(axis=1)])


def colour_costs(raster: Raster, cell: Int, label: Int, columns: int) -> Float:
    """Costs (C, columns) for C cells with labels (C,), by the colours that each label has; 0 for labels that none has.

    A wall that is plain between its windows is known by its colour, and so is the roof above it as another thing.
    """
    colour = raster.shade
    everywhere = np.bincount(colour, minlength=SHADES) + 1.0
    everywhere /= everywhere.sum()
    of_cell = np.bincount(cell * SHADES + colour, minlength=len(label) * SHADES).reshape(-1, SHADES)
    costs = np.zeros((len(label), columns))
    for number in np.unique(label).tolist():
        own = of_cell[label == number].sum(axis=0)
        share = own + (SHARE_OF_ALL * own.sum() + 1) * everywhere
        odds = np.clip(np.log(share / share.sum() / everywhere), -MOST_BY_COLOUR, MOST_BY_COLOUR)
        costs[:, number] = -COLOUR_WEIGHT * (of_cell @ odds)
    return costs
