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

from linecad.arrays import Bool, Float
from linecad.directions import UP, components, directions_of, partner
from linecad.geometry import lengths, world_rays
from linecad.model.regions import partition
from linecad.model.regions.filling import Filled
from linecad.model.regions.labelling import Labels
from linecad.model.regions.mapped import is_of_map_at
from linecad.model.regions.raster import Raster
from linecad.model.regions.segments import View
from linecad.model.regions.surfaces import Surface, apart
from linecad.scene import Plane

NEAREST, FURTHEST = 0.5, 12.0  # of what is looked at beside the camera, in heights of the camera
ROW = 0.005  # log of the distance beside the camera
ALONG, COLUMNS = (0.5, 40.0), 320  # along the street, in heights of the camera, evenly in the log
FINEST = 0.5 / 1920  # of the photo's width; a row that is narrower there is not told from the next
FACE = 15  # samples; what is no ground and narrower, between ground, may be a kerb's face
SIDE = 4  # rows on each side of an edge, whose mean colours are compared
BESIDE = 31  # columns over which a difference of colours is averaged: grain and wheels of cars are shorter
EDGE = 3.0  # CIE L*a*b*, least difference across an edge
SAME_WAY = 0.4  # share of the usual difference that a column has at least, along it
STEPS = (0.048, 0.14)  # log height of a kerb's face
USUAL, VARYING = 0.075, 0.35  # usual log height, 12 cm at 1.6 m, and by how much its log varies
LONG, SHORT = 0.08, 0.04  # of the photo's width, that both edges show at least; opposite one of the same height
SAME_STEP = 0.01  # log height within which both sides of a street have one kerb
OPEN = 0.45  # share of the view of it in which what lies behind is as unlike the road as elsewhere
AS_UNLIKE = (0.6, 1.6)  # of the usual difference of road and pavement, what is as unlike
UNLIKE = 6.0  # CIE L*a*b*, least difference between road and pavement
PLAIN = 0.6  # share of the contrast at its edges that road or face may have in itself at most
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
    length: float  # of both its edges in the photo, as a share of its width

    @property
    def weight(self) -> float:
        """Its length, less for a height that few kerbs have."""
        unusual = np.log(self.drop / USUAL) / VARYING
        return self.length * float(np.exp(-(unusual**2) / 2))


@dataclass(frozen=True, eq=False)
class _Lane:
    """The ground on one side of the camera and one way along a street: R rows away from the camera, C along it."""

    colour: NDArray[Any]  # (R, C, 3) CIE L*a*b*
    shown: Bool  # (R, C) whether the photo shows ground there
    length: Float  # (R, C) of the photo, along the row, as a share of its width


@dataclass(frozen=True, eq=False)
class _Places:
    """Where the photo shows a lane."""

    at: Float  # (R, C, 2) px, 0 where it does not
    inside: Bool  # (R, C) whether it does
    shown: Bool  # (R, C) as of the lane
    length: Float  # (R, C)


@dataclass(frozen=True, eq=False)
class _Edge:
    """A row of a lane at which the colour changes."""

    row: int  # the first behind it
    columns: Bool  # (C,) where it does


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
    places = {
        (along, side): [
            seen for way in (1.0, -1.0) if (seen := _places((along, way, side), is_ground, raster, view)) is not None
        ]
        for along in (axis for axis in range(len(directions_of(view.turns))) if axis != UP)
        for side in (1.0, -1.0)
    }  # fmt: skip
    lanes = _lanes(places, view.photo)
    found = [kerb for key, own in lanes.items() for lane in own for kerb in _kerbs(lane, *key, LONG)]
    if not found:
        return []
    best = max(found, key=lambda kerb: kerb.weight)
    opposite = [kerb for lane in lanes[best.along, -best.side] for kerb in _kerbs(lane, best.along, -best.side, SHORT)]
    opposite = [kerb for kerb in opposite if abs(kerb.drop - best.drop) <= SAME_STEP]
    return [best, *sorted(opposite, key=lambda kerb: -kerb.weight)[:1]]


