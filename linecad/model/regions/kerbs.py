"""Kerbs: the road lies lower than the pavement on which the walls stand.

Seen from the road, a kerb is a stripe along the street: its face, between the road's edge and the pavement's. Both run
to one vanishing point. Laid onto one level, an image line to that point lies as far beside the camera as its slope
says, and the logs of the slopes of a kerb's two edges differ by the log of the heights of the camera above road and
pavement, wherever the kerb is. A band of 5 to 14 % beside a plain road, with another surface behind it, is a kerb: that
is a step of 8 to 22 cm below an eye at 1.6 m.
"""

from dataclasses import dataclass, replace
from typing import Any

import cv2
import numpy as np
import shapely
from numpy.typing import NDArray

from linecad.arrays import Bool, Float, Int
from linecad.directions import UP, components, partner
from linecad.geometry import world_rays
from linecad.model.regions import partition
from linecad.model.regions.filling import Filled
from linecad.model.regions.labels import Labels
from linecad.model.regions.lanes import EDGE, NEAREST, ROW, SIDE, Edge, Lane, find_edges, find_lanes, mean_of
from linecad.model.regions.mapped import is_of_map_at
from linecad.model.regions.raster import Raster
from linecad.model.regions.segments import View
from linecad.model.regions.surfaces import Surface, apart
from linecad.scene import Plane

FACE = 15  # samples; what is no ground and narrower, between ground, may be a kerb's face
STEPS = (0.048, 0.14)  # log height of a kerb's face
CLEAR = 0.2  # of the photo's width, that a clear edge shows at least where a kerb's other edge is faint
FAINT, CLEARER = 1.5, 3.0  # CIE L*a*b*, least difference across that one; and times the usual one of its rows
NET = 0.5  # share of the difference across a faint edge, by which face and ground differ: beside a line they do not
NEAR = 8.0  # heights of the camera; such an edge is looked for up to there, since shadows farther away look the same
SHOWN = 0.4  # share of a clear edge's columns that a row shows at least
USUAL, VARYING = 0.075, 0.35  # usual log height, 12 cm at 1.6 m, and by how much its log varies
LONG, SHORT = 0.08, 0.04  # of the photo's width, that both edges show at least; opposite one of the same height
SAME_STEP = 0.01  # log height within which both sides of a street have one kerb
OPEN = 0.45  # share of the view of it in which what lies behind is as unlike the road as elsewhere
AS_UNLIKE = (0.6, 1.6)  # of the usual difference of road and pavement, what is as unlike
UNLIKE = 6.0  # CIE L*a*b*, least difference between road and pavement
UNLIKE_ALONE = (12.0, 45.0)  # the same where one edge is faint; a railing differs more from what is sunlit behind it
PLAIN = 0.6  # share of the contrast at a clear edge that road or face may have in itself at most
GREY = 12.0  # CIE a* and b*, most of a road's colour; lawns, floors of wood and tables are no roads. Shadows are blue
ROAD, PAVEMENT = 24, 12  # rows of plain road before a kerb and of ground behind it
SAME_ROAD = 0.015  # log height between the road by its kerb and a level plane of lines that is it


@dataclass(frozen=True)
class Kerb:
    """One edge of a road, with the walls' ground behind it."""

    along: int  # axis of the street
    side: float  # of the camera, 1 or -1 along the partner of that axis
    upper: float  # log distance of its upper edge beside the camera, in heights of the camera above the pavement
    drop: float  # log of the camera's height above the road over that above the pavement
    length: float  # of its clear edges in the photo, where both are seen, as a share of its width

    @property
    def weight(self) -> float:
        """Its length, less for a height that few kerbs have."""
        unusual = np.log(self.drop / USUAL) / VARYING
        return self.length * float(np.exp(-(unusual**2) / 2))


