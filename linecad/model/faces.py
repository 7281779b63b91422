"""Faces: polygons on planes, as the regions of the photo that show them.

Corners of regions are where image lines cross: of lines of the scene, of the meets of two planes, of the photo's
border. Their rays meet the planes in space, and what is a line's or a plane's coordinate there becomes that number
exactly, so that neighbours share corners and lines lie on the edges they made.
"""

from dataclasses import dataclass, replace

import numpy as np
import shapely

from linecad.arrays import Float
from linecad.directions import MAIN, Turns, across, components, lies_across
from linecad.geometry import world_rays
from linecad.model.regions.filling import Filled
from linecad.model.regions.partition import GRID, polygons_of, positive_part, without_holes
from linecad.model.regions.roofs import Roof
from linecad.model.regions.surfaces import Surface
from linecad.scene import Camera, Face, FaceKind, Lines, Plane

SAME = 1e-7  # of the depth; computed coordinates that differ by less are one
LEAST_AREA = 0.0015  # of the photo
FURTHEST = 2.0  # times the depth of the furthest line, where surfaces end that go on to their horizon
LEAST_CORNERS = 3
ONE_CORNER = 1e-4  # px, within which corners of parts that are joined are one
LEAST_HIDDEN = 0.0002  # of the photo; smaller hidden parts are not worth a ring

KINDS: dict[str, FaceKind] = {
    "wall": "wall", "level": "other", "kerb": "other", "ground": "ground", "ceiling": "ceiling",
}  # fmt: skip


@dataclass(frozen=True, eq=False)
class _Part:
    """A region of one surface with its rings in space: outline, holes, then hidden parts."""

    surface: Surface
    rings: list[Float]  # (V, 3) each
    holes: int
    measured: list[Float]  # the same rings before coordinates that differ by rounding became one number


def faces_seen_and_going_on(
    planes: tuple[Plane, ...], lines: Lines, regions: Filled, camera: Camera, rotation: Float, turns: Turns = ()
) -> tuple[tuple[Plane, ...], tuple[Plane, ...]]:
    """`find_faces` of what is seen alone, and of that with where it goes on unseen; the planes are the same."""
    seen = find_faces(planes, lines, replace(regions, behind={}), camera, rotation, turns)
    if not regions.behind:
        return seen, seen
    return seen, faces_that_go_on(seen, find_faces(planes, lines, regions, camera, rotation, turns))


def faces_that_go_on(seen: tuple[Plane, ...], going_on: tuple[Plane, ...]) -> tuple[Plane, ...]:
    """The planes with faces that go on where others hide them, numbered as those with what is seen alone.

    Where the numbers differ, since a region has no area in space with one of both outlines, what is seen counts.
    """
    numbers = [[(plane.id, plane.axis, plane.offset) for plane in each] for each in (seen, going_on)]
    return going_on if numbers[0] == numbers[1] else seen


def find_faces(
    planes: tuple[Plane, ...], lines: Lines, regions: Filled, camera: Camera, rotation: Float, turns: Turns = ()
) -> tuple[Plane, ...]:
    """The planes with a face for each region that shows one; a ground without lines becomes one more plane.

    `rotation` (3, 3) takes world to camera; `turns` are of further frames.
    """
    axes = components(rotation, turns)
    labels = regions.labels
    area = camera.width * camera.height
    depth = FURTHEST * float((lines.ends @ rotation[2]).max(initial=0.0))
    shown: dict[int, list[shapely.Polygon]] = {}
    parts = []
    for number, whole in labels.regions:
        if number >= labels.sky:
            continue
        surface = labels.surfaces[number]
        seen = _beside(_before(whole, surface, depth, camera, axes), number, regions.roofs)
        shown.setdefault(number, []).extend(polygons_of(seen, LEAST_AREA * area))
    for number, seen in shown.items():
        surface = labels.surfaces[number]
        parts_behind = polygons_of(regions.behind_of(number), LEAST_HIDDEN * area)
        behind = [_before(part, surface, depth, camera, axes) for part in parts_behind]
        unseen = shapely.union_all([part for each in behind for part in polygons_of(each, LEAST_HIDDEN * area)])
        hides = shapely.union_all([regions.clutter, unseen])
        for region in _going_on(seen, unseen):
            hidden = polygons_of(shapely.intersection(region, hides), LEAST_HIDDEN * area)
            hidden = [piece for part in hidden for piece in without_holes(part)]  # a hidden part is one ring
            parts.append(_lifted(surface, region, hidden, camera, axes))
    parts = _snapped(parts, planes, lines)
    faces: dict[int, list[Face]] = {}
    count = 0
    for part in parts:
        face = _face(count, part, turns)
        if face is not None:
            faces.setdefault(id(part.surface), []).append(face)
            count += 1
    return _with_faces(planes, labels.surfaces, faces)


