"""Window grids that continue from one body of lines to another: scale cues between bodies of one facade.

The storeys of a facade are often bodies of their own, since nothing between them crosses. But their jambs stand above
each other, and the sills of one row lie on one image line through their vanishing point. Each such pair is a
coincidence if the two bodies have nothing to do with each other; how many of those are usual, pairs tell that miss
each other by a little more. If there are too many for chance, both bodies lie in one plane, which gives the scale.
"""

from dataclasses import dataclass

import numpy as np

from linecad.arrays import Bool, Float, Int, true_places
from linecad.directions import UP, lies_across
from linecad.geometry import PhotoLength, directions_to, vanishing_points
from linecad.graph.connectivity import group_numbers
from linecad.line_graph import LineGraph
from linecad.model.body_scales import ScaleCues
from linecad.scene import Camera

ACROSS = PhotoLength(2.5, floor=0.8)  # between two segments of one image line
WIDER = 6.0  # times that distance, in which pairs are counted that are chance
RELIEF = 0.02  # of a wall's distance, by which its lines may stand off its plane
FEWEST_LINES = 4  # of a wall
TOLERANCE = 0.02  # log scale; what relief makes of the planes of two bodies


@dataclass(frozen=True, eq=False)
class _Wall:
    """The wall of a body along one axis, that with the most lines by length."""

    lines: Int  # (M,)
    log_offset: float  # of the plane's distance from the camera along its normal
    side: int  # of the camera, 1 or -1


def find_window_grid_cues(graph: LineGraph, camera: Camera, axes: Float, bodies: list[Int], offset: Float) -> ScaleCues:
    """Scale cues between bodies, each given by its lines, whose lines have components `offset` (N, K).

    `axes` (3, K) is every direction in the camera frame.
    """
    across = ACROSS.px(camera.width)
    distance = _line_distances(graph, vanishing_points(camera.matrix, axes))
    found: list[tuple[int, int, float, int, float]] = []
    for normal in (axis for axis in range(axes.shape[1]) if axis != UP):
        walls = [_find_wall(graph, body, offset, normal) for body in bodies]
        for first, one in enumerate(walls):
            for second in range(first + 1, len(walls)):
                other = walls[second]
                if one is None or other is None or one.side != other.side:
                    continue
                seen, expected = _coincidences(graph, distance, one.lines, other.lines, across)
                if seen:
                    found.append((first, second, one.log_offset - other.log_offset, seen, expected))
    table = np.array(found, float).reshape(-1, 5)
    return ScaleCues(
        bodies=table[:, :2].astype(np.int64),
        log_ratio=table[:, 2],
        tolerance=np.full(len(table), TOLERANCE),
        seen=table[:, 3],
        expected=table[:, 4],
    )


def _find_wall(graph: LineGraph, body: Int, offset: Float, normal: int) -> _Wall | None:
    """The wall of a body with the given normal, None where it has none."""
    own = body[lies_across(graph.axis[body], normal)]
    place = np.log(np.maximum(np.abs(offset[own, normal]), np.finfo(float).tiny))
    side = np.sign(offset[own, normal])
    length = graph.segments.length[own]
    near = (np.abs(place[:, None] - place) < RELIEF) & (side[:, None] == side)
    best = int((near @ length).argmax()) if len(own) else 0
    if len(own) < FEWEST_LINES or near[best].sum() < FEWEST_LINES:
        return None
    lines = own[near[best]]
    if len(np.unique(graph.axis[lines])) < 2 or side[best] == 0:
        return None
    return _Wall(lines, float(np.average(place[near[best]], weights=length[near[best]])), int(side[best]))


def _line_distances(graph: LineGraph, vanishing: Float) -> list[tuple[Int, Float]]:
    """For each axis: the place (N,) of each line among those of the axis, and how far these pass each other (M, M), px.

    The image line of a segment leads through its vanishing point; of two distances, each from the middle of one to the
    line of the other, the larger counts.
    """
    middle = graph.segments.ends.mean(axis=1)
    found = []
    for axis in range(len(vanishing)):
        own = np.flatnonzero(graph.axis == axis)
        place = np.full(len(middle), -1)
        place[own] = np.arange(len(own))
        along = directions_to(middle[own], vanishing[axis])
        to = middle[own][None] - middle[own][:, None]
        beside = np.abs(to[..., 0] * along[:, None, 1] - to[..., 1] * along[:, None, 0])
        found.append((place, np.maximum(beside, beside.T)))
    return found


def _coincidences(
    graph: LineGraph, distance: list[tuple[Int, Float]], one: Int, other: Int, across: float
) -> tuple[int, float]:
    """How many image lines two walls share, and how many chance would give.

    Four sills in a row on either side are one image line, not sixteen pairs; pairs that miss each other are counted in
    the same measure.
    """
    seen, expected = 0, 0.0
    for axis, (place, apart) in enumerate(distance):
        first, second = place[one[graph.axis[one] == axis]], place[other[graph.axis[other] == axis]]
        if len(first) == 0 or len(second) == 0:
            continue
        between = apart[np.ix_(first, second)]
        same = between < across
        missed = float(((between < WIDER * across) & ~same).sum()) / (WIDER - 1)
        shared = _image_lines(same)
        seen += shared
        expected += missed * shared / same.sum() if shared else missed
    return seen, expected


def _image_lines(same: Bool) -> int:
    """The number of groups of segments that pairs of the mask (A, B) put on one image line."""
    one, other = true_places(same)
    if len(one) == 0:
        return 0
    group = group_numbers(sum(same.shape), np.column_stack([one, len(same) + other]))
    return len(np.unique(group[one]))
