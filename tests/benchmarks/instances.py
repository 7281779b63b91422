"""Line graphs of made streets with the paper's statistics: boxes with windows, one camera, noise, no hidden lines.

The paper's graphs have 215 lines and 867 crossings on average, of which 13 % are fake (its data: 751.78 of 867.22 are
real). `make_instance` draws a street from a seed, keeps the lines that the camera sees, and returns a connected part
of their line graph, of the size asked for, together with the truth about each crossing: the meeting of two lines in
space, never a draw. `describe.py` prints what the sizes come to.
"""

from dataclasses import dataclass
from itertools import pairwise

import networkx as nx
import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from linecad.arrays import Bool, Float, Int
from linecad.line_graph import LineGraph, Segments

WIDTH, HEIGHT, FOCAL = 3840, 2160, 1900.0  # px
EYE = 1.7  # m above the street
SAMPLES = 33  # points of a line that are tested for visibility
NOISE = 0.7  # px, standard deviation of each end across the segment
SIGMA = 1.0  # px, the noise that the tolerances assume
SIGMAS = 3.0  # half width of a tolerance
LEAST_TOLERANCE = 2e-3  # log depth
UNINFORMATIVE = np.log(1.6)  # log depth, a tolerance beyond which a crossing says nothing
MISSED = 0.08  # share of the lines that the detector does not see
WINDOWS = 0.15  # share of the bays of a facade with a window of its own
COURSES = 0.75  # share of the storeys and bays that a line across the whole facade divides
REACH = 1.0  # m by which a line may be extended to a real junction


@dataclass(frozen=True)
class Size:
    """How large a street is drawn, and what of it is kept."""

    lines: int  # of the graph, where the street has as many in one connected part
    buildings: int
    bay: float  # m, width of a window with its share of wall; storeys are as high
    span: int  # bays or storeys that a line runs on at most
    shortest: float  # px, of a segment; the graph keeps the longest, so that this only bounds the work
    extension: float  # px, of each end, to find crossings


Ends = tuple[Float, Float]  # (3,) each, of one line, m

PAPER_SIZE = Size(lines=215, buildings=6, bay=0.55, span=15, shortest=20, extension=27)
SMALL_SIZE = Size(lines=26, buildings=4, bay=2.5, span=15, shortest=20, extension=27)
LADDER = {
    "small": SMALL_SIZE,  # fits a size-limited licence
    "paper": PAPER_SIZE,
    "640": Size(lines=640, buildings=6, bay=0.3, span=19, shortest=14, extension=22),
    "2000": Size(lines=2000, buildings=8, bay=0.22, span=17, shortest=9, extension=12),
    "5000": Size(lines=5000, buildings=8, bay=0.15, span=17, shortest=8, extension=9),
}


@dataclass(frozen=True, eq=False)
class Instance:
    """A line graph of N lines and E edges with the truth."""

    graph: LineGraph
    real: Bool  # (E,)


def make_instance(seed: int, size: Size = PAPER_SIZE) -> Instance:
    """The longest lines of a made street that are one part of its line graph; the same for the same arguments."""
    rng = np.random.default_rng(seed)
    rotation = _camera(rng)
    low, high = _buildings(rng, size.buildings)
    lines = np.concatenate([_facade_lines(rng, low[k], high[k], size.bay, size.span) for k in range(len(low))])
    ends, axis, true_ends = _photograph(rng, lines, low, high, rotation, size.shortest)
    ends = _through_vanishing_points(ends, axis, rotation)
    edges, crossing, gap = _crossings(ends, axis, size.extension)
    real = _meet(edges, axis, true_ends)
    graph = _line_graph(ends, axis, edges, crossing, gap, rotation)
    keep = _longest_connected(rng, graph, size.lines)
    inside = np.isin(graph.edges, keep).all(axis=1)
    return Instance(graph.subset(keep), real[inside])


def _longest_connected(rng: np.random.Generator, graph: LineGraph, wanted: int) -> Int:
    """Indices of `wanted` lines in one part, ascending: the shortest go as long as so many remain in one part.

    The last to go may have split off lines with it; then those nearest to some line of the larger part are kept.
    """
    count = len(graph.segments)
    rank = np.empty(count, np.int64)
    rank[np.argsort(-graph.segments.length, kind="stable")] = np.arange(count)
    # The largest part grows with the number of lines, so the least number that suffices is found by halving.
    fewest, enough = 0, count
    while fewest < enough:
        half = (fewest + enough) // 2
        if len(_largest_part(graph, rank < half)) >= wanted:
            enough = half
        else:
            fewest = half + 1
    part = _largest_part(graph, rank < enough)
    edges = graph.edges[np.isin(graph.edges, part).all(axis=1)]
    middle = int(rng.choice(part))
    near = [middle, *(line for _, line in nx.bfs_edges(nx.Graph(edges.tolist()), middle))]
    return np.array(sorted(near[:wanted]))


