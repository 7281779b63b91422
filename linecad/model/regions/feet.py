"""Walls that end on the ground: their borders with it moved to the line in which the two planes meet.

Borders follow lines of the photo, and few corners are cheap, so that a foot may be a little off the true meet. In the
photo that is some pixels; seen from above, where the ground is foreshortened in the photo, it is a gap.
"""

from dataclasses import replace

import numpy as np
import shapely

from linecad.arrays import Float
from linecad.directions import UP, directions_of
from linecad.geometry import vanishing_points
from linecad.model.regions import partition
from linecad.model.regions.filling import Filled
from linecad.model.regions.labels import STRAIGHT, Labels
from linecad.model.regions.raster import Raster
from linecad.model.regions.segments import View
from linecad.model.regions.surfaces import Surface
from linecad.scene import Camera

REACH = 0.02  # of the photo's width, between a border and the meet; what is further off is another thing
UPRIGHT = 0.2  # sine to the upright direction, of the sides of walls
LEAST_STRIP = 1e-3  # px^2
ON_EDGE = 1e-3  # px


def on_ground(filled: Filled, raster: Raster, view: View) -> Filled:
    """The regions with the feet of walls where their planes meet the ground."""
    labels = filled.labels
    strips = _strips(labels, view)
    if not strips:
        return filled
    outlines = shapely.boundary(np.array([*labels.cells, *(strip for strip, _ in strips)], object))
    cells = partition.cells_between(list(outlines))
    middle = shapely.point_on_surface(np.array(cells, object))
    label = np.full(len(cells), labels.clutter)
    point, old = shapely.STRtree(labels.cells).query(middle, predicate="within")
    label[point] = labels.label[old]
    for strip, number in strips:
        label[shapely.contains(strip, middle)] = number
    cell = partition.draw(cells, raster.shape, raster.step)
    return replace(filled, labels=replace(labels, cells=cells, cell=cell, label=label))


def _strips(labels: Labels, view: View) -> list[tuple[shapely.Polygon, int]]:
    """The parts of the photo between borders and meets, px, with the label that each gets."""
    shapes = np.array(labels.cells, object)
    # With all corners of their cells, so that neighbours share pieces exactly.
    regions = {
        number: shapely.union_all(shapes[labels.label == number])
        for number in np.unique(labels.label[labels.label < labels.sky]).tolist()
    }
    found: list[tuple[shapely.Polygon, int]] = []
    for ground, wall in ((a, b) for a in regions for b in regions):
        if labels.surfaces[ground].kind != "ground" or labels.surfaces[wall].kind != "wall":
            continue
        meet = image_line(labels.surfaces[wall], labels.surfaces[ground], view)
        for chain in borders_between(shapely.boundary(regions[ground]), shapely.boundary(regions[wall])):
            for quad in _between(chain, meet, view):
                for before, after in ((ground, wall), (wall, ground)):
                    strip = shapely.intersection(quad, regions[before])
                    found += [(part, after) for part in partition.polygons_of(strip, LEAST_STRIP)]
    return found


def borders_between(one: shapely.Geometry, other: shapely.Geometry) -> list[Float]:
    """What two outlines of regions, px, share: chains (V, 2) with corners only where they turn."""
    shared = shapely.get_parts(shapely.intersection(one, other))
    pieces = [part for part in shared if isinstance(part, shapely.LineString) and part.length > 0]
    if not pieces:
        return []
    merged = shapely.simplify(shapely.line_merge(shapely.MultiLineString(pieces)), STRAIGHT)
    return [shapely.get_coordinates(chain) for chain in shapely.get_parts(merged)]


def image_line(one: Surface, other: Surface, view: View) -> Float:
    """The image line (3,) in which two surfaces of different normals meet: zero for (u, v, 1) on it, px."""
    # On it the ray has the ratio of both offsets in their two components.
    normals = directions_of(view.turns)
    line = (
        (other.offset * normals[one.axis] - one.offset * normals[other.axis])
        @ view.rotation.T
        @ np.linalg.inv(view.camera.matrix)
    )
    scaled: Float = line / np.hypot(line[0], line[1])
    return scaled


def _between(chain: Float, meet: Float, view: View) -> list[shapely.Polygon]:
    """The parts of the photo between a border (V, 2) px and a meet (3,), along uprights; none where they are apart."""
    chain = beyond_photo(chain, view.camera, REACH * view.camera.width)
    upright = vanishing_points(view.camera.matrix, view.rotation)[UP]
    direction = upright[:2] - chain * upright[2]
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    with np.errstate(divide="ignore", invalid="ignore"):
        step = -(chain @ meet[:2] + meet[2]) / (direction @ meet[:2])
    moved = chain + step[:, None] * direction
    quads = []
    for number in range(len(chain) - 1):
        along = chain[number + 1] - chain[number]
        along = along / np.linalg.norm(along)
        if abs(along[0] * direction[number, 1] - along[1] * direction[number, 0]) < UPRIGHT:
            continue  # the side of a wall
        if not (np.abs(step[number : number + 2]) < REACH * view.camera.width).all():
            return []
        corners = np.array([chain[number], chain[number + 1], moved[number + 1], moved[number]])
        quads += partition.polygons_of(shapely.make_valid(shapely.Polygon(corners)))
    return quads


def beyond_photo(chain: Float, camera: Camera, reach: float) -> Float:
    """A border (V, 2) px that goes on for `reach` px outside the photo where it ends on the photo's edge.

    Uprights lean there, and a strip between two of them would leave a splinter beside the edge.
    """
    longer = chain.copy()
    for end, next_to in ((0, 1), (-1, -2)):
        low, high = chain[end] + 0.5, np.array([camera.width, camera.height]) - 0.5 - chain[end]
        if min(low.min(), high.min()) < ON_EDGE:
            along = chain[end] - chain[next_to]
            longer[end] += along * (reach / np.linalg.norm(along))
    return longer
