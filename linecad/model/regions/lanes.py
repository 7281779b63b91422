"""Lanes: the ground beside the camera and along a street, laid flat, and the edges on it that follow the street.

A row of a lane is a log of the distance beside the camera, in heights of the camera, and so an image line to the
street's vanishing point; a column is one of the distance along the street.
"""

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from linecad.arrays import Bool, Float
from linecad.directions import UP, directions_of, partner
from linecad.geometry import lengths
from linecad.model.regions.raster import Raster
from linecad.model.regions.segments import View
from linecad.ties.depth_samples import weighted_median

NEAREST, FURTHEST = 0.5, 12.0  # of what is looked at beside the camera, in heights of the camera
ROW = 0.005  # log of the distance beside the camera
ALONG, COLUMNS = (0.5, 40.0), 320  # along the street, in heights of the camera, evenly in the log
FINEST = 0.5 / 1920  # of the photo's width; a row that is narrower there is not told from the next
SIDE = 4  # rows on each side of an edge, whose mean colours are compared
BESIDE = 31  # columns over which a difference of colours is averaged: grain and wheels of cars are shorter
EDGE = 3.0  # CIE L*a*b*, least difference across an edge
SAME_WAY = 0.4  # share of the usual difference that a column has at least, along it

Lanes = dict[tuple[int, float], list["Lane"]]  # by the axis of the street, and the side of the camera along its partner


@dataclass(frozen=True, eq=False)
class Lane:
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
class Edge:
    """A row of a lane at which the colour changes."""

    row: int  # the first behind it
    columns: Bool  # (C,) where it does


def find_lanes(is_ground: Bool, raster: Raster, view: View) -> Lanes:
    """The lanes along every level axis on both sides of the camera, one way and the other.

    Only what `is_ground`, of the raster's samples (S,), is shown in them. The view must have a photo.
    """
    assert view.photo is not None
    places: dict[tuple[int, float], list[_Places]] = {}
    for along in (axis for axis in range(len(directions_of(view.turns))) if axis != UP):
        for side in (1.0, -1.0):
            ways = (_find_places((along, way, side), is_ground, raster, view) for way in (1.0, -1.0))
            places[along, side] = [seen for seen in ways if seen is not None]
    return _lanes_of(places, view.photo)


def _find_places(where: tuple[int, float, float], is_ground: Bool, raster: Raster, view: View) -> _Places | None:
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


def _lanes_of(places: dict[tuple[int, float], list[_Places]], photo: NDArray[np.uint8]) -> Lanes:
    """The lanes at places of a photo (H, W, 3) RGB; what is outside the photo has the colour of its first pixel."""
    tops = [seen.at[seen.inside][:, 1].min() for own in places.values() for seen in own]
    if not tops:
        return {key: [] for key in places}
    top = int(min(tops))
    # Half of the photo is above the horizon, and its conversion would take longer than all else here.
    smooth = cv2.GaussianBlur(photo, (3, 3), 0)
    rows = np.concatenate([smooth[:1], smooth[top:]])
    colour = cv2.cvtColor(np.divide(rows, np.float32(255), dtype=np.float32), cv2.COLOR_RGB2Lab)
    lanes: Lanes = {key: [] for key in places}
    for key, own in places.items():
        for seen in own:
            across, down = seen.at.astype(np.float32).transpose(2, 0, 1)
            row = np.where(seen.inside, down - top + 1, 0)
            lanes[key].append(Lane(cv2.remap(colour, across, row, cv2.INTER_LINEAR), seen.shown, seen.length))
    return lanes


def find_edges(lane: Lane, least: float) -> list[Edge]:
    """The rows of a lane at which the colour changes along `least` of the photo's width, the longest first."""
    across, seen = differences_of(lane)
    contrast = np.linalg.norm(across, axis=2)
    peak = (contrast > EDGE) & (contrast >= cv2.dilate(contrast, np.ones((2 * SIDE - 1, 1))))
    near = (cv2.dilate(peak.astype(np.uint8), np.ones((3, 1), np.uint8)) > 0) & seen
    length = (near * lane.length).sum(axis=1)
    exact = ((peak & seen) * lane.length).sum(axis=1)
    found: list[Edge] = []
    for row in np.argsort(-length, kind="stable").tolist():
        if length[row] < least:
            break
        # The rows beside an edge are near it as much as its own.
        row = row - 1 + int(exact[row - 1 : row + 2].argmax())
        if any(abs(row - edge.row) < SIDE for edge in found):
            continue
        colours, weight = across[row][near[row]], lane.length[row][near[row]]
        usual = np.array([weighted_median(channel, weight) for channel in colours.T])
        size = float(usual @ usual)
        columns = near[row] & (across[row] @ usual > SAME_WAY * size)
        if size >= EDGE**2 and lane.length[row][columns].sum() >= least:
            found.append(Edge(row, columns))
    return found


def differences_of(lane: Lane) -> tuple[NDArray[np.float32], Bool]:
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


def mean_of(lane: Lane, rows: slice) -> tuple[Bool, NDArray[Any]]:
    """Which columns (C,) of a lane are shown in some rows, and their mean colour (C, 3) there."""
    shown = lane.shown[rows]
    count = shown.sum(axis=0)
    return count > 0, (lane.colour[rows] * shown[..., None]).sum(axis=0) / np.maximum(count, 1)[:, None]