def _largest_part(graph: LineGraph, chosen: Bool) -> Int:
    """Indices of the lines in the largest connected part of the graph of the chosen ones, ascending."""
    edges = graph.edges[chosen[graph.edges].all(axis=1)]
    count = len(chosen)
    joined = coo_array((np.ones(len(edges)), edges.T), shape=(count, count))
    _, part = connected_components(joined, directed=False)
    members: Int = np.flatnonzero(part == np.bincount(part).argmax())
    return members


def _camera(rng: np.random.Generator) -> Float:
    """World (x right, y along the street, z up) to camera (x right, y down, z forward)."""
    yaw, pitch = rng.uniform(-0.5, 0.5), rng.uniform(-0.1, 0.15)
    base = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
    turn = np.array([[np.cos(yaw), np.sin(yaw), 0], [-np.sin(yaw), np.cos(yaw), 0], [0, 0, 1]])
    nod = np.array([[1, 0, 0], [0, np.cos(pitch), -np.sin(pitch)], [0, np.sin(pitch), np.cos(pitch)]])
    return np.asarray(nod @ base @ turn)


def _buildings(rng: np.random.Generator, count: int) -> tuple[Float, Float]:
    """(M, 3) lower and upper corners, m: two rows along the street, and one building across its end."""
    low, high = [], []
    for side in (-1, 1):
        y = rng.uniform(4, 9)
        for _ in range(count // 2):
            x, depth, along, top = rng.uniform(6, 10), rng.uniform(6, 12), rng.uniform(9, 20), rng.uniform(6, 16)
            low.append([x if side > 0 else -x - depth, y, -EYE])
            high.append([x + depth if side > 0 else -x, y + along, top])
            y += along + rng.uniform(0, 6)
    far = max(corner[1] for corner in high) + rng.uniform(2, 8)
    low.append([-9.0, far, -EYE])
    high.append([rng.uniform(4, 12), far + 10, rng.uniform(6, 15)])
    return np.array(low), np.array(high)


def _facade_lines(rng: np.random.Generator, low: Float, high: Float, bay: float, span: int) -> Float:
    """(L, 2, 3) both ends of the edges of one building and of the windows and courses of its two visible facades."""
    lines = []
    for axis in range(3):
        first, second = (a for a in range(3) if a != axis)
        for u in (low, high):
            for v in (low, high):
                start = low.copy()
                start[first], start[second] = u[first], v[second]
                lines.append((start, _at(start, axis, high[axis])))
    for normal, at in ((1, low[1]), (0, low[0] if low[0] > 0 else high[0])):
        along = 1 - normal
        columns = np.linspace(low[along], high[along], max(2, round((high[along] - low[along]) / bay)) + 1)
        rows = np.linspace(low[2], high[2], max(2, round((high[2] - low[2]) / bay)) + 1)
        margin = rng.uniform(0.15, 0.3, 2) * bay
        corner = _at(low, normal, at)
        for left, right in pairwise(columns):
            for bottom, top in pairwise(rows):
                if rng.random() < WINDOWS:
                    box = [left + margin[0], right - margin[0], bottom + margin[1], top - margin[1]]
                    lines += _rectangle(corner, along, *box)
        for height in rows[1:-1]:
            if rng.random() < COURSES:
                lines += _pieces(rng, _at(corner, 2, height), along, columns, span)
        for place in columns[1:-1]:
            if rng.random() < COURSES:
                lines += _pieces(rng, _at(corner, along, place), 2, rows, span)
    return np.array(lines)


def _pieces(rng: np.random.Generator, start: Float, axis: int, joints: Float, span: int) -> list[Ends]:
    """A line along `axis` through all joints, in pieces of at most `span` of them, as blinds and pipes break it."""
    cuts = [0, *range(int(rng.integers(1, span + 1)), len(joints) - 1, span), len(joints) - 1]
    return [(_at(start, axis, joints[first]), _at(start, axis, joints[last])) for first, last in pairwise(cuts)]


def _rectangle(corner: Float, along: int, left: float, right: float, bottom: float, top: float) -> list[Ends]:
    """The four sides of an upright rectangle in the facade of `corner`."""
    points = [_at(_at(corner, along, u), 2, v) for u, v in ((left, bottom), (right, bottom), (right, top), (left, top))]
    return [(points[0], points[1]), (points[1], points[2]), (points[3], points[2]), (points[0], points[3])]


def _at(point: Float, axis: int, value: float) -> Float:
    moved = point.copy()
    moved[axis] = value
    return moved


def _photograph(
    rng: np.random.Generator, lines: Float, low: Float, high: Float, rotation: Float, shortest: float
) -> tuple[Float, Int, Float]:
    """Ends in px with noise, axis and true ends in m of the longest visible piece of each line that is detected."""
    steps = np.linspace(0, 1, SAMPLES)[:, None]
    found = []
    for start, end in lines[_may_show(lines, rotation, shortest)]:
        points = start + (end - start) * steps
        pixels = _project(points, rotation)
        inside = (pixels >= 0).all(axis=1) & (pixels < [WIDTH, HEIGHT]).all(axis=1)
        seen = np.concatenate([[False], inside & _visible(points, low, high), [False]])
        edges = np.flatnonzero(seen[1:] != seen[:-1]).reshape(-1, 2)
        if len(edges) == 0:
            continue
        first, after = edges[np.argmax(edges[:, 1] - edges[:, 0])]
        first, last = int(first), int(after) - 1
        length = np.linalg.norm(pixels[last] - pixels[first])
        if length >= shortest and rng.random() >= MISSED:
            found.append((pixels[[first, last]], int(np.argmax(np.abs(end - start))), points[[first, last]]))
    ends = np.array([piece[0] for piece in found])
    axis = np.array([piece[1] for piece in found])
    direction = ends[:, 1] - ends[:, 0]
    length = np.linalg.norm(direction, axis=1, keepdims=True)
    direction = direction / length
    across = np.stack([-direction[:, 1], direction[:, 0]], axis=1)
    ends = ends + across[:, None] * rng.normal(0, NOISE, (len(ends), 2, 1))
    short = np.minimum(rng.uniform(-6, 12, (len(ends), 2)), 0.2 * length)  # px by which the detector falls short
    ends = ends + direction[:, None] * (short * [1, -1])[:, :, None]
    return ends, axis, np.array([piece[2] for piece in found])


def _may_show(lines: Float, rotation: Float, shortest: float) -> Bool:
    """(L,) False where a look at both ends already says that no piece of `shortest` px is in the photo; saves time."""
    pixels = _project(lines.reshape(-1, 3), rotation).reshape(-1, 2, 2)
    beyond = np.asarray((pixels < 0).all(axis=1) | (pixels >= [WIDTH, HEIGHT]).all(axis=1)).any(axis=1)
    # An end behind the camera is not a number, and no comparison with it holds.
    return np.asarray(~(beyond | (np.linalg.norm(pixels[:, 1] - pixels[:, 0], axis=1) < shortest)))


def _project(points: Float, rotation: Float) -> Float:
    """(n, 2) px; not finite behind the camera."""
    camera = points @ rotation.T
    depth = np.where(camera[:, 2:] > 0.1, camera[:, 2:], np.nan)
    return FOCAL * camera[:, :2] / depth + [WIDTH / 2, HEIGHT / 2]


def _visible(points: Float, low: Float, high: Float) -> Bool:
    """(n,) whether no building stands between the camera and a point on one of them."""
    with np.errstate(divide="ignore", invalid="ignore"):
        one, other = low / points[:, None], high / points[:, None]
    enter = np.minimum(one, other).max(axis=2)
    leave = np.maximum(one, other).min(axis=2)
    return np.asarray(~((enter < leave) & (enter > 0) & (enter < 1 - 2e-3)).any(axis=1))


def _through_vanishing_points(ends: Float, axis: Int, rotation: Float) -> Float:
    """Each segment turned about its middle to pass through the vanishing point of its axis."""
    middle = ends.mean(axis=1)
    half = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1) / 2
    towards = _towards_vanishing_point(middle, axis, rotation)
    sign = np.sign((towards * (ends[:, 1] - ends[:, 0])).sum(axis=1))
    step = towards * (half * sign)[:, None]
    return np.stack([middle - step, middle + step], axis=1)


