"""What a person said that parts of the photo show: evidence that no other outweighs, and labels that end there.

A correction stays local: away from the areas, what was seen without them outweighs most evidence.

An *area* is a part of the photo with what it shows; no two areas share a place, since the later word counts.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import cv2
import numpy as np
import shapely

from linecad.arrays import Bool, Float, Int
from linecad.corrections.edits import Shown
from linecad.model.regions import partition
from linecad.model.regions.evidence import CLUTTER, SKY
from linecad.model.regions.heaven import Heaven
from linecad.model.regions.raster import Raster
from linecad.model.regions.surfaces import RELIEF, Surface, apart
from linecad.scene import Camera

FALSE = 200.0  # cost of another label, in samples: more than all borders, edges and colours of a sample together
KEPT = 1.0  # cost of another label than was seen without what was told, in samples
AROUND = 12.0  # samples about an area, in which labels are free to follow it
LEAST_AREA = 1e-6  # px^2; what later words leave of an earlier area, and is less, is rounding


@dataclass(frozen=True, eq=False)
class Area:
    """A part of the photo and what it shows: a wall, or one of the words of `Region`."""

    shape: shapely.Geometry  # px
    shows: Shown | Surface


@dataclass(frozen=True, eq=False)
class Before:
    """What samples were seen to show before anything was told."""

    surfaces: list[Surface]  # K
    label: Int  # (S,) from 0: a surface, then the sky, then clutter


@dataclass(frozen=True, eq=False)
class Told:
    """All areas of a photo, in the order in which they were told."""

    areas: tuple[Area, ...] = ()
    notes: tuple[str, ...] = ()  # on what could not be taken, for people
    camera: Camera | None = None  # of the photo; None where there are no areas
    before: Before | None = None  # what is kept away from the areas

    def with_area(self, corners: Float, shows: Shown | Surface, camera: Camera) -> "Told":
        """The areas with one more, a polygon (V, 2) px: what it covers of others is no part of these any more."""
        photo = shapely.box(-0.5, -0.5, camera.width - 0.5, camera.height - 0.5)
        shape = polygons(shapely.intersection(shapely.make_valid(shapely.Polygon(corners)), photo))
        if shape.is_empty:
            return replace(self, notes=(*self.notes, "a part of the photo that you named lies outside it"))
        rest = [replace(area, shape=polygons(shapely.difference(area.shape, shape))) for area in self.areas]
        kept = [area for area in rest if not area.shape.is_empty]
        return replace(self, areas=(*kept, Area(shape, shows)), camera=camera)

    def shapes(self, *words: Shown) -> shapely.Geometry:
        """The parts of the photo that show one of these, px."""
        return shapely.union_all([area.shape for area in self.areas if area.shows in words])

    def samples(self, word: Shown, raster: Raster) -> Bool:
        """Mask (S,) of the samples that show it."""
        found = np.zeros(raster.size, bool)
        for area in self.areas:
            if area.shows == word:
                found |= raster.inside(area.shape)
        return found

    @cached_property
    def cuts(self) -> list[shapely.Geometry]:
        """Lines, px, along which cells end.

        An outline inside one cell would be a hole in it: two uprights to the photo's border join each to the others.
        """
        if self.camera is None:
            return []
        found: list[shapely.Geometry] = []
        for area in self.areas:
            for part in partition.polygons_of(area.shape):
                corners = shapely.get_coordinates(part.exterior)
                top, bottom = corners[corners[:, 1].argmin()], corners[corners[:, 1].argmax()]
                found += [
                    part.boundary,
                    shapely.LineString([top, (top[0], -0.5)]),
                    shapely.LineString([bottom, (bottom[0], self.camera.height - 0.5)]),
                ]
        return [line for line in found if line.length > 0]

    def cut(self, lines: Float) -> list[shapely.Polygon]:
        """The cells that lines (M, 2, 2) cut out of the photo, px, of which none goes on beyond an area."""
        if not self.areas:
            return partition.cut(lines)
        return partition.cells_between([*shapely.linestrings(lines), *self.cuts])

    def over(self, costs: Float, surfaces: list[Surface], raster: Raster, with_clutter: bool = True) -> Float:
        """Costs (S, K + 2) where what was told is free and all else is FALSE, but for clutter if that is left out."""
        if not self.areas:
            return costs
        found = costs.copy(order="F")
        if self.before is not None:
            self._keep(self.before, found, surfaces, raster)
            self._end(self.before, found, surfaces, raster)
        for area in self.areas:
            number = column_of(area, surfaces)
            if number is None or (area.shows == "clutter" and not with_clutter):
                continue
            inside = raster.inside(area.shape)
            if isinstance(area.shows, Surface):
                found[:, number] = FALSE  # it ends at its edges
            found[inside] = FALSE
            found[inside, number] = 0.0
        return found

    def _keep(self, before: Before, costs: Float, surfaces: list[Surface], raster: Raster) -> None:
        """Raise costs (S, K + 2) of other labels than were seen, away from the areas; but not of new surfaces."""
        near = np.any([raster.inside(area.shape) for area in self.areas], axis=0)
        away = raster.distance(near) > AROUND
        known = {_look(surface): number for number, surface in enumerate(before.surfaces)}
        walls = {id(area.shows) for area in self.areas}
        columns = [None if id(surface) in walls else known.get(_look(surface)) for surface in surfaces]
        columns += [len(before.surfaces), len(before.surfaces) + 1]
        for column, number in enumerate(columns):
            if number is not None:
                costs[away & (before.label != number), column] += KEPT

    def _end(self, before: Before, costs: Float, surfaces: list[Surface], raster: Raster) -> None:
        """Make costs (S, K + 2) FALSE of walls in the planes of told ones, all over the pieces that those cut."""
        for area in self.areas:
            if not isinstance(area.shows, Surface):
                continue
            inside = raster.inside(area.shape)
            for column, surface in enumerate(surfaces):
                if surface is area.shows or (surface.kind, surface.axis) != ("wall", area.shows.axis):
                    continue
                was = [n for n, each in enumerate(before.surfaces) if _look(each) == _look(surface)]
                if was and apart(surface.offset, area.shows.offset) < RELIEF:
                    shown = np.isin(before.label, was).reshape(raster.shape).astype(np.uint8)
                    piece = cv2.connectedComponents(shown, connectivity=4)[1].ravel()
                    costs[(piece > 0) & np.isin(piece, piece[inside]), column] = FALSE

    def sky(self, heaven: Heaven, raster: Raster) -> Heaven:
        """The heaven with what was told of it: told sky shows the sky's colours, what is something else does not."""
        if not self.areas:
            return heaven
        seed = heaven.seed.copy()
        for area in self.areas:
            seed[raster.inside(area.shape)] = area.shows == "sky"
        is_told = any(area.shows == "sky" for area in self.areas)
        return Heaven(seed, (heaven.is_sky or is_told) and bool(seed.any()), heaven.is_ceiling and not is_told)


NOTHING = Told()


def _look(surface: Surface) -> tuple[str, int, float]:
    """What a surface is known by."""
    return surface.kind, surface.axis, surface.offset


def column_of(area: Area, surfaces: list[Surface]) -> int | None:
    """The column of costs of what an area shows; None where that is no surface of these."""
    if area.shows == "sky":
        return SKY % (len(surfaces) + 2)
    if area.shows == "clutter":
        return CLUTTER % (len(surfaces) + 2)
    for number, surface in enumerate(surfaces):
        if surface is area.shows or (area.shows == "ground" and surface.kind == "ground"):
            return number
    return None


def polygons(shape: shapely.Geometry) -> shapely.Geometry:
    """The polygons of a shape as one, without what is rounding."""
    return shapely.union_all(partition.polygons_of(shape, LEAST_AREA))