def _before(region: shapely.Polygon, surface: Surface, depth: float, camera: Camera, axes: Float) -> shapely.Geometry:
    """The part of a region in which its surface is before the camera and no deeper than `depth`.

    That is one side of an image line, so that what is cut off is cut off straight.
    """
    corners = shapely.get_coordinates(region.exterior)
    nearness = world_rays(corners, camera.matrix, axes)[:, surface.axis] / surface.offset - 1 / depth
    if nearness.min() >= 0:
        return region
    left, top, right, bottom = shapely.box(*region.bounds).buffer(1).bounds
    frame = np.array([[left, top], [right, top], [right, bottom], [left, bottom]])
    near = world_rays(frame, camera.matrix, axes)[:, surface.axis] / surface.offset - 1 / depth
    return shapely.intersection(region, positive_part(frame, near))


def _going_on(seen: list[shapely.Polygon], behind: shapely.Geometry) -> list[shapely.Polygon]:
    """The regions of a surface, px, with where it goes on `behind` others; what nothing seen goes on as is none."""
    if behind.is_empty or not seen:
        return seen
    whole = shapely.simplify(shapely.union_all([*seen, behind], grid_size=GRID), ONE_CORNER)
    return [part for part in polygons_of(whole) if any(shapely.intersection(part, each).area > 0 for each in seen)]


def _beside(region: shapely.Geometry, number: int, roofs: tuple[Roof, ...]) -> shapely.Geometry:
    """The part of a region of surface `number` that is neither a roof nor above the eave of one that it carries."""
    taken = [roof.polygon for roof in roofs] + [roof.hood for roof in roofs if number in roof.walls]
    return shapely.difference(region, shapely.union_all(taken)) if roofs else region


def with_roofs(
    planes: tuple[Plane, ...], roofs: tuple[Roof, ...], camera: Camera, rotation: Float, turns: Turns
) -> tuple[Plane, ...]:
    """The planes with one more for each roof, which has a face for each part of it that the photo shows.

    The numbers of planes and faces go on.
    """
    number = max([plane.id for plane in planes], default=-1) + 1
    count = max([face.id for plane in planes for face in plane.faces], default=-1) + 1
    found = list(planes)
    for roof in roofs:
        normal = roof.normal(turns)
        offset = float(normal @ roof.eave)
        faces = []
        for part in polygons_of(roof.polygon):
            rings = [
                rays * (offset / (rays @ normal))[:, None]
                for ring in (part.exterior, *part.interiors)
                for rays in (world_rays(shapely.get_coordinates(ring)[:-1], camera.matrix, rotation),)
            ]
            faces.append(Face(count, rings[0], tuple(rings[1:]), kind="roof"))
            count += 1
        found.append(Plane(number, roof.axis, offset, (), tuple(faces), roof.tilt))
        number += 1
    return tuple(found)


def _lifted(
    surface: Surface, region: shapely.Polygon, hidden: list[shapely.Polygon], camera: Camera, axes: Float
) -> _Part:
    """The rings of a region where their rays meet a surface."""
    rings = []
    for ring in (region.exterior, *region.interiors, *(part.exterior for part in hidden)):
        rays = world_rays(shapely.get_coordinates(ring)[:-1], camera.matrix, axes)
        points = rays[:, :MAIN] * (surface.offset / rays[:, surface.axis])[:, None]
        if surface.axis < MAIN:
            points[:, surface.axis] = surface.offset
        rings.append(points)
    return _Part(surface, rings, len(region.interiors), rings)