def _places(where: tuple[int, float, float], is_ground: Bool, raster: Raster, view: View) -> _Places | None:
    """The ground along an axis, one way and on one side; None where the photo does not show enough of it."""
    along, way, side = where
    axes = directions_of(view.turns)
    beside = np.exp(np.arange(np.log(NEAREST), np.log(FURTHEST), ROW))
    ahead = np.geomspace(*ALONG, COLUMNS)
    points = (side * beside[:, None] * axes[int(partner(along))])[:, None] + way * ahead[:, None] * axes[along]
    points = points - axes[UP]
    seen = points @ (view.camera.matrix @ view.rotation).T
    depth = seen[..., 2]
    before = depth > NEAREST * np.finfo(np.float32).eps
    pixels, inside = np.empty((*before.shape, 2)), before
    for number, size in enumerate((view.camera.width, view.camera.height)):
        at = seen[..., number] / np.where(before, depth, 1.0)
        inside = inside & (at > 0) & (at < size - 1)
        pixels[..., number] = at
    if not inside.any():
        return None
    pixels[~inside] = 0.0
    column, row = np.rint(raster.samples_of(pixels)).astype(np.int64).transpose(2, 0, 1)
    height, width = raster.shape
    sample = np.clip(row, 0, height - 1) * width + np.clip(column, 0, width - 1)
    step = lengths(np.diff(pixels, axis=0, append=pixels[-1:]))
    shown = inside & is_ground[sample] & (step > FINEST * view.camera.width)
    if not shown.any():
        return None
    length = lengths(np.diff(pixels, axis=1, append=pixels[:, -1:])) / view.camera.width
    length[:, :-1] *= inside[:, 1:]
    return _Places(pixels, inside, shown, np.where(shown, length, 0.0))


def _lanes(
    places: dict[tuple[int, float], list[_Places]], photo: NDArray[np.uint8]
) -> dict[tuple[int, float], list[_Lane]]:
    """The lanes at places of a photo (H, W, 3) RGB; what is outside the photo has the colour of its first pixel."""
    tops = [seen.at[seen.inside][:, 1].min() for own in places.values() for seen in own]
    if not tops:
        return {key: [] for key in places}
    top = int(min(tops))
    # Half of the photo is above the horizon, and its conversion would take longer than all else here.
    smooth = cv2.GaussianBlur(photo, (3, 3), 0)
    rows = np.concatenate([smooth[:1], smooth[top:]])
    colour = cv2.cvtColor(np.divide(rows, np.float32(255), dtype=np.float32), cv2.COLOR_RGB2Lab)
    lanes: dict[tuple[int, float], list[_Lane]] = {key: [] for key in places}
    for key, own in places.items():
        for seen in own:
            across, down = seen.at.astype(np.float32).transpose(2, 0, 1)
            row = np.where(seen.inside, down - top + 1, 0)
            lanes[key].append(_Lane(cv2.remap(colour, across, row, cv2.INTER_LINEAR), seen.shown, seen.length))
    return lanes


def _kerbs(lane: _Lane, along: int, side: float, least: float) -> list[Kerb]:
    """All bands of a lane that may be the face of a kerb, `least` of the photo's width long or more."""
    edges = _edges(lane, least)
    found = []
    for lower in edges:
        for upper in edges:
            drop = (upper.row - lower.row) * ROW
            if STEPS[0] <= drop <= STEPS[1]:
                length = _length_of_kerb(lane, lower, upper)
                if length >= least:
                    # An edge lies between its row and the one before.
                    at = float(np.log(NEAREST) + (upper.row - 0.5) * ROW)
                    found.append(Kerb(along, side, at, drop, length))
    return found


def _edges(lane: _Lane, least: float) -> list[_Edge]:
    """The rows of a lane at which the colour changes along `least` of the photo's width, the longest first."""
    across, seen = _differences(lane)
    contrast = np.linalg.norm(across, axis=2)
    peak = (contrast > EDGE) & (contrast >= cv2.dilate(contrast, np.ones((2 * SIDE - 1, 1))))
    near = (cv2.dilate(peak.astype(np.uint8), np.ones((3, 1), np.uint8)) > 0) & seen
    length = (near * lane.length).sum(axis=1)
    exact = ((peak & seen) * lane.length).sum(axis=1)
    found: list[_Edge] = []
    for row in np.argsort(-length, kind="stable").tolist():
        if length[row] < least:
            break
        # The rows beside an edge are near it as much as its own.
        row = row - 1 + int(exact[row - 1 : row + 2].argmax())
        if any(abs(row - edge.row) < SIDE for edge in found):
            continue
        usual = _median(across[row][near[row]], lane.length[row][near[row]])
        size = float(usual @ usual)
        columns = near[row] & (across[row] @ usual > SAME_WAY * size)
        if size >= EDGE**2 and lane.length[row][columns].sum() >= least:
            found.append(_Edge(row, columns))
    return found