def on_kerbs(filled: Filled, planes: tuple[Plane, ...], raster: Raster, view: View) -> Filled:
    """The regions with the part of the ground that is a road at the road's level, and the faces of kerbs.

    Of the scene's planes the road has the one that lies there, if any.
    """
    kerbs = find_kerbs(filled.labels, raster, view)
    if not kerbs:
        return filled
    labels = filled.labels
    ground = _ground(labels)
    drop = float(np.average([kerb.drop for kerb in kerbs], weights=[kerb.weight for kerb in kerbs]))
    height = -labels.surfaces[ground].offset
    no_lines = np.zeros(0, np.int64)
    road = _level(-height * float(np.exp(drop)), planes, labels.surfaces)
    drop = float(np.log(-road.offset / height))  # so that the kerb's face ends on it exactly
    faces = [
        Surface("kerb", int(partner(kerb.along)), kerb.side * height * float(np.exp(kerb.upper)), no_lines, None)
        for kerb in kerbs
    ]
    lower = [_beyond(kerb, kerb.upper - drop, view) for kerb in kerbs]
    upper = [_beyond(kerb, kerb.upper, view) for kerb in kerbs]
    cells = [*labels.cells]
    walls = [number for number, each in enumerate(labels.surfaces) if any(is_of_map_at(each, one) for one in faces)]
    on_ground = shapely.union_all(np.array(cells, object)[np.isin(labels.label, [ground, *walls])])
    edges = [shapely.intersection(shapely.boundary(part), on_ground) for part in (*lower, *upper)]
    cells = partition.cells_between([*shapely.boundary(np.array(labels.cells, object)), *edges])
    middle = shapely.point_on_surface(np.array(cells, object))
    label = np.full(len(cells), labels.clutter)
    point, old = shapely.STRtree(labels.cells).query(middle, predicate="within")
    label[point] = labels.label[old]
    was_ground, was_wall = label == ground, np.isin(label, walls)
    added = 1 + len(faces)
    label[label >= labels.sky] += added
    label[was_ground] = len(labels.surfaces)
    for number, (before, behind) in enumerate(zip(lower, upper, strict=True)):
        past = shapely.contains(behind, middle)
        label[(was_ground | was_wall) & shapely.contains(before, middle) & ~past] = len(labels.surfaces) + 1 + number
        label[was_ground & past] = ground
    surfaces = [*labels.surfaces, road, *faces]
    cell = partition.draw(cells, raster.shape, raster.step)
    labels = replace(labels, surfaces=surfaces, cells=cells, cell=cell, label=label)
    return replace(filled, labels=labels, drop=float(np.expm1(drop)))


def _level(offset: float, planes: tuple[Plane, ...], surfaces: list[Surface]) -> Surface:
    """A road at a height: the nearest level plane within SAME_ROAD, unless another surface is there."""
    taken = {surface.plane for surface in surfaces}
    free = [plane for plane in planes if plane.axis == UP and plane.offset < 0 and plane.id not in taken]
    near = [plane for plane in free if apart(plane.offset, offset) < SAME_ROAD]
    if not near:
        return Surface("ground", UP, offset, np.zeros(0, np.int64), None)
    plane = min(near, key=lambda each: apart(each.offset, offset))
    return Surface("ground", UP, plane.offset, np.zeros(0, np.int64), plane.id)


def _ground(labels: Labels) -> int:
    return next(number for number, surface in enumerate(labels.surfaces) if surface.kind == "ground")


def find_kerbs(labels: Labels, raster: Raster, view: View) -> list[Kerb]:
    """The kerbs of one street, at most one on each side; none in a room, without pixels or without ground."""
    kinds = {surface.kind for surface in labels.surfaces}
    if view.photo is None or "ground" not in kinds or "ceiling" in kinds:
        return []
    on_ground = (labels.label[labels.cell] == _ground(labels)).astype(np.uint8).reshape(raster.shape)
    closed = cv2.morphologyEx(on_ground, cv2.MORPH_CLOSE, np.ones((FACE, 1), np.uint8))
    is_ground = (closed.ravel() > 0) & ~raster.plants
    lanes = find_lanes(is_ground, raster, view)
    edges = {key: [(lane, find_edges(lane, LONG)) for lane in own] for key, own in lanes.items()}
    found = [kerb for key, own in edges.items() for each in own for kerb in _kerbs(*each, *key, LONG)]
    if not found:
        found = [kerb for key, own in edges.items() for each in own for kerb in _half_seen_kerbs(*each, *key)]
    if not found:
        return []
    best = max(found, key=lambda kerb: kerb.weight)
    there = best.along, -best.side
    shorter = [kerb for lane in lanes[there] for kerb in _kerbs(lane, find_edges(lane, SHORT), *there, SHORT)]
    opposite = shorter + [kerb for kerb in found if (kerb.along, kerb.side) == there]
    opposite = [kerb for kerb in opposite if abs(kerb.drop - best.drop) <= SAME_STEP]
    return [best, *sorted(opposite, key=lambda kerb: -kerb.weight)[:1]]