def _towards_vanishing_point(middle: Float, axis: Int, rotation: Float) -> Float:
    """(N, 2) unit direction in the photo of a line of this axis through this pixel."""
    x, y, z = rotation[:, axis]
    towards = np.stack([FOCAL * x, FOCAL * y], axis=1) - (middle - [WIDTH / 2, HEIGHT / 2]) * z[:, None]
    return np.asarray(towards / np.linalg.norm(towards, axis=1, keepdims=True))


def _crossings(ends: Float, axis: Int, extension: float) -> tuple[Int, Float, Float]:
    """(E, 2) pairs of segments of different axes that cross after extending, the pixel, and the gap on each side."""
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    along = (ends[:, 1] - ends[:, 0]) / length[:, None]
    edges, pixels, gaps = [], [], []
    for i in range(len(ends) - 1):
        other = np.arange(i + 1, len(ends))
        other = other[axis[other] != axis[i]]
        u, v, offset = along[i], along[other], ends[other, 0] - ends[i, 0]
        area = u[0] * v[:, 1] - u[1] * v[:, 0]
        with np.errstate(divide="ignore", invalid="ignore"):
            s = (offset[:, 0] * v[:, 1] - offset[:, 1] * v[:, 0]) / area
            t = (offset[:, 0] * u[1] - offset[:, 1] * u[0]) / area
        short = np.stack([np.maximum(-s, s - length[i]), np.maximum(-t, t - length[other])], axis=1)
        for k in np.flatnonzero((short <= extension).all(axis=1)):
            edges.append((i, int(other[k])))
            pixels.append(ends[i, 0] + s[k] * u)
            gaps.append(np.maximum(short[k], 0))
    return np.array(edges), np.array(pixels), np.array(gaps)


