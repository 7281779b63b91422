"""Shared planes: two bodies whose main planes of one normal become one plane at one ratio of their scales."""

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from scipy.spatial import cKDTree

from linecad.arrays import Float, Int
from linecad.directions import count_of, lies_across
from linecad.ties.setting import Setting, densest_groups, sample

WIDTH = 0.008  # log offset within which lines lie in one plane
MOST = 4  # planes of a body on one side of the camera, by length of their lines
LONGEST = 400.0  # px of a line that count
LEAST_LINES = 2
WORST_RANK = 2  # of both planes together
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
    found = []
    for (number, (first, one)), (place, (second, other)) in combinations(enumerate(planes), 2):
        if first == second or (one.normal, one.side) != (other.normal, other.side):
            continue
        if one.rank + other.rank <= WORST_RANK:
            distance = float(trees[number].query(points[place])[0].min())
            found.append(_shared((first, second), one, other, distance))
    return found


def _shared(bodies: tuple[int, int], one: BodyPlane, other: BodyPlane, distance: float) -> SharedPlane:
    return SharedPlane(
        bodies,
        other.log_offset - one.log_offset,
        one.normal,
        distance,
        (one.share, other.share),
        (len(one.lines), len(other.lines)),
        one.rank + other.rank,
    )


def is_induced(plane: SharedPlane, connected: float) -> bool:
    """Whether crossings made the two planes one, in a fit that connects the bodies in so many of its repetitions."""
    return abs(plane.log_ratio) < INDUCED and connected > INDUCED_CONNECTED