def _snapped(parts: list[_Part], planes: tuple[Plane, ...], lines: Lines) -> list[_Part]:
    """The parts with one number for coordinates that differ by rounding: a plane's or a line's where it is one."""
    rings = [ring for part in parts for ring in part.rings]
    if not rings:
        return parts
    points = np.concatenate(rings)
    tolerance = SAME * float(np.linalg.norm(points, axis=1).max())
    snapped = points.copy()
    for axis in range(MAIN):
        of_planes = [plane.offset for plane in planes if plane.axis == axis]
        of_surfaces = [part.surface.offset for part in parts if part.surface.axis == axis]
        known = np.unique(np.concatenate([of_planes, of_surfaces, lines.ends[lies_across(lines.axis, axis), 0, axis]]))
        snapped[:, axis] = _joined(points[:, axis], known, tolerance)
    starts = np.cumsum([len(ring) for ring in rings])[:-1]
    new = iter(np.split(snapped, starts))
    return [replace(part, rings=[next(new) for _ in part.rings]) for part in parts]


def _joined(values: Float, known: Float, tolerance: float) -> Float:
    """Values (N,) as the nearest known one (M,), else as the first of those that follow each other closely."""
    joined = values.copy()
    if len(known):
        at = np.searchsorted(known, values)
        below, above = known[np.maximum(at - 1, 0)], known[np.minimum(at, len(known) - 1)]
        nearest = np.where(np.abs(below - values) <= np.abs(above - values), below, above)
        joined = np.where(np.abs(nearest - values) <= tolerance, nearest, values)
    free = np.flatnonzero(~np.isin(joined, known))
    order = free[np.argsort(joined[free], kind="stable")]
    group = np.cumsum(np.r_[False, np.diff(joined[order]) > tolerance]) if len(order) else np.zeros(0, np.int64)
    first = np.flatnonzero(np.r_[True, np.diff(group) > 0]) if len(order) else np.zeros(0, np.int64)
    joined[order] = joined[order[first]][group]
    return joined


def _face(number: int, part: _Part, turns: Turns) -> Face | None:
    """A face; None for a region that has no area in space."""
    flat = sorted(across(np.array(part.surface.axis)).tolist())
    for rings in (part.rings, part.measured):
        outline, *others = [without_spikes(ring) for ring in rings]
        if len(outline) < LEAST_CORNERS:
            return None
        holes = [ring for ring in others[: part.holes] if len(ring) >= LEAST_CORNERS]
        hidden = [ring for ring in others[part.holes :] if len(ring) >= LEAST_CORNERS]
        shell, *inner = (components(ring, turns)[:, flat] for ring in (outline, *holes))
        if shapely.Polygon(shell, inner).is_valid:
            return Face(number, outline, tuple(holes), KINDS[part.surface.kind], tuple(hidden))
    return None


def without_spikes(ring: Float) -> Float:
    """A ring (V, 3) without corners that are the one before, and without edges there and back, all the way or in part.

    A strip of the photo that is thinner than rounding becomes such an edge.
    """
    while True:
        there, back = ring - np.roll(ring, 1, axis=0), np.roll(ring, -1, axis=0) - ring
        idle = (there == 0).all(axis=1)
        tips = np.flatnonzero((np.cross(there, back) == 0).all(axis=1) & ((there * back).sum(axis=1) < 0))
        if idle.any():
            ring = ring[~idle]
        elif len(tips):
            ring = np.delete(ring, tips[0], axis=0)  # one at a time: its neighbours are one corner now
        else:
            return ring


def _with_faces(planes: tuple[Plane, ...], surfaces: list[Surface], faces: dict[int, list[Face]]) -> tuple[Plane, ...]:
    """The planes with their faces, then those of surfaces that no line shows."""
    owned: dict[int, list[Face]] = {}
    for surface in surfaces:
        if surface.plane is not None:
            owned.setdefault(surface.plane, []).extend(faces.get(id(surface), []))
    found = [Plane(plane.id, plane.axis, plane.offset, plane.lines, tuple(owned.get(plane.id, ()))) for plane in planes]
    number = max([plane.id for plane in planes], default=-1) + 1
    for surface in surfaces:
        if surface.plane is None and faces.get(id(surface)):
            found.append(Plane(number, surface.axis, surface.offset, (), tuple(faces[id(surface)])))
            number += 1
    return tuple(found)
