"""Where a depth map and the walls of bodies can be compared: pixels on either side of the lines of each wall.

A network is least right on edges, which bleed from the near side to the far one. So it is asked beside the lines, at
several distances from them, where the plane of the wall has a depth as exact as on the line. Where another wall begins
at the line, one side tells of that: of each wall the samples that agree with each other count.
"""

from dataclasses import dataclass

import numpy as np

from linecad.arrays import Float, Int
from linecad.depth.depth_map import DepthMap, Kind, camera_depths
from linecad.geometry import unit_normals, world_rays
from linecad.ties.planes import BodyPlane, find_planes_of_bodies
from linecad.ties.setting import Setting, densest_groups

ALONG = np.linspace(0.08, 0.92, 9)  # of a line's length
BESIDE = (-0.014, -0.006, 0.006, 0.014)  # of the photo's width
LEAST_SAMPLES, MOST_SAMPLES = 8, 300  # of a wall
STEEPEST = 0.03  # by which share the depth of a plane may change from the line to a sample
SAME = 0.03  # log depth, half of the window whose samples a wall is at
LEAST_AGREEING = 0.4  # share of a wall's samples in it, where any wall of the body has as much
LEAST_LINES = 3  # of a wall, where any wall of the body has as many


@dataclass(frozen=True, eq=False)
class DepthSamples:
    """S samples of a depth map on the walls of B bodies."""

    value: Float  # (S,) of the map
    slant: Float  # (S,) distance of a point over its depth
    log_depth: Float  # (S,) of the wall, at its body's own scale
    wall: Int  # (S,) in ascending order, from 0
    body: Int  # (S,)
    lines: Int  # (S,) of the sample's wall
    bodies: int  # B

    def __len__(self) -> int:
        return len(self.value)

    def excess(self, kind: Kind, shift: float = 0.0) -> Float:
        """(S,) log of the map's depth over the wall's; NaN where a map of that kind and shift has no depth."""
        excess: Float = np.log(camera_depths(self.value, self.slant, kind, shift)) - self.log_depth
        return excess


def sample_walls(setting: Setting, depth: DepthMap) -> DepthSamples:
    """Samples of the map, which lies on the photo's pixels, on all planes of all bodies."""
    walls = [(body, plane) for body, own in enumerate(find_planes_of_bodies(setting)) for plane in own]
    found = [_sample(setting, depth, plane) for _, plane in walls]
    kept = [number for number, (value, *_) in enumerate(found) if len(value) >= LEAST_SAMPLES]
    count = [len(found[number][0]) for number in kept]
    value, slant, log_depth = (
        np.concatenate([np.zeros(0), *(found[number][part] for number in kept)]) for part in range(3)
    )
    body, lines = (
        np.repeat(np.array(of_walls, np.int64), count)
        for of_walls in ([walls[number][0] for number in kept], [len(walls[number][1].lines) for number in kept])
    )
    wall = np.repeat(np.arange(len(kept)), count)
    return DepthSamples(value, slant, log_depth, wall, body, lines, setting.bodies.count)


def _sample(setting: Setting, depth: DepthMap, plane: BodyPlane) -> tuple[Float, Float, Float]:
    """Values of the map beside the lines of one plane, slants, and log depths of the plane, each (S,)."""
    sight = setting.sight
    ends = setting.graph.segments.ends[plane.lines]
    direction = ends[:, 1] - ends[:, 0]
    beside = unit_normals(direction)
    on = ends[:, None, None, 0] + ALONG[:, None, None] * direction[:, None, None]  # lines, along, beside, x and y
    pixels = on + np.array(BESIDE)[:, None] * sight.width * beside[:, None, None]
    on = np.broadcast_to(on, pixels.shape).reshape(-1, 2)
    pixels = pixels.reshape(-1, 2)
    column, row = np.rint(pixels).astype(np.int64).T
    inside = (column >= 0) & (column < depth.width) & (row >= 0) & (row < depth.height)
    column, row = column[inside], row[inside]
    rays, rays_on = (world_rays(at[inside], sight.matrix, sight.rotation) for at in (pixels, on))
    value = depth.values[row, column].astype(np.float64)
    towards, towards_on = (plane.side * those[:, plane.normal] for those in (rays, rays_on))
    is_near = (towards > towards_on * (1 - STEEPEST)) & (towards < towards_on * (1 + STEEPEST))
    has = np.flatnonzero(depth.valid[row, column] & is_near)
    has = has[:: -(-len(has) // MOST_SAMPLES) or 1]
    log_depth = plane.log_offset - np.log(towards[has])
    slant: Float = np.linalg.norm(rays[has, :3], axis=1)
    return value[has], slant, log_depth


@dataclass(frozen=True, eq=False)
class WallVotes:
    """What a map says of V walls of bodies, each of which has one vote, in the order of their bodies."""

    body: Int  # (V,)
    log_scale: Float  # (V,) by which log the map asks the body to grow
    weight: Float  # (V,) samples that agree, times their share of the wall's

    def of_bodies(self, count: int) -> Float:
        """(B,) the median of the votes of each of `count` bodies; NaN where it has none."""
        at = np.full(count, np.nan)
        for body in np.unique(self.body).tolist():
            own = self.body == body
            at[body] = weighted_median(self.log_scale[own], self.weight[own])
        return at


def wall_votes(samples: DepthSamples, excess: Float) -> WallVotes:
    """The votes of those walls that tell most clearly of their bodies, for excesses (S,).

    A wall votes for what most of its samples agree on.
    """
    votes: dict[int, list[tuple[float, float, float, int]]] = {}
    known = np.isfinite(excess)
    starts = np.flatnonzero(np.diff(samples.wall, prepend=-1))
    for start, end in zip(starts, np.append(starts, len(samples))[1:], strict=True):
        own = excess[start:end][known[start:end]]
        if len(own) < LEAST_SAMPLES:
            continue
        which = densest_groups(own, np.ones(len(own)), SAME, 1)[0][1]
        votes.setdefault(int(samples.body[start]), []).append(
            (float(np.median(own[which])), len(which), len(which) / len(own), int(samples.lines[start]))
        )
    told: list[tuple[float, float, float]] = []
    for body, own_votes in sorted(votes.items()):
        agreeing = [vote for vote in own_votes if vote[2] >= LEAST_AGREEING]
        clearest = [vote for vote in agreeing if vote[3] >= LEAST_LINES] or agreeing or own_votes
        told += [(body, asked, count * share) for asked, count, share, _ in clearest]
    body_of, asked_of, weight = np.array(told).reshape(-1, 3).T
    return WallVotes(body_of.astype(np.int64), asked_of, weight)


def weighted_median(values: Float, weight: Float) -> float:
    """The value (N,) at which half of the weight (N,) is reached."""
    return float(values[median_place(values, weight)])


def median_place(values: Float, weight: Float) -> int:
    """The place of the weighted median of values (N,)."""
    order = np.argsort(values, kind="stable")
    sums = np.cumsum(weight[order])
    return int(order[np.searchsorted(sums, sums[-1] / 2)])