def _differences(lane: _Lane) -> tuple[NDArray[np.float32], Bool]:
    """By how much (R, C, 3) the SIDE rows from each on differ from those before it, and where (R, C) all are shown."""
    colour = np.where(lane.shown[..., None], lane.colour, 0)
    sums = np.concatenate([np.zeros((1, *colour.shape[1:]), np.float32), np.cumsum(colour, axis=0)])
    count = np.concatenate([np.zeros((1, colour.shape[1]), np.int64), np.cumsum(lane.shown, axis=0)])
    across = np.zeros_like(colour)
    across[SIDE:-SIDE] = (sums[2 * SIDE : -1] - 2 * sums[SIDE : -SIDE - 1] + sums[: -2 * SIDE - 1]) / SIDE
    seen = np.zeros(lane.shown.shape, bool)
    seen[SIDE:-SIDE] = count[2 * SIDE : -1] - count[: -2 * SIDE - 1] == 2 * SIDE
    across = np.where(seen[..., None], across, 0)
    share = cv2.blur(seen.astype(np.float32), (BESIDE, 1))
    mean = cv2.blur(across, (BESIDE, 1)) / np.maximum(share, 1 / BESIDE)[..., None]
    return np.where(seen[..., None], mean, 0).astype(np.float32), seen


def _length_of_kerb(lane: _Lane, lower: _Edge, upper: _Edge) -> float:
    """The length, as a share of the photo's width, of the band between two edges if it is a kerb's face, else 0."""
    first, last = max(0, lower.row - ROAD), upper.row + PAVEMENT
    if last > len(lane.shown):
        return 0.0
    both = lower.columns & upper.columns & lane.shown[upper.row : last].all(axis=0)
    length = float(lane.length[lower.row][both].sum())
    if length == 0 or _share_as_unlike(lane, lower, upper, both) < OPEN:
        return 0.0
    road = np.median(lane.colour[first : lower.row - 1, both], axis=1)
    face = np.median(lane.colour[lower.row + 3 : upper.row - 2, both], axis=1)
    pavement = np.median(lane.colour[upper.row + 2 : last, both], axis=1)
    middle = [np.median(part, axis=0) for part in (road, face, pavement)]
    at_lower, at_upper = (float(np.linalg.norm(middle[number + 1] - middle[number])) for number in range(2))
    is_plain = _spread(road) <= PLAIN * at_lower and _spread(face) <= PLAIN * min(at_lower, at_upper)
    is_told = min(at_lower, at_upper) >= EDGE and np.linalg.norm(middle[2] - middle[0]) >= UNLIKE
    is_grey = abs(middle[0][1]) < GREY and middle[0][2] < GREY
    return length if is_plain and is_told and is_grey else 0.0


def _share_as_unlike(lane: _Lane, lower: _Edge, upper: _Edge, usual: Bool) -> float:
    """Share of the view of both edges, by length, in which road and pavement differ as in `usual` columns (C,)."""
    near, far = slice(max(0, lower.row - 2 * SIDE), lower.row - 1), slice(upper.row + 2, upper.row + 2 * SIDE + 1)
    (before, road), (behind, pavement) = _mean(lane, near), _mean(lane, far)
    across = pavement - road
    middle = np.median(across[usual], axis=0)
    share = across @ middle / max(float(middle @ middle), EDGE**2)
    length = np.where(lane.shown[lower.row] & lane.shown[upper.row], lane.length[lower.row], 0.0)
    return float(length[before & behind & (share > AS_UNLIKE[0]) & (share < AS_UNLIKE[1])].sum() / length.sum())


def _mean(lane: _Lane, rows: slice) -> tuple[Bool, NDArray[Any]]:
    """Which columns (C,) of a lane are shown in some rows, and their mean colour (C, 3) there."""
    shown = lane.shown[rows]
    count = shown.sum(axis=0)
    return count > 0, (lane.colour[rows] * shown[..., None]).sum(axis=0) / np.maximum(count, 1)[:, None]


def _spread(rows: NDArray[Any]) -> float:
    """How far colours (M, 3) go apart."""
    return float(np.linalg.norm(np.ptp(rows, axis=0)))


def _median(values: NDArray[np.float32], weight: Float) -> Float:
    """The weighted median (3,) of colours (M, 3)."""
    found = np.zeros(3)
    for channel in range(3):
        order = np.argsort(values[:, channel], kind="stable")
        sums = np.cumsum(weight[order])
        found[channel] = values[order[int(np.searchsorted(sums, sums[-1] / 2))], channel]
    return found


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
