"""From what a person said about faces to areas of the photo, with the walls and the ground that they ask for."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely

from linecad.arrays import Float, Int
from linecad.corrections.edits import FaceEdit, Point, Region, WallByEdges
from linecad.directions import UP, components, partner
from linecad.geometry import project, world_rays
from linecad.model.openings.corners import on_wall
from linecad.model.regions.segments import View
from linecad.model.regions.surfaces import RELIEF, GroundOfFeet, Surface, apart, weights_of, with_ground
from linecad.model.regions.told import Told
from linecad.scene import Lines, Plane
from linecad.ties.depth_samples import median_place, weighted_median

ON_GROUND = 0.9  # share of a level line that told ground must cover in the photo, for the line to lie on it
IN_THE_SKY = "what you called ground lies above the horizon, where no ground can be seen; draw around what is below it"
APART = 0.01  # log offset between the edges of one wall, above which a note says so


@dataclass(frozen=True, eq=False)
class Rectangle:
    """A wall by its edges."""

    surface: Surface
    corners: Float  # (4, 3) world
    apart: float  # largest log offset of an edge from the wall


def tell(
    faces: Sequence[FaceEdit],
    planes: tuple[Plane, ...],
    lines: Lines,
    surfaces: list[Surface],
    view: View,
    feet: GroundOfFeet | None,
) -> tuple[Told, list[Surface]]:
    """The areas that `faces` tell of, and the surfaces with those that they ask for.

    A wall by edges is one more surface, in the plane of the one that is there if there is one. Told ground has the
    height of the level lines on it where no ground was found, else the one that `feet` tell, else that of the lowest
    end of a line.
    """
    told = Told()
    for edit in faces:
        match edit:
            case Region(shows="ground") if is_above_horizon(edit.polygon, view.camera.matrix, view.rotation):
                told = replace(told, notes=(*told.notes, IN_THE_SKY))
            case Region():
                told = told.with_area(np.array(edit.polygon), edit.shows, view.camera)
            case WallByEdges():
                found = wall_by_edges(edit, planes, lines, surfaces, view)
                if isinstance(found, str):
                    told = replace(told, notes=(*told.notes, found))
                    continue
                surfaces = _with_wall(surfaces, found.surface)
                corners = project(found.corners, view.camera.matrix, view.rotation)
                told = told.with_area(corners, found.surface, view.camera)
                if found.apart > APART:
                    words = (
                        f"a wall by four edges stands where the surest is; another is {np.expm1(found.apart):.0%} off"
                    )
                    told = replace(told, notes=(*told.notes, words))
    ground = told.shapes("ground")
    if ground.is_empty or any(surface.kind == "ground" for surface in surfaces):
        return told, surfaces
    height = ground_height(ground, lines, feet)
    if height is None:
        words = "what you called ground has no face: nothing tells how low it is; draw a line that lies on it"
        return replace(told, notes=(*told.notes, words)), surfaces
    return told, with_ground(surfaces, height)


def is_above_horizon(polygon: Sequence[Point], K: Float, R: Float) -> bool:
    """Whether no ray of a part of the photo, px, goes down."""
    return bool((world_rays(np.array(polygon), K, R)[:, UP] >= 0).all())


def ground_height(ground: shapely.Geometry, lines: Lines, feet: GroundOfFeet | None) -> float | None:
    """Height of the camera above told ground, px; None where no line is below the horizon and feet tell nothing."""
    segments = shapely.linestrings(lines.segment)
    share = shapely.length(shapely.intersection(segments, ground)) / shapely.length(segments)
    low = -lines.ends[:, :, UP].min(axis=1)
    on_it = np.flatnonzero((lines.axis != UP) & (share >= ON_GROUND) & (low > 0))
    if len(on_it):
        return weighted_median(low[on_it], weights_of(lines)[on_it])
    if feet is not None:
        return feet.height
    return float(low.max()) if low.max(initial=0.0) > 0 else None


def wall_by_edges(
    edit: WallByEdges, planes: tuple[Plane, ...], lines: Lines, surfaces: list[Surface], view: View
) -> Rectangle | str:
    """The wall between four lines of the photo, or why there is none.

    It stands where the middle one of those stands that are in the scene, by their length and probability, in the plane
    of the wall that is there if there is one. The others bound it where their rays meet that plane.
    """
    along = next(line.axis for line in edit.lines if line.axis != UP)
    normal = int(partner(along))
    rows = rows_of(edit, lines)
    there = np.array([row for row in rows if row is not None], np.int64)
    if not len(there):
        return "a wall by four edges is left out: none of its edges is in the model; join one to other lines"
    offsets = components(lines.ends[there, 0], view.turns)[:, normal]
    best = median_place(offsets, weights_of(lines)[there])
    surface = _surface(normal, float(offsets[best]), there, int(lines.id[there[best]]), planes)
    alike = [each for each in surfaces if (each.kind, each.axis) == ("wall", normal)]
    alike = [each for each in alike if apart(each.offset, surface.offset) < RELIEF]
    if surface.plane is not None:  # which is the wall's, whatever is there without lines
        alike = [each for each in alike if each.plane is not None]
    if alike:
        # In the same plane, but another surface: where it ends, the one that was found ends too.
        near = min(alike, key=lambda each: apart(each.offset, surface.offset))
        surface = replace(surface, offset=near.offset, plane=near.plane)
    sides: dict[int, list[float]] = {along: [], UP: []}
    for line, row in zip(edit.lines, rows, strict=True):
        across = along if line.axis == UP else UP
        own = None if row is None else components(lines.ends[row, 0], view.turns)
        if own is not None and own[normal] == surface.offset:
            sides[across].append(float(own[across]))
            continue
        rays = components(world_rays(np.array(line.ends), view.camera.matrix, view.rotation), view.turns)
        if (rays[:, normal] * surface.offset <= 0).any():
            return "a wall by four edges is left out: it would go on behind the camera"
        sides[across].append(float((rays[:, across] / rays[:, normal]).mean() * surface.offset))
    (u0, u1), (v0, v1) = sorted(sides[along]), sorted(sides[UP])
    if not (u0 < u1 and v0 < v1):
        return "a wall by four edges is left out: it has no area; choose two lines of each direction that are apart"
    corners = on_wall(np.array([[u0, v0], [u1, v0], [u1, v1], [u0, v1]]), normal, surface.offset, view.turns)
    # The camera is the origin: what is behind another edge is so on all rays.
    return Rectangle(surface, corners, max(apart(surface.offset, float(offset)) for offset in offsets))


def _surface(normal: int, offset: float, rows: Int, line: int, planes: tuple[Plane, ...]) -> Surface:
    """A wall at an offset, in the plane of the line with that id if it has one of that normal."""
    plane = next((each.id for each in planes if each.axis == normal and line in each.lines), None)
    return Surface("wall", normal, offset, rows, plane)


def rows_of(edit: WallByEdges, lines: Lines) -> list[int | None]:
    """The rows of the four lines in a scene; None for one that is not in it."""
    return [lines.row_by_look.get((line.axis, np.array(line.ends).tobytes())) for line in edit.lines]


def _with_wall(surfaces: list[Surface], wall: Surface) -> list[Surface]:
    """The surfaces with a wall, before ground and ceiling."""
    first = next((n for n, each in enumerate(surfaces) if each.kind in ("ground", "ceiling")), len(surfaces))
    return [*surfaces[:first], wall, *surfaces[first:]]