def _kerbs(lane: Lane, edges: list[Edge], along: int, side: float, least: float) -> list[Kerb]:
    """All bands between edges of a lane that may be the face of a kerb, `least` of the photo's width long or more."""
    found = []
    for lower in edges:
        for upper in edges:
            drop = (upper.row - lower.row) * ROW
            if STEPS[0] <= drop <= STEPS[1]:
                length = _length_of_kerb(lane, lower, upper)
                if length >= least:
                    found.append(_kerb(along, side, (lower.row, upper.row), length))
    return found


def _kerb(along: int, side: float, rows: tuple[int, int], length: float) -> Kerb:
    """One between two rows of a lane, the first ones behind its lower and its upper edge."""
    lower, upper = rows
    # An edge lies between its row and the one before.
    return Kerb(along, side, float(np.log(NEAREST) + (upper - 0.5) * ROW), (upper - lower) * ROW, length)


def _half_seen_kerbs(lane: Lane, edges: list[Edge], along: int, side: float) -> list[Kerb]:
    """All bands of a lane with one clear edge that may be the face of a kerb; the other shows in median colours."""
    found = []
    for edge in edges:
        length = float(lane.length[edge.row][edge.columns].sum())
        if length >= CLEAR and edge.row * ROW <= np.log(NEAR / NEAREST):
            faint = _faint_edge(lane, edge)
            if faint is not None and _is_half_seen(lane, edge, *faint):
                rows = min(edge.row, faint[0]), max(edge.row, faint[0])
                found.append(_kerb(along, side, rows, length))
    return found


def _faint_edge(lane: Lane, edge: Edge) -> tuple[int, float] | None:
    """The row of a kerb's other edge, clearest in the median colours along an edge, and the difference across it.

    None where there is none, as beside the edge of a shadow, or of two kinds of paving.
    """
    least, most = (round(step / ROW) for step in STEPS)
    rows = np.arange(edge.row - most - 3 * SIDE, edge.row + most + 3 * SIDE + 1)
    colour = _along(lane, rows, edge.columns)
    step = np.full(len(rows), np.nan)
    for at in range(SIDE, len(rows) - SIDE):
        step[at] = np.linalg.norm(colour[at : at + SIDE].mean(axis=0) - colour[at - SIDE : at].mean(axis=0))
    around = [step[max(0, at - SIDE) : at + SIDE + 1] for at in range(len(rows))]
    away = np.abs(rows - edge.row)
    with np.errstate(invalid="ignore"):
        peak = (step >= [np.nanmax(part, initial=0) for part in around]) & (step >= FAINT)
        peak &= (away >= least) & (away <= most)
    if not peak.any():
        return None
    at = int(np.flatnonzero(peak)[step[peak].argmax()])
    usual = float(np.nanmedian(step[away > SIDE + 1]))
    return (int(rows[at]), float(step[at])) if step[at] >= CLEARER * usual else None


def _along(lane: Lane, rows: Int, columns: Bool) -> Float:
    """The median colour (M, 3) of rows (M,) of a lane along columns (C,); NaN where little of a row is shown."""
    colour = np.full((len(rows), 3), np.nan)
    for number, row in enumerate(rows.tolist()):
        if 0 <= row < len(lane.shown):
            shown = columns & lane.shown[row]
            if shown.sum() >= SHOWN * columns.sum():
                colour[number] = np.median(lane.colour[row, shown], axis=0)
    return colour


