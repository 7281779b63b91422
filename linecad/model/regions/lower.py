"""What goes on behind walls that are lower than the camera: parapets, counters, hedges, rows of parked cars.

One looks over them, so what is seen above them goes on behind them: a wall down to its foot, and the ground from there
to the lower edge of the photo. What a higher wall hides is not known.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely

from linecad.arrays import Float
from linecad.directions import UP, components
from linecad.geometry import vanishing_points, world_rays
from linecad.model.regions.feet import UPRIGHT, beyond_photo, borders_between
from linecad.model.regions.labels import Labels
from linecad.model.regions.partition import polygons_of, positive_part
from linecad.model.regions.segments import View
from linecad.model.regions.surfaces import Surface

FARTHER = 1.05  # times the depth of a low wall at its top: what begins there is behind it, and does not stand on it
TOUCHING = 0.99  # of that depth, from which on it is no nearer than the wall before it
WITHIN = 1.0  # px under its top, where a wall is looked for
SHORT_OF_NADIR = 0.999  # of the way to where all uprights meet


@dataclass(frozen=True, eq=False)
class _Edge:
    """A piece of the top of a low wall."""

    ends: Float  # (2, 2) px, beyond the photo's edge where it ends on it
    wall: int
    behind: int  # what is seen above it


def parts_behind(labels: Labels, view: View, ending: Sequence[Surface] = ()) -> dict[int, shapely.Geometry]:
    """The parts of the photo, px, in which each surface goes on behind what is seen there, by the number of it.

    Walls that a person told with their edges are `ending` there.
    """
    sight = _Sight.of(labels, view)
    told = [number for number, surface in enumerate(labels.surfaces) if any(surface is each for each in ending)]
    grounds = sorted(
        (number for number in sight.regions if number < labels.sky and labels.surfaces[number].kind == "ground"),
        key=lambda number: -labels.surfaces[number].offset,
    )
    found: dict[int, list[shapely.Geometry]] = {}
    for edge in sight.edges() if grounds else ():
        under = sight.under(edge.ends)
        if edge.behind in grounds:
            found.setdefault(edge.behind, []).append(sight.hidden(edge.behind, under))
            continue
        ground = max(grounds, key=lambda own: (sight.shared(edge.behind, own), sight.shared(edge.wall, own)))
        before_foot = sight.nearness(edge.behind, under) - sight.nearness(ground, under)
        for number, sign in ((edge.behind, 1), (ground, -1)):
            if number in told:
                continue
            part = shapely.get_coordinates(positive_part(under, sign * before_foot))[:-1]
            found.setdefault(number, []).append(sight.hidden(number, part))
    return {number: shapely.union_all(parts) for number, parts in found.items()}


@dataclass(frozen=True, eq=False)
class _Sight:
    """A photo with what its parts show."""

    surfaces: list[Surface]
    regions: dict[int, shapely.Geometry]  # px, of each surface and of clutter; with all corners of their cells
    clutter: int
    view: View
    frame: Float  # (4, 2) px, the corners of the photo

    @staticmethod
    def of(labels: Labels, view: View) -> "_Sight":
        """Of the labels of a photo."""
        shapes = np.array(labels.cells, object)
        regions = {
            number: shapely.union_all(shapes[labels.label == number])
            for number in np.unique(labels.label[labels.label != labels.sky]).tolist()
        }
        right, bottom = view.camera.width - 0.5, view.camera.height - 0.5
        frame = np.array([[-0.5, -0.5], [right, -0.5], [right, bottom], [-0.5, bottom]])
        return _Sight(labels.surfaces, regions, labels.clutter, view, frame)

    @cached_property
    def outlines(self) -> dict[int, shapely.Geometry]:
        """The borders of the regions, px."""
        return {number: shapely.boundary(region) for number, region in self.regions.items()}

    def edges(self) -> Iterator[_Edge]:
        """The tops of low walls, where something farther away is seen above them."""
        kinds = {number: self.surfaces[number].kind for number in self.regions if number != self.clutter}
        for wall in (number for number, kind in kinds.items() if kind == "wall"):
            for behind in (number for number, kind in kinds.items() if kind in ("wall", "ground") and number != wall):
                for border in borders_between(self.outlines[wall], self.outlines[behind]):
                    longer = _pieces(beyond_photo(border, self.view.camera, self.view.camera.width))
                    is_top = [self._is_top(ends, wall) for ends in _pieces(border)]
                    if any(is_top) and self._is_behind(behind, _pieces(border)[is_top], wall):
                        yield from (_Edge(ends, wall, behind) for ends in longer[is_top])

    def _is_top(self, ends: Float, wall: int) -> bool:
        """Whether an edge (2, 2) px of a wall is its upper one, below the camera."""
        down = self._down(ends)
        along = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
        if np.abs(along[0] * down[:, 1] - along[1] * down[:, 0]).min() < UPRIGHT:
            return False
        if not shapely.contains_xy(self.regions[wall], *(ends.mean(axis=0) + WITHIN * down.mean(axis=0))):
            return False
        return bool((world_rays(ends, self.view.camera.matrix, self.view.rotation)[:, UP] < 0).all())

    def _is_behind(self, number: int, tops: Float, wall: int) -> bool:
        """Whether a surface lies behind all of some connected tops (T, 2, 2) px of a wall, far behind one of them."""
        near, far = (self.nearness(each, tops.reshape(-1, 2)).reshape(-1, 2) for each in (wall, number))
        is_behind = (far > 0).all() and (near > TOUCHING * far).all()
        return bool(is_behind and (near.sum(axis=1) > FARTHER * far.sum(axis=1)).any())

    def _down(self, pixels: Float) -> Float:
        """The directions (M, 2) that things fall in at pixels (M, 2)."""
        up = vanishing_points(self.view.camera.matrix, self.view.rotation)[UP]
        along = pixels * up[2] - up[:2]
        down: Float = along / np.linalg.norm(along, axis=1, keepdims=True)
        return down

    def under(self, ends: Float) -> Float:
        """The corners (V, 2) px of the part of the photo under an edge (2, 2), between uprights through its ends."""
        up = vanishing_points(self.view.camera.matrix, self.view.rotation)[UP]
        reach = 2.0 * (self.view.camera.width + self.view.camera.height)
        # Where the camera looks down they meet, at the nadir, so many times nearer.
        to_nadir = SHORT_OF_NADIR * np.linalg.norm(up[:2] - ends * up[2], axis=1)
        nearer = np.maximum(-up[2] * reach / to_nadir, 1.0)
        lower = ends + (reach / nearer)[:, None] * self._down(ends)
        quad = shapely.Polygon([ends[0], ends[1], lower[1], lower[0]])
        corners: Float = shapely.get_coordinates(shapely.intersection(quad, shapely.Polygon(self.frame)))[:-1]
        return corners

    def nearness(self, number: int, pixels: Float) -> Float:
        """1 over the depth (M,) of a surface on the rays of pixels (M, 2)."""
        rays = components(world_rays(pixels, self.view.camera.matrix, self.view.rotation), self.view.turns)
        near: Float = rays[:, self.surfaces[number].axis] / self.surfaces[number].offset
        return near

    def shared(self, one: int, other: int) -> float:
        """The length of the border between two regions, px."""
        return float(shapely.intersection(self.outlines[one], self.outlines[other]).length)

    def hidden(self, number: int, part: Float) -> shapely.Geometry:
        """The part of a convex polygon (V, 2) px in which a surface lies behind what is seen."""
        shape = shapely.Polygon(part) if len(part) else shapely.Polygon()
        found = []
        for other, region in self.regions.items():
            if other == number:
                continue
            before = shape
            if other != self.clutter:
                nearer = self.nearness(other, self.frame) - self.nearness(number, self.frame)
                before = shapely.intersection(shape, positive_part(self.frame, nearer))
            found += polygons_of(shapely.intersection(before, region))
        return shapely.union_all(found)


def _pieces(chain: Float) -> Float:
    """The straight pieces (V - 1, 2, 2) of a chain (V, 2)."""
    return np.stack([chain[:-1], chain[1:]], axis=1)
