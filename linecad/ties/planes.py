"""Shared planes: two bodies whose main planes of one normal become one plane at one ratio of their scales."""

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from scipy.spatial import cKDTree

from linecad.arrays import Float, Int
from linecad.directions import UP, count_of, lies_across, partner
from linecad.geometry import world_rays
from linecad.ties.setting import Setting, densest_groups, sample

WIDTH = 0.008  # log offset within which lines lie in one plane
MOST = 4  # planes of a body on one side of the camera, by length of their lines
LONGEST = 400.0  # px of a line that count
LEAST_LINES = 2
WORST_RANK = 2  # of both planes together
NOWHERE = (np.inf, -np.inf)
NEARLY_ALL = (2, 98)  # percentiles of a plane's points along it, between which it reaches
INDUCED = 0.003  # log ratio, and INDUCED_CONNECTED of the fits: a plane that the fit itself made one tells nothing
INDUCED_CONNECTED = 0.2


@dataclass(frozen=True, eq=False)
class BodyPlane:
    """A plane that lines of two axes of one body lie in."""

    normal: int
    side: int  # -1, 1: sign of its offset
    log_offset: float  # at the body's own scale
    lines: Int
    share: float  # of the lines of its body
    rank: int  # among the planes of this normal of its body, by length of their lines


@dataclass(frozen=True)
class SharedPlane:
    """Two planes of two bodies that would be one."""

    bodies: tuple[int, int]
    log_ratio: float
    normal: int
    distance: float  # px at the reference width between their lines in the photo
    shares: tuple[float, float]
    lines: tuple[int, int]
    rank: int  # of both together
    overlap: float  # of the shorter one's reach along the wall, that the other has too; 0 if a plane is level or low


def find_planes_of_bodies(setting: Setting) -> list[list[BodyPlane]]:
    """The planes of each body."""
    graph = setting.graph
    length = np.minimum(graph.segments.length * setting.scale, LONGEST)
    found = []
    for lines in setting.lines:
        planes: list[BodyPlane] = []
        for normal in range(count_of(graph.turns)):
            own = lines[lies_across(graph.axis[lines], normal)]
            planes += _planes(setting, own, normal, length[lines].size, length)
        found.append(planes)
    return found


def _planes(setting: Setting, lines: Int, normal: int, of: int, length: Float) -> list[BodyPlane]:
    """Those of one normal among the `lines` of a body of `of` lines; `length` (N,) px of each line that counts."""
    graph = setting.graph
    groups = []
    for side in (-1, 1):
        own = lines[np.sign(graph.components[lines, normal]) == side]
        log_offset = np.log(np.abs(graph.components[own, normal])) + setting.log_depth[own]
        for middle, which in densest_groups(log_offset, length[own], WIDTH, MOST):
            if len(which) >= LEAST_LINES:
                groups.append((float(length[own[which]].sum()), side, middle, own[which]))
    groups.sort(key=lambda group: -group[0])
    return [
        BodyPlane(normal, side, middle, own, len(own) / of, rank)
        for rank, (_, side, middle, own) in enumerate(groups)
        if len(np.unique(graph.axis[own])) > 1
    ]


def find_shared_planes(setting: Setting) -> list[SharedPlane]:
    """Pairs of planes of any two bodies, of one normal and on one side of the camera."""
    planes = [(body, plane) for body, own in enumerate(find_planes_of_bodies(setting)) for plane in own]
    points = [sample(setting.graph.segments.ends[plane.lines] * setting.scale) for _, plane in planes]
    trees = [cKDTree(places) for places in points]
    reach = [_reach_along(setting, plane) for _, plane in planes]
    found = []
    for (number, (first, one)), (place, (second, other)) in combinations(enumerate(planes), 2):
        if first == second or (one.normal, one.side) != (other.normal, other.side):
            continue
        if one.rank + other.rank <= WORST_RANK:
            distance = float(trees[number].query(points[place])[0].min())
            overlap = _overlap(reach[number], reach[place])
            found.append(_shared((first, second), one, other, distance, overlap))
    return found


def _reach_along(setting: Setting, plane: BodyPlane) -> tuple[float, float]:
    """From where to where an upright plane's lines reach along it, at distance 1.

    Nothing for a level plane, and for one that is all lower than the camera: such a wall stands before the one that is
    seen above it, as a fence does, more often than below it.
    """
    if plane.normal == UP:
        return NOWHERE
    before = rays_before(setting, plane, sample(setting.graph.segments.ends[plane.lines]))
    if not len(before) or np.percentile(before[:, UP], NEARLY_ALL[1]) < 0:
        return NOWHERE
    along = before[:, int(partner(plane.normal))] / np.abs(before[:, plane.normal])
    low, high = np.percentile(along, NEARLY_ALL)
    return float(low), float(high)


def rays_before(setting: Setting, plane: BodyPlane, pixels: Float) -> Float:
    """(M, K) world rays of those pixels (P, 2) that meet a plane before the camera."""
    rays = world_rays(pixels, setting.sight.matrix, setting.sight.rotation)
    before: Float = rays[rays[:, plane.normal] * plane.side > 0]
    return before


def _overlap(one: tuple[float, float], other: tuple[float, float]) -> float:
    """Share of the shorter of two intervals that lies in the other."""
    shorter = min(one[1] - one[0], other[1] - other[0])
    both = min(one[1], other[1]) - max(one[0], other[0])
    return float(np.clip(both / shorter, 0.0, 1.0)) if shorter > 0 else 0.0


def _shared(bodies: tuple[int, int], one: BodyPlane, other: BodyPlane, distance: float, overlap: float) -> SharedPlane:
    return SharedPlane(
        bodies,
        other.log_offset - one.log_offset,
        one.normal,
        distance,
        (one.share, other.share),
        (len(one.lines), len(other.lines)),
        one.rank + other.rank,
        overlap,
    )


def is_induced(plane: SharedPlane, connected: float) -> bool:
    """Whether crossings made the two planes one, in a fit that connects the bodies in so many of its repetitions."""
    return abs(plane.log_ratio) < INDUCED and connected > INDUCED_CONNECTED