def _is_half_seen(lane: Lane, edge: Edge, other: int, step: float) -> bool:
    """Whether a plain, grey road ends at an edge and a faint one, with a face between them, along enough of the view.

    The pavement is lighter, and the face unlike both, not only at the faint edge, across which colours differ by
    `step`: there may be a line.
    """
    lower, upper = min(edge.row, other), max(edge.row, other)
    road, face, pavement = (_along(lane, np.arange(*rows), edge.columns) for rows in _parts(lower, upper))
    if any(np.isnan(part).any() for part in (road, face, pavement)):
        return False
    before, between, behind = (np.median(part, axis=0) for part in (road, face, pavement))
    unlike = float(np.linalg.norm(behind - before))
    net = min(float(np.linalg.norm(between - before)), float(np.linalg.norm(behind - between)))
    is_plain = _spread(road) <= PLAIN * unlike
    is_told = UNLIKE_ALONE[0] <= unlike <= UNLIKE_ALONE[1] and behind[0] > before[0] and net >= max(FAINT, NET * step)
    return bool(
        is_plain and _is_grey(before) and is_told and _share_as_unlike(lane, lower, upper, edge.columns) >= OPEN
    )


def _length_of_kerb(lane: Lane, lower: Edge, upper: Edge) -> float:
    """The length, as a share of the photo's width, of the band between two edges if it is a kerb's face, else 0."""
    last = upper.row + PAVEMENT
    if last > len(lane.shown):
        return 0.0
    both = lower.columns & upper.columns & lane.shown[upper.row : last].all(axis=0)
    length = float(lane.length[lower.row][both].sum())
    if length == 0 or _share_as_unlike(lane, lower.row, upper.row, both) < OPEN:
        return 0.0
    parts = _parts(lower.row, upper.row)
    road, face, pavement = (np.median(lane.colour[max(0, first) : end, both], axis=1) for first, end in parts)
    middle = [np.median(part, axis=0) for part in (road, face, pavement)]
    at_lower, at_upper = (float(np.linalg.norm(middle[number + 1] - middle[number])) for number in range(2))
    is_plain = _spread(road) <= PLAIN * at_lower and _spread(face) <= PLAIN * min(at_lower, at_upper)
    is_told = min(at_lower, at_upper) >= EDGE and np.linalg.norm(middle[2] - middle[0]) >= UNLIKE
    return length if is_plain and is_told and _is_grey(middle[0]) else 0.0


def _parts(lower: int, upper: int) -> tuple[tuple[int, int], ...]:
    """From which row on and up to which the road is, the face and the pavement, of a kerb between two rows."""
    return (lower - ROAD, lower - 1), (lower + 3, upper - 2), (upper + 2, upper + PAVEMENT)


def _is_grey(colour: Float) -> bool:
    """Whether a road may have a colour (3,)."""
    return bool(abs(colour[1]) < GREY and colour[2] < GREY)


def _share_as_unlike(lane: Lane, lower: int, upper: int, usual: Bool) -> float:
    """Share of the view of two rows, by length, in which road and pavement differ as in `usual` columns (C,)."""
    near, far = slice(max(0, lower - 2 * SIDE), lower - 1), slice(upper + 2, upper + 2 * SIDE + 1)
    (before, road), (behind, pavement) = mean_of(lane, near), mean_of(lane, far)
    across, known = pavement - road, usual & before & behind
    if not known.any():
        return 0.0
    middle = np.median(across[known], axis=0)
    share = across @ middle / max(float(middle @ middle), EDGE**2)
    length = np.where(lane.shown[lower] & lane.shown[upper], lane.length[lower], 0.0)
    return float(length[before & behind & (share > AS_UNLIKE[0]) & (share < AS_UNLIKE[1])].sum() / length.sum())


def _spread(rows: NDArray[Any]) -> float:
    """How far colours (M, 3) go apart."""
    return float(np.linalg.norm(np.ptp(rows, axis=0)))


def _beyond(kerb: Kerb, distance: float, view: View) -> shapely.Geometry:
    """What of the photo, below the horizon, lies further beside the camera than a log distance, px.

    Distances are those of points of the pavement, in heights of the camera above it.
    """
    left, top, right, bottom = -0.5, -0.5, view.camera.width - 0.5, view.camera.height - 0.5
    frame = np.array([[left, top], [right, top], [right, bottom], [left, bottom]])
    parts = world_rays(frame, view.camera.matrix, components(view.rotation, view.turns))
    below = -parts[:, UP]
    further = kerb.side * parts[:, int(partner(kerb.along))] - np.exp(distance) * below
    return shapely.intersection(partition.positive_part(frame, further), partition.positive_part(frame, below))