def _meet(edges: Int, axis: Int, true_ends: Float) -> Bool:
    """(E,) whether the two lines meet in space, within reach of what is seen of both."""
    real = np.zeros(len(edges), bool)
    for k, (i, j) in enumerate(edges.tolist()):
        first, second, third = axis[i], axis[j], 3 - axis[i] - axis[j]
        if abs(true_ends[i, 0, third] - true_ends[j, 0, third]) > 1e-6:
            continue
        outside = []
        for line, own, at in ((i, first, true_ends[j, 0, first]), (j, second, true_ends[i, 0, second])):
            low, high = sorted(true_ends[line, :, own])
            outside.append(max(low - at, at - high))
        real[k] = max(outside) <= REACH
    return real


def _line_graph(ends: Float, axis: Int, edges: Int, crossing: Float, gap: Float, rotation: Float) -> LineGraph:
    """The record, with tolerances from moving each segment across by the pixel noise; all weights are one."""
    matrix = np.array([[FOCAL, 0, WIDTH / 2], [0, FOCAL, HEIGHT / 2], [0, 0, 1]])
    to_world = np.linalg.inv(matrix @ rotation).T
    middle = ends.mean(axis=1)
    end_rays = np.concatenate([ends, np.ones((len(ends), 2, 1))], axis=2) @ to_world
    rays = np.concatenate([middle, np.ones((len(ends), 1))], axis=1) @ to_world
    towards = _towards_vanishing_point(middle, axis, rotation)
    across = np.stack([-towards[:, 1], towards[:, 0], np.zeros(len(ends))], axis=1) @ to_world * SIGMA
    i, j = edges.T
    coordinate = 3 - axis[i] - axis[j]
    d_i, d_j = rays[i, coordinate], rays[j, coordinate]
    spread = np.hypot(across[i, coordinate] / d_i, across[j, coordinate] / d_j)
    tolerance = np.maximum(SIGMAS * spread, LEAST_TOLERANCE)
    possible = d_i * d_j > 0
    inside = (gap == 0).sum(axis=1)
    return LineGraph(
        segments=Segments(ends, axis),
        rays=rays,
        end_rays=end_rays,
        edges=edges,
        crossing=crossing,
        gap=gap,
        kind=np.array(["L", "T", "X"])[inside],
        corner=np.zeros(len(edges), bool),
        weight=np.ones(len(edges)),
        coordinate=coordinate,
        log_ratio=np.where(possible, np.log(np.where(possible, d_j / d_i, 1.0)), 0.0),
        tolerance=tolerance,
        possible=possible,
        informative=tolerance <= UNINFORMATIVE,
    )
