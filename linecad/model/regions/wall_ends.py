"""From where to where each wall goes, as the photo shows it: up to its corners, and no further."""

from dataclasses import dataclass

import numpy as np
import shapely

from linecad.arrays import Float, Int
from linecad.directions import UP, components, partner
from linecad.geometry import directions_to, vanishing_points, world_rays
from linecad.model.regions import partition
from linecad.model.regions.corners import LEAST_HEIGHT, walls_beside
from linecad.model.regions.labels import Labels
from linecad.model.regions.raster import Raster
from linecad.model.regions.segments import View

LARGE = 0.1  # of the largest part of a wall, of those that tell how far it goes
UPRIGHT = 0.02  # of the photo's width, of the piece of an upright that is drawn out
CORNER = 0.03  # log depth, by which two walls may differ at their border for this to be their corner
MOST_BEYOND = 0.1  # of what the photo shows of a wall; with more of it beyond, another wall only abuts on it


@dataclass(frozen=True, eq=False)
class Ends:
    """The ends of one wall."""

    low: float  # component along the wall
    high: float
    uprights: Float  # (2, 2, 2) px, a piece of the upright at each end
    beyond: tuple[shapely.Polygon, ...]  # px, what is labelled as the wall though it is beyond a corner


@dataclass(frozen=True, eq=False)
class _Corner:
    """Where a wall ends because another one meets it there."""

    place: float  # component along the wall, and offset of the other one
    inwards: float  # 1 where the wall is at larger components, else -1
    line: Float  # (3,) value for (u, v, 1), px: 0 at the corner, positive beyond it
    pixel: Float  # (2,) of the corner


def ends_of_walls(found: Labels, raster: Raster, view: View) -> dict[int, Ends]:
    """The ends of each wall that the photo shows; none in a room, which is closed."""
    if any(surface.kind == "ceiling" for surface in found.surfaces):
        return {}
    camera = view.camera
    axes = components(view.rotation, view.turns)
    upward = vanishing_points(camera.matrix, view.rotation)[UP]
    corners = _corners(found, raster, view)
    ends = {}
    for number, surface in enumerate(found.surfaces):
        parts = [region for own, region in found.regions if own == number]
        if surface.kind != "wall" or not parts:
            continue
        largest = max(part.area for part in parts)
        outline = np.concatenate([shapely.get_coordinates(part) for part in parts if part.area >= LARGE * largest])
        rays = world_rays(outline, camera.matrix, axes)
        along = surface.offset * rays[:, int(partner(surface.axis))] / rays[:, surface.axis]
        reach, last = [float(along.min()), float(along.max())], outline[[along.argmin(), along.argmax()]]
        beyond: list[shapely.Polygon] = []
        for corner in corners.get(number, []):
            end = 0 if corner.inwards > 0 else 1
            if corner.inwards * (corner.place - reach[end]) > 0:
                reach[end], last[end] = corner.place, corner.pixel
            beyond += [piece for part in parts for piece in _beyond(part, corner, raster.step**2)]
        half = UPRIGHT * camera.width * directions_to(last, np.stack([upward, upward]))
        ends[number] = Ends(reach[0], reach[1], np.stack([last - half, last + half], axis=1), tuple(beyond))
    return ends


def _beyond(part: shapely.Polygon, corner: _Corner, least: float) -> list[shapely.Polygon]:
    """What of a part of the photo is beyond a corner, in pieces of `least` px^2 or more."""
    box = np.array(shapely.box(*part.bounds).exterior.coords[:-1])
    side = partition.positive_part(box, np.column_stack([box, np.ones(len(box))]) @ corner.line)
    return partition.polygons_of(shapely.intersection(part, side), least)


def _corners(found: Labels, raster: Raster, view: View) -> dict[int, list[_Corner]]:
    """The corners at which walls end, by wall."""
    is_wall = [surface.kind == "wall" for surface in found.surfaces]
    beside = walls_beside(found.label[found.cell], is_wall, raster)
    pairs, between = np.sort(beside.walls, axis=1), (beside.left + beside.right) / 2
    corners: dict[int, list[_Corner]] = {}
    for one, other in np.unique(pairs, axis=0).tolist():
        first, second = found.surfaces[one], found.surfaces[other]
        if second.axis != int(partner(first.axis)):
            continue
        ratio = first.offset / between[:, first.axis] / (second.offset / between[:, second.axis])
        meets = (pairs == (one, other)).all(axis=1) & (ratio > 0) & (np.abs(np.log(np.abs(ratio))) < CORNER)
        if meets.sum() < LEAST_HEIGHT * raster.shape[0]:
            continue
        pixel = (beside.at[meets].mean(axis=0)[::-1] + np.array([1.0, 0.5])) * raster.step - 0.5
        for wall, another in ((one, other), (other, one)):
            corner = _corner(found, wall, another, raster, view, pixel)
            corners.setdefault(wall, []).extend([] if corner is None else [corner])
    return corners


def _corner(found: Labels, wall: int, another: int, raster: Raster, view: View, pixel: Float) -> _Corner | None:
    """The corner of one wall with another that is beside it at a pixel (2,); None where it goes on beyond."""
    own, other = found.surfaces[wall], found.surfaces[another]
    rays: Float = raster.rays[found.label[found.cell] == wall]
    along = own.offset * rays[:, other.axis] / rays[:, own.axis]
    inside: Int = np.array([(along < other.offset).sum(), (along > other.offset).sum()])
    if inside.min() > MOST_BEYOND * inside.sum():
        return None
    inwards = 1.0 if inside[1] > inside[0] else -1.0
    # Components of the ray through (u, v, 1); the wall is before the camera, so its own one has the offset's sign.
    to_rays = components(view.rotation, view.turns).T @ np.linalg.inv(view.camera.matrix)
    line = own.offset * to_rays[other.axis] - other.offset * to_rays[own.axis]
    line *= -inwards * np.sign(own.offset) / np.linalg.norm(line[:2])
    on_corner: Float = pixel - (np.append(pixel, 1.0) @ line) * line[:2]
    return _Corner(other.offset, inwards, line, on_corner)
